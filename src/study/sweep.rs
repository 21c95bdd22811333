//! A response over the values of one or two inputs.

use super::axes::{base, set};
use super::mesh::MeshMemo;
use super::point::{self, Point, Wanted};
use super::{SolveError, Stage, Surroundings};
use crate::job::document::{Axis, Continuation, JobDocument};
use crate::job::result::{Sweep, SweepAxis, SweepPoint};
use crate::job::{DocumentError, parse_value};
use rayon::prelude::*;
use serde_json::Value;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Solves every point. Points without continuation are independent and run in parallel; with it, each line along the first
/// axis is followed in order, the lines of the second axis in parallel.
///
/// # Errors
/// [`SolveError::Canceled`]. A point that fails says so in its row.
pub fn run(document: &JobDocument, surroundings: &Surroundings, memo: &MeshMemo) -> Result<Sweep, SolveError> {
    let base = base(document);
    let (first, second) = (&document.axes[0], document.axes.get(1));
    let lines = second.map_or(1, Axis::len);
    let length = first.len();
    let done = AtomicUsize::new(0);
    let solve =
        |line: usize, index: usize, start: Option<&[f64]>| -> Result<(SweepPoint, Option<Vec<f64>>), SolveError> {
            let mut values = vec![first.value(index)];
            values.extend(second.map(|axis| axis.value(line)));
            let row = solve_point(&base, document, values, start, surroundings, memo)?;
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            (surroundings.progress)(Stage::Sweep, count as f64 / (lines * length) as f64);
            Ok(row)
        };
    let rows: Vec<SweepPoint> = match document.continuation.unwrap_or(Continuation::None) {
        Continuation::None => independent(lines, length, |line, index| solve(line, index, None).map(|(row, _)| row))?,
        direction => {
            // The first line leaves to the others what they share (compliance, contact).
            let mut followed = vec![follow(first, direction, |index, start| solve(0, index, start))?];
            followed.par_extend(
                (1..lines)
                    .into_par_iter()
                    .map(|line| follow(first, direction, |index, start| solve(line, index, start)))
                    .collect::<Result<Vec<_>, _>>()?,
            );
            followed.into_iter().flatten().collect()
        }
    };
    let axes = document.axes.iter().map(|axis| SweepAxis {
        pointer: axis.pointer.clone(),
        values: (0..axis.len()).map(|index| axis.value(index)).collect(),
    });
    Ok(Sweep { axes: axes.collect(), points: rows })
}

/// Solves all points in parallel, but the very first before all others and the first of every line before the rest of it: whatever the
/// points share (compliance, contact) is then there and not computed by several at once.
fn independent(
    lines: usize,
    length: usize,
    solve: impl Fn(usize, usize) -> Result<SweepPoint, SolveError> + Sync,
) -> Result<Vec<SweepPoint>, SolveError> {
    let mut rows = vec![SweepPoint::default(); lines * length];
    rows[0] = solve(0, 0)?;
    let mut firsts: Vec<_> = rows.iter_mut().step_by(length).enumerate().skip(1).collect();
    firsts.par_iter_mut().try_for_each(|(line, row)| {
        **row = solve(*line, 0)?;
        Ok::<_, SolveError>(())
    })?;
    rows.par_iter_mut().enumerate().filter(|(point, _)| point % length > 0).try_for_each(|(point, row)| {
        *row = solve(point / length, point % length)?;
        Ok::<_, SolveError>(())
    })?;
    Ok(rows)
}

/// Follows one line of points from its lowest value up or from its highest down; rows come back in the order of the axis.
fn follow(
    axis: &Axis,
    direction: Continuation,
    mut solve: impl FnMut(usize, Option<&[f64]>) -> Result<(SweepPoint, Option<Vec<f64>>), SolveError>,
) -> Result<Vec<SweepPoint>, SolveError> {
    let mut order: Vec<usize> = (0..axis.len()).collect();
    order.sort_by(|&a, &b| axis.value(a).total_cmp(&axis.value(b)));
    if direction == Continuation::Down {
        order.reverse();
    }
    let mut rows = vec![SweepPoint::default(); axis.len()];
    let mut state: Option<Vec<f64>> = None;
    for index in order {
        let (row, end) = solve(index, state.as_deref())?;
        state = end;
        rows[index] = row;
    }
    Ok(rows)
}

fn solve_point(
    base: &Value,
    document: &JobDocument,
    values: Vec<f64>,
    start: Option<&[f64]>,
    surroundings: &Surroundings,
    memo: &MeshMemo,
) -> Result<(SweepPoint, Option<Vec<f64>>), SolveError> {
    let mut value = base.clone();
    for (axis, number) in document.axes.iter().zip(&values) {
        set(&mut value, &axis.pointer, *number);
    }
    let solved = parse_value(&value).map_err(SolveError::from).and_then(|document| {
        point::solve(
            &document,
            &Surroundings { progress: &|_, _| {}, ..*surroundings },
            memo,
            &Wanted { start, whole: false },
        )
    });
    match solved {
        Ok(point) => Ok((row(values, &point), point.end_state)),
        Err(SolveError::Canceled(canceled)) => Err(canceled.into()),
        Err(error) => Ok((SweepPoint { values, error: Some(reason(&error)), ..SweepPoint::default() }, None)),
    }
}

fn row(values: Vec<f64>, point: &Point) -> SweepPoint {
    let result = &point.result;
    let response = result.response.as_ref();
    SweepPoint {
        values,
        mesh_circumferential_acceleration_rms_m_s2: response.map(|r| r.rms.mesh_circumferential_acceleration_m_s2),
        pinion_axial_acceleration_rms_m_s2: response.map(|r| r.rms.pinion_axial_acceleration_m_s2),
        dynamic_factor: response.and_then(|r| r.dynamic_factor),
        regime: response.map(|r| r.regime.clone()),
        contact: response.map(|r| r.contact.clone()),
        min_displacement_um: response.map(|r| r.min_displacement_um),
        stiffness_mean_n_per_um: result.mesh.as_ref().map(|mesh| mesh.stiffness_mean_n_per_um),
        impact_force_n: result.impact.as_ref().map(|impact| impact.force_n),
        total_contact_ratio: result.geometry.as_ref().map(|geometry| geometry.total_contact_ratio),
        loaded_contact_ratio: result.mesh.as_ref().and_then(|mesh| mesh.loaded_contact_ratio),
        error: None,
    }
}

/// What a row says of a point without a response.
fn reason(error: &SolveError) -> String {
    match error {
        SolveError::Document(DocumentError::Invalid(violations) | DocumentError::Unsupported(violations)) => violations
            .iter()
            .map(|violation| format!("{} {}", violation.pointer, violation.detail))
            .collect::<Vec<_>>()
            .join("; "),
        other => other.to_string(),
    }
}
