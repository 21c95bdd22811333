//! Errors and median times of all methods on all cases and tolerances, measured in rounds.

use std::hint::black_box;

use crate::case::ReferenceCase;
use crate::methods::{Method, Origin};
use herringbone_tools::statistics::median;
use herringbone_tools::stopwatch::Stopwatch;

/// Mesh periods of a run.
pub const PERIODS: u64 = 20;

/// Shortest time of a measurement, s; shorter runs are repeated within it.
const SHORTEST_TURN_S: f64 = 1e-3;

/// Rounds of SciPy, whose runs take up to a second.
const SCIPY_ROUNDS: usize = 3;

/// Number of periods after which the error of a case is taken.
pub fn error_periods(case: &ReferenceCase) -> u64 {
    if case.name == "B" { 5 } else { PERIODS }
}

/// Results at one tolerance.
pub struct Rung {
    pub tolerance: f64,
    pub error: f64,
    /// After [`PERIODS`].
    pub late_error: f64,
    /// Processor time per mesh period and operating point.
    pub seconds: f64,
    times: Vec<f64>,
}

/// Results of one method on one case.
pub struct Ladder {
    pub case: String,
    pub name: String,
    pub origin: Origin,
    /// Operating points integrated side by side.
    pub points: usize,
    pub rungs: Vec<Rung>,
}

impl Ladder {
    /// Time per mesh period at which the error falls to `error`, interpolated between tolerances on logarithmic scales;
    /// the error at a time is the least reached by then. None if it is not reached.
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

/// All measurements. A tolerance at which a method fails is left out and reported on standard error.
pub fn all(cases: &[ReferenceCase], methods: &mut [Box<dyn Method>], rounds: usize) -> Vec<Ladder> {
    let mut ladders = Vec::new();
    // Indices of method and case of each ladder.
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
                origin: method.origin(),
                points: method.points(),
                rungs,
            });
            of.push((m, c));
        }
    }
    let turns: Vec<(usize, usize)> =
        ladders.iter().enumerate().flat_map(|(l, ladder)| (0..ladder.rungs.len()).map(move |r| (l, r))).collect();
    for round in 0..rounds {
        // Each round begins with another measurement.
        let first = round * turns.len() / rounds;
        for &(l, r) in turns[first..].iter().chain(&turns[..first]) {
            if ladders[l].origin == Origin::Scipy && round >= SCIPY_ROUNDS {
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

/// Errors at a tolerance.
fn rung(method: &mut dyn Method, case: &ReferenceCase, tolerance: f64) -> Result<Rung, String> {
    let run = method.run(case, tolerance, PERIODS)?;
    let late_error = case.error(PERIODS, &run.state);
    let error = match error_periods(case) {
        PERIODS => late_error,
        periods => case.error(periods, &method.run(case, tolerance, periods)?.state),
    };
    Ok(Rung { tolerance, error, late_error, seconds: f64::INFINITY, times: Vec::new() })
}

/// Adds a measurement. A short run is done once without measuring and then repeated.
fn turn(method: &mut dyn Method, case: &ReferenceCase, rung: &mut Rung) {
    let mut runs = |count: usize| {
        let watch = Stopwatch::start();
        // Deterministic: a run that succeeded once succeeds again.
        let elsewhere =
            (0..count).filter_map(|_| black_box(method.run(case, rung.tolerance, PERIODS)).ok()?.seconds).sum();
        let here = watch.seconds();
        (if elsewhere > 0.0 { elsewhere } else { here }) / (count * method.points()) as f64
    };
    let first = runs(1);
    let count = (SHORTEST_TURN_S / first.max(1e-6)).ceil();
    rung.times.push(if count > 1.0 { runs(count as usize) } else { first });
}
