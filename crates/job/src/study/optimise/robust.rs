//! Choice of the best design by its values over the tolerances.

use super::run::{Course, OWN, SEARCH, Solver};
use crate::document::{GoalInput, JobDocument, RobustInput, RobustMeasureInput};
use crate::field::Words;
use crate::result::{EvaluationPhase, RobustCandidate, RobustResult, RobustStatistics, SweepPoint};
use crate::study::SolveError;
use crate::study::evaluation::{Inputs, Rows, Task};
use crate::study::tolerance::{Scatter, scrambles};
use herringbone_search::statistics::{mean, percentile, student_t_interval};
use herringbone_search::{MAX_SOBOL_POINTS, sobol_point};

/// Least distance of candidates in units of the ranges.
const APART: f64 = 0.05;

/// Ranks candidates by their statistic over a common sample; returns the numbers and the row of the winner.
///
/// # Errors
/// [`SolveError::Canceled`].
pub(super) fn run(
    solver: &Solver,
    rows: &mut Rows,
    course: &Course,
    best: Option<usize>,
) -> Result<(Option<RobustResult>, Option<usize>), SolveError> {
    let (Some(robust), Some(_)) = (&solver.document.robust, best) else { return Ok((None, best)) };
    let scatter = Scatter::new(solver.document, &solver.evaluator.base);
    let chosen = candidates(solver, &rows.rows, course, robust.candidates as usize);
    let seed = u64::from(solver.document.seed.unwrap_or(1));
    let base = solver.search_base.map_or((&solver.evaluator.base, OWN), |base| (base, SEARCH));
    let mut ranked = Vec::new();
    for at in chosen {
        let values = rows.rows[at].values.clone();
        let nominal = solver.oriented(&rows.rows[at]).first().copied().unwrap_or(f64::NAN);
        let common = points(robust.samples, scatter.len(), scrambles(seed, 20)[0]);
        let found = sample(solver, rows, &scatter, &values, common, (EvaluationPhase::Robust, base))?;
        let value = statistic(&found, robust);
        ranked.push((at, nominal, value));
    }
    ranked.sort_by(|a, b| a.2.unwrap_or(f64::INFINITY).total_cmp(&b.2.unwrap_or(f64::INFINITY)));
    let winner = ranked.first().map(|(at, ..)| *at).or(best);
    let sign = if solver.problem.objectives[0].goal == GoalInput::Maximise { -1.0 } else { 1.0 };
    let shown = |value: f64| sign * value;
    // Another sample, with the settings of the document.
    let own = (&solver.evaluator.base, OWN);
    let fresh = || points(robust.confirm_samples, scatter.len(), scrambles(seed, 21)[0]);
    let phase = EvaluationPhase::RobustConfirm;
    let of_input = sample(solver, rows, &scatter, &solver.input_values(), fresh(), (phase, own))?;
    let of_best = match winner {
        Some(at) => {
            let values = rows.rows[at].values.clone();
            sample(solver, rows, &scatter, &values, fresh(), (phase, own))?
        }
        None => Vec::new(),
    };
    let (before, after) = (statistic(&of_input, robust), statistic(&of_best, robust));
    let gain_percent = before
        .zip(after)
        .filter(|(before, _)| *before != 0.0)
        .map(|(before, after)| 100.0 * (before - after) / before.abs());
    let result = RobustResult {
        measure: robust.measure.as_word().to_owned(),
        candidates: ranked
            .into_iter()
            .map(|(at, nominal, value)| RobustCandidate {
                position: at as u64,
                nominal: shown(nominal),
                robust: value.map(shown),
            })
            .collect(),
        sample: robust.confirm_samples,
        input: statistics(&of_input, sign),
        best: statistics(&of_best, sign),
        gain_percent,
    };
    Ok((Some(result), winner))
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

fn points(count: u32, dimensions: usize, seed: u32) -> Vec<Vec<f64>> {
    (0..count.min(MAX_SOBOL_POINTS)).map(|index| sobol_point(index, dimensions, seed)).collect()
}

/// The first objective, to be made small, at the points of a sample about a design; `None` of those that violate
/// nothing but could not be evaluated.
fn sample(
    solver: &Solver,
    rows: &mut Rows,
    scatter: &Scatter,
    values: &[f64],
    points: Vec<Vec<f64>>,
    (phase, (base, settings)): (EvaluationPhase, (&JobDocument, u8)),
) -> Result<Vec<Option<f64>>, SolveError> {
    let mut design = base.clone();
    let mut refused = Vec::new();
    for (inputs, value) in solver.problem.inputs.iter().zip(values) {
        inputs.put(&mut design, *value, &mut refused);
    }
    let generation = rows.rows.last().and_then(|row| row.generation).unwrap_or(0) + 1;
    let task = |point: &Vec<f64>| Task {
        values: values.to_vec(),
        further: scatter.values(&mut design.clone(), point).0,
        phase,
        generation: Some(generation),
    };
    let tasks: Vec<Task> = points.iter().map(task).collect();
    let inputs: Vec<Inputs> = scatter.inputs.clone();
    // What scatters is judged by the objective alone.
    let gate = |_: &[Option<f64>]| 0.0;
    let evaluate = |task: &Task| solver.evaluator.evaluate(&design, &inputs, &task.further, &gate);
    let range = rows.run(tasks, settings + 4, evaluate, &|outcome, row| solver.complete(outcome, row))?;
    Ok(rows.rows[range].iter().map(|row| solver.oriented(row).first().copied()).collect())
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
