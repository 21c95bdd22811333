//! A part of a sweep that is solved apart from the rest, as on another machine: some of its points, or a stretch of a
//! line that is followed by continuation.

use super::mesh::MeshMemo;
use super::sweep::{Points, ways};
use super::{CheckedJob, LineEnd, SolveContext, SolveError, branches};
use crate::document::{Axis, JobDocument, JobKind};
use crate::result::BranchDirection;
use rayon::prelude::*;

/// The lines of a sweep and the order in which their points are solved.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepOrder {
    /// Number of lines: the values of the second axis, once for each direction of continuation.
    pub lines: usize,
    /// Points of a line.
    pub length: usize,
    ways: &'static [BranchDirection],
    /// Indices on the first axis from its least value up.
    upwards: Vec<usize>,
}

impl SweepOrder {
    /// The order of a sweep's document.
    pub fn of(document: &JobDocument) -> Self {
        let ways = ways(document);
        let values = document.axes.get(1).map_or(1, Axis::len);
        let first = document.axes.first();
        let upwards = first.map(|first| branches::order(first, BranchDirection::Up)).unwrap_or_default();
        Self { lines: values * ways.len().max(1), length: first.map_or(0, Axis::len), ways, upwards }
    }

    /// Whether each point of a line continues the motion of the one before.
    pub fn is_continued(&self) -> bool {
        !self.ways.is_empty()
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.lines * self.length
    }

    /// Positions of the points of a line, in the order in which it is followed; in their own order without
    /// continuation.
    pub fn line(&self, line: usize) -> Vec<usize> {
        let position = |index: &usize| line * self.length + index;
        match self.way(line) {
            None => (0..self.length).map(|index| line * self.length + index).collect(),
            Some(BranchDirection::Up) => self.upwards.iter().map(position).collect(),
            Some(BranchDirection::Down) => self.upwards.iter().rev().map(position).collect(),
        }
    }

    /// Direction in which a line is followed.
    pub(super) fn way(&self, line: usize) -> Option<BranchDirection> {
        let lines = self.lines / self.ways.len().max(1);
        self.ways.get(line / lines.max(1)).copied()
    }
}

/// A part of a sweep.
#[derive(Debug, Clone, PartialEq)]
pub enum SweepPart {
    /// Points without continuation, by their positions.
    Points(Vec<usize>),
    /// Points of a line, in the order in which it is followed: those at the places `from` to `to` (not included) of
    /// [`SweepOrder::line`]. `start`: the state at the end of the point before.
    Stretch { line: usize, from: usize, to: usize, start: Option<Vec<f64>> },
}

/// Solves a part of a sweep: its rows go to the point store of the context. Returns where a line was left.
///
/// # Errors
/// [`SolveError::Canceled`]; [`SolveError::Failed`] when the sweep has no such part. The row of a point that fails
/// contains the error.
pub fn solve_part(job: &CheckedJob, part: &SweepPart, context: &SolveContext) -> Result<Option<LineEnd>, SolveError> {
    let (document, memo) = (job.document(), MeshMemo::default());
    let order = SweepOrder::of(document);
    let is_sweep = document.kind == JobKind::Sweep;
    match part {
        SweepPart::Points(positions) => {
            if !is_sweep || order.is_continued() || positions.iter().any(|position| *position >= order.points()) {
                return Err(no_such_part());
            }
            let points = Points::new(document, context, &memo, positions.len());
            // The first point computes the parts that the others share (compliance, contact).
            let (first, others) = positions.split_at(positions.len().min(1));
            points.solve(first)?;
            others.par_chunks(points.together()).try_for_each(|group| points.solve(group).map(drop))?;
            Ok(None)
        }
        SweepPart::Stretch { line, from, to, start } => {
            if !is_sweep || !order.is_continued() || *line >= order.lines || from >= to || *to > order.length {
                return Err(no_such_part());
            }
            let positions = order.line(*line);
            let points = Points::new(document, context, &memo, to - from);
            let (_, state) = points.follow(*line, &positions[*from..*to], start.clone())?;
            Ok(Some(LineEnd { line: *line, position: positions[*to - 1], state }))
        }
    }
}

fn no_such_part() -> SolveError {
    SolveError::Failed {
        stage: super::Stage::Sweep,
        code: "internal".to_owned(),
        detail: "the sweep has no such part".to_owned(),
        sim_time_s: None,
        step: None,
    }
}
