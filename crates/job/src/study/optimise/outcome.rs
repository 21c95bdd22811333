//! What is said of the best design.

use super::problem::Problem;
use super::run::{Course, Solver};
use crate::document::{GoalInput, SearchMethodInput};
use crate::field::Words;
use crate::result::{
    ActiveLimit, BestDesign, ConstraintResult, Flatness, FrontDesign, InputDesign, ObjectiveResult, OptimiseResult,
    PointGain, SearchNumerics, SweepPoint,
};
use crate::study::evaluation::{SEARCH_ACCURACY, SEARCH_POSITIONS};
use herringbone_search::{StoppedBy, crowded_front, knee};

/// Designs of a front that are listed.
const FRONT: usize = 50;
/// Improvement from which on a design is better, relative.
const BETTER: f64 = 1e-6;
/// Part of a range within which a variable stands at a bound, and of a limit within which a constraint is active.
const AT_BOUND: f64 = 1e-3;
const ACTIVE: f64 = 0.01;
/// Designs that count as equally good, relative.
const FLAT: f64 = 0.02;

/// The result, without the rows and the robust numbers.
pub(super) fn result(solver: &Solver, rows: &[SweepPoint], course: &Course, best: Option<usize>) -> OptimiseResult {
    let problem = solver.problem;
    let input = &rows[0];
    let row = best.map(|at| &rows[at]);
    let all = &rows[course.searched.clone()];
    let is_infeasible = |row: &&SweepPoint| row.error.is_none() && row.violation != Some(0.0);
    OptimiseResult {
        verdict: verdict(solver, rows, best).to_owned(),
        best: best.map(|at| BestDesign { values: named(problem, &rows[at].values), position: at as u64 }),
        input: input_design(solver, input),
        objectives: (0..problem.objectives.len()).map(|index| objective(solver, index, input, row)).collect(),
        constraints: row.map(|row| constraints(problem, row)).unwrap_or_default(),
        active: row.map(|row| active(problem, row)).unwrap_or_default(),
        flatness: row.map(|row| flatness(solver, all, row)).unwrap_or_default(),
        neighbours: Vec::new(),
        history: course.history.clone(),
        front: front_designs(solver, rows, course),
        robust: None,
        numerics: SearchNumerics {
            evaluations: rows.len() as u32,
            infeasible: all.iter().filter(is_infeasible).count() as u32,
            failed: all.iter().filter(|row| row.error.is_some()).count() as u32,
            generations: course.generations,
            stopped_by: stopped_by(course.stopped_by).to_owned(),
            method: method(solver).to_owned(),
            seed: solver.document.seed.unwrap_or(1),
            search_positions: solver.search_differs(|ltca| f64::from(ltca.positions.unwrap_or(0)), SEARCH_POSITIONS),
            search_accuracy: solver.search_differs(|ltca| ltca.accuracy, SEARCH_ACCURACY),
        },
        points: Vec::new(),
    }
}

/// Why a search ended, as a word.
pub(super) fn stopped_by(reason: StoppedBy) -> &'static str {
    match reason {
        StoppedBy::Tolerance => "tolerance",
        StoppedBy::Budget => "budget",
        StoppedBy::Caller => "time",
    }
}

fn method(solver: &Solver) -> &'static str {
    let few = solver.problem.variables.len() <= 3;
    match solver.document.method {
        Some(SearchMethodInput::NelderMead) => "nelder_mead",
        Some(SearchMethodInput::CmaEs) if solver.problem.variables.len() > 1 => "cma_es",
        Some(SearchMethodInput::Auto) | None if !few => "cma_es",
        _ => "nelder_mead",
    }
}

fn verdict(solver: &Solver, rows: &[SweepPoint], best: Option<usize>) -> &'static str {
    let Some(best) = best else { return "no feasible design" };
    let [input, best] = [0, best].map(|at| solver.score(&rows[at], 0));
    if !input.is_feasible() {
        return "improved";
    }
    // With several objectives a design of the front that is better in one is an improvement.
    let is_better = (0..solver.problem.objectives.len()).any(|objective| {
        let least = rows.iter().filter(|row| solver.is_permitted(row)).map(|row| solver.score(row, objective));
        let least =
            least.filter(|score| score.is_feasible()).map(|score| score.objective).fold(f64::INFINITY, f64::min);
        let own = solver.score(&rows[0], objective).objective;
        solver.problem.objectives.len() > 1 && least < own - BETTER * own.abs()
    });
    if is_better || best.objective < input.objective - BETTER * input.objective.abs() {
        "improved"
    } else {
        "no better design within the bounds"
    }
}

fn named<'a>(problem: &Problem<'a>, values: &[f64]) -> std::collections::BTreeMap<String, f64> {
    problem.variables.iter().zip(values).map(|(variable, value)| (variable.pointer.clone(), *value)).collect()
}

fn input_design(solver: &Solver, row: &SweepPoint) -> InputDesign {
    let mut base = solver.evaluator.base.clone();
    let value = |inputs: &crate::study::evaluation::Inputs| (inputs.pointer.to_owned(), inputs.value(&mut base));
    InputDesign {
        values: solver.problem.inputs.iter().map(value).collect(),
        feasible: solver.score(row, 0).is_feasible(),
        violation: row.violation.unwrap_or_default(),
        error: row.error.clone(),
    }
}

/// Improvement in per cent.
fn gain(goal: GoalInput, input: Option<f64>, best: Option<f64>) -> Option<f64> {
    let (input, best) = (input?, best?);
    let sign = if goal == GoalInput::Maximise { -1.0 } else { 1.0 };
    (input != 0.0).then(|| sign * 100.0 * (input - best) / input.abs())
}

fn objective(solver: &Solver, index: usize, input: &SweepPoint, best: Option<&SweepPoint>) -> ObjectiveResult {
    let problem = solver.problem;
    let (objective, measure) = (&problem.objectives[index], &problem.measures[index]);
    let value = |row: &SweepPoint| row.objectives.as_ref().map(|objectives| objectives[index]);
    let at_points = |row: Option<&SweepPoint>| {
        row.and_then(|row| row.measures.as_ref()).map(|measures| problem.of_measure(measures, index).to_vec())
    };
    let (of_input, of_best) = (at_points(Some(input)), at_points(best));
    let distance = |value: f64| objective.target.map_or(value, |target| (value - target).abs());
    let points = solver.evaluator.operating_points().into_iter().enumerate();
    let per_point = points.map(|(at, [pinion_speed_rpm, pinion_torque_nm])| {
        let of = |values: &Option<Vec<f64>>| values.as_ref().map(|values| values[at]);
        let (input, best) = (of(&of_input), of(&of_best));
        let gain_percent = gain(objective.goal, input.map(distance), best.map(distance));
        PointGain { pinion_speed_rpm, pinion_torque_nm, input, best, gain_percent }
    });
    let (input, best) = (value(input), best.and_then(value));
    ObjectiveResult {
        measure: measure.name.clone(),
        label: measure.label.clone(),
        unit: measure.unit.to_owned(),
        goal: objective.goal.as_word().to_owned(),
        over: objective.over.as_word().to_owned(),
        relative_to: objective.relative_to.map(|word| word.as_word().to_owned()),
        input,
        best,
        gain_percent: gain(objective.goal, input, best),
        per_point: per_point.collect(),
    }
}

fn constraints(problem: &Problem, row: &SweepPoint) -> Vec<ConstraintResult> {
    let Some(measures) = &row.measures else { return Vec::new() };
    let first = problem.objectives.len();
    let of = |(index, constraint): (usize, &crate::document::ConstraintInput)| {
        let counts = |at: &usize| {
            constraint.points.as_ref().is_none_or(|points| points.iter().any(|point| *point as usize == *at))
        };
        let values = problem.of_measure(measures, first + index);
        let values: Vec<f64> = (0..values.len()).filter(counts).map(|at| values[at]).collect();
        let name = problem.measures[first + index].name.clone();
        if constraint.is.is_some() {
            let met = values.iter().all(|value| *value == 1.0);
            return ConstraintResult { constraint: name, value: None, slack: None, met };
        }
        let slack = |value: f64| {
            let above = constraint.at_least.map_or(f64::INFINITY, |limit| value - limit);
            above.min(constraint.at_most.map_or(f64::INFINITY, |limit| limit - value))
        };
        let nearest = values.into_iter().min_by(|a, b| slack(*a).total_cmp(&slack(*b)));
        let slack = nearest.map(slack);
        ConstraintResult { constraint: name, value: nearest, slack, met: slack.is_none_or(|slack| slack >= 0.0) }
    };
    problem.constraints.iter().enumerate().map(of).collect()
}

fn active(problem: &Problem, row: &SweepPoint) -> Vec<ActiveLimit> {
    let mut found = Vec::new();
    for (variable, value) in problem.variables.iter().zip(&row.values) {
        let near = AT_BOUND * (variable.to - variable.from);
        let at = if value - variable.from <= near {
            "lower bound"
        } else if variable.to - value <= near {
            "upper bound"
        } else {
            continue;
        };
        let (pointer, at) = (Some(variable.pointer.clone()), Some(at.to_owned()));
        found.push(ActiveLimit { pointer, at, ..ActiveLimit::default() });
    }
    for (constraint, result) in problem.constraints.iter().zip(constraints(problem, row)) {
        let limit = constraint.at_least.or(constraint.at_most).unwrap_or_default();
        let size = if limit == 0.0 { 1.0 } else { limit.abs() };
        if let Some(slack) = result.slack.filter(|slack| *slack < ACTIVE * size) {
            let constraint = Some(result.constraint);
            found.push(ActiveLimit { constraint, slack: Some(slack), ..ActiveLimit::default() });
        }
    }
    found
}

fn flatness(solver: &Solver, rows: &[SweepPoint], best: &SweepPoint) -> Vec<Flatness> {
    let least = solver.score(best, 0).objective;
    let most = least + FLAT * least.abs();
    let good: Vec<&SweepPoint> = rows
        .iter()
        .filter(|row| {
            let score = solver.score(row, 0);
            score.is_feasible() && score.objective <= most
        })
        .chain(std::iter::once(best))
        .collect();
    let of = |(index, variable): (usize, &crate::document::VariableInput)| {
        let range = good.iter().map(|row| row.values[index]);
        let range = range.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], value| [a.min(value), b.max(value)]);
        Flatness {
            pointer: variable.pointer.clone(),
            range_within_2_percent: range,
            designs: good.len() as u32,
            ..Flatness::default()
        }
    };
    solver.problem.variables.iter().enumerate().map(of).collect()
}

/// Rows, of those given, none of which is better than another in every objective.
pub(super) fn front(solver: &Solver, rows: &[SweepPoint], among: &[usize]) -> Vec<usize> {
    let objectives: Vec<Vec<f64>> = among.iter().map(|at| solver.oriented(&rows[*at])).collect();
    crowded_front(&objectives, FRONT).into_iter().map(|place| among[place]).collect()
}

/// The front of all searches. Its designs have the settings of the search.
fn front_designs(solver: &Solver, rows: &[SweepPoint], course: &Course) -> Vec<FrontDesign> {
    if solver.problem.objectives.len() < 2 {
        return Vec::new();
    }
    let is_candidate = |at: &usize| solver.score(&rows[*at], 0).is_feasible() && solver.is_permitted(&rows[*at]);
    let among: Vec<usize> = course.searched.clone().filter(is_candidate).collect();
    let front = front(solver, rows, &among);
    let oriented: Vec<Vec<f64>> = front.iter().map(|at| solver.oriented(&rows[*at])).collect();
    let knee = knee(&oriented);
    let design = |(place, at): (usize, &usize)| FrontDesign {
        position: *at as u64,
        objectives: rows[*at].objectives.clone().unwrap_or_default(),
        knee: knee == Some(place),
    };
    front.iter().enumerate().map(design).collect()
}
