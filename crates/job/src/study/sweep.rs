//! A response over the values of one or two inputs.

use super::axes::base;
use super::branches;
use super::mesh::MeshMemo;
use super::part::SweepOrder;
use super::points::{LineEnd, StoredPoints};
use super::row;
use super::{SolveContext, SolveError, Stage, campbell, response_result};
use crate::document::{Axis, Continuation, JobDocument, MethodInput, Recorded};
use crate::result::{BranchDirection, SweepAxis, SweepPoint, SweepResult};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Points that are integrated side by side: a multiple of the lanes, few enough to keep all threads busy.
const POINTS_TOGETHER: usize = 32;

/// Number of points that are solved in one go. Points that are integrated go side by side; the others take very
/// different times, so each is for the next free thread.
pub(super) fn together(sweep: &JobDocument) -> usize {
    if sweep.analysis.method == MethodInput::Integrate { POINTS_TOGETHER } else { 1 }
}

/// The points of a sweep and how each is solved.
///
/// Positions of the result go line after line; with two directions the lines of the second follow those of the first.
pub(super) struct Points<'a> {
    base: JobDocument,
    sweep: &'a JobDocument,
    context: &'a SolveContext<'a>,
    memo: &'a MeshMemo,
    order: SweepOrder,
    /// Values of the axes.
    axes: Vec<Vec<f64>>,
    solved: AtomicUsize,
    /// Points that are to be solved altogether.
    all: usize,
}

impl<'a> Points<'a> {
    /// Of a sweep of which `all` points are to be solved, for the progress.
    pub(super) fn new(sweep: &'a JobDocument, context: &'a SolveContext<'a>, memo: &'a MeshMemo, all: usize) -> Self {
        let (base, order) = (base(sweep), SweepOrder::of(sweep));
        let axes = sweep.axes.iter().map(Axis::values).collect();
        Self { base, sweep, context, memo, order, axes, solved: AtomicUsize::new(0), all: all.max(1) }
    }

    fn values(&self, position: usize) -> Vec<f64> {
        let mut places = position;
        let value = |axis: &Vec<f64>| {
            let value = axis[places % axis.len()];
            places /= axis.len();
            value
        };
        self.axes.iter().map(value).collect()
    }

    fn count(&self, solved: usize) {
        let count = self.solved.fetch_add(solved, Ordering::Relaxed) + solved;
        (self.context.progress)(Stage::Sweep, count as f64 / self.all as f64);
    }

    /// Solves and stores points without continuation.
    ///
    /// # Errors
    /// [`SolveError::Canceled`].
    pub(super) fn solve(&self, positions: &[usize]) -> Result<Vec<SweepPoint>, SolveError> {
        let group = positions.iter().map(|position| self.values(*position)).collect();
        let solved = row::solve_together(&self.base, self.sweep, group, self.context, self.memo)?;
        let rows: Vec<SweepPoint> = solved.into_iter().map(|solved| solved.row).collect();
        positions.iter().zip(&rows).for_each(|(position, row)| self.context.points.save(*position, row, None));
        self.count(positions.len());
        Ok(rows)
    }

    /// Follows a line along points that are given in the order of its continuation, from the state at the end of the
    /// point before them. Returns the rows and the state at the end of the last one.
    ///
    /// # Errors
    /// [`SolveError::Canceled`].
    pub(super) fn follow(
        &self,
        line: usize,
        positions: &[usize],
        mut state: Option<Vec<f64>>,
    ) -> Result<(Vec<SweepPoint>, Option<Vec<f64>>), SolveError> {
        let mut rows = Vec::with_capacity(positions.len());
        for &position in positions {
            let start = state.as_deref();
            let values = self.values(position);
            let mut solved = row::solve(&self.base, self.sweep, values, start, self.context, self.memo)?;
            solved.row.branch = self.order.way(line);
            let end = LineEnd { line, position, state: solved.end_state };
            self.context.points.save(position, &solved.row, Some(&end));
            state = end.state;
            rows.push(solved.row);
            self.count(1);
        }
        Ok((rows, state))
    }
}

/// Solves every point that is not in `stored`. Points without continuation are independent and run in parallel; with
/// it, each line along the first axis is followed in order, the lines of the second axis in parallel, and upwards
/// beside downwards.
///
/// # Errors
/// [`SolveError::Canceled`]. The row of a point that fails contains the error.
pub(super) fn run(
    document: &JobDocument,
    stored: StoredPoints,
    context: &SolveContext,
    memo: &MeshMemo,
) -> Result<SweepResult, SolveError> {
    let (first, second) = (&document.axes[0], document.axes.get(1));
    let order = SweepOrder::of(document);
    let (lines, length, ways) = (second.map_or(1, Axis::len), first.len(), ways(document));
    let all = lines * length * ways.len().max(1);
    let points = Points::new(document, context, memo, all);
    let axes = document.axes.iter().map(|axis| SweepAxis {
        pointer: axis.pointer.clone(),
        also: axis.also.clone(),
        values: axis.values(),
    });
    let mut sweep = SweepResult {
        axes: axes.collect(),
        spectrum_mesh_orders: document.record.contains(&Recorded::Spectrum).then(response_result::band_orders),
        ..SweepResult::default()
    };
    if ways.is_empty() {
        let rows: HashMap<_, _> = stored.rows.into_iter().filter(|(position, _)| *position < all).collect();
        points.count(rows.len());
        sweep.points = independent((lines, length), together(document), rows, |positions| points.solve(positions))?;
    } else {
        let follow = |line: usize| -> Result<Vec<SweepPoint>, SolveError> {
            let positions = order.line(line);
            let (mut followed, state) = followed(&stored, line, &positions);
            points.count(followed.len());
            let (rows, _) = points.follow(line, &positions[followed.len()..], state)?;
            followed.extend(rows);
            // In the order of the axis.
            let mut rows: Vec<_> = positions.into_iter().zip(followed).collect();
            rows.sort_by_key(|(position, _)| *position);
            Ok(rows.into_iter().map(|(_, row)| row).collect())
        };
        // The first line computes the parts that the others share (compliance, contact).
        let mut rows = vec![follow(0)?];
        let others: Result<Vec<_>, _> = (1..ways.len() * lines).into_par_iter().map(follow).collect();
        rows.extend(others?);
        let value = |line: usize| second.map(|axis| axis.value(line));
        let jumps = rows
            .iter()
            .enumerate()
            .flat_map(|(line, rows)| branches::jumps(first, ways[line / lines], value(line % lines), rows));
        sweep.jumps = Some(jumps.collect());
        if let [up, down] = rows.chunks(lines).collect::<Vec<_>>()[..] {
            let pairs = up.iter().zip(down).enumerate();
            let found = pairs.flat_map(|(line, (up, down))| branches::hysteresis(first, value(line), up, down));
            sweep.hysteresis = Some(found.collect());
        }
        sweep.points = rows.into_iter().flatten().collect();
    }
    sweep.campbell = campbell::run(&points.base, document, context, memo)?;
    Ok(sweep)
}

/// Directions in which the branches of a sweep are followed, in the order of its rows; none without continuation.
pub(super) fn ways(document: &JobDocument) -> &'static [BranchDirection] {
    match document.continuation.unwrap_or(Continuation::None) {
        Continuation::None => &[],
        Continuation::Up => &[BranchDirection::Up],
        Continuation::Down => &[BranchDirection::Down],
        Continuation::Both => &[BranchDirection::Up, BranchDirection::Down],
    }
}

/// Position of the point from whose end the point at `position` continues; `None` for the first of a line, and without
/// continuation.
pub fn continued_from(document: &JobDocument, position: usize) -> Option<usize> {
    let first = document.axes.first()?;
    let lines = document.axes.get(1).map_or(1, Axis::len);
    let (line, index) = (position / first.len(), position % first.len());
    let order = branches::order(first, *ways(document).get(line / lines)?);
    let place = order.iter().position(|other| *other == index)?;
    Some(line * first.len() + order[place.checked_sub(1)?])
}

/// Solves all points without a row in parallel, but the very first before all others and the first of every line before
/// the rest of it: whatever the points share (compliance, contact) is then there and not computed by several at once.
/// The rest goes in groups of `together`.
fn independent(
    (lines, length): (usize, usize),
    together: usize,
    mut rows: HashMap<usize, SweepPoint>,
    solve: impl Fn(&[usize]) -> Result<Vec<SweepPoint>, SolveError> + Sync,
) -> Result<Vec<SweepPoint>, SolveError> {
    let missing = |line: usize| (line * length..(line + 1) * length).filter(|position| !rows.contains_key(position));
    let mut firsts: Vec<usize> = (0..lines).filter_map(|line| missing(line).next()).collect();
    let rest: Vec<usize> = (0..lines).flat_map(|line| missing(line).skip(1)).collect();
    let others = firsts.split_off(firsts.len().min(1));
    for (positions, together) in [(firsts, 1), (others, 1), (rest, together)] {
        let solved = positions.par_chunks(together).map(|group| Ok((group, solve(group)?)));
        let solved: Vec<_> = solved.collect::<Result<_, SolveError>>()?;
        rows.extend(solved.into_iter().flat_map(|(group, rows)| group.iter().copied().zip(rows)));
    }
    Ok((0..lines * length).map(|position| rows.remove(&position).unwrap_or_default()).collect())
}

/// Rows of a line solved by an earlier run, in the order of the continuation, and the state from which it resumes.
/// `positions`: those of the line, in that order.
fn followed(stored: &StoredPoints, line: usize, positions: &[usize]) -> (Vec<SweepPoint>, Option<Vec<f64>>) {
    let Some(end) = stored.ends.get(&line) else { return Default::default() };
    let upto = positions.iter().position(|position| *position == end.position).map_or(0, |last| last + 1);
    let rows: Vec<_> = positions[..upto].iter().map_while(|position| stored.rows.get(position).cloned()).collect();
    // Without every row up to the end the line is followed afresh.
    if rows.len() == upto { (rows, end.state.clone()) } else { Default::default() }
}
