//! What jobs of many evaluations have in common: operating points and measures.

use super::{JobDocument, JobKind};
use crate::reader::ObjectPlace;
use herringbone_macros::{Input, Words};
use serde::Serialize;

/// Largest number of operating points of an evaluation.
pub const MAX_OPERATING_POINTS: usize = 32;
/// Largest number of evaluations, each of which is a row.
pub const MAX_EVALUATIONS: u32 = 100_000;
/// Most characters of a pointer.
pub(super) const POINTER_CHARS: usize = 200;
/// Most inputs that move with another one.
pub(super) const MAX_ALSO: usize = 16;

/// An operating point of every evaluation, instead of that of `operation`.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct OperatingPointInput {
    /// Speed of the pinion; that of operation when null.
    #[input(unit = "r/min", min = 0.1, max = 200_000.0)]
    pub pinion_speed_rpm: Option<f64>,
    /// Torque of the whole pinion; that of operation when null.
    #[input(unit = "N m", min = -1e7, max = 1e7)]
    pub pinion_torque_nm: Option<f64>,
    /// Weight of the point in weighted measures: the others have theirs in proportion.
    #[input(min = 0.0, max = 1e6, default = 1.0)]
    pub share: f64,
}

/// Value of a quantity of which each half has its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum HalvesInput {
    /// The larger one.
    Larger,
    /// The mean of both.
    Mean,
    /// That of the left half.
    Left,
    /// That of the right half.
    Right,
}

/// Value over the operating points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum OverInput {
    /// The worst one.
    Worst,
    /// The mean.
    Mean,
    /// The root of the mean square.
    Rms,
    /// The mean, weighted by the shares.
    Weighted,
}

/// The rules about fields that only some kinds of jobs have, and their defaults.
pub(super) fn of_some_kinds_only(document: &mut JobDocument, place: &ObjectPlace) {
    let kind = document.kind;
    let evaluates = matches!(kind, JobKind::Optimise | JobKind::Tolerance);
    let optimises = kind == JobKind::Optimise;
    let tolerates = kind == JobKind::Tolerance;
    let robust = document.robust.is_some();
    let given = [
        ("operating_points", !document.operating_points.is_empty(), evaluates, "optimise or tolerance"),
        ("variables", !document.variables.is_empty(), optimises, "optimise"),
        ("objectives", !document.objectives.is_empty(), optimises, "optimise"),
        ("constraints", !document.constraints.is_empty(), optimises, "optimise"),
        ("robust", robust, optimises, "optimise"),
        ("budget", document.budget.is_some(), optimises, "optimise"),
        ("method", document.method.is_some(), optimises, "optimise"),
        (
            "tolerances",
            !document.tolerances.is_empty(),
            tolerates || (optimises && robust),
            "tolerance, or optimise with robust",
        ),
        ("measures", !document.measures.is_empty(), tolerates, "tolerance"),
        (
            "correlations",
            !document.correlations.is_empty(),
            tolerates || (optimises && robust),
            "tolerance, or optimise with robust",
        ),
        ("limits", !document.limits.is_empty(), tolerates, "tolerance"),
        ("samples", document.samples.is_some(), tolerates, "tolerance"),
        ("sampling", document.sampling.is_some(), tolerates, "tolerance"),
        ("sensitivity", document.sensitivity.is_some(), tolerates, "tolerance"),
        ("seed", document.seed.is_some(), evaluates, "optimise or tolerance"),
    ];
    for (name, is_given, belongs, kinds) in given {
        if is_given && !belongs {
            place.conflict(name, format!("is given, but is of jobs of kind {kinds} only"));
        }
    }
    if !evaluates {
        return;
    }
    if document.sweep_point.is_some() {
        place.conflict("sweep_point", format!("is given, but kind is \"{}\"", kind.as_str()));
    }
    document.seed = document.seed.or(Some(1));
    if optimises {
        super::optimise::rules(document, place);
    } else {
        super::tolerance::rules(document, place);
    }
}

/// Reports that a list is missing where it is needed.
pub(super) fn require(place: &ObjectPlace, name: &str, is_empty: bool, expected: &str) {
    if is_empty && !place.gives(name) {
        place.missing(name, format!("is required: {expected}"));
    }
}
