//! Choice of the best design by its values over the tolerances.

use super::outcome::stopped_by;
use super::run::{AFTER_ROBUST_SEARCH, Course, Solver};
use crate::document::{GoalInput, RobustInput, RobustMeasureInput};
use crate::field::Words;
use crate::result::{EvaluationPhase, RobustCandidate, RobustResult, RobustSearch, RobustStatistics, SweepPoint};
use crate::study::SolveError;
use crate::study::evaluation::{EvaluationSettings, EvaluationTask, Rows};
use crate::study::tolerance::{Scatter, scrambles};
use herringbone_search::statistics::{mean, percentile, student_t_interval};
use herringbone_search::{MAX_SOBOL_POINTS, Method, Score, Search, SearchSettings, StoppedBy, sobol_point};

/// Least distance of candidates in units of the ranges.
const APART: f64 = 0.05;

/// What the samples of candidates and designs have in common.
struct Robust<'a> {
    solver: &'a Solver<'a>,
    robust: &'a RobustInput,
    scatter: &'a Scatter<'a>,
    /// Points of the unit cube of the common sample.
    common: Vec<Vec<f64>>,
}

/// A design with its statistic over the common sample.
type Ranked = (usize, f64, Option<f64>);

/// Ranks candidates by their statistic over a common sample, and searches on from the winner where that is wanted;
/// returns the numbers and the row of the winner.
///
/// # Errors
/// [`SolveError::Canceled`].
pub(super) fn run(
    solver: &Solver,
    rows: &mut Rows,
    course: &Course,
    best: Option<usize>,
) -> Result<(Option<RobustResult>, Option<usize>), SolveError> {
    let (Some(robust), Some(scatter), Some(nominal_best)) = (&solver.document.robust, &solver.scatter, best) else {
        return Ok((None, best));
    };
    let seed = u64::from(solver.document.seed.unwrap_or(1));
    let points = |count: u32, sample: u64| -> Vec<Vec<f64>> {
        let seed = scrambles(seed, sample)[0];
        let all = 0..count.min(MAX_SOBOL_POINTS);
        all.map(|index| scatter.in_company(sobol_point(index, scatter.len(), seed))).collect()
    };
    let (common, fresh) = (points(robust.samples, 20), points(robust.confirm_samples, 21));
    let all = Robust { solver, robust, scatter, common };
    let ranked = all.rank(rows, candidates(solver, &rows.rows, course, robust.candidates as usize))?;
    let mut winner = ranked.first().map_or(nominal_best, |(at, ..)| *at);
    let search = match ranked.first() {
        Some(first) if robust.search => {
            let (found, at) = all.search(rows, first)?;
            winner = at;
            Some(found)
        }
        _ => None,
    };
    // Another sample, with the settings of the document.
    let of_design = |rows: &mut Rows, values: Vec<f64>| {
        let settings = EvaluationSettings::OwnSample;
        let mut found = all.samples(rows, &[values], &fresh, (EvaluationPhase::RobustConfirm, settings))?;
        Ok::<_, SolveError>(found.pop().unwrap_or_default())
    };
    let of_input = of_design(rows, solver.input_values())?;
    let of_best = of_design(rows, rows.rows[winner].values.clone())?;
    let of_nominal = match rows.rows[nominal_best].values != rows.rows[winner].values {
        true => of_design(rows, rows.rows[nominal_best].values.clone())?,
        false => Vec::new(),
    };
    let (before, after) = (statistic(&of_input, robust), statistic(&of_best, robust));
    let gain_percent = before
        .zip(after)
        .filter(|(before, _)| *before != 0.0)
        .map(|(before, after)| 100.0 * (before - after) / before.abs());
    let sign = all.sign();
    let candidate = |(at, nominal, value): Ranked| RobustCandidate {
        position: at as u64,
        nominal: sign * nominal,
        robust: value.map(|value| sign * value),
    };
    let result = RobustResult {
        measure: robust.measure.as_word().to_owned(),
        candidates: ranked.into_iter().map(candidate).collect(),
        sample: robust.confirm_samples,
        input: statistics(&of_input, sign),
        best: statistics(&of_best, sign),
        nominal_best: statistics(&of_nominal, sign),
        search,
        gain_percent,
    };
    Ok((Some(result), Some(winner)))
}

impl Robust<'_> {
    /// Of a goal to be made large, values that are made small have the other sign.
    fn sign(&self) -> f64 {
        if self.solver.problem.objectives[0].goal == GoalInput::Maximise { -1.0 } else { 1.0 }
    }

    /// Settings of samples during the search.
    fn settings(&self) -> EvaluationSettings {
        match self.solver.search_base {
            Some(_) => EvaluationSettings::SearchSample,
            None => EvaluationSettings::OwnSample,
        }
    }

    /// Rows by their statistic over the common sample, the best first.
    fn rank(&self, rows: &mut Rows, chosen: Vec<usize>) -> Result<Vec<Ranked>, SolveError> {
        let designs: Vec<Vec<f64>> = chosen.iter().map(|at| rows.rows[*at].values.clone()).collect();
        let found = self.samples(rows, &designs, &self.common, (EvaluationPhase::Robust, self.settings()))?;
        let of = |(at, sample): (usize, Vec<Option<f64>>)| {
            let nominal = self.solver.oriented(&rows.rows[at]).first().copied().unwrap_or(f64::NAN);
            (at, nominal, statistic(&sample, self.robust))
        };
        let mut ranked: Vec<Ranked> = chosen.into_iter().zip(found).map(of).collect();
        ranked.sort_by(|a, b| a.2.unwrap_or(f64::INFINITY).total_cmp(&b.2.unwrap_or(f64::INFINITY)));
        Ok(ranked)
    }

    /// Searches for a smaller statistic over the common sample from a candidate on; returns the row of the best design
    /// with the settings of the document.
    fn search(&self, rows: &mut Rows, first: &Ranked) -> Result<(RobustSearch, usize), SolveError> {
        let (solver, problem) = (self.solver, self.solver.problem);
        let (start, before) = (first.0, first.2);
        let mut search = Search::new(SearchSettings {
            start: problem.point(&rows.rows[start].values),
            steps: problem.steps(),
            seed: u64::from(solver.document.seed.unwrap_or(1)) << 8 | 255,
            evaluations: self.robust.search_designs.unwrap_or_default() as usize,
            accuracy: solver.document.budget.as_ref().map_or(1e-4, |budget| budget.accuracy),
            method: Method::CmaEs,
            refines: true,
        });
        let phase = EvaluationPhase::RobustSearch;
        let mut designs: Vec<Vec<f64>> = Vec::new();
        while let Some(batch) = search.ask() {
            let values: Vec<Vec<f64>> = batch.points.iter().map(|point| problem.values(point)).collect();
            let generation = rows.next_generation();
            let is_up = search.stopped_by() == StoppedBy::Caller;
            let of_nominal = if is_up { EvaluationPhase::Nearest } else { phase };
            let nominal = solver.evaluate(rows, values.clone(), (of_nominal, generation), solver.search_settings())?;
            // Designs that violate a constraint have no sample.
            let violations: Vec<Option<f64>> = rows.rows[nominal].iter().map(|row| row.violation).collect();
            let is_feasible = |at: &usize| violations[*at] == Some(0.0);
            let feasible: Vec<usize> = (0..values.len()).filter(is_feasible).collect();
            let sampled: Vec<Vec<f64>> = feasible.iter().map(|at| values[*at].clone()).collect();
            let found = self.samples(rows, &sampled, &self.common, (phase, self.settings()))?;
            let mut scores: Vec<Score> =
                violations.iter().map(|violation| Score::infeasible(violation.unwrap_or(1.0).max(1e-9))).collect();
            for (at, sample) in feasible.into_iter().zip(found) {
                scores[at] = statistic(&sample, self.robust).map_or(Score::infeasible(1e-9), Score::feasible);
            }
            search.tell(&scores);
            designs.extend(values);
            if search.stopped_by() != StoppedBy::Caller && solver.is_time_up(rows, &AFTER_ROBUST_SEARCH) {
                search.stop();
            }
        }
        let best = search.best().map(|at| (&designs[at], search.archive()[at].1));
        let best =
            best.filter(|(_, score)| score.is_feasible() && before.is_none_or(|before| score.objective < before));
        let found = RobustSearch {
            designs: designs.len() as u32,
            before: before.map(|value| self.sign() * value),
            after: best.map(|(_, score)| score.objective).or(before).map(|value| self.sign() * value),
            stopped_by: stopped_by(search.stopped_by()).to_owned(),
        };
        let Some((values, _)) = best else { return Ok((found, start)) };
        let generation = rows.next_generation();
        let own = EvaluationSettings::Own;
        let at = solver.evaluate(rows, vec![values.clone()], (EvaluationPhase::RobustConfirm, generation), own)?.start;
        let is_answer = solver.score(&rows.rows[at], 0).is_feasible() && solver.is_permitted(&rows.rows[at]);
        Ok((found, if is_answer { at } else { start }))
    }

    /// The first objective, to be made small, of each design at the points of a sample; `None` where it could not be
    /// evaluated.
    fn samples(
        &self,
        rows: &mut Rows,
        designs: &[Vec<f64>],
        points: &[Vec<f64>],
        (phase, settings): (EvaluationPhase, EvaluationSettings),
    ) -> Result<Vec<Vec<Option<f64>>>, SolveError> {
        let solver = self.solver;
        let generation = rows.next_generation();
        let mut tasks = Vec::new();
        for values in designs {
            let mut design = solver.design(settings, values);
            tasks.extend(points.iter().map(|point| EvaluationTask {
                settings,
                values: values.clone(),
                further: self.scatter.values(&mut design, point).0,
                phase,
                generation: Some(generation),
            }));
        }
        let range = rows.run(tasks, solver)?;
        let values: Vec<Option<f64>> =
            rows.rows[range].iter().map(|row| solver.oriented(row).first().copied()).collect();
        Ok(values.chunks(points.len().max(1)).map(<[Option<f64>]>::to_vec).collect())
    }
}

/// Rows of the best designs that are apart from each other.
fn candidates(solver: &Solver, rows: &[SweepPoint], course: &Course, most: usize) -> Vec<usize> {
    let all = course.confirmed.clone().chain(course.searched.clone());
    let mut order: Vec<usize> =
        all.filter(|at| solver.is_permitted(&rows[*at]) && solver.score(&rows[*at], 0).is_feasible()).collect();
    order.sort_by(|a, b| solver.score(&rows[*a], 0).compare(&solver.score(&rows[*b], 0)));
    let mut chosen: Vec<usize> = Vec::new();
    for at in order {
        let point = solver.problem.point(&rows[at].values);
        let is_apart = |other: &usize| {
            let others = solver.problem.point(&rows[*other].values);
            point.iter().zip(&others).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) > APART
        };
        if chosen.len() < most && chosen.iter().all(is_apart) {
            chosen.push(at);
        }
    }
    chosen
}

/// The statistic by which candidates are ranked; `None` if more than a tenth of the sample has no value.
fn statistic(sample: &[Option<f64>], robust: &RobustInput) -> Option<f64> {
    let mut values: Vec<f64> = sample.iter().copied().flatten().collect();
    if values.is_empty() || 10 * (sample.len() - values.len()) > sample.len() {
        return None;
    }
    values.sort_by(f64::total_cmp);
    Some(match robust.measure {
        RobustMeasureInput::Mean => mean(&values),
        RobustMeasureInput::P50 => percentile(&values, 0.5),
        RobustMeasureInput::P75 => percentile(&values, 0.75),
        RobustMeasureInput::P90 => percentile(&values, 0.9),
        RobustMeasureInput::P95 => percentile(&values, 0.95),
        RobustMeasureInput::Max => percentile(&values, 1.0),
    })
}

fn statistics(sample: &[Option<f64>], sign: f64) -> Option<RobustStatistics> {
    let mut values: Vec<f64> = sample.iter().copied().flatten().map(|value| sign * value).collect();
    if values.is_empty() {
        return None;
    }
    // Eight interleaved parts of the sample as independent estimates.
    let part = |part: usize| {
        let mut values: Vec<f64> = values.iter().copied().skip(part).step_by(8).collect();
        values.sort_by(f64::total_cmp);
        percentile(&values, 0.9)
    };
    let parts: Vec<f64> = if values.len() >= 64 { (0..8).map(part).collect() } else { Vec::new() };
    values.sort_by(f64::total_cmp);
    let p90 = percentile(&values, 0.9);
    Some(RobustStatistics {
        mean: mean(&values),
        p50: percentile(&values, 0.5),
        p90,
        p95: percentile(&values, 0.95),
        max: percentile(&values, 1.0),
        p90_interval: student_t_interval(p90, &parts),
        failed: (sample.len() - values.len()) as u32,
    })
}
