//! A response over the values of one or two inputs.

use super::axes::base;
use super::branches;
use super::mesh::MeshMemo;
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
    let base = base(document);
    let (first, second) = (&document.axes[0], document.axes.get(1));
    let lines = second.map_or(1, Axis::len);
    let length = first.len();
    let ways = ways(document);
    let all = lines * length * ways.len().max(1);
    let done = AtomicUsize::new(0);
    // Positions of the result, line after line; with two directions the lines of the second follow those of the first.
    let values = |position: usize| {
        let mut values = vec![first.value(position % length)];
        values.extend(second.map(|axis| axis.value(position / length % lines)));
        values
    };
    let count = |solved: usize| {
        let count = done.fetch_add(solved, Ordering::Relaxed) + solved;
        (context.progress)(Stage::Sweep, count as f64 / all as f64);
    };
    let axes = document.axes.iter().map(|axis| SweepAxis {
        pointer: axis.pointer.clone(),
        also: axis.also.clone(),
        values: (0..axis.len()).map(|index| axis.value(index)).collect(),
    });
    let mut sweep = SweepResult {
        axes: axes.collect(),
        spectrum_mesh_orders: document.record.contains(&Recorded::Spectrum).then(response_result::band_orders),
        ..SweepResult::default()
    };
    if ways.is_empty() {
        let solve = |points: &[usize]| -> Result<Vec<SweepPoint>, SolveError> {
            let group = points.iter().map(|position| values(*position)).collect();
            let solved = row::solve_together(&base, document, group, context, memo)?;
            let rows: Vec<SweepPoint> = solved.into_iter().map(|solved| solved.row).collect();
            points.iter().zip(&rows).for_each(|(position, row)| context.points.save(*position, row, None));
            count(points.len());
            Ok(rows)
        };
        // Points that are integrated go side by side; the others take very different times, so each is for the next
        // free thread.
        let together = if document.analysis.method == MethodInput::Integrate { POINTS_TOGETHER } else { 1 };
        let rows: HashMap<_, _> = stored.rows.into_iter().filter(|(position, _)| *position < all).collect();
        count(rows.len());
        sweep.points = independent((lines, length), together, rows, solve)?;
    } else {
        let follow = |line: usize| -> Result<Vec<SweepPoint>, SolveError> {
            let way = ways[line / lines];
            let order = branches::order(first, way);
            let (mut followed, mut state) = followed(&stored, line, length, &order);
            count(followed.len());
            for &index in &order[followed.len()..] {
                let position = line * length + index;
                let mut solved = row::solve(&base, document, values(position), state.as_deref(), context, memo)?;
                solved.row.branch = Some(way);
                let end = LineEnd { line, position, state: solved.end_state };
                context.points.save(position, &solved.row, Some(&end));
                state = end.state;
                followed.push(solved.row);
                count(1);
            }
            // In the order of the axis.
            let mut rows: Vec<_> = order.into_iter().zip(followed).collect();
            rows.sort_by_key(|(index, _)| *index);
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
    sweep.campbell = campbell::run(&base, document, context, memo)?;
    Ok(sweep)
}

/// Directions in which the branches of a sweep are followed, in the order of its rows; none without continuation.
fn ways(document: &JobDocument) -> &'static [BranchDirection] {
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
fn followed(stored: &StoredPoints, line: usize, length: usize, order: &[usize]) -> (Vec<SweepPoint>, Option<Vec<f64>>) {
    let Some(end) = stored.ends.get(&line) else { return Default::default() };
    let upto = order.iter().position(|index| line * length + index == end.position).map_or(0, |last| last + 1);
    let rows: Vec<_> =
        order[..upto].iter().map_while(|index| stored.rows.get(&(line * length + index)).cloned()).collect();
    // Without every row up to the end the line is followed afresh.
    if rows.len() == upto { (rows, end.state.clone()) } else { Default::default() }
}
