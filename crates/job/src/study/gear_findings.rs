//! Infeasibilities and warnings of a gear pair as violations and warnings of a job: code, pointer to the field of the
//! document, one sentence.

use crate::Violation;
use crate::unit::with_unit;
use crate::warning::Warning;
use herringbone_physics::gear::{
    self, AssemblyField, CenterDistanceFit, Consequence, GearField, Infeasibility, InfeasibilityReason, MaterialField,
    MemberId, SpecField, WarningReason,
};

/// Millimetres per metre.
const MM: f64 = 1e3;
/// Micrometres per metre.
const UM: f64 = 1e6;

/// Violation of an infeasibility.
pub(super) fn violation(found: &Infeasibility) -> Violation {
    let (code, unit) = code_and_unit(found);
    Violation {
        pointer: pointer(found.field),
        code: code.to_owned(),
        detail: detail(found),
        minimum: None,
        maximum: None,
        unit: Some(unit.to_owned()),
    }
}

/// A warning of a pair that is solved.
pub(super) fn warning(found: &gear::Warning) -> Warning {
    let side = side(found.field);
    let (code, detail) = match &found.reason {
        WarningReason::Undercut { profile_shift, limit, form_radius_m } => (
            "undercut",
            format!(
                "the {side} is undercut: its profile shift {profile_shift:.4} is below {limit:.4}; the involute starts at {:.4} mm diameter",
                2.0 * form_radius_m * MM
            ),
        ),
        WarningReason::ThinTip { thickness, limit } => (
            "thin-tip",
            format!("the {side}'s tip is {thickness:.4} m_n thick in the normal section, less than {limit} m_n"),
        ),
        WarningReason::ThinRim { thickness_m, limit_tooth_heights } => (
            "thin-rim",
            format!(
                "the rim of the {side} is {:.4} mm thick, less than {limit_tooth_heights} tooth heights: its teeth are softer than those of a solid gear",
                thickness_m * MM
            ),
        ),
        WarningReason::FilletInterference { cut_m } => (
            "fillet-interference",
            format!(
                "the {side}'s tip dips {:.2} µm into the {}'s nominal root fillet: the tips need an edge break or the root more depth",
                cut_m * UM,
                mate(found.field)
            ),
        ),
        WarningReason::SmallTipClearance { clearance, limit } => (
            "small-tip-clearance",
            format!(
                "between the {side}'s tip and the {}'s root {clearance:.4} m_n are left, less than {limit} m_n",
                mate(found.field)
            ),
        ),
        WarningReason::TransverseContactRatioBelowOne { transverse, overlap, undercut, shortest_over_mean } => (
            "transverse-contact-ratio-below-one",
            format!(
                "the transverse contact ratio is {transverse:.4}{}, below 1: in a transverse section no teeth touch during a part of the mesh period; the overlap ratio {overlap:.4} keeps lines of contact at every phase, the shortest {:.1} % of their mean",
                undercut_included(*undercut),
                100.0 * shortest_over_mean
            ),
        ),
        WarningReason::NegativeBacklash { backlash_m, fit } => (
            "negative-play",
            format!(
                "at the working centre distance {:.4} mm teeth of nominal thickness overlap by {:.1} µm along the base tangent: they must be thinner by that and the play; {}",
                fit.center_distance_m * MM,
                -backlash_m * UM,
                fitting(fit)
            ),
        ),
        WarningReason::LargeBacklash { backlash_m, fit } => (
            "large-play",
            format!(
                "at the working centre distance {:.4} mm teeth of nominal thickness have {:.0} µm play along the base tangent; the dynamics take the play stated as backlash_um; {}",
                fit.center_distance_m * MM,
                backlash_m * UM,
                fitting(fit)
            ),
        ),
        WarningReason::TipReliefOverWholePath { length_m, path_m } => (
            "tip-relief-over-whole-path",
            format!(
                "the tip relief of the {side} is {:.4} mm long, the path of contact only {:.4} mm",
                length_m * MM,
                path_m * MM
            ),
        ),
    };
    Warning { code: code.to_owned(), pointer: pointer(found.field), detail }
}

/// Stable code of an infeasibility, and the unit of its numbers.
fn code_and_unit(found: &Infeasibility) -> (&'static str, &'static str) {
    match &found.reason {
        InfeasibilityReason::ValueOutOfRange { .. } => ("value-out-of-range", field_unit(found.field).0),
        InfeasibilityReason::RackTipPointed { .. } => ("rack-tip-pointed", "m_n"),
        InfeasibilityReason::FilletRadiusTooLarge { .. } => ("fillet-radius-too-large", "m_n"),
        InfeasibilityReason::RootCircleVanishes { .. } => ("root-circle-vanishes", "mm"),
        InfeasibilityReason::NoInvolute { .. } => ("no-involute", "mm"),
        InfeasibilityReason::ToothCutOff { .. } => ("tooth-cut-off", "m_n"),
        InfeasibilityReason::PointedTip { .. } => ("pointed-tip", "m_n"),
        InfeasibilityReason::BoreTooLarge { .. } => ("bore-too-large", "mm"),
        InfeasibilityReason::ProfileShiftSumTooSmall { .. } => ("profile-shift-sum-too-small", "m_n"),
        InfeasibilityReason::CenterDistanceTooSmall { .. } => ("center-distance-too-small", "mm"),
        InfeasibilityReason::TipInterference { .. } => ("tip-interference", "m_n"),
        InfeasibilityReason::FilletInterference { .. } => ("fillet-interference", "m_n"),
        InfeasibilityReason::NoTipClearance { .. } => ("no-tip-clearance", "m_n"),
        InfeasibilityReason::ContactRatioBelowOne { .. } => ("contact-ratio-below-one", "1"),
        InfeasibilityReason::FlanksOverlap { .. } => ("flanks-overlap", "mm"),
        InfeasibilityReason::CenterDistanceDoesNotFit { .. } => ("center-distance-does-not-fit", "mm"),
    }
}

/// One sentence with value, limit and unit.
fn detail(found: &Infeasibility) -> String {
    let (side, other) = (side(found.field), mate(found.field));
    match &found.reason {
        InfeasibilityReason::ValueOutOfRange { value, minimum, maximum } => {
            let (unit, convert) = field_unit(found.field);
            let [value, low, high] = [*value, *minimum, *maximum].map(convert);
            format!("{} is outside {low} … {}", with_unit(value, unit), with_unit(high, unit))
        }
        InfeasibilityReason::RackTipPointed { dedendum, .. } => {
            format!("the rack that cuts the {side} is pointed before it reaches a dedendum of {dedendum} m_n")
        }
        InfeasibilityReason::FilletRadiusTooLarge { fillet_radius, limit } => format!(
            "a tip rounding of {fillet_radius} m_n does not fit the rack that cuts the {side}: at most {limit:.4} m_n"
        ),
        InfeasibilityReason::RootCircleVanishes { root_radius_m, .. } => {
            format!("the root circle of the {side} has a radius of {:.4} mm", root_radius_m * MM)
        }
        InfeasibilityReason::NoInvolute { tip_radius_m, start_radius_m } => format!(
            "the {side} has no involute flank: its tip radius {:.4} mm is not above {:.4} mm, where the flank starts",
            tip_radius_m * MM,
            start_radius_m * MM
        ),
        InfeasibilityReason::ToothCutOff { .. } => {
            format!("the cutter leaves no tooth on the {side}: undercut takes its whole thickness")
        }
        InfeasibilityReason::PointedTip { thickness } => {
            format!("the {side}'s tooth ends pointed below its tip circle: tip thickness {thickness:.4} m_n")
        }
        InfeasibilityReason::BoreTooLarge { bore_radius_m, root_radius_m } => format!(
            "the bore of the {side}, {:.4} mm, reaches the root circle of {:.4} mm",
            2.0 * bore_radius_m * MM,
            2.0 * root_radius_m * MM
        ),
        InfeasibilityReason::ProfileShiftSumTooSmall { sum, limit } => format!(
            "no centre distance brings both flanks into contact: the profile shifts add up to {sum:.4}, at least {limit:.4} is needed"
        ),
        InfeasibilityReason::CenterDistanceTooSmall { base_radius_sum_m, fit } => format!(
            "the working centre distance {:.4} mm is not above the sum of the base radii, {:.4} mm, at any profile shifts; {}",
            fit.center_distance_m * MM,
            base_radius_sum_m * MM,
            fitting(fit)
        ),
        InfeasibilityReason::TipInterference { cut, addendum, limit } => format!(
            "the {side}'s tip passes the point where the line of action leaves the {other}'s base circle and cuts {cut:.4} m_n deep into what the cutter has left standing there: addendum {addendum:.4} m_n, at most {limit:.4} m_n"
        ),
        InfeasibilityReason::FilletInterference { cut, limit } => {
            format!("the {side}'s tip cuts {cut:.4} m_n deep into the {other}'s root fillet, more than {limit} m_n")
        }
        InfeasibilityReason::NoTipClearance { clearance } => {
            format!("the {side}'s tip reaches {:.4} m_n into the {other}'s root circle", -clearance)
        }
        InfeasibilityReason::ContactRatioBelowOne { transverse, overlap, undercut } => {
            let sum = if *transverse > 0.0 && *overlap > 0.0 {
                format!(", with the overlap ratio {overlap:.4} together {:.4}", transverse + overlap)
            } else {
                String::new()
            };
            format!(
                "the transverse contact ratio is {transverse:.4}{}{sum}; below 1 the teeth do not hand over: lines of contact are missing during a part of the mesh period",
                undercut_included(*undercut)
            )
        }
        InfeasibilityReason::FlanksOverlap { backlash_m, limit_m, limit } => format!(
            "teeth of nominal thickness overlap by {:.1} µm along the base tangent, more than {:.1} µm ({limit} m_n), which thinner teeth could make up for",
            -backlash_m * UM,
            limit_m * UM
        ),
        InfeasibilityReason::CenterDistanceDoesNotFit { fit, consequences, .. } => {
            let consequences: Vec<String> = consequences.iter().map(consequence).collect();
            format!(
                "the working centre distance {:.4} mm does not belong to the profile shifts; {}. At {:.4} mm: {}",
                fit.center_distance_m * MM,
                fitting(fit),
                fit.center_distance_m * MM,
                consequences.join("; ")
            )
        }
    }
}

fn consequence(consequence: &Consequence) -> String {
    match consequence {
        Consequence::Infeasible(found) => detail(found),
        Consequence::ContactRatioLost { fitting, working, backlash, limit } => format!(
            "the transverse contact ratio falls from {fitting:.4} to {working:.4}, and the teeth have {backlash:.3} m_n play along the base tangent, more than {limit} m_n"
        ),
    }
}

fn undercut_included(undercut: bool) -> &'static str {
    if undercut { ", undercut included" } else { "" }
}

/// Text with the centre distance of the given profile shifts and the profile shifts of the given centre distance.
fn fitting(fit: &CenterDistanceFit) -> String {
    let sum = fit.shift_sum;
    let distance = match fit.fitting_center_distance_m {
        Some(a) => format!("the given profile shifts add up to {sum:.4} and fit {:.4} mm without play", a * MM),
        None => format!("the given profile shifts add up to {sum:.4} and fit no centre distance"),
    };
    let shifts = match fit.fitting_shift_sum {
        Some(sum) => format!("{:.4} mm fits a sum of {sum:.4}", fit.center_distance_m * MM),
        None => format!("no sum fits {:.4} mm", fit.center_distance_m * MM),
    };
    format!("{distance}; {shifts}")
}

fn side(field: SpecField) -> &'static str {
    field.member().map_or("pair", MemberId::as_str)
}

fn mate(field: SpecField) -> &'static str {
    field.member().map_or("pair", |member| member.mate().as_str())
}

/// JSON pointer to the field of the document from which a field of the specification is derived.
fn pointer(field: SpecField) -> String {
    match field {
        SpecField::NormalModule => "/design/normal_module_mm".to_owned(),
        SpecField::NormalPressureAngle => "/design/pressure_angle_deg".to_owned(),
        SpecField::HelixAngle => "/design/helix_angle_deg".to_owned(),
        SpecField::FaceWidth => "/design/face_width_mm".to_owned(),
        SpecField::GapWidth => "/design/gap_width_mm".to_owned(),
        SpecField::CenterDistance => "/design/center_distance_mm".to_owned(),
        SpecField::Material(field) => format!("/design/{}", material_key(field)),
        SpecField::Assembly(field) => format!(
            "/design/assembly/{}",
            match field {
                AssemblyField::CenterDistanceError => "center_distance_error_um",
                AssemblyField::InPlaneMisalignment => "in_plane_misalignment_um",
                AssemblyField::OutOfPlaneMisalignment => "out_of_plane_misalignment_um",
                AssemblyField::ApexOffset => "apex_offset_um",
            }
        ),
        SpecField::Member(member, field) => format!("/design/{}/{}", member.as_str(), gear_key(field)),
    }
}

fn gear_key(field: GearField) -> &'static str {
    match field {
        GearField::Teeth => "teeth",
        GearField::ProfileShift => "profile_shift",
        GearField::Addendum => "addendum",
        GearField::Dedendum => "dedendum",
        GearField::FilletRadius => "fillet_radius",
        GearField::TipAlteration => "tip_alteration",
        GearField::BoreRadius => "bore_diameter_mm",
        GearField::FaceWidth => "face_width_mm",
        GearField::Material(field) => material_key(field),
        GearField::TipReliefAmount => "tip_relief/amount_um",
        GearField::TipReliefLength => "tip_relief/length_mm",
        GearField::LeadCrowning => "lead_crowning_um",
        GearField::HelixSlope => "helix_slope_um",
        GearField::EndReliefAmount => "end_relief/amount_um",
        GearField::EndReliefLength => "end_relief/length_mm",
    }
}

fn material_key(field: MaterialField) -> &'static str {
    match field {
        MaterialField::YoungsModulus => "material/youngs_modulus_gpa",
        MaterialField::PoissonsRatio => "material/poissons_ratio",
        MaterialField::Density => "material/density_kg_m3",
    }
}

/// Unit of a field of the document, and the conversion to it.
fn field_unit(field: SpecField) -> (&'static str, fn(f64) -> f64) {
    const MILLIMETRE: (&str, fn(f64) -> f64) = ("mm", |m| m * MM);
    const MICROMETRE: (&str, fn(f64) -> f64) = ("um", |m| m * UM);
    const COEFFICIENT: (&str, fn(f64) -> f64) = ("m_n", |value| value);
    const NUMBER: (&str, fn(f64) -> f64) = ("1", |value| value);
    match field {
        SpecField::NormalModule | SpecField::FaceWidth | SpecField::GapWidth | SpecField::CenterDistance => MILLIMETRE,
        SpecField::NormalPressureAngle | SpecField::HelixAngle => ("deg", f64::to_degrees),
        SpecField::Assembly(_) => MICROMETRE,
        SpecField::Material(field) | SpecField::Member(_, GearField::Material(field)) => match field {
            MaterialField::YoungsModulus => ("GPa", |pa| pa / 1e9),
            MaterialField::PoissonsRatio => NUMBER,
            MaterialField::Density => ("kg/m3", |value| value),
        },
        SpecField::Member(_, field) => match field {
            GearField::Teeth => NUMBER,
            GearField::BoreRadius => ("mm", |m| m * 2.0 * MM),
            GearField::FaceWidth | GearField::TipReliefLength | GearField::EndReliefLength => MILLIMETRE,
            GearField::TipReliefAmount
            | GearField::LeadCrowning
            | GearField::HelixSlope
            | GearField::EndReliefAmount => MICROMETRE,
            _ => COEFFICIENT,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_physics::gear::{GearSpec, Pair, PairSpec};

    /// z 19/63, m_n 16 mm, profile shifts of 1.309 in all: 680 mm fit.
    fn large(center_distance_mm: f64) -> PairSpec {
        let side =
            |teeth, profile_shift| GearSpec { profile_shift, tip_alteration: -0.058_625, ..GearSpec::plain(teeth) };
        let angles = [20f64.to_radians(), 7f64.to_radians()];
        let free = PairSpec::plain(16e-3, angles, 0.28, [side(19, 0.52), side(63, 0.789)]);
        PairSpec { center_distance_m: Some(center_distance_mm * 1e-3), ..free }
    }

    #[test]
    fn a_centre_distance_that_does_not_fit_is_named_with_what_fits() {
        for (center_distance_mm, code) in
            [(861.0, "center-distance-does-not-fit"), (600.0, "center-distance-too-small")]
        {
            let reasons = Pair::new(&large(center_distance_mm)).expect_err("infeasible");
            let [reason] = &reasons[..] else { panic!("{reasons:?}") };
            let found = violation(reason);
            assert_eq!((found.pointer.as_str(), found.code.as_str()), ("/design/center_distance_mm", code));
            assert_eq!(found.unit.as_deref(), Some("mm"));
            for part in ["680.0007 mm", "add up to 1.3090"] {
                assert!(found.detail.contains(part), "{part}: {}", found.detail);
            }
            assert_eq!(found.detail.contains("fits a sum of 20.3552"), center_distance_mm == 861.0, "{}", found.detail);
        }
    }

    #[test]
    fn backlash_beyond_the_allowances_is_a_warning_of_the_centre_distance() {
        for (center_distance_mm, code, part) in
            [(679.0, "negative-play", "overlap by"), (682.0, "large-play", "play along the base tangent")]
        {
            let (_, warnings) = Pair::new(&large(center_distance_mm)).expect("feasible");
            let [found] = &warnings[..] else { panic!("{warnings:?}") };
            let found = warning(found);
            assert_eq!((found.pointer.as_str(), found.code.as_str()), ("/design/center_distance_mm", code));
            assert!(found.detail.contains(part) && found.detail.contains("fit 680.0007 mm"), "{}", found.detail);
        }
    }

    #[test]
    fn stated_values_are_reported_in_the_units_of_the_document() {
        let mut wrong = large(680.0);
        wrong.gap_width_m = -1e-3;
        wrong.pinion.bore_radius_m = 60.0;
        wrong.material.youngs_modulus_pa = 1e6;
        let reasons = Pair::new(&wrong).expect_err("infeasible");
        let details: Vec<_> = reasons.iter().map(violation).map(|v| (v.pointer, v.detail)).collect();
        let expected = [
            ("/design/gap_width_mm", "-1 mm is outside 0 … 10000 mm"),
            ("/design/material/youngs_modulus_gpa", "0.001 GPa is outside 0.01 … 2000 GPa"),
            ("/design/pinion/bore_diameter_mm", "120000 mm is outside 0 … 100000 mm"),
        ];
        for (pointer, detail) in expected {
            assert!(details.iter().any(|(p, d)| p == pointer && d == detail), "{pointer}: {details:?}");
        }
    }
}
