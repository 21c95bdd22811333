//! The inputs of a sweep.

use super::{JobDocument, JobKind};
use crate::field::{Input, Slot};
use crate::grid;
use crate::reader::{Object, ObjectPlace};
use herringbone_macros::{Input, Words};
use serde::Serialize;

/// Largest number of points of a sweep.
pub const MAX_SWEEP_POINTS: usize = 100_000;
/// Largest number of points of a sweep whose rows carry more than numbers.
const MAX_RECORDED_POINTS: usize = 5_000;
/// Most inputs that move with the first of an axis.
const MAX_ALSO: usize = 16;

/// The rules about the fields that only sweeps have, or only other jobs.
pub(super) fn of_sweeps_only(document: &mut JobDocument, place: &ObjectPlace) {
    let is_sweep = document.kind == JobKind::Sweep;
    let not_here = |name| place.conflict(name, "is given, but kind is not \"sweep\"");
    if document.axes.is_empty() {
        if is_sweep && !place.gives("axes") {
            place.missing("axes", "is required for a sweep: one or two axes");
        }
    } else if !is_sweep {
        not_here("axes");
    }
    if is_sweep && document.sweep_point.is_some() {
        place.conflict("sweep_point", "is given, but kind is \"sweep\"");
    }
    let points: usize = document.axes.iter().map(Axis::len).product();
    if points > MAX_SWEEP_POINTS {
        place.conflict("axes", format!("have {points} points together; permitted: at most {MAX_SWEEP_POINTS}"));
    }
    match document.continuation {
        Some(_) if !is_sweep => not_here("continuation"),
        None if is_sweep => document.continuation = Some(Continuation::None),
        _ => {}
    }
    if !document.record.is_empty() {
        if !is_sweep {
            not_here("record");
        } else if points > MAX_RECORDED_POINTS {
            let detail = format!("is given for {points} points; permitted: at most {MAX_RECORDED_POINTS}");
            place.conflict("record", detail);
        }
    }
}

/// One swept input: where it stands in the document, and the values it takes, in the order in which they are solved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    pub pointer: String,
    /// Further inputs that take the same value.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub also: Vec<String>,
    #[serde(flatten)]
    pub points: AxisPoints,
}

/// The values of an axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum AxisPoints {
    Range { from: f64, to: f64, points: u32, spacing: Spacing },
    Values { values: Vec<f64> },
}

/// Spacing of the values of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum Spacing {
    Linear,
    Logarithmic,
}

/// The members of the JSON object of [`Axis`].
#[derive(Input)]
struct AxisMembers {
    /// JSON pointer of the input that varies.
    #[input(max_chars = 200)]
    pointer: String,
    /// JSON pointers of further inputs that take the axis' value.
    #[input(max_items = MAX_ALSO)]
    also: Vec<String>,
    /// First value.
    #[input(unit = "unit of the input", min = -1e12, max = 1e12)]
    from: Option<f64>,
    /// Last value.
    #[input(unit = "unit of the input", min = -1e12, max = 1e12)]
    to: Option<f64>,
    /// Number of values.
    #[input(min = 1, max = MAX_SWEEP_POINTS, default = 50)]
    points: u32,
    /// Spacing of the values.
    #[input(default = Spacing::Linear)]
    spacing: Spacing,
    /// The values, instead of from, to and points.
    #[input(unit = "unit of the input", min = -1e12, max = 1e12, min_items = 1, max_items = MAX_SWEEP_POINTS)]
    values: Option<Vec<f64>>,
}

impl Input for Axis {
    fn read(object: &Object, _base: Option<&Self>) -> Self {
        let AxisMembers { pointer, also, from, to, points, spacing, values } = Input::read(object, None);
        let place = object.place();
        let points = match (values, from, to) {
            (Some(values), None, None) => AxisPoints::Values { values },
            (Some(values), ..) => {
                place.conflict("values", "is given together with from or to; give one or the other");
                AxisPoints::Values { values }
            }
            (None, Some(from), Some(to)) => {
                if spacing == Spacing::Logarithmic && (from <= 0.0 || to <= 0.0) {
                    place.conflict("spacing", "is logarithmic, which needs from and to above 0");
                }
                AxisPoints::Range { from, to, points, spacing }
            }
            (None, from, _) => {
                let name = if from.is_none() { "from" } else { "to" };
                if !place.gives("values") && !place.gives(name) {
                    let detail = "is required, unless values is given: -1e12 to 1e12, in the unit of the input";
                    place.missing(name, detail);
                }
                AxisPoints::Values { values: vec![0.0] }
            }
        };
        Axis { pointer, also, points }
    }

    fn check(&mut self, _place: &ObjectPlace) {}

    /// None: what varies is set in a document without axes.
    fn slot(&mut self, _pointer: &str) -> Option<Slot<'_>> {
        None
    }
}

impl Axis {
    /// Every input that takes the axis' value.
    pub fn pointers(&self) -> impl Iterator<Item = &str> {
        std::iter::once(&self.pointer).chain(&self.also).map(String::as_str)
    }

    pub fn len(&self) -> usize {
        match &self.points {
            AxisPoints::Range { points, .. } => *points as usize,
            AxisPoints::Values { values } => values.len(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The values by position, as [`Axis::value`] has them.
    pub fn values(&self) -> Vec<f64> {
        match &self.points {
            AxisPoints::Values { values } => values.clone(),
            AxisPoints::Range { from, to, points, spacing } => grid::values(*from, *to, *points as usize, *spacing),
        }
    }

    /// The value at position `index`; both ends of a range, and round values between them, are met exactly.
    pub fn value(&self, index: usize) -> f64 {
        match &self.points {
            AxisPoints::Values { values } => values[index],
            AxisPoints::Range { from, to, points, spacing } => {
                grid::value(*from, *to, *points as usize, *spacing, index)
            }
        }
    }
}

/// Start of the points of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum Continuation {
    /// From rest.
    None,
    /// From the end of the neighbour below along the first axis.
    Up,
    /// From the end of the neighbour above along the first axis.
    Down,
    /// Up and then down, and where the two differ.
    Both,
}

/// Data that a row of a sweep can carry beside its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum Recorded {
    /// The motion at the starts of mesh periods.
    Poincare,
    /// Amplitudes at the mesh orders.
    Spectrum,
}
