//! Errors and median times of every method on every case over its tolerances, the methods taking turns.

use std::hint::black_box;

use crate::case::Case;
use crate::methods::{Method, Whose};
use herringbone_tools::statistics::median;
use herringbone_tools::stopwatch::Stopwatch;

/// Mesh periods of a run.
pub const PERIODS: u64 = 20;

/// A shorter run than this is repeated within its turn, s.
const SHORTEST_TURN_S: f64 = 1e-3;

/// SciPy takes part in so many rounds: its runs take up to a second.
const SCIPY_ROUNDS: usize = 3;

/// After how many periods the error of a case is taken.
pub fn error_periods(case: &Case) -> u64 {
    if case.name == "B" { 5 } else { PERIODS }
}

/// One tolerance.
pub struct Rung {
    pub tolerance: f64,
    pub error: f64,
    /// After [`PERIODS`].
    pub late_error: f64,
    /// Processor time per mesh period and operating point.
    pub seconds: f64,
    times: Vec<f64>,
}

/// One method on one case.
pub struct Ladder {
    pub case: String,
    pub name: String,
    pub whose: Whose,
    /// Operating points side by side.
    pub points: usize,
    pub rungs: Vec<Rung>,
}

impl Ladder {
    /// Time per mesh period at which the error falls to `error`, interpolated between rungs on logarithmic scales; the error at a time is the
    /// least reached by then. None if it is not reached.
    pub fn seconds_at(&self, error: f64) -> Option<f64> {
        let mut by_time: Vec<&Rung> = self.rungs.iter().collect();
        by_time.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
        let mut before: Option<&Rung> = None;
        for rung in by_time {
            if before.is_some_and(|b| rung.error >= b.error) {
                continue;
            }
            if rung.error <= error {
                return Some(match before {
                    None => rung.seconds,
                    Some(b) => {
                        let part = (b.error / error).ln() / (b.error / rung.error).ln();
                        b.seconds * (rung.seconds / b.seconds).powf(part)
                    }
                });
            }
            before = Some(rung);
        }
        None
    }
}

/// Everything measured. What fails at a tolerance is left out there, and said on standard error.
pub fn all(cases: &[Case], methods: &mut [Box<dyn Method>], rounds: usize) -> Vec<Ladder> {
    let mut ladders = Vec::new();
    // Which method, which case, for each ladder.
    let mut of = Vec::new();
    for (m, method) in methods.iter_mut().enumerate() {
        for (c, case) in cases.iter().enumerate() {
            let mut rungs = Vec::new();
            for tolerance in method.tolerances() {
                match rung(method.as_mut(), case, tolerance) {
                    Ok(rung) => rungs.push(rung),
                    Err(message) => {
                        eprintln!("{}, case {}, tolerance {tolerance:.1e}: {message}", method.name(), case.name)
                    }
                }
            }
            ladders.push(Ladder {
                case: case.name.clone(),
                name: method.name(),
                whose: method.whose(),
                points: method.points(),
                rungs,
            });
            of.push((m, c));
        }
    }
    let turns: Vec<(usize, usize)> =
        ladders.iter().enumerate().flat_map(|(l, ladder)| (0..ladder.rungs.len()).map(move |r| (l, r))).collect();
    for round in 0..rounds {
        // Each round begins with somebody else.
        let first = round * turns.len() / rounds;
        for &(l, r) in turns[first..].iter().chain(&turns[..first]) {
            if ladders[l].whose == Whose::Scipy && round >= SCIPY_ROUNDS {
                continue;
            }
            let (m, c) = of[l];
            turn(methods[m].as_mut(), &cases[c], &mut ladders[l].rungs[r]);
        }
        eprintln!("round {} of {rounds}", round + 1);
    }
    for rung in ladders.iter_mut().flat_map(|l| &mut l.rungs) {
        rung.seconds = median(rung.times.drain(..)) / PERIODS as f64;
    }
    ladders
}

/// The errors at a tolerance.
fn rung(method: &mut dyn Method, case: &Case, tolerance: f64) -> Result<Rung, String> {
    let run = method.run(case, tolerance, PERIODS)?;
    let late_error = case.error(PERIODS, &run.state);
    let error = match error_periods(case) {
        PERIODS => late_error,
        periods => case.error(periods, &method.run(case, tolerance, periods)?.state),
    };
    Ok(Rung { tolerance, error, late_error, seconds: f64::INFINITY, times: Vec::new() })
}

/// One time more. What is short is done once for nothing and then often enough.
fn turn(method: &mut dyn Method, case: &Case, rung: &mut Rung) {
    let mut runs = |count: usize| {
        let watch = Stopwatch::start();
        // Deterministic: what went well the first time does again.
        let elsewhere =
            (0..count).filter_map(|_| black_box(method.run(case, rung.tolerance, PERIODS)).ok()?.seconds).sum();
        let here = watch.seconds();
        (if elsewhere > 0.0 { elsewhere } else { here }) / (count * method.points()) as f64
    };
    let first = runs(1);
    let count = (SHORTEST_TURN_S / first.max(1e-6)).ceil();
    rung.times.push(if count > 1.0 { runs(count as usize) } else { first });
}
