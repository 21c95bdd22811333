//! A response over the values of one or two inputs.

use super::mesh::MeshMemo;
use super::point::{self, Point};
use super::{SolveError, Stage, Surroundings};
use crate::job::document::{Axis, Continuation, JobDocument, Kind};
use crate::job::result::{Sweep, SweepAxis, SweepPoint};
use crate::job::{DocumentError, Violation, parse_value};
use rayon::prelude::*;
use serde_json::Value;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Refuses axes that point at nothing, at something that is not a number, or at values out of range.
///
/// # Errors
/// [`DocumentError::Invalid`] with pointers into `/axes`.
pub fn check_axes(document: &JobDocument) -> Result<(), DocumentError> {
    let base = base(document);
    let mut violations = Vec::new();
    for (index, axis) in document.axes.iter().enumerate() {
        let here = format!("/axes/{index}/pointer");
        match base.pointer(&axis.pointer) {
            Some(Value::Number(_)) => {}
            Some(Value::Null) if is_number_field(&axis.pointer) => {}
            Some(_) => {
                let detail = format!("\"{}\" is not a number; a sweep varies one number", axis.pointer);
                violations.push(Violation::new(here, "conflict", detail));
                continue;
            }
            None => {
                let detail = format!("\"{}\" is not a field of the document", axis.pointer);
                violations.push(Violation::new(here, "conflict", detail));
                continue;
            }
        }
        // Ranges are intervals, so the extremes stand for all values; of whole numbers every value has to be one.
        let whole = is_whole_number_field(&axis.pointer);
        let values = || (0..axis.len()).map(|position| axis.value(position));
        let least = values().fold(f64::INFINITY, f64::min);
        let greatest = values().fold(f64::NEG_INFINITY, f64::max);
        let fractional = values().find(|number| whole && number.fract() != 0.0);
        for number in [Some(least), Some(greatest), fractional].into_iter().flatten() {
            let mut value = base.clone();
            set(&mut value, &axis.pointer, number);
            if let Err(DocumentError::Invalid(found)) = parse_value(&value) {
                violations.extend(found.into_iter().map(|violation| Violation {
                    detail: format!("at {} = {number}: {}", axis.pointer, violation.detail),
                    pointer: format!("/axes/{index}"),
                    ..violation
                }));
                break;
            }
        }
    }
    if let [first, second] = document.axes.as_slice()
        && first.pointer == second.pointer
    {
        violations.push(Violation::new("/axes/1/pointer", "conflict", "is the same input as the first axis"));
    }
    if violations.is_empty() { Ok(()) } else { Err(DocumentError::Invalid(violations)) }
}

fn is_number_field(pointer: &str) -> bool {
    field_type(pointer).is_some_and(|word| word == "number" || word == "integer")
}

fn is_whole_number_field(pointer: &str) -> bool {
    field_type(pointer).is_some_and(|word| word == "integer")
}

fn field_type(pointer: &str) -> Option<String> {
    let fields = crate::job::schema::field_descriptions();
    let field = fields.into_iter().find(|field| field.pointer == pointer)?;
    field.schema["type"].as_str().map(str::to_owned)
}

/// The document of one point, before the swept values are put in.
fn base(document: &JobDocument) -> Value {
    let plain = JobDocument { kind: Kind::Response, axes: Vec::new(), continuation: None, ..document.clone() };
    // A document holds finite numbers and strings only, so writing it cannot fail.
    let mut value = serde_json::to_value(plain).unwrap_or_default();
    // Series are not kept for the points of a sweep.
    value["analysis"]["channels"] = Value::Array(Vec::new());
    value
}

fn set(value: &mut Value, pointer: &str, number: f64) {
    if let Some(slot) = value.pointer_mut(pointer) {
        *slot = serde_json::json!(number);
    }
}

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
        Continuation::None => (0..lines * length)
            .into_par_iter()
            .map(|point| solve(point / length, point % length, None).map(|(row, _)| row))
            .collect::<Result<_, _>>()?,
        direction => {
            let followed: Vec<Vec<SweepPoint>> = (0..lines)
                .into_par_iter()
                .map(|line| follow(first, direction, |index, start| solve(line, index, start)))
                .collect::<Result<_, _>>()?;
            followed.into_iter().flatten().collect()
        }
    };
    let axes = document.axes.iter().map(|axis| SweepAxis {
        pointer: axis.pointer.clone(),
        values: (0..axis.len()).map(|index| axis.value(index)).collect(),
    });
    Ok(Sweep { axes: axes.collect(), points: rows })
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
        point::solve(&document, &Surroundings { progress: &|_, _| {}, ..*surroundings }, memo, start)
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
