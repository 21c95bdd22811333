//! A response over the values of one or two inputs.

use super::axes::base;
use super::branches::{self, Way};
use super::mesh::MeshMemo;
use super::row::{self, Solved};
use super::{SolveError, Stage, Surroundings, answer, campbell};
use crate::job::document::{Axis, Continuation, JobDocument, Method, Recorded};
use crate::job::result::{Sweep, SweepAxis, SweepPoint};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Points that are integrated side by side: a multiple of the lanes, few enough to keep all threads busy.
const SIDE_BY_SIDE: usize = 32;

/// Solves every point. Points without continuation are independent and run in parallel; with it, each line along the first
/// axis is followed in order, the lines of the second axis in parallel, and upwards beside downwards.
///
/// # Errors
/// [`SolveError::Canceled`]. A point that fails says so in its row.
pub fn run(document: &JobDocument, surroundings: &Surroundings, memo: &MeshMemo) -> Result<Sweep, SolveError> {
    let base = base(document);
    let (first, second) = (&document.axes[0], document.axes.get(1));
    let lines = second.map_or(1, Axis::len);
    let length = first.len();
    let ways: &[Way] = match document.continuation.unwrap_or(Continuation::None) {
        Continuation::None => &[],
        Continuation::Up => &[Way::Up],
        Continuation::Down => &[Way::Down],
        Continuation::Both => &[Way::Up, Way::Down],
    };
    let all = lines * length * ways.len().max(1);
    let done = AtomicUsize::new(0);
    let values = |line: usize, index: usize| {
        let mut values = vec![first.value(index)];
        values.extend(second.map(|axis| axis.value(line)));
        values
    };
    let count = |solved: usize| {
        let count = done.fetch_add(solved, Ordering::Relaxed) + solved;
        (surroundings.progress)(Stage::Sweep, count as f64 / all as f64);
    };
    let solve = |line: usize, index: usize, start: Option<&[f64]>| -> Result<Solved, SolveError> {
        let solved = row::solve(&base, document, values(line, index), start, surroundings, memo)?;
        count(1);
        Ok(solved)
    };
    let solve_together = |points: &[(usize, usize)]| -> Result<Vec<SweepPoint>, SolveError> {
        let group = points.iter().map(|&(line, index)| values(line, index)).collect();
        let solved = row::solve_together(&base, document, group, surroundings, memo)?;
        count(points.len());
        Ok(solved.into_iter().map(|solved| solved.row).collect())
    };
    // Points that are integrated go side by side; the others take very different times, so each is for the next free thread.
    let together = if document.analysis.method == Method::Integrate { SIDE_BY_SIDE } else { 1 };
    let axes = document.axes.iter().map(|axis| SweepAxis {
        pointer: axis.pointer.clone(),
        values: (0..axis.len()).map(|index| axis.value(index)).collect(),
    });
    let mut sweep = Sweep {
        axes: axes.collect(),
        spectrum_mesh_orders: document.record.contains(&Recorded::Spectrum).then(answer::band_orders),
        ..Sweep::default()
    };
    if ways.is_empty() {
        sweep.points = independent((lines, length), together, solve_together)?;
    } else {
        let follow = |branch: usize| follow(first, ways[branch / lines], |at, start| solve(branch % lines, at, start));
        // The first line leaves to the others what they share (compliance, contact).
        let mut followed = vec![follow(0)?];
        let others: Result<Vec<_>, _> = (1..ways.len() * lines).into_par_iter().map(follow).collect();
        followed.extend(others?);
        let value = |line: usize| second.map(|axis| axis.value(line));
        let jumps = followed
            .iter()
            .enumerate()
            .flat_map(|(branch, line)| branches::jumps(first, ways[branch / lines], value(branch % lines), line));
        sweep.jumps = Some(jumps.collect());
        if let [up, down] = followed.chunks(lines).collect::<Vec<_>>()[..] {
            let pairs = up.iter().zip(down).enumerate();
            let found = pairs.flat_map(|(line, (up, down))| branches::hysteresis(first, value(line), up, down));
            sweep.hysteresis = Some(found.collect());
        }
        sweep.points = followed.into_iter().flatten().map(|solved| solved.row).collect();
    }
    sweep.campbell = campbell::run(&base, document, surroundings, memo)?;
    Ok(sweep)
}

/// Solves all points in parallel, but the very first before all others and the first of every line before the rest of it: whatever the
/// points share (compliance, contact) is then there and not computed by several at once. The rest goes in groups of `together`.
fn independent(
    (lines, length): (usize, usize),
    together: usize,
    solve: impl Fn(&[(usize, usize)]) -> Result<Vec<SweepPoint>, SolveError> + Sync,
) -> Result<Vec<SweepPoint>, SolveError> {
    let all = |points: Vec<(usize, usize)>, together: usize| {
        let solved = points.par_chunks(together).map(|group| Ok((group.to_vec(), solve(group)?)));
        solved.collect::<Result<Vec<_>, SolveError>>()
    };
    let mut solved = all(vec![(0, 0)], 1)?;
    solved.extend(all((1..lines).map(|line| (line, 0)).collect(), 1)?);
    solved.extend(all((0..lines).flat_map(|line| (1..length).map(move |at| (line, at))).collect(), together)?);
    let mut rows = vec![SweepPoint::default(); lines * length];
    for ((line, index), row) in solved.into_iter().flat_map(|(points, rows)| points.into_iter().zip(rows)) {
        rows[line * length + index] = row;
    }
    Ok(rows)
}

/// Follows one line of points from its lowest value up or from its highest down; they come back in the order of the axis.
fn follow(
    axis: &Axis,
    way: Way,
    mut solve: impl FnMut(usize, Option<&[f64]>) -> Result<Solved, SolveError>,
) -> Result<Vec<Solved>, SolveError> {
    let mut line = vec![Solved::default(); axis.len()];
    let mut state: Option<Vec<f64>> = None;
    for index in branches::order(axis, way) {
        let mut solved = solve(index, state.as_deref())?;
        solved.row.branch = Some(way.word().to_owned());
        state = solved.end_state.take();
        line[index] = solved;
    }
    Ok(line)
}
