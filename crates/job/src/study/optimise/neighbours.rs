//! What lies around the best design: how far each variable can go alone, and whether a jump is near.

use super::run::Solver;
use crate::document::SPEED_STEPS;
use crate::result::{EvaluationPhase, Flatness, OptimiseResult, SpeedNeighbour};
use crate::study::SolveError;
use crate::study::evaluation::{EvaluationSettings, EvaluationTask, Level, Rows};
use crate::warning::Warning;

/// Speeds of the neighbours over that of the document, in per cent, less 100: outwards on either side.
const SPEEDS_PERCENT: [f64; SPEED_STEPS] = [-2.0, -5.0, 2.0, 5.0];
/// Ratio of a measure at neighbouring speeds from which on it has jumped: a resonance of the usual damping is not as
/// steep.
const JUMP: f64 = 1.5;

/// Factor of the speeds at a place among the neighbours.
pub(super) fn speed_factor(place: u8) -> f64 {
    1.0 + SPEEDS_PERCENT.get(usize::from(place)).copied().unwrap_or_default() / 100.0
}

/// Evaluates the best design with one variable after the other at the ends of its range of good values.
///
/// # Errors
/// [`SolveError::Canceled`].
pub(super) fn confirm_flatness(
    solver: &Solver,
    rows: &mut Rows,
    best: usize,
    flatness: &mut [Flatness],
) -> Result<(), SolveError> {
    let own = rows.rows[best].clone();
    let mut places = Vec::new();
    let mut designs = Vec::new();
    for (variable, flat) in flatness.iter().enumerate() {
        for (end, value) in flat.range_within_2_percent.into_iter().enumerate() {
            if value != own.values[variable] {
                let mut values = own.values.clone();
                values[variable] = value;
                places.push((variable, end));
                designs.push(values);
            }
        }
    }
    if designs.is_empty() {
        return Ok(());
    }
    let generation = rows.next_generation();
    let found = solver.evaluate(rows, designs, (EvaluationPhase::Flatness, generation), EvaluationSettings::Own)?;
    let of_best = solver.score(&own, 0).objective;
    for ((variable, end), at) in places.into_iter().zip(found) {
        let score = solver.score(&rows.rows[at], 0);
        let rise = 100.0 * (score.objective - of_best) / of_best.abs();
        flatness[variable].rise_at_ends_percent[end] =
            Some(rise).filter(|rise| score.is_feasible() && rise.is_finite());
    }
    Ok(())
}

/// Evaluates the best design at neighbouring speeds; nothing where the objective is none of the motion, or the speed is
/// a variable.
///
/// # Errors
/// [`SolveError::Canceled`].
pub(super) fn at_speeds(solver: &Solver, rows: &mut Rows, best: usize) -> Result<Vec<SpeedNeighbour>, SolveError> {
    let problem = solver.problem;
    let sets_speed =
        problem.inputs.iter().flat_map(|inputs| inputs.pointers()).any(|(at, _)| at == "/operation/pinion_speed_rpm");
    if problem.measures[0].level() != Level::Response || sets_speed {
        return Ok(Vec::new());
    }
    let own = rows.rows[best].clone();
    let measures = |measures: &Option<Vec<f64>>| measures.as_ref().map(|all| problem.of_measure(all, 0).to_vec());
    let generation = rows.next_generation();
    let task = |place: u8| EvaluationTask {
        settings: EvaluationSettings::Speed(place),
        values: own.values.clone(),
        further: Vec::new(),
        phase: EvaluationPhase::Speed,
        generation: Some(generation),
    };
    let evaluated = rows.run((0..SPEED_STEPS as u8).map(task).collect(), solver)?;
    let mut found = Vec::new();
    let mut inner = measures(&own.measures);
    for ((place, speed_percent), at) in SPEEDS_PERCENT.into_iter().enumerate().zip(evaluated) {
        if place == SPEED_STEPS / 2 {
            inner = measures(&own.measures);
        }
        let here = measures(&rows.rows[at].measures);
        let jump = has_jumped(inner.as_deref(), here.as_deref());
        let objective = rows.rows[at].objectives.as_ref().and_then(|objectives| objectives.first().copied());
        found.push(SpeedNeighbour { speed_percent, objective, jump });
        inner = here;
    }
    found.sort_by(|a, b| a.speed_percent.total_cmp(&b.speed_percent));
    Ok(found)
}

/// Whether a measure at any operating point differs by more than a jump.
fn has_jumped(one: Option<&[f64]>, other: Option<&[f64]>) -> bool {
    let (Some(one), Some(other)) = (one, other) else { return false };
    let is_jump = |(a, b): (&f64, &f64)| {
        let (least, most) = (a.abs().min(b.abs()), a.abs().max(b.abs()));
        most > JUMP * least && most > 0.0
    };
    one.iter().zip(other).any(is_jump)
}

/// Warning of a best design near a jump.
pub(in crate::study) fn warnings(result: &OptimiseResult) -> Vec<Warning> {
    let jumps: Vec<String> =
        result.neighbours.iter().filter(|one| one.jump).map(|one| format!("{:+} %", one.speed_percent)).collect();
    if jumps.is_empty() {
        return Vec::new();
    }
    vec![Warning {
        code: "near-jump".to_owned(),
        pointer: "/operating_points".to_owned(),
        detail: format!(
            "lie near a jump of the best design: its first measure changes by more than a half up to a speed {} away",
            jumps.join(" and ")
        ),
    }]
}
