//! The rows of a job of evaluations, solved or taken from an earlier attempt.

use super::evaluator::Outcome;
use crate::result::{EvaluationPhase, SweepPoint};
use crate::study::points::StoredPoints;
use crate::study::{SolveContext, SolveError, Stage};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// An evaluation to be made.
#[derive(Debug, Clone)]
pub(in crate::study) struct Task {
    /// Values of the inputs, the first of each.
    pub values: Vec<f64>,
    /// Values of further inputs that are not in the row.
    pub further: Vec<f64>,
    pub phase: EvaluationPhase,
    pub generation: Option<u32>,
}

/// The rows so far.
pub(in crate::study) struct Rows<'a> {
    context: &'a SolveContext<'a>,
    stored: HashMap<usize, SweepPoint>,
    pub rows: Vec<SweepPoint>,
    /// Evaluations that are expected altogether.
    expected: usize,
    /// Rows of the same values and settings, which need not be solved again.
    known: HashMap<(u8, Vec<u64>), usize>,
    /// Rows of an earlier job with the settings 0, by their values.
    earlier: HashMap<Vec<u64>, SweepPoint>,
    pub has_reused: bool,
    /// Positions that are to be evaluated; all when there are none. The rows of the others are empty.
    wanted: Option<HashSet<usize>>,
    /// Evaluations that were counted as done.
    done: usize,
}

/// Turns an outcome into the numbers of the row.
pub(in crate::study) type Complete<'f> = &'f (dyn Fn(&Outcome, &mut SweepPoint) + Sync);

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
        }
    }

    /// Rows of which only these are evaluated, and stored; each as if it were alone.
    pub(in crate::study) fn of_positions(positions: &[usize], context: &'a SolveContext<'a>) -> Self {
        let rows = Self::new(StoredPoints::default(), positions.len() as u64, context);
        Self { wanted: Some(positions.iter().copied().collect()), ..rows }
    }

    /// Gives rows of an earlier job with the settings 0 and of nothing but values.
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
    /// `settings`: a number for the settings that `evaluate` uses.
    ///
    /// # Errors
    /// [`SolveError::Canceled`].
    pub(in crate::study) fn run(
        &mut self,
        tasks: Vec<Task>,
        settings: u8,
        evaluate: impl Fn(&Task) -> Result<Outcome, SolveError> + Sync,
        complete: Complete,
    ) -> Result<Range<usize>, SolveError> {
        let first = self.rows.len();
        let key = |task: &Task| {
            let values = task.values.iter().chain(&task.further).map(|value| value.to_bits());
            (settings, values.collect::<Vec<_>>())
        };
        let progress = AtomicUsize::new(self.done);
        let (stored, rows, known, wanted) = (&self.stored, &self.rows, &self.known, &self.wanted);
        let earlier = &self.earlier;
        let count = || {
            let done = progress.fetch_add(1, Ordering::Relaxed) + 1;
            (self.context.progress)(Stage::Evaluations, (done as f64 / self.expected as f64).min(1.0));
        };
        let solve = |(at, task): (usize, &Task)| -> Result<SweepPoint, SolveError> {
            let position = first + at;
            if wanted.as_ref().is_some_and(|wanted| !wanted.contains(&position)) {
                return Ok(SweepPoint::default());
            }
            let is_same = |row: &&SweepPoint| {
                row.phase == Some(task.phase)
                    && row.values.len() == task.values.len()
                    && row.values.iter().zip(&task.values).all(|(a, b)| a.to_bits() == b.to_bits())
            };
            if let Some(row) = stored.get(&position).filter(is_same) {
                count();
                return Ok(row.clone());
            }
            // Among positions apart, the row of the same values may be an empty one.
            let of_same_values = known.get(&key(task)).filter(|_| wanted.is_none()).map(|known| &rows[*known]);
            let of_earlier = || {
                let is_plain = settings == 0 && task.further.is_empty();
                if is_plain { earlier.get(&bits(&task.values)) } else { None }
            };
            let mut row = match of_same_values.or_else(of_earlier) {
                Some(known) => known.clone(),
                None => {
                    let outcome = evaluate(task)?;
                    let mut row = outcome.row.clone();
                    row.error.clone_from(&outcome.error);
                    row.measures.clone_from(&outcome.measures);
                    complete(&outcome, &mut row);
                    row
                }
            };
            row.values.clone_from(&task.values);
            row.phase = Some(task.phase);
            row.generation = task.generation;
            self.context.points.save(position, &row, None);
            count();
            Ok(row)
        };
        let solved: Vec<SweepPoint> = tasks.par_iter().enumerate().map(solve).collect::<Result<_, SolveError>>()?;
        self.done = progress.into_inner();
        for (at, (task, row)) in tasks.iter().zip(solved).enumerate() {
            self.known.entry(key(task)).or_insert(first + at);
            self.rows.push(row);
        }
        Ok(first..self.rows.len())
    }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}
