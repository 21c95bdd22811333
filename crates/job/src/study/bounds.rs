//! Warnings of assumptions, and of numbers outside the range of a model or of practice: each with code, pointer, value
//! and limit.

use super::equations::MotionPlane;
use super::prepare::Prepared;
use super::supports::shown;
use crate::document::{
    DEFAULT_BACKLASH_UM, ImpactDuration, ImpactInput, JobDocument, JobKind, Ltca, MeshStiffness, MethodInput,
    StiffnessLaw,
};
use crate::result::Mesh;
use crate::warning::Warning;
use herringbone_physics::dynamics;
use herringbone_physics::response::{Regime, Summary};

/// Ratio of given inertias and masses to those of the geometry, or its inverse, above which there is a warning: a
/// shaft, hub or web outweighs the gear, or a unit is wrong.
const IMPLAUSIBLE_RATIO: f64 = 2.0;

/// Fraction of the least normal backlash below which there is a warning.
const SMALL_BACKLASH: f64 = 0.25;

/// Allowable contact stress number of case-hardened wrought steel, grade ME, MPa (ISO 6336-5:2016, figure 13): the
/// highest of the standard, above which no steel has a long life.
const ALLOWABLE_PRESSURE_MPA: f64 = 1650.0;
/// Young's modulus of steel, GPa: the limit of a softer material is taken in proportion to its modulus.
const STEEL_GPA: f64 = 206.0;

/// Ratio of secant to tangent stiffness below which flank modifications dominate the secant. With Hertzian contact
/// alone the ratio is above 0.8.
const SECANT_OF_TANGENT: f64 = 0.7;

fn warning(code: &str, pointer: impl Into<String>, detail: String) -> Warning {
    Warning { code: code.to_owned(), pointer: pointer.into(), detail }
}

/// Backlash along s, µm: as given, or the default.
pub(crate) fn backlash_um(document: &JobDocument) -> f64 {
    document.design.backlash_um.unwrap_or(DEFAULT_BACKLASH_UM)
}

/// Warnings of a document before anything is solved: masses and inertias, with those of solid discs by the geometry
/// (`discs`, kg and kg m²), and backlash.
pub(crate) fn of_document(document: &JobDocument, prepared: &Prepared, discs: [(f64, f64); 2]) -> Vec<Warning> {
    let vibrates = document.kind != JobKind::Mesh;
    // On shafts the masses are those of the shafts.
    let has_masses = vibrates && document.design.shafts.is_none();
    let strikes = matches!(document.model.impact, ImpactInput::CornerContact(_) | ImpactInput::Zhou2008(_));
    let mut warnings = Vec::new();
    let design = &document.design;
    for ((name, gear), (mass_kg, inertia_kg_m2)) in
        [("pinion", &design.pinion), ("gear", &design.gear)].into_iter().zip(discs)
    {
        if has_masses || strikes {
            let pointer = format!("/design/{name}/inertia_kg_m2");
            match gear.inertia_kg_m2 {
                None => warnings.push(warning(
                    "assumed-inertia",
                    pointer,
                    format!("not given: {} kg·m² assumed (solid discs of both halves from the bore to the reference circle; shaft and hub are not counted)", shown(inertia_kg_m2)),
                )),
                Some(given) => warnings.extend(implausible("inertia-implausible", pointer, given, inertia_kg_m2, "kg·m²")),
            }
        }
        if has_masses {
            let pointer = format!("/design/{name}/mass_kg");
            match gear.mass_kg {
                None => warnings.push(warning(
                    "assumed-mass",
                    pointer,
                    format!("not given: {} kg assumed (solid discs of both halves from the bore to the reference circle; shaft and hub are not counted)", shown(mass_kg)),
                )),
                Some(given) => warnings.extend(implausible("mass-implausible", pointer, given, mass_kg, "kg")),
            }
        }
    }
    if vibrates {
        warnings.extend(backlash(document, prepared));
    }
    warnings
}

fn implausible(code: &str, pointer: String, given: f64, geometry: f64, unit: &str) -> Option<Warning> {
    let ratio = given / geometry;
    let plausible = (1.0 / IMPLAUSIBLE_RATIO..=IMPLAUSIBLE_RATIO).contains(&ratio);
    (!plausible && geometry > 0.0).then(|| {
        let low = geometry / IMPLAUSIBLE_RATIO;
        let high = geometry * IMPLAUSIBLE_RATIO;
        let detail = format!(
            "is {} {unit}, {ratio:.2} times what the geometry gives ({} {unit}); outside {} to {} {unit} it is that of other parts too, or not of this gear",
            shown(given),
            shown(geometry),
            shown(low),
            shown(high)
        );
        warning(code, pointer, detail)
    })
}

/// Least normal backlash of industrial drives with steel housings, mm: (2/3)(0.06 + 0.0005 a + 0.03 m_n), a and m_n in
/// mm (ISO/TR 10064-2:1996, table A.1 and its formula).
pub(crate) fn least_backlash_mm(center_distance_mm: f64, normal_module_mm: f64) -> f64 {
    2.0 / 3.0 * (0.06 + 0.0005 * center_distance_mm + 0.03 * normal_module_mm)
}

fn backlash(document: &JobDocument, prepared: &Prepared) -> Vec<Warning> {
    const POINTER: &str = "/design/backlash_um";
    let um = backlash_um(document);
    let least_um = 1e3 * least_backlash_mm(prepared.pair.center_distance_m * 1e3, document.design.normal_module_mm);
    let mut warnings = Vec::new();
    if document.design.backlash_um.is_none() {
        let detail =
            format!("not given: {um} µm assumed; practice for this size is {least_um:.0} µm and more (ISO/TR 10064-2)");
        warnings.push(warning("assumed-backlash", POINTER, detail));
    }
    let limit_um = SMALL_BACKLASH * least_um;
    if um < limit_um {
        let detail = format!(
            "is {um} µm, below {limit_um:.0} µm, a quarter of the least normal backlash of practice for this module and centre distance ({least_um:.0} µm, ISO/TR 10064-2): \
             teeth that separate meet the back flanks sooner than those of a real pair"
        );
        warnings.push(warning("backlash-small", POINTER, detail));
    }
    warnings
}

/// Warnings of the mesh stage.
pub(crate) fn of_mesh(document: &JobDocument, mesh: &Mesh) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let design = &document.design;
    let members = [&design.pinion, &design.gear].map(|gear| gear.material.as_ref().unwrap_or(&design.material));
    let modulus_gpa = members.iter().fold(f64::INFINITY, |m, material| m.min(material.youngs_modulus_gpa));
    let limit_mpa = ALLOWABLE_PRESSURE_MPA * (modulus_gpa / STEEL_GPA).min(1.0);
    if let Some(mpa) = mesh.max_contact_pressure_mpa.filter(|mpa| *mpa > limit_mpa) {
        let material = if modulus_gpa < STEEL_GPA {
            format!(
                "1650 MPa of case-hardened steel in proportion to the softer gear's Young's modulus {modulus_gpa} GPa"
            )
        } else {
            "the allowable stress number of case-hardened steel, grade ME".to_owned()
        };
        let detail = format!(
            "puts {mpa:.0} MPa of contact pressure on the flanks, more than {limit_mpa:.0} MPa ({material}, ISO 6336-5): flanks do not bear it, and the elastic contact analysis does not know that"
        );
        warnings.push(warning("pressure-implausible", "/operation/pinion_torque_nm", detail));
    }
    let ratio = mesh.secant_stiffness_mean_n_per_um / mesh.stiffness_mean_n_per_um;
    let secant = matches!(&document.model.mesh_stiffness, MeshStiffness::Ltca(Ltca { law: StiffnessLaw::Secant, .. }));
    if secant && ratio < SECANT_OF_TANGENT {
        let detail = format!(
            "is \"secant\", whose mean is {ratio:.2} of the tangent stiffness ({:.0} of {:.0} N/µm), below {SECANT_OF_TANGENT}: the closing of flank modifications or misalignment \
             counts as softness, and natural frequencies come out too low; \"transmission_error\" does not",
            mesh.secant_stiffness_mean_n_per_um, mesh.stiffness_mean_n_per_um
        );
        warnings.push(warning("secant-law-misleading", "/model/mesh_stiffness/law", detail));
    }
    warnings
}

/// Warnings of pulses longer than the mesh period, or with a mean above the load.
pub(crate) fn of_pulses(
    document: &JobDocument,
    plane: &MotionPlane,
    pulses: &[Option<dynamics::ImpactExcitation>; 2],
) -> Vec<Warning> {
    let mut warnings = Vec::new();
    let longest = pulses.iter().flatten().filter_map(|pulse| match pulse {
        dynamics::ImpactExcitation::HalfSine { duration_mesh_periods, .. } => Some(*duration_mesh_periods),
        dynamics::ImpactExcitation::Harmonics { .. } => None,
    });
    let longest = longest.fold(0.0, f64::max);
    let calculated = match &document.model.impact {
        ImpactInput::CornerContact(corner) | ImpactInput::Zhou2008(corner) => Some(corner.duration),
        _ => None,
    };
    if longest > 1.0 {
        let advice = match calculated {
            Some(ImpactDuration::EnergyBalance) => "; \"corner_to_start\" is shorter",
            _ => "",
        };
        let pointer =
            if calculated.is_some() { "/model/impact/duration" } else { "/model/impact/duration_mesh_periods" };
        let detail = format!(
            "makes a pulse of {longest:.3} mesh periods, longer than 1: the pulses of successive tooth pairs overlap, and a part of them is a constant force{advice}"
        );
        warnings.push(warning("pulse-longer-than-period", pointer, detail));
    }
    let mean_n = pulses.iter().flatten().map(dynamics::ImpactExcitation::mean_n).fold(0.0, f64::max);
    let load_n = (document.operation.pinion_torque_nm / 2.0 / plane.pinion_radius_m).abs();
    if mean_n > load_n {
        let pointer = if calculated.is_some() { "/model/impact" } else { "/model/impact/force_n" };
        let detail = format!(
            "puts a mean of {mean_n:.0} N on each half over the mesh period, more than the load of the mesh, {load_n:.0} N: an impact that carries more momentum than the torque does no longer follows from it"
        );
        warnings.push(warning("pulse-exceeds-load", pointer, detail));
    }
    warnings
}

/// Warnings of the motion.
pub(crate) fn of_motion(document: &JobDocument, summary: &Summary) -> Vec<Warning> {
    let rate = summary.lyapunov_per_mesh_period.filter(|rate| rate.is_finite());
    match summary.regime {
        Regime::Unstable => {
            let rate = rate.unwrap_or(0.0);
            let detail = format!(
                "is where the vibration grows without bound, by a factor of {:.4} per mesh period (growth rate {rate:.4}): the fluctuation of the mesh stiffness feeds it more than the dampers \
                 take. RMS values, extremes and the dynamic factor are those of the first {} mesh periods and mean nothing",
                rate.exp(),
                summary.recorded_mesh_periods
            );
            vec![warning("unstable", "/operation/pinion_speed_rpm", detail)]
        }
        Regime::NotSettled => {
            let integrates = document.analysis.method == MethodInput::Integrate;
            let pointer = if integrates { "/analysis/mesh_periods" } else { "/analysis/method" };
            let course = match rate {
                Some(rate) if rate < 0.0 => format!("deviations fall by a factor of {:.4} per mesh period", rate.exp()),
                Some(rate) => format!("deviations grow by a factor of {:.4} per mesh period", rate.exp()),
                None => "deviations die away within a mesh period".to_owned(),
            };
            let detail = format!(
                "ends before the motion has settled: it does not repeat within the recorded {} mesh periods and {course}. Its numbers are those of this record, not of a steady state",
                summary.recorded_mesh_periods
            );
            vec![warning("not-settled", pointer, detail)]
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse_value;
    use crate::study::SolveContext;
    use crate::study::unchecked::{check, solve};
    use serde_json::{Value, json};

    fn example(name: &str) -> Value {
        let path = format!("{}/../../examples/{name}.json", env!("CARGO_MANIFEST_DIR"));
        serde_json::from_slice(&std::fs::read(path).expect("readable")).expect("JSON")
    }

    fn set(value: &mut Value, pointer: &str, to: Value) {
        let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
        value.pointer_mut(parent).expect("a parent")[name] = to;
    }

    fn checked(value: &Value) -> Vec<Warning> {
        check(&parse_value(value).expect("valid")).expect("feasible").warnings
    }

    fn solved(value: &Value) -> crate::result::JobResult {
        solve(&parse_value(value).expect("valid"), &SolveContext::none()).expect("solved").result
    }

    fn has(warnings: &[Warning], code: &str, pointer: &str) -> bool {
        warnings.iter().any(|w| w.code == code && w.pointer == pointer)
    }

    #[test]
    fn what_was_assumed_is_said_with_its_value_and_what_was_given_is_not() {
        let base = example("table1");
        for (pointer, code, given) in [
            ("/design/pinion/inertia_kg_m2", "assumed-inertia", json!(0.02)),
            ("/design/gear/inertia_kg_m2", "assumed-inertia", json!(0.9)),
            ("/design/pinion/mass_kg", "assumed-mass", json!(10.0)),
            ("/design/gear/mass_kg", "assumed-mass", json!(70.0)),
            ("/design/backlash_um", "assumed-backlash", json!(200.0)),
        ] {
            let mut value = base.clone();
            set(&mut value, pointer, Value::Null);
            let warnings = checked(&value);
            let warned =
                warnings.iter().find(|w| w.code == code && w.pointer == pointer).unwrap_or_else(|| panic!("{pointer}"));
            assert!(
                warned.detail.contains("assumed") && warned.detail.chars().any(|c| c.is_ascii_digit()),
                "{}",
                warned.detail
            );
            // A stored document with its defaults filled in has the same warnings.
            let stored = serde_json::to_value(parse_value(&value).expect("valid")).expect("JSON");
            assert_eq!(checked(&stored), warnings, "{pointer}");
            set(&mut value, pointer, given);
            assert!(!has(&checked(&value), code, pointer), "{pointer}");
            set(&mut value, pointer, Value::Null);
            value["kind"] = json!("mesh");
            set(&mut value, "/model/impact", json!({"source": "none"}));
            assert!(!has(&checked(&value), code, pointer), "{pointer}: no part of a mesh alone");
        }
    }

    #[test]
    fn given_inertias_and_masses_far_from_the_geometry_are_told() {
        for (field, code) in [("inertia_kg_m2", "inertia-implausible"), ("mass_kg", "mass-implausible")] {
            for (gear, at) in [("pinion", 0), ("gear", 1)] {
                for factor in [0.3, 0.49, 0.51, 1.0, 1.98, 2.03, 30.0] {
                    let mut value = example("table1");
                    let pointer = format!("/design/{gear}/{field}");
                    set(&mut value, &pointer, Value::Null);
                    let geometry = check(&parse_value(&value).expect("valid")).expect("feasible").geometry;
                    let member = [&geometry.pinion, &geometry.gear][at];
                    let natural = if field == "mass_kg" { member.mass_kg } else { member.inertia_kg_m2 };
                    set(&mut value, &pointer, json!(natural * factor));
                    let warned = has(&checked(&value), code, &pointer);
                    assert_eq!(warned, !(0.5..=2.0).contains(&factor), "{pointer}, {factor}");
                }
            }
        }
    }

    #[test]
    fn a_backlash_far_below_practice_is_told() {
        // The table of ISO/TR 10064-2: module 5 mm, 200 mm apart 0.21 mm; module 12 mm, 400 mm apart 0.41 mm.
        assert!(
            (least_backlash_mm(200.0, 5.0) - 0.21).abs() < 0.005
                && (least_backlash_mm(400.0, 12.0) - 0.41).abs() < 0.005
        );
        for (module_mm, backlash_um, small) in [
            (6.0, 2.0, true),
            (6.0, 40.0, true),
            (6.0, 80.0, false),
            (6.0, 300.0, false),
            (2.0, 10.0, true),
            (2.0, 40.0, false),
        ] {
            let mut value = example("table1");
            value["design"]["normal_module_mm"] = json!(module_mm);
            for gear in ["pinion", "gear"] {
                value["design"][gear]["bore_diameter_mm"] = Value::Null;
            }
            value["design"]["backlash_um"] = json!(backlash_um);
            let warned = has(&checked(&value), "backlash-small", "/design/backlash_um");
            assert_eq!(warned, small, "module {module_mm} mm, {backlash_um} um");
        }
    }

    #[test]
    fn contact_pressure_beyond_hardened_steel_is_told() {
        for (torque_nm, modulus_gpa, warned) in
            [(400.0, 206.0, false), (800.0, 206.0, false), (12_000.0, 206.0, true), (2000.0, 3.0, true)]
        {
            let mut value = example("table1");
            value["kind"] = json!("mesh");
            value["operation"]["pinion_torque_nm"] = json!(torque_nm);
            value["design"]["material"]["youngs_modulus_gpa"] = json!(modulus_gpa);
            let result = solved(&value);
            println!(
                "{torque_nm} N m, {modulus_gpa} GPa: {:?}",
                result.mesh.as_ref().and_then(|m| m.max_contact_pressure_mpa)
            );
            assert_eq!(
                has(&result.warnings, "pressure-implausible", "/operation/pinion_torque_nm"),
                warned,
                "{torque_nm} N m, {modulus_gpa} GPa"
            );
        }
    }

    #[test]
    fn a_secant_of_corrected_flanks_is_told() {
        for (name, law, warned) in [
            ("assembly_errors", "secant", true),
            ("assembly_errors", "transmission_error", false),
            ("assembly_errors", "tangent", false),
            ("table1", "secant", false),
        ] {
            let mut value = example(name);
            value["kind"] = json!("mesh");
            value["model"]["mesh_stiffness"]["law"] = json!(law);
            let result = solved(&value);
            assert_eq!(
                has(&result.warnings, "secant-law-misleading", "/model/mesh_stiffness/law"),
                warned,
                "{name}, {law}"
            );
        }
    }

    #[test]
    fn pulses_beyond_the_mesh_period_or_the_load_are_told() {
        // The source's pulse by the energy balance is about a mesh period long at 2000 r/min.
        for (rpm, duration, longer) in
            [(2000.0, "corner_to_start", false), (6000.0, "energy_balance", true), (12_000.0, "energy_balance", true)]
        {
            let mut value = example("table1");
            value["operation"]["pinion_speed_rpm"] = json!(rpm);
            value["model"]["impact"] = json!({"source": "corner_contact", "duration": duration});
            let warnings = solved(&value).warnings;
            assert_eq!(
                has(&warnings, "pulse-longer-than-period", "/model/impact/duration"),
                longer,
                "{rpm}, {duration}: {warnings:?}"
            );
        }
        // T/2 over the radius is near 7.5 kN; a half sine has 2/π of its peak over its length.
        for (force_n, length, more) in
            [(3000.0, 0.08, false), (20_000.0, 0.5, false), (30_000.0, 0.5, true), (12_500.0, 1.0, true)]
        {
            let mut value = example("given_stiffness");
            value["operation"]["pinion_torque_nm"] = json!(800.0);
            value["model"]["impact"] = json!({"source": "given", "force_n": force_n, "duration_mesh_periods": length});
            let warnings = solved(&value).warnings;
            assert_eq!(
                has(&warnings, "pulse-exceeds-load", "/model/impact/force_n"),
                more,
                "{force_n} N over {length}: {warnings:?}"
            );
        }
    }
}
