//! The whole analysis against three-dimensional finite elements of a z 29/67 pair (tests/data/fe_pair_29_67.json). The
//! bounds are what the analytic model reaches; examples/contact_validation.rs prints the errors.

use std::collections::BTreeMap;

use serde_json::Value;

use super::{pair, spec};
use crate::compliance::{BodyHold, Compliance, Settings};
use crate::contact::solve_half;
use crate::fe::{FlankFlexibility, Resolution};
use crate::gear::{Half, Pair, ReliefShape, Rotation, TipRelief};
use crate::watch::Watch;
use herringbone_oracle::check_worst;

fn variant(name: &str) -> Pair {
    let mut spec = spec([29, 67], 30.0, 45e-3);
    spec.pinion.bore_radius_m = 25e-3;
    spec.gear.bore_radius_m = 60e-3;
    let plain = pair(&spec);
    match name {
        "lead_zero_at_mesh_in_end" => spec.pinion.flanks[0].helix_slope_m = 8e-6,
        "lead_zero_at_mesh_out_end" => {
            spec.pinion.flanks[0].helix_slope_m = 8e-6;
            spec.rotation = Rotation::ApexTrailing;
        }
        "tip_relief" => {
            let relief = |length_m| TipRelief { amount_m: 15e-6, length_m, shape: ReliefShape::Parabolic };
            let pitch = plain.pitch_point_m();
            spec.pinion.flanks[0].tip_relief = relief((plain.pinion.tip_roll_m() - pitch) / 3.0);
            spec.gear.flanks[0].tip_relief = relief((plain.gear.tip_roll_m() - (plain.line_of_action_m - pitch)) / 3.0);
        }
        _ => {}
    }
    pair(&spec)
}

/// Bounds of the relative errors of stiffness and mean transmission error, of the first harmonic and the swing of the
/// transmission error (with tip relief), and of the load shares (of a half-loaded face).
struct Bounds {
    mean: f64,
    harmonic: [f64; 2],
    swing: [f64; 2],
    share: [f64; 2],
}

fn compare(topic: &str, bounds: &Bounds, compliance: &dyn Fn(&Pair, &Settings) -> Compliance) {
    let reference: Value = serde_json::from_str(include_str!("../../../../../tests/data/fe_pair_29_67.json")).unwrap();
    // Relative errors (of the shares: differences) of each variant and quantity over its torques, with their bound.
    let mut errors: BTreeMap<(String, &str), (f64, Vec<f64>)> = BTreeMap::new();
    let mut note = |name: &str, what, error: f64, bound: f64| {
        errors.entry((name.replace('_', " "), what)).or_insert((bound, Vec::new())).1.push(error);
    };
    for case in reference["cases"].as_array().unwrap() {
        let name = case["variant"].as_str().unwrap();
        let number = |key: &str| case[key].as_f64().unwrap();
        let pair = variant(name);
        let settings = Settings {
            positions: Some(32),
            accuracy: 1e-3,
            slices: None,
            body: if name == "nominal_rim_clamped" { BodyHold::Rim } else { BodyHold::Bore },
            corner_contact: name == "nominal_ext",
        };
        let force = number("torque_nm") / pair.pinion.base_radius_m;
        let cycle =
            solve_half(&pair, Half::Left, force, &compliance(&pair, &settings), &settings, Watch::none()).unwrap();
        let bound = bounds.mean;
        let error = |value: f64, key: &str| value / number(key) - 1.0;
        note(name, "mean secant stiffness", error(cycle.secant_stiffness.mean, "secant_n_per_m"), bound);
        note(name, "mean tangent stiffness", error(cycle.stiffness.mean, "tangent_n_per_m"), bound);
        note(name, "mean transmission error", error(cycle.transmission_error.mean * 1e6, "te_mean_um"), bound);
        // Tip relief leaves a small remainder of two large effects.
        let relieved = usize::from(name == "tip_relief");
        let bound = bounds.harmonic[relieved];
        let harmonic = error(cycle.transmission_error_harmonics_m[0] * 1e6, "te_harmonic_1_um");
        note(name, "transmission error, first harmonic", harmonic, bound);
        let swing = cycle.transmission_error.max - cycle.transmission_error.min;
        let bound = bounds.swing[relieved];
        note(name, "transmission error, peak to peak", error(swing * 1e6, "te_pp_um"), bound);
        for entry in case["share"].as_array().unwrap() {
            let (at, expected) = (entry[0].as_f64().unwrap(), entry[1].as_f64().unwrap());
            let i = cycle.load_share_phase.partition_point(|&p| p < at);
            let (p, s) = (&cycle.load_share_phase, &cycle.load_share);
            let got = s[i - 1] + (at - p[i - 1]) / (p[i] - p[i - 1]) * (s[i] - s[i - 1]);
            let bound = bounds.share[usize::from(name.starts_with("lead"))];
            note(name, "load share of a pair, difference", got - expected, bound);
        }
    }
    for ((name, what), (bound, errors)) in errors {
        check_worst(topic, &format!("{name}: {what}, three torques"), errors, bound);
    }
}

#[test]
fn the_analytic_model_stays_within_its_stated_deviation() {
    let bounds = Bounds { mean: 0.02, harmonic: [0.12, 0.26], swing: [0.12, 0.22], share: [0.015, 0.035] };
    compare("Contact: loaded pair 29/67 against finite elements", &bounds, &|pair, settings| {
        Compliance::analytic(pair, settings, Watch::none()).expect("not canceled")
    });
}

/// Coarse elements, so that the test is short; `examples/contact_validation.rs standard` prints the errors of the
/// default ones.
#[test]
fn the_finite_elements_stay_within_their_stated_deviation() {
    let bounds = Bounds { mean: 0.012, harmonic: [0.05, 0.08], swing: [0.08, 0.1], share: [0.01, 0.02] };
    // The flexibilities of either holding serve all variants: those with corner contact reach further.
    let wide = Settings { corner_contact: true, ..Settings::default() };
    let plain = variant("nominal");
    let flanks = [BodyHold::Rim, BodyHold::Bore].map(|body| {
        let settings = Settings { body, ..wide };
        let inputs = Compliance::finite_element_inputs(&plain, &settings, Resolution::Coarse);
        inputs.map(|input| FlankFlexibility::new(&input, Watch::none()).unwrap())
    });
    compare("Contact: loaded pair 29/67, own coarse elements against finite elements", &bounds, &|pair, settings| {
        let [pinion, gear] = &flanks[usize::from(settings.body == BodyHold::Bore)];
        Compliance::finite_elements(pair, settings, [pinion, gear], Watch::none()).expect("not canceled")
    });
}
