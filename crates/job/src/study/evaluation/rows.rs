//! The rows of a job of evaluations, solved or taken from an earlier attempt.

use super::evaluator::Outcome;
use super::task::{EvaluationBatch, EvaluationSettings, EvaluationTask};
use crate::result::{EvaluationPhase, SweepPoint};
use crate::study::points::StoredPoints;
use crate::study::{SolveContext, SolveError, Stage};
use rayon::prelude::*;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The rows so far.
pub(in crate::study) struct Rows<'a> {
    context: &'a SolveContext<'a>,
    stored: HashMap<usize, SweepPoint>,
    pub rows: Vec<SweepPoint>,
    /// Evaluations that are expected altogether.
    expected: usize,
    /// Rows of the same values and settings, which need not be solved again.
    known: HashMap<(EvaluationSettings, Vec<u64>), usize>,
    /// Rows of an earlier job with the settings of the document, by their values.
    earlier: HashMap<Vec<u64>, SweepPoint>,
    pub has_reused: bool,
    /// Positions that are to be evaluated; all when there are none. The rows of the others are empty.
    wanted: Option<HashSet<usize>>,
    /// Evaluations that were counted as done.
    done: usize,
    /// Evaluations that were made here, and their time in milliseconds.
    made: (usize, f64),
}

/// Makes evaluations.
pub(in crate::study) trait Evaluate: Sync {
    /// # Errors
    /// [`SolveError::Canceled`].
    fn outcome(&self, task: &EvaluationTask) -> Result<Outcome, SolveError>;

    /// Turns an outcome into the numbers of the row.
    fn complete(&self, outcome: &Outcome, row: &mut SweepPoint);

    /// Makes an evaluation: its row.
    ///
    /// # Errors
    /// [`SolveError::Canceled`].
    fn row(&self, task: &EvaluationTask) -> Result<SweepPoint, SolveError> {
        let outcome = self.outcome(task)?;
        let mut row = outcome.row.clone();
        row.error.clone_from(&outcome.error);
        row.measures.clone_from(&outcome.measures);
        self.complete(&outcome, &mut row);
        Ok(of_task(row, task))
    }
}

/// A row with what its task says.
fn of_task(mut row: SweepPoint, task: &EvaluationTask) -> SweepPoint {
    row.values.clone_from(&task.values);
    row.phase = Some(task.phase);
    row.generation = task.generation;
    row
}

impl<'a> Rows<'a> {
    pub(in crate::study) fn new(stored: StoredPoints, expected: u64, context: &'a SolveContext<'a>) -> Self {
        let has_reused = !stored.rows.is_empty();
        Self {
            context,
            stored: stored.rows,
            rows: Vec::new(),
            expected: expected.max(1) as usize,
            known: HashMap::new(),
            earlier: HashMap::new(),
            has_reused,
            wanted: None,
            done: 0,
            made: (0, 0.0),
        }
    }

    /// Rows of which only these are evaluated, and stored; each as if it were alone.
    pub(in crate::study) fn of_positions(positions: &[usize], context: &'a SolveContext<'a>) -> Self {
        let rows = Self::new(StoredPoints::default(), positions.len() as u64, context);
        Self { wanted: Some(positions.iter().copied().collect()), ..rows }
    }

    /// Gives rows of an earlier job with the settings of the document and of nothing but values.
    pub(in crate::study) fn know(&mut self, rows: Vec<SweepPoint>) {
        self.earlier = rows.into_iter().map(|row| (bits(&row.values), row)).collect();
    }

    /// Position of the first stored row of one of these phases: where an earlier attempt had ended what comes before
    /// them.
    pub(in crate::study) fn first_stored(&self, phases: &[EvaluationPhase]) -> Option<usize> {
        let is_of = |row: &SweepPoint| row.phase.is_some_and(|phase| phases.contains(&phase));
        self.stored.iter().filter(|(_, row)| is_of(row)).map(|(position, _)| *position).min()
    }

    /// Rows so far.
    pub(in crate::study) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Number of the batch that follows.
    pub(in crate::study) fn next_generation(&self) -> u32 {
        self.rows.last().and_then(|row| row.generation).unwrap_or(0) + 1
    }

    /// Evaluates tasks side by side, in any order; their rows follow those of before in the order of the tasks.
    ///
    /// # Errors
    /// [`SolveError::Canceled`].
    pub(in crate::study) fn run(
        &mut self,
        tasks: Vec<EvaluationTask>,
        evaluate: &impl Evaluate,
    ) -> Result<Range<usize>, SolveError> {
        let first = self.rows.len();
        let progress = AtomicUsize::new(self.done);
        let count = || {
            let done = progress.fetch_add(1, Ordering::Relaxed) + 1;
            (self.context.progress)(Stage::Evaluations, (done as f64 / self.expected as f64).min(1.0));
        };
        let sources: Vec<RowSource> =
            tasks.iter().enumerate().map(|(at, task)| self.source(first + at, task)).collect();
        let made_elsewhere = self.evaluate_elsewhere(first, &tasks, &sources);
        // The row, and the time of an evaluation that was made here.
        let solve = |(at, (task, source)): (usize, (&EvaluationTask, RowSource))| {
            let position = first + at;
            let (row, made_ms) = match source {
                RowSource::Unwanted => return Ok((SweepPoint::default(), None)),
                RowSource::Stored(row) => {
                    count();
                    return Ok((row.clone(), None));
                }
                RowSource::Known(row) => (of_task(row.clone(), task), None),
                RowSource::New => match made_elsewhere.get(&position) {
                    Some(row) => {
                        count();
                        return Ok((of_task(row.clone(), task), None));
                    }
                    None => {
                        let started_ms = (self.context.clock_ms)();
                        (evaluate.row(task)?, Some((self.context.clock_ms)() - started_ms))
                    }
                },
            };
            self.context.points.save(position, &row, None);
            count();
            Ok((row, made_ms))
        };
        let solved: Vec<(SweepPoint, Option<f64>)> =
            tasks.par_iter().zip(sources).enumerate().map(solve).collect::<Result<_, SolveError>>()?;
        self.done = progress.into_inner();
        for (at, (task, (row, made_ms))) in tasks.iter().zip(solved).enumerate() {
            if let Some(made_ms) = made_ms {
                self.made = (self.made.0 + 1, self.made.1 + made_ms);
            }
            self.known.entry(key(task)).or_insert(first + at);
            self.rows.push(row);
        }
        Ok(first..self.rows.len())
    }

    /// Where the row of a task comes from.
    fn source(&self, position: usize, task: &EvaluationTask) -> RowSource<'_> {
        if self.wanted.as_ref().is_some_and(|wanted| !wanted.contains(&position)) {
            return RowSource::Unwanted;
        }
        let is_same = |row: &&SweepPoint| row.phase == Some(task.phase) && bits(&row.values) == bits(&task.values);
        if let Some(row) = self.stored.get(&position).filter(is_same) {
            return RowSource::Stored(row);
        }
        // Among positions apart, the row of the same values may be an empty one.
        let of_same_values =
            self.known.get(&key(task)).filter(|_| self.wanted.is_none()).map(|known| &self.rows[*known]);
        let of_earlier = || {
            let is_plain = task.settings == EvaluationSettings::Own && task.further.is_empty();
            if is_plain { self.earlier.get(&bits(&task.values)) } else { None }
        };
        of_same_values.or_else(of_earlier).map_or(RowSource::New, RowSource::Known)
    }

    /// Has the new ones of some tasks evaluated on other machines; the rows of those that were, by their positions.
    fn evaluate_elsewhere(
        &self,
        first: usize,
        tasks: &[EvaluationTask],
        sources: &[RowSource],
    ) -> HashMap<usize, SweepPoint> {
        let is_new = |at: &usize| matches!(sources[*at], RowSource::New);
        let new = (0..tasks.len()).filter(is_new).map(|at| ((first + at) as u64, tasks[at].clone()));
        let tasks: BTreeMap<u64, EvaluationTask> = if self.wanted.is_none() { new.collect() } else { BTreeMap::new() };
        if tasks.is_empty() {
            return HashMap::new();
        }
        let measures_of_input = self.rows.first().and_then(|row| row.measures.clone());
        let evaluation_ms = (self.made.0 > 0).then(|| self.made.1 / self.made.0 as f64);
        self.context.points.evaluate(EvaluationBatch { measures_of_input, tasks }, evaluation_ms)
    }
}

/// Where a row comes from.
#[derive(Clone, Copy)]
enum RowSource<'a> {
    /// It is not wanted.
    Unwanted,
    /// An earlier attempt stored it.
    Stored(&'a SweepPoint),
    /// Another row of the same values and settings.
    Known(&'a SweepPoint),
    /// It is to be evaluated.
    New,
}

fn key(task: &EvaluationTask) -> (EvaluationSettings, Vec<u64>) {
    (task.settings, task.values.iter().chain(&task.further).map(|value| value.to_bits()).collect())
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}
