//! Documents with shafts against the reference calculations, through the whole study.

use super::{SolveContext, unchecked};
use crate::document::JobDocument;
use herringbone_oracle::Tolerance::{Absolute, Relative};
use herringbone_oracle::{check, check_worst};
use serde_json::{Value, json};

const TOPIC: &str = "Shafts: documents";

fn cases() -> Vec<Value> {
    serde_json::from_str(include_str!("../../../../tests/data/shafts_static.json")).expect("a list of cases")
}

fn solved(input: &Value) -> Value {
    let document: JobDocument = crate::parse(input.to_string().as_bytes()).expect("a valid document");
    let outcome = unchecked::solve(&document, &SolveContext::none()).expect("a result");
    serde_json::to_value(outcome.result).expect("JSON")
}

/// Largest difference that the reference's section 7 allows for the value at a path, by the largest value of its kind.
fn allowed(path: &str, expected: &Value, case: &Value) -> Option<f64> {
    let value = expected.as_f64()?.abs();
    let result = &case["result"];
    let open = result["open_fraction"].as_f64()? > 0.0;
    let line_load = result["line_load_mean_n_per_mm"].as_f64()?;
    let largest = |keys: &[&str]| -> f64 {
        let of = |value: &Value| value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect::<Vec<_>>();
        let mut most = 0.0f64;
        for member in ["pinion", "gear"] {
            for key in keys {
                of(&result[member][key]).into_iter().for_each(|v| most = most.max(v.abs()));
                for bearing in result[member]["bearings"].as_array().into_iter().flatten() {
                    of(&bearing[key]).into_iter().for_each(|v| most = most.max(v.abs()));
                }
            }
        }
        most
    };
    let of_load = if open { 0.02 } else { 0.01 };
    let parts: Vec<&str> = path.split('/').collect();
    let has = |name: &str| parts.contains(&name);
    let name = parts.iter().rev().find(|part| part.parse::<usize>().is_err())?;
    Some(match *name {
        "face_ends" | "max_gap_in_contact_um" | "max_penetration_outside_um" | "balance_rel" | "pp" => return None,
        "between_couplings_pp_um" | "normal_force_pp_n" => return None,
        "k_h_beta" | "k_h_beta_5mm" => of_load,
        "line_load_peak_over_mean" => of_load * value.max(1.0),
        // Values at places, which section 7 does not name: at the border of an open part they depend on the segments.
        "line_load_n_per_mm" if open => 0.05 * line_load,
        key if key.starts_with("line_load_") && key != "line_load_mean_n_per_mm" => of_load * line_load,
        "share" => 0.002,
        "harmonics_um" | "approach_mid_face_harmonics_um" if parts.last() == Some(&"0") => (0.02 * value).max(0.01),
        "harmonics_um" | "approach_mid_face_harmonics_um" => (0.05 * value).max(0.02),
        "x_um" | "y_um" | "z_um" => 5e-3 * largest(&["x_um", "y_um", "z_um"]),
        "tilt_x_urad" | "tilt_y_urad" => 5e-3 * largest(&["tilt_x_urad", "tilt_y_urad"]),
        "twist_from_coupling_urad" => 5e-3 * largest(&["twist_from_coupling_urad"]),
        "force_on_shaft_n" => 3e-3 * largest(&["force_on_shaft_n"]),
        "moment_on_shaft_nm" => 3e-3 * largest(&["moment_on_shaft_nm"]) + 1e-9,
        "mean" if has("pinion_axial_float_um") => (0.01 * value).max(0.02),
        "open_fraction" => 0.01,
        "load_centroid_from_inner_end_mm" => 0.2,
        _ => 3e-3 * value.max(1e-6),
    })
}

/// Collects the differences over what is allowed.
fn compare(path: &str, got: &Value, expected: &Value, case: &Value, errors: &mut Vec<f64>) {
    match expected {
        Value::Object(map) => {
            for (key, value) in map.iter().filter(|(key, _)| *key != "solver") {
                compare(&format!("{path}/{key}"), &got[key], value, case, errors);
            }
        }
        Value::Array(list) => {
            assert_eq!(got.as_array().map(Vec::len), Some(list.len()), "{path}");
            for (i, value) in list.iter().enumerate() {
                compare(&format!("{path}/{i}"), &got[i], value, case, errors);
            }
        }
        Value::Number(_) => {
            let value = got.as_f64().unwrap_or_else(|| panic!("{path} is {got}"));
            if let Some(tolerance) = allowed(path, expected, case) {
                let error = (value - expected.as_f64().unwrap_or(f64::NAN)) / tolerance.max(f64::MIN_POSITIVE);
                assert!(error.abs() <= 1.0, "{path} is {value} instead of {expected}, allowed {tolerance}");
                errors.push(error);
            }
        }
        _ => assert_eq!(got, expected, "{path}"),
    }
}

/// Every number of the ten reference results at its place in the block `shafts`.
#[test]
fn the_reference_documents_give_the_reference_results() {
    for case in cases() {
        let result = solved(&case["input"]);
        let mut errors = Vec::new();
        let name = case["name"].as_str().expect("a name");
        compare(name, &result["shafts"], &case["result"], &case, &mut errors);
        assert!(errors.len() > 150, "{name}: {} numbers", errors.len());
        check_worst(TOPIC, &format!("{name}: all numbers, over what the reference allows"), errors, 1.0);
    }
}

fn dynamic_cases() -> Vec<Value> {
    serde_json::from_str(include_str!("../../../../tests/data/shafts_dynamic.json")).expect("a list of cases")
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
}

/// Natural frequencies and energy shares of both geared rotors, up to 3 kHz.
#[test]
fn the_reference_rotors_have_the_reference_modes() {
    for case in dynamic_cases() {
        let name = case["name"].as_str().expect("a name");
        let mut input = case["input"].clone();
        // A small, damped motion: the modes are what is looked at.
        input["analysis"] = json!({"method": "integrate", "mesh_periods": 2, "record_mesh_periods": 1});
        let result = solved(&input);
        let frequencies = numbers(&result["response"]["natural_frequencies_hz"]);
        let expected = numbers(&case["result"]["natural_frequencies_hz"]);
        let modes = &result["response"]["rotor"]["modes"];
        for (i, expected_hz) in expected.iter().enumerate().filter(|(_, hz)| **hz <= 3000.0) {
            let what = |quantity: &str| format!("{name}, mode {}: {quantity}", i + 1);
            check(TOPIC, &what("natural frequency, Hz"), frequencies[i], *expected_hz, Relative(3e-3));
            let reference = &case["result"]["modes"][i];
            let bearings = modes[i]["strain_energy_bearings"].as_f64().expect("a share");
            let share = reference["strain_energy_bearings"].as_f64().expect("a share");
            check(TOPIC, &what("strain energy of the bearings"), bearings, share, Absolute(0.01));
            for half in ["left", "right"] {
                let got = modes[i]["strain_energy_mesh"][half].as_f64().expect("a share");
                let share = reference["strain_energy_mesh"][half].as_f64().expect("a share");
                check(TOPIC, &what(&format!("strain energy of the {half} mesh")), got, share, Absolute(0.01));
            }
        }
    }
}

/// Mesh and bearing forces under a displacement excitation, gyroscopic terms included.
#[test]
fn the_reference_rotor_vibrates_as_the_reference_does() {
    for case in dynamic_cases() {
        let Some(forced) = case["forced"].as_array() else { continue };
        for point in forced {
            let mut input = case["input"].clone();
            input["operation"]["pinion_speed_rpm"] = point["pinion_speed_rpm"].clone();
            input["model"]["excitation_um"] = json!({"left": 1.0, "right": 1.0});
            input["model"]["impact"] = json!({"source": "none"});
            let result = solved(&input);
            let response = &result["response"];
            let expected = &point["with_gyroscopic"];
            let name = format!("{} at {} 1/min", case["name"].as_str().expect("a name"), point["pinion_speed_rpm"]);
            let amplitude = |value: &Value| value.as_f64().expect("a force");
            let forces = &expected["mesh_force_amplitude_n"];
            let largest = amplitude(&forces["left"]).max(amplitude(&forces["right"]));
            for half in ["left", "right"] {
                let got = amplitude(&response["tooth_force_orders_n"][half]["amplitudes"][0]);
                let what = format!("{name}: mesh force {half}, N");
                check(TOPIC, &what, got, amplitude(&forces[half]), Absolute(0.02 * largest));
            }
            let reference = expected["bearing_force_amplitude_n"].as_array().expect("bearings");
            let bearings = response["bearings"].as_array().expect("bearings");
            assert_eq!(bearings.len(), reference.len());
            let all = reference.iter().flat_map(|b| ["x", "y", "z"].map(|axis| amplitude(&b[axis])));
            let largest = all.fold(0.0, f64::max);
            for (got, expected) in bearings.iter().zip(reference) {
                assert_eq!((&got["shaft"], &got["position_mm"]), (&expected["shaft"], &expected["position_mm"]));
                for axis in ["x", "y", "z"] {
                    let force = got["force_n"][axis]["amplitudes"][0].as_f64().unwrap_or(0.0);
                    let what = format!("{name}: {} bearing at {} mm, {axis}, N", got["shaft"], got["position_mm"]);
                    check(TOPIC, &what, force, amplitude(&expected[axis]), Absolute(0.02 * largest));
                }
            }
        }
    }
}

/// Sweeps over arrangements and single fields of the shafts fill the columns of the shafts; what moves together is
/// named by `also`.
#[test]
fn sweeps_vary_the_shafts() {
    let mut input = dynamic_cases()[0]["input"].clone();
    input["kind"] = json!("sweep");
    input["model"]["mesh_stiffness"] =
        json!({"source": "ltca", "fidelity": "uniform", "line_stiffness_n_per_mm_um": 14.0, "corner_contact": false});
    input["model"]["mesh_force"] = json!("stiffness");
    input["operation"]["pinion_torque_nm"] = json!(800.0);
    let derived = json!({"arrangement": {"bearing_span_mm": 340.0, "pinion_shaft_diameter_mm": 80.0}});
    let sweep = |shafts: Option<&Value>, axes: Value| {
        let mut document = input.clone();
        shafts.into_iter().for_each(|shafts| document["design"]["shafts"] = shafts.clone());
        document["axes"] = axes;
        let points = solved(&document)["sweep"]["points"].take();
        points.as_array().cloned().expect("rows")
    };
    let column = |points: &[Value], pointer: &str| -> Vec<f64> {
        points
            .iter()
            .map(|row| row.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} of {row}")))
            .collect()
    };
    let all = [
        "/k_h_beta_5mm/left",
        "/k_h_beta_5mm/right",
        "/k_gamma",
        "/between_couplings_mean_um",
        "/between_couplings_harmonic_1_um",
        "/largest_bearing_force_rms_n",
        "/lowest_natural_frequency_hz",
    ];
    let pinion = "/design/shafts/pinion";
    let cases = [
        (Some(&derived), json!([{"pointer": "/design/shafts/arrangement/bearing_span_mm", "values": [320, 500]}])),
        (
            Some(&derived),
            json!([{"pointer": "/design/shafts/arrangement/pinion_shaft_diameter_mm", "values": [60, 95],
                    "also": ["/design/shafts/arrangement/gear_shaft_diameter_mm"]}]),
        ),
        (Some(&derived), json!([{"pointer": "/design/gap_width_mm", "values": [10, 60]}])),
        (None, json!([{"pointer": format!("{pinion}/bearings/0/position_mm"), "values": [60, 150]}])),
        (
            None,
            json!([{"pointer": format!("{pinion}/segments/3/diameter_mm"), "values": [80, 97],
                    "also": [format!("{pinion}/segments/5/diameter_mm")]}]),
        ),
        // The end where the torque enters.
        (None, json!([{"pointer": format!("{pinion}/coupling/position_mm"), "values": [0, 480]}])),
    ];
    for (shafts, axes) in cases {
        let points = sweep(shafts, axes.clone());
        for pointer in all {
            assert!(column(&points, pointer).iter().all(|value| *value > 0.0), "{pointer} of {axes}");
        }
        let [first, second] = [0, 1].map(|row| column(&points, "/k_h_beta_5mm/left")[row]);
        assert!((first - second).abs() > 1e-3, "{axes}: {first} and {second}");
    }
}

/// Under negative torque the coast flanks carry: the mirror image of the drive flanks of a pair of the other hands.
#[test]
fn the_coast_flanks_are_the_mirror_image_of_drive_flanks() {
    let cases = cases();
    let case = cases.iter().find(|case| case["name"] == "axially_held_tilting_bearings").expect("the case");
    let (mut coast, mut mirrored) = (case["input"].clone(), case["input"].clone());
    coast["operation"]["pinion_torque_nm"] = json!(-800.0);
    mirrored["design"]["pinion"]["left_half_hand"] = json!("right");
    mirrored["operation"]["rotation"] = json!("apex_trailing");
    let (coast, mirrored) = (&solved(&coast)["shafts"], &solved(&mirrored)["shafts"]);
    let mut errors = Vec::new();
    for half in ["left", "right"] {
        for value in ["k_h_beta", "share", "axial_force_on_pinion_n"] {
            let of = |result: &Value| result[half][value].as_f64().expect("a number");
            errors.push(of(coast) / of(mirrored) - 1.0);
        }
    }
    // Seen in the mirror of the plane of both axes.
    for (value, sign) in [("x_um", 1.0), ("y_um", -1.0), ("z_um", 1.0), ("tilt_x_urad", -1.0), ("tilt_y_urad", 1.0)] {
        let [own, image] = [coast, mirrored].map(|result| numbers(&result["pinion"][value]));
        assert_eq!((own.len(), image.len()), (4, 4));
        errors.extend(own.iter().zip(&image).map(|(own, image)| own / (sign * image) - 1.0));
    }
    check_worst(TOPIC, "coast flanks against the mirrored pair", errors, 1e-9);
}

/// The reactions of the bearings to the mean motion are those of the static contact, on either flank.
#[test]
fn the_mean_bearing_forces_are_the_static_ones() {
    for torque_nm in [800.0, -800.0] {
        let document = json!({
            "kind": "response",
            "design": {
                "normal_module_mm": 6.0, "helix_angle_deg": 24.43, "face_width_mm": 75.0,
                "pinion": {"teeth": 17}, "gear": {"teeth": 44},
                "shafts": {"arrangement": {"type": "straddle", "input": "left"}}
            },
            "operation": {"pinion_speed_rpm": 2000.0, "pinion_torque_nm": torque_nm}
        });
        let result = solved(&document);
        let members = ["pinion", "gear"].map(|member| result["shafts"][member]["bearings"].as_array().cloned());
        let reactions: Vec<Value> = members.into_iter().flatten().flatten().collect();
        let bearings = result["response"]["bearings"].as_array().expect("bearings");
        assert_eq!((reactions.len(), bearings.len()), (4, 4));
        let mut errors = Vec::new();
        for (bearing, reaction) in bearings.iter().zip(&reactions) {
            for (c, axis) in ["x", "y"].into_iter().enumerate() {
                let mean = bearing["force_n"][axis]["mean"].as_f64().expect("a force");
                errors.push((mean - numbers(&reaction["force_on_shaft_n"])[c]) / 7000.0);
            }
        }
        check_worst(TOPIC, &format!("mean bearing forces against the static contact, {torque_nm} N m"), errors, 1e-3);
    }
}
