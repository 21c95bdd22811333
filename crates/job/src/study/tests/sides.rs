//! Tests of negative and zero torque: the coast flanks, and gears at rest.

use super::*;

const TOPIC: &str = "Job: coast side";

fn closed_form() -> Value {
    let mut value = example("table1");
    value["model"]["mesh_stiffness"] = json!({"source": "iso6336"});
    value["model"]["impact"] = json!({"source": "none"});
    value
}

fn under(value: &Value, torque_nm: f64) -> Outcome {
    let mut value = value.clone();
    value["operation"]["pinion_torque_nm"] = json!(torque_nm);
    solved(&value)
}

fn codes(outcome: &Outcome) -> Vec<&str> {
    outcome.result.warnings.iter().map(|warning| warning.code.as_str()).collect()
}

fn rms(outcome: &Outcome) -> f64 {
    outcome.result.response.as_ref().expect("a response").rms.mesh_circumferential_acceleration_m_s2.left
}

/// The closed form's course is the same forwards and backwards: but for where the curve is sampled, the other flank
/// vibrates as this one does.
#[test]
fn the_closed_form_runs_on_the_other_flank() {
    let [drive, coast] = [800.0, -800.0].map(|torque| under(&closed_form(), torque));
    let [d, c] = [&drive, &coast].map(|outcome| outcome.result.mesh.as_ref().expect("a mesh"));
    check_value(
        TOPIC,
        "ISO 6336-1, mean stiffness",
        c.stiffness_mean_n_per_um,
        d.stiffness_mean_n_per_um,
        Relative(1e-4),
    );
    assert_eq!(c.force_n, -d.force_n);
    assert!(c.transmission_error_mean_um < 0.0 && c.axial_force_n.left < 0.0);
    check_value(
        TOPIC,
        "ISO 6336-1, transmission error, µm",
        -c.transmission_error_mean_um,
        d.transmission_error_mean_um,
        Relative(1e-4),
    );
    // 128 samples of a curve with kinks, which lie between other samples here.
    check_value(TOPIC, "ISO 6336-1, RMS of x''", rms(&coast), rms(&drive), Relative(3e-3));
    // At the phases of the coast flanks: the drive's curve mirrored about some phase, not the same curve.
    let curve = |mesh: &crate::result::Mesh| mesh.curve.stiffness_n_per_um.clone();
    assert_ne!(curve(c), curve(d));
}

/// Loaded contact: a relief of the drive flanks leaves the results of unrelieved coast flanks bit-identical; a relief
/// of the coast flanks changes them.
#[test]
fn loaded_contact_runs_on_the_other_flank_with_its_own_modifications() {
    let mut bare = example("table1");
    bare["kind"] = json!("mesh");
    bare["model"]["mesh_stiffness"] = json!({"source": "ltca"});
    let relief = json!({"amount_um": 25.0, "length_mm": 6.0});
    let none = json!({"amount_um": 0.0});
    let with = |drive: &Value, coast: Option<&Value>| {
        let mut value = bare.clone();
        for gear in ["pinion", "gear"] {
            value["design"][gear]["tip_relief"] = drive.clone();
            if let Some(coast) = coast {
                value["design"][gear]["coast"] = json!({"tip_relief": coast});
            }
        }
        value
    };
    let mesh = |value: &Value, torque: f64| under(value, torque).result.mesh.expect("a mesh");
    let plain = mesh(&bare, -800.0);
    assert_eq!(mesh(&with(&relief, Some(&none)), -800.0), plain);
    assert_eq!(mesh(&with(&none, Some(&relief)), 800.0), mesh(&bare, 800.0));
    let relieved = mesh(&with(&none, Some(&relief)), -800.0);
    assert_ne!(relieved, plain);
    // Left out, they are as the drive flanks.
    assert_eq!(mesh(&with(&relief, None), -800.0), relieved);
    let drive = mesh(&bare, 800.0);
    assert!(plain.force_n == -drive.force_n && plain.transmission_error_mean_um < 0.0);
    assert!(plain.curve.transmission_error_um.iter().all(|error| *error < 0.0));
    // The same teeth under the same load from the other side: nearly as stiff. (The gear drives: other corners meet.)
    check_value(
        TOPIC,
        "loaded contact, mean stiffness",
        plain.stiffness_mean_n_per_um,
        drive.stiffness_mean_n_per_um,
        Relative(0.01),
    );
    // One half only.
    let mut half = bare.clone();
    half["design"]["gear"]["coast"] = json!({"right": {"lead_crowning_um": 15.0}});
    let crowned = mesh(&half, -800.0);
    let right = crowned.right_curve.expect("halves that differ");
    assert_eq!(crowned.curve.stiffness_n_per_um, plain.curve.stiffness_n_per_um);
    assert_ne!(right.stiffness_n_per_um, plain.curve.stiffness_n_per_um);
    // The right half's flanks are open by the crowning, more than the left's: its displacement is the larger one, and
    // negative.
    let mean = |curve: &[f64]| curve.iter().sum::<f64>() / curve.len() as f64;
    assert!(mean(&right.transmission_error_um) < mean(&crowned.curve.transmission_error_um));
    let tan = check(&document(&bare)).expect("feasible").geometry.base_helix_angle_deg.to_radians().tan();
    let shift = (mean(&crowned.curve.transmission_error_um) - mean(&right.transmission_error_um)) / (2.0 * tan);
    check_value(
        TOPIC,
        "axial shift from the transmission errors, µm",
        crowned.pinion_axial_shift_um,
        shift,
        Relative(1e-9),
    );
}

#[test]
fn a_response_on_the_coast_side_is_solved_and_says_what_it_leaves_out() {
    let mut value = example("table1");
    let coast = under(&value, -800.0);
    assert!(codes(&coast).contains(&"impact-not-calculated"), "{:?}", codes(&coast));
    assert!(coast.result.impact.is_none() && rms(&coast).is_finite());
    value["model"]["impact"] = json!({"source": "none"});
    assert!(!codes(&under(&value, -800.0)).contains(&"impact-not-calculated"));
    // A given stiffness with a calculated impact was refused.
    let mut given = example("given_stiffness");
    given["model"]["impact"] = json!({"source": "corner_contact"});
    assert!(codes(&under(&given, -800.0)).contains(&"impact-not-calculated"));
}

#[test]
fn without_torque_the_gears_are_at_rest() {
    let mut loaded = example("table1");
    loaded["model"]["impact"] = json!({"source": "none"});
    for value in [closed_form(), loaded, example("table1")] {
        let rest = under(&value, 0.0);
        let warning = rest.result.warnings.iter().find(|warning| warning.code == "no-load").expect("said");
        assert_eq!(warning.pointer, "/operation/pinion_torque_nm");
        let mesh = rest.result.mesh.as_ref().expect("a mesh");
        assert_eq!((mesh.force_n, mesh.axial_force_n.left), (0.0, 0.0));
        assert!(mesh.stiffness_mean_n_per_um > 0.0 && mesh.transmission_error_mean_um.abs() < 0.5);
        assert!(mesh.apex_sensitivity.is_none() && rest.result.impact.is_none());
        assert!(rms(&rest) < 1e-6, "{}", rms(&rest));
    }
    // The limit of ever lighter loads, from either side.
    let mut light = closed_form();
    light["kind"] = json!("mesh");
    let mean = |torque: f64| under(&light, torque).result.mesh.expect("a mesh").stiffness_mean_n_per_um;
    assert!(mean(0.0) < mean(100.0));
    check_value(TOPIC, "ISO 6336-1 at a light load, either side", mean(-100.0), mean(100.0), Relative(1e-4));
}
