//! The inputs of a sweep.

use super::{MAX_RECORDED_POINTS, MAX_SWEEP_POINTS, conflict, number};
use crate::document::*;
use crate::reader::Object;
use crate::violation::Violation;

/// Most inputs that move with the first of an axis.
const MAX_ALSO: usize = 16;

pub(super) fn axes(root: &Object, kind: JobKind) -> Vec<Axis> {
    let help = "sweep: one or two inputs to vary.";
    let Some(objects) = root.objects("axes", 1, 2, help) else {
        if kind == JobKind::Sweep && !root.has("axes") {
            root.reading().violate(Violation::new("/axes", "missing", "is required for a sweep: one or two axes"));
        }
        return Vec::new();
    };
    if kind != JobKind::Sweep {
        conflict(root, "axes", "is given, but kind is not \"sweep\"");
    }
    let axes: Vec<Axis> = objects.into_iter().map(axis).collect();
    let points: usize = axes.iter().map(Axis::len).product();
    if points > MAX_SWEEP_POINTS {
        let detail = format!("have {points} points together; permitted: at most {MAX_SWEEP_POINTS}");
        conflict(root, "axes", &detail);
    }
    axes
}

fn axis(object: Object) -> Axis {
    let any = |help| number(-1e12, 1e12, "unit of the input", None, help);
    let pointer = object.required_text("pointer", 200, "JSON pointer of the input that varies.");
    let also = object
        .texts("also", MAX_ALSO, None, "JSON pointers of further inputs that take the axis' value.")
        .unwrap_or_default();
    let from = object.optional_number("from", any("First value."));
    let to = object.optional_number("to", any("Last value."));
    let points = object.integer("points", 1, MAX_SWEEP_POINTS as u64, Some(50), "Number of values.") as u32;
    let spacing = object.choice(
        "spacing",
        &[("linear", Spacing::Linear), ("logarithmic", Spacing::Logarithmic)],
        Spacing::Linear,
        "linear",
        "Spacing of the values.",
    );
    let values = object.numbers("values", 1, MAX_SWEEP_POINTS, any("The values, instead of from, to and points."));
    let points = match (values, from, to) {
        (Some(values), None, None) => AxisPoints::Values { values },
        (Some(values), ..) => {
            conflict(&object, "values", "is given together with from or to; give one or the other");
            AxisPoints::Values { values }
        }
        (None, Some(from), Some(to)) => {
            if spacing == Spacing::Logarithmic && (from <= 0.0 || to <= 0.0) {
                conflict(&object, "spacing", "is logarithmic, which needs from and to above 0");
            }
            AxisPoints::Range { from, to, points, spacing }
        }
        (None, from, _) => {
            let name = if from.is_none() { "from" } else { "to" };
            if !object.has("values") && !object.has(name) {
                object.reading().violate(Violation::new(
                    object.pointer_to(name),
                    "missing",
                    "is required, unless values is given: -1e12 to 1e12, in the unit of the input",
                ));
            }
            AxisPoints::Values { values: vec![0.0] }
        }
    };
    object.finish();
    Axis { pointer, also, points }
}

pub(super) fn continuation(root: &Object, kind: JobKind) -> Option<Continuation> {
    let value = root.choice(
        "continuation",
        &[
            ("none", Continuation::None),
            ("up", Continuation::Up),
            ("down", Continuation::Down),
            ("both", Continuation::Both),
        ],
        Continuation::None,
        "none",
        "sweep: whether a point starts cold, or from the end of its neighbour below (up) or above (down) along the first axis; both: \
         up, then down, and where they differ. The steady motion is found from there; with method integrate, by \
         analysis.mesh_periods.",
    );
    if kind != JobKind::Sweep && root.has("continuation") {
        conflict(root, "continuation", "is given, but kind is not \"sweep\"");
    }
    (kind == JobKind::Sweep).then_some(value)
}

pub(super) fn record(root: &Object, kind: JobKind, axes: &[Axis]) -> Vec<Recorded> {
    let help = "sweep: what every row carries beside its numbers: poincare (mesh displacement and velocity at the starts of the \
                last mesh periods), spectrum (amplitudes at the mesh orders 1/4 to 20).";
    let permitted = Recorded::ALL.map(|(word, _)| word);
    let Some(words) = root.texts("record", Recorded::ALL.len(), Some(&permitted), help) else { return Vec::new() };
    let mut record = Vec::new();
    for (index, word) in words.iter().enumerate() {
        match Recorded::ALL.iter().find(|(known, _)| known == word) {
            Some((_, what)) if !record.contains(what) => record.push(*what),
            Some(_) => {}
            None => {
                let detail = format!("is \"{word}\"; permitted: poincare, spectrum");
                let pointer = format!("{}/{index}", root.pointer_to("record"));
                root.reading().violate(Violation::new(pointer, "not-one-of", detail));
            }
        }
    }
    if kind != JobKind::Sweep && !record.is_empty() {
        conflict(root, "record", "is given, but kind is not \"sweep\"");
        return Vec::new();
    }
    let points: usize = axes.iter().map(Axis::len).product();
    if !record.is_empty() && points > MAX_RECORDED_POINTS {
        let detail = format!("is given for {points} points; permitted: at most {MAX_RECORDED_POINTS}");
        conflict(root, "record", &detail);
    }
    record
}
