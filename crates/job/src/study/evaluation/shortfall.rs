//! How far a pair is from one that exists.

use crate::document::JobDocument;
use crate::study::prepare::infeasibilities;
use herringbone_physics::gear::{Consequence, InfeasibilityReason};

/// Sum of what is missing at each infeasibility of the pair, each in units of its limit or in normal modules; `None` of
/// a pair that exists.
pub(in crate::study) fn shortfall(document: &JobDocument) -> Option<f64> {
    let found = infeasibilities(document);
    (!found.is_empty()).then(|| found.iter().map(|found| of_reason(&found.reason)).sum())
}

/// What is missing, never below a small number: every reason counts.
fn of_reason(reason: &InfeasibilityReason) -> f64 {
    use InfeasibilityReason as Reason;
    let beyond = |value: f64, limit: f64| (value - limit) / if limit == 0.0 { 1.0 } else { limit.abs() };
    let missing = match reason {
        Reason::ValueOutOfRange { value, minimum, maximum } => {
            beyond(*minimum, *value).max(beyond(*value, *maximum)).abs()
        }
        Reason::RackTipPointed { dedendum, limit } => beyond(*dedendum, *limit),
        Reason::FilletRadiusTooLarge { fillet_radius, limit } => fillet_radius - limit,
        Reason::RootCircleVanishes { root_radius_m, limit_m } => -beyond(*root_radius_m, *limit_m),
        Reason::NoInvolute { tip_radius_m, start_radius_m } => beyond(*start_radius_m, *tip_radius_m),
        Reason::ToothCutOff { thickness } | Reason::PointedTip { thickness } => -thickness,
        Reason::BoreTooLarge { bore_radius_m, root_radius_m } => beyond(*bore_radius_m, *root_radius_m),
        Reason::ProfileShiftSumTooSmall { sum, limit } => limit - sum,
        Reason::CenterDistanceTooSmall { base_radius_sum_m, fit } => beyond(*base_radius_sum_m, fit.center_distance_m),
        Reason::TipInterference { addendum, limit, .. } => addendum - limit,
        Reason::FilletInterference { cut, limit } => cut - limit,
        Reason::NoTipClearance { clearance } => -clearance,
        Reason::ContactRatioBelowOne { transverse, overlap, .. } => 1.0 - transverse - overlap,
        Reason::FlanksOverlap { backlash_m, limit_m, .. } => beyond(-backlash_m, *limit_m),
        Reason::CenterDistanceDoesNotFit { consequences, .. } => consequences.iter().map(of_consequence).sum(),
    };
    if missing.is_finite() { missing.max(1e-6) } else { 1.0 }
}

fn of_consequence(consequence: &Consequence) -> f64 {
    match consequence {
        Consequence::Infeasible(found) => of_reason(&found.reason),
        Consequence::ContactRatioLost { fitting, working, .. } => fitting - working,
    }
}
