//! The run of an optimisation.

use super::neighbours::{self, speed_factor};
use super::outcome;
use super::problem::Problem;
use super::robust;
use crate::document::{CONFIRMED, JobDocument, Ltca, MeshStiffness, SearchMethodInput};
use crate::result::{EvaluationPhase, OptimiseResult, SearchHistory, SweepPoint};
use crate::study::evaluation::{
    Evaluate, EvaluationBatch, EvaluationSettings, EvaluationTask, Evaluator, Outcome, Rows,
};
use crate::study::mesh::MeshMemo;
use crate::study::points::StoredPoints;
use crate::study::tolerance::Scatter;
use crate::study::{SolveContext, SolveError, Stage};
use herringbone_search::{Method, Phase, Score, Search, SearchSettings, StoppedBy, hypervolume};
use rayon::prelude::*;

/// What a run has found, for the result.
pub(super) struct Course {
    pub history: SearchHistory,
    pub stopped_by: StoppedBy,
    pub generations: u32,
    /// Improvements of the designs so far, of which none is better than another in every objective, as parts of the
    /// input's values.
    gains: Vec<Vec<f64>>,
    /// Range of the rows of the searches, and of those with the settings of the document.
    pub searched: std::ops::Range<usize>,
    pub confirmed: std::ops::Range<usize>,
}

/// Solves a document of kind `optimise`.
///
/// # Errors
/// [`SolveError::Canceled`]; [`SolveError::Document`] if the problem is none.
pub(in crate::study) fn run(
    document: &JobDocument,
    stored: StoredPoints,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<(OptimiseResult, bool), SolveError> {
    let problem = Problem::new(document)?;
    let evaluator = Evaluator::new(document, &problem.measures, context, memo);
    let mut rows = Rows::new(stored, document.evaluations(), context);
    let coarse = evaluator.coarse_base();
    let solver = Solver::new(document, &problem, &evaluator, coarse.as_ref(), context);
    solver.evaluate_input(&mut rows)?;
    relate(&problem, rows.rows[0].measures.as_ref())?;
    let mut course = solver.search(&mut rows)?;
    let first = rows.len();
    if coarse.is_some() {
        solver.confirm(&mut rows, course.searched.clone())?;
    }
    course.confirmed = if coarse.is_some() { first..rows.len() } else { course.searched.clone() };
    let best = solver.best(&rows.rows, &course);
    let (robust, best) = robust::run(&solver, &mut rows, &course, best)?;
    let mut result = outcome::result(&solver, &rows.rows, &course, best);
    result.robust = robust;
    if let Some(best) = best {
        neighbours::confirm_flatness(&solver, &mut rows, best, &mut result.flatness)?;
        result.neighbours = neighbours::at_speeds(&solver, &mut rows, best)?;
    }
    result.numerics.evaluations = rows.len() as u32;
    let has_reused = rows.has_reused;
    result.points = rows.rows;
    Ok((result, has_reused))
}

/// Makes evaluations of a document of kind `optimise` apart from the rest; their rows go to the point store of the
/// context.
///
/// # Errors
/// [`SolveError::Canceled`]; [`SolveError::Document`] if the problem is none.
pub(in crate::study) fn run_part(
    document: &JobDocument,
    batch: &EvaluationBatch,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<(), SolveError> {
    let problem = Problem::new(document)?;
    let evaluator = Evaluator::new(document, &problem.measures, context, memo);
    let coarse = evaluator.coarse_base();
    let solver = Solver::new(document, &problem, &evaluator, coarse.as_ref(), context);
    relate(&problem, batch.measures_of_input.as_ref())?;
    batch.tasks.par_iter().try_for_each(|(position, task)| {
        let row = solver.row(task)?;
        context.points.save(*position as usize, &row, None);
        Ok(())
    })
}

/// Relates objectives to the measures of the document itself.
fn relate(problem: &Problem, measures: Option<&Vec<f64>>) -> Result<(), SolveError> {
    problem.relate_to(measures).map_err(|(index, reason)| SolveError::Failed {
        stage: Stage::Evaluations,
        code: "input-has-no-value".to_owned(),
        detail: format!("/objectives/{index}/relative_to is input, but {reason}"),
        sim_time_s: None,
        step: None,
    })
}

/// What a run needs everywhere.
pub(super) struct Solver<'a> {
    pub document: &'a JobDocument,
    pub problem: &'a Problem<'a>,
    pub evaluator: &'a Evaluator<'a>,
    /// The base of the search's evaluations, where it differs from that of the document.
    pub search_base: Option<&'a JobDocument>,
    /// The tolerances, where designs are judged by them.
    pub scatter: Option<Scatter<'a>>,
    clock: Clock<'a>,
}

struct Clock<'a> {
    now_ms: &'a (dyn Fn() -> f64 + Sync),
    started_ms: f64,
}

/// Phases after that of the search, and after that of the search on a robust measure.
const AFTER_SEARCH: [EvaluationPhase; 7] = [
    EvaluationPhase::Nearest,
    EvaluationPhase::Confirm,
    EvaluationPhase::Robust,
    EvaluationPhase::RobustSearch,
    EvaluationPhase::RobustConfirm,
    EvaluationPhase::Flatness,
    EvaluationPhase::Speed,
];
pub(super) const AFTER_ROBUST_SEARCH: [EvaluationPhase; 4] =
    [EvaluationPhase::Nearest, EvaluationPhase::RobustConfirm, EvaluationPhase::Flatness, EvaluationPhase::Speed];

impl Evaluate for Solver<'_> {
    fn outcome(&self, task: &EvaluationTask) -> Result<Outcome, SolveError> {
        let (evaluator, inputs) = (self.evaluator, &self.problem.inputs);
        let gate = |found: &[Option<f64>]| self.problem.violation(found);
        let no_gate = |_: &[Option<f64>]| 0.0;
        match task.settings {
            EvaluationSettings::Input => evaluator.evaluate(&evaluator.base, &[], &[], &no_gate),
            EvaluationSettings::Own | EvaluationSettings::Search => {
                evaluator.evaluate(self.base(task.settings), inputs, &task.values, &gate)
            }
            // What scatters is judged by the objective alone.
            EvaluationSettings::OwnSample | EvaluationSettings::SearchSample => {
                let design = self.design(task.settings, &task.values);
                let inputs = self.scatter.as_ref().map(|scatter| scatter.inputs.as_slice()).unwrap_or_default();
                evaluator.evaluate(&design, inputs, &task.further, &no_gate)
            }
            EvaluationSettings::Speed(place) => {
                let evaluator = evaluator.at_speeds(speed_factor(place));
                evaluator.evaluate(&evaluator.base, inputs, &task.values, &no_gate)
            }
        }
    }

    /// Writes objectives and violation into a row.
    fn complete(&self, outcome: &Outcome, row: &mut SweepPoint) {
        let Some(measures) = &outcome.measures else {
            row.violation = Some(outcome.violation);
            return;
        };
        let known: Vec<Option<f64>> = measures.iter().copied().map(Some).collect();
        row.objectives = Some(self.problem.objectives_of(measures));
        row.violation = Some(self.problem.violation(&known));
    }
}

impl<'a> Solver<'a> {
    fn new(
        document: &'a JobDocument,
        problem: &'a Problem<'a>,
        evaluator: &'a Evaluator<'a>,
        search_base: Option<&'a JobDocument>,
        context: &'a SolveContext<'a>,
    ) -> Self {
        let scatter = document.robust.is_some().then(|| Scatter::new(document, &evaluator.base));
        let clock = Clock { now_ms: context.clock_ms, started_ms: (context.clock_ms)() };
        Self { document, problem, evaluator, search_base, scatter, clock }
    }

    /// The base of evaluations with some settings.
    fn base(&self, settings: EvaluationSettings) -> &JobDocument {
        let own = &self.evaluator.base;
        match settings {
            EvaluationSettings::Search | EvaluationSettings::SearchSample => self.search_base.unwrap_or(own),
            _ => own,
        }
    }

    /// Settings of the search.
    pub(super) fn search_settings(&self) -> EvaluationSettings {
        if self.search_base.is_some() { EvaluationSettings::Search } else { EvaluationSettings::Own }
    }

    /// The document of a design.
    pub(super) fn design(&self, settings: EvaluationSettings, values: &[f64]) -> JobDocument {
        let mut design = self.base(settings).clone();
        let mut refused = Vec::new();
        for (inputs, value) in self.problem.inputs.iter().zip(values) {
            inputs.put(&mut design, *value, &mut refused);
        }
        design
    }

    /// Whether the time is up, or was in an earlier attempt, which went on with the phases `after`: its rows say where.
    pub(super) fn is_time_up(&self, rows: &Rows, after: &[EvaluationPhase]) -> bool {
        let Some(seconds) = self.document.budget.as_ref().and_then(|budget| budget.seconds) else { return false };
        match rows.first_stored(after) {
            Some(end) => rows.len() >= end,
            None => (self.clock.now_ms)() - self.clock.started_ms > 1e3 * seconds,
        }
    }

    pub(super) fn evaluate(
        &self,
        rows: &mut Rows,
        points: Vec<Vec<f64>>,
        (phase, generation): (EvaluationPhase, u32),
        settings: EvaluationSettings,
    ) -> Result<std::ops::Range<usize>, SolveError> {
        let task =
            |values| EvaluationTask { settings, values, further: Vec::new(), phase, generation: Some(generation) };
        rows.run(points.into_iter().map(task).collect(), self)
    }

    /// The setting of the search where it differs from that of the document.
    pub(super) fn search_differs<T>(&self, of: impl Fn(&Ltca) -> f64, setting: T) -> Option<T> {
        let value = |document: &JobDocument| match &document.model.mesh_stiffness {
            MeshStiffness::Ltca(ltca) => Some(of(ltca)),
            _ => None,
        };
        (value(self.search_base?) != value(&self.evaluator.base)).then_some(setting)
    }

    fn evaluate_input(&self, rows: &mut Rows) -> Result<(), SolveError> {
        let task = EvaluationTask {
            settings: EvaluationSettings::Input,
            values: self.input_values(),
            further: Vec::new(),
            phase: EvaluationPhase::Input,
            generation: Some(0),
        };
        rows.run(vec![task], self)?;
        Ok(())
    }

    /// Values of the variables in the document; the least permitted one where it has none.
    pub(super) fn input_values(&self) -> Vec<f64> {
        let mut base = self.evaluator.base.clone();
        let value = |(index, inputs): (usize, &crate::study::evaluation::Inputs)| {
            inputs.value(&mut base).unwrap_or(self.problem.variables[index].from)
        };
        self.problem.inputs.iter().enumerate().map(value).collect()
    }

    /// One search for each objective; of several, then one for each of some weights of them.
    fn search(&self, rows: &mut Rows) -> Result<Course, SolveError> {
        let count = self.document.objectives.len();
        let weights = weights(count);
        let evaluations = self.document.budget.as_ref().and_then(|budget| budget.evaluations).unwrap_or(300) as usize;
        let searches = count + weights.len();
        let first = rows.len();
        let mut course = Course {
            history: SearchHistory::default(),
            stopped_by: StoppedBy::Tolerance,
            generations: 0,
            gains: Vec::new(),
            searched: first..first,
            confirmed: 0..0,
        };
        for number in 0..searches {
            let share = evaluations * (number + 1) / searches - evaluations * number / searches;
            let scale =
                if number < count { None } else { Some(self.chebyshev(&rows.rows[first..], &weights[number - count])) };
            let score = |row: &SweepPoint| match (row.violation, &row.objectives) {
                (Some(0.0), Some(objectives)) => {
                    let oriented = self.problem.oriented(objectives);
                    Score::feasible(match &scale {
                        None => oriented[number],
                        Some(scale) => scale.value(&oriented),
                    })
                }
                (violation, _) => Score::infeasible(violation.unwrap_or(1.0)),
            };
            let start = match &scale {
                None => self.input_values(),
                // The nearest design that is known.
                Some(_) => {
                    let known = rows.rows[first..].iter();
                    let best = known.min_by(|a, b| score(a).compare(&score(b)));
                    best.map_or_else(|| self.input_values(), |row| row.values.clone())
                }
            };
            self.one_search(rows, &mut course, (number, share), &start, &score)?;
            if course.stopped_by == StoppedBy::Caller {
                break;
            }
        }
        course.searched = first..rows.len();
        Ok(course)
    }

    fn one_search(
        &self,
        rows: &mut Rows,
        course: &mut Course,
        (number, evaluations): (usize, usize),
        start: &[f64],
        score: &dyn Fn(&SweepPoint) -> Score,
    ) -> Result<(), SolveError> {
        let mut search = Search::new(SearchSettings {
            start: self.problem.point(start),
            steps: self.problem.steps(),
            seed: u64::from(self.document.seed.unwrap_or(1)) << 8 | number as u64,
            evaluations,
            accuracy: self.document.budget.as_ref().map_or(1e-4, |budget| budget.accuracy),
            method: match self.document.method {
                Some(SearchMethodInput::CmaEs) => Method::CmaEs,
                Some(SearchMethodInput::NelderMead) => Method::NelderMead,
                _ => Method::Auto,
            },
            refines: false,
        });
        while let Some(batch) = search.ask() {
            course.generations += 1;
            let phase = match batch.phase {
                Phase::Start | Phase::Sample => EvaluationPhase::Sample,
                Phase::Run => EvaluationPhase::Search,
                Phase::Polish if search.stopped_by() == StoppedBy::Caller => EvaluationPhase::Nearest,
                Phase::Polish => EvaluationPhase::Polish,
            };
            let points = batch.points.iter().map(|point| self.problem.values(point)).collect();
            let solved = self.evaluate(rows, points, (phase, course.generations), self.search_settings())?;
            let scores: Vec<Score> = rows.rows[solved].iter().map(score).collect();
            search.tell(&scores);
            self.note(course, &rows.rows, search.spread());
            if search.stopped_by() != StoppedBy::Caller && self.is_time_up(rows, &AFTER_SEARCH) {
                search.stop();
            }
        }
        if search.stopped_by() != StoppedBy::Tolerance {
            course.stopped_by = search.stopped_by();
        }
        Ok(())
    }

    /// Adds an entry to the history.
    fn note(&self, course: &mut Course, rows: &[SweepPoint], spread: Option<f64>) {
        let history = &mut course.history;
        let from = history.evaluations.last().map_or(1, |last| *last as usize);
        let sign = |value: f64| self.problem.oriented(&[value])[0];
        let feasible = rows[from..].iter().filter(|row| row.violation == Some(0.0));
        let found = feasible.filter_map(|row| row.objectives.as_ref().map(|objectives| objectives[0]));
        let best = found.chain(history.best.last().copied().flatten()).min_by(|a, b| sign(*a).total_cmp(&sign(*b)));
        history.evaluations.push(rows.len() as u32);
        history.best.push(best);
        history.sigma.push(spread);
        if self.problem.objectives.len() > 1 {
            self.note_gains(course, rows, from);
        }
    }

    /// Adds the improvements of the rows from `from` on to the front, and its volume to the history.
    fn note_gains(&self, course: &mut Course, rows: &[SweepPoint], from: usize) {
        let input = self.oriented(&rows[0]);
        if input.is_empty() || input.contains(&0.0) {
            return;
        }
        for row in rows[from..].iter().filter(|row| row.violation == Some(0.0) && row.objectives.is_some()) {
            let gain: Vec<f64> =
                self.oriented(row).iter().zip(&input).map(|(value, own)| (own - value) / own.abs()).collect();
            let covers = |one: &[f64], other: &[f64]| one.iter().zip(other).all(|(a, b)| a >= b);
            if gain.iter().any(|part| *part <= 0.0) || course.gains.iter().any(|other| covers(other, &gain)) {
                continue;
            }
            course.gains.retain(|other| !covers(&gain, other));
            course.gains.push(gain);
        }
        course.history.hypervolume.push(hypervolume(&course.gains));
    }

    /// Evaluates the best designs with the settings of the document.
    fn confirm(&self, rows: &mut Rows, searched: std::ops::Range<usize>) -> Result<(), SolveError> {
        let mut chosen: Vec<Vec<f64>> = Vec::new();
        for objective in 0..self.document.objectives.len() {
            let share = CONFIRMED.div_ceil(self.document.objectives.len());
            let mut order: Vec<usize> = searched.clone().filter(|at| self.is_permitted(&rows.rows[*at])).collect();
            order.sort_by(|a, b| self.score(&rows.rows[*a], objective).compare(&self.score(&rows.rows[*b], objective)));
            let mut taken = 0;
            for at in order {
                let values = &rows.rows[at].values;
                if taken < share && !chosen.contains(values) {
                    chosen.push(values.clone());
                    taken += 1;
                }
            }
        }
        chosen.truncate(CONFIRMED);
        let generation = rows.next_generation();
        self.evaluate(rows, chosen, (EvaluationPhase::Confirm, generation), EvaluationSettings::Own)?;
        Ok(())
    }

    /// Score of a row by one objective.
    pub(super) fn score(&self, row: &SweepPoint, objective: usize) -> Score {
        match (row.violation, &row.objectives) {
            (Some(0.0), Some(objectives)) => Score::feasible(self.problem.oriented(objectives)[objective]),
            (violation, _) => Score::infeasible(violation.unwrap_or(1.0)),
        }
    }

    /// Whether a row's values may be an answer.
    pub(super) fn is_permitted(&self, row: &SweepPoint) -> bool {
        self.problem.is_permitted(&row.values)
    }

    /// The row of the best design: by the first objective, or at the knee of the front; `None` if none is feasible.
    pub(super) fn best(&self, rows: &[SweepPoint], course: &Course) -> Option<usize> {
        let candidates = std::iter::once(0).chain(course.confirmed.clone());
        let feasible: Vec<usize> =
            candidates.filter(|at| self.is_permitted(&rows[*at]) && self.score(&rows[*at], 0).is_feasible()).collect();
        if self.document.objectives.len() > 1 {
            let front = outcome::front(self, rows, &feasible);
            let objectives: Vec<Vec<f64>> = front.iter().map(|at| self.oriented(&rows[*at])).collect();
            if let Some(knee) = herringbone_search::knee(&objectives) {
                return Some(front[knee]);
            }
        }
        feasible.into_iter().min_by(|a, b| self.score(&rows[*a], 0).compare(&self.score(&rows[*b], 0)))
    }

    /// Objectives of a row, all to be made small.
    pub(super) fn oriented(&self, row: &SweepPoint) -> Vec<f64> {
        row.objectives.as_ref().map(|objectives| self.problem.oriented(objectives)).unwrap_or_default()
    }

    /// The weighted distance from the best of each objective, in units of the ranges over the best designs of each.
    fn chebyshev(&self, rows: &[SweepPoint], weights: &[f64]) -> Chebyshev {
        let count = weights.len();
        let best_of = |objective: usize| {
            let best = rows.iter().min_by(|a, b| self.score(a, objective).compare(&self.score(b, objective)));
            best.map(|row| self.oriented(row)).filter(|values| values.len() == count)
        };
        let ends: Vec<Vec<f64>> = (0..count).filter_map(best_of).collect();
        let extreme = |objective: usize, start: f64, choose: fn(f64, f64) -> f64| {
            ends.iter().map(|end| end[objective]).fold(start, choose)
        };
        let ideal: Vec<f64> = (0..count).map(|objective| extreme(objective, f64::INFINITY, f64::min)).collect();
        let worst: Vec<f64> = (0..count).map(|objective| extreme(objective, f64::NEG_INFINITY, f64::max)).collect();
        let ranges = ideal.iter().zip(&worst).map(|(ideal, worst)| {
            let range = worst - ideal;
            if range > 0.0 && range.is_finite() { range } else { 1.0 }
        });
        Chebyshev { ranges: ranges.collect(), ideal, weights: weights.to_vec() }
    }
}

/// Weighted Chebyshev distance, with a small part of the sum so that no design is dominated by a neighbour (Steuer and
/// Choo 1983, doi:10.1007/BF02591870).
struct Chebyshev {
    ideal: Vec<f64>,
    ranges: Vec<f64>,
    weights: Vec<f64>,
}

impl Chebyshev {
    const SUM: f64 = 1e-3;

    fn value(&self, oriented: &[f64]) -> f64 {
        let parts: Vec<f64> = (0..oriented.len())
            .map(|at| {
                let ideal = if self.ideal[at].is_finite() { self.ideal[at] } else { 0.0 };
                self.weights[at] * (oriented[at] - ideal) / self.ranges[at]
            })
            .collect();
        parts.iter().copied().fold(f64::NEG_INFINITY, f64::max) + Self::SUM * parts.iter().sum::<f64>()
    }
}

/// Weights of two or three objectives; none of one.
fn weights(objectives: usize) -> Vec<Vec<f64>> {
    match objectives {
        2 => (1..=5).map(|at| f64::from(at) / 6.0).map(|weight| vec![weight, 1.0 - weight]).collect(),
        3 => vec![
            vec![1.0 / 3.0; 3],
            vec![0.6, 0.2, 0.2],
            vec![0.2, 0.6, 0.2],
            vec![0.2, 0.2, 0.6],
            vec![0.45, 0.45, 0.1],
            vec![0.45, 0.1, 0.45],
            vec![0.1, 0.45, 0.45],
        ],
        _ => Vec::new(),
    }
}
