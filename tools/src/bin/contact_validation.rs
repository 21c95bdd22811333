//! Compares the loaded tooth contact with the finite-element reference of a z 29/67 helical pair and prints the errors:
//! `scripts/tool contact_validation [analytic|coarse|medium|standard|fine [SLICES [POSITIONS]]]`.

use std::time::Instant;

use herringbone_physics::compliance::{BodyHold, Compliance, Settings};
use herringbone_physics::contact::solve_half;
use herringbone_physics::fe::FlankFlexibility;
use herringbone_physics::gear::{Half, Pair, ReliefShape, Rotation, TipRelief};
use herringbone_physics::watch::Watch;
use herringbone_tools::arguments::{Arguments, resolution};
use herringbone_tools::{Failure, reference};

/// The reference pair in one of its variants, as this crate describes it.
fn reference_pair(variant: &str) -> Pair {
    let mut spec = reference::spec();
    let pair = reference::pair(&spec);
    match variant {
        "lead_zero_at_mesh_in_end" => spec.pinion.flanks[0].helix_slope_m = 8e-6,
        "lead_zero_at_mesh_out_end" => {
            spec.pinion.flanks[0].helix_slope_m = 8e-6;
            spec.rotation = Rotation::ApexTrailing;
        }
        "tip_relief" => {
            let relief = |length_m| TipRelief { amount_m: 15e-6, length_m, shape: ReliefShape::Parabolic };
            let pitch = pair.pitch_point_m();
            spec.pinion.flanks[0].tip_relief = relief((pair.pinion.tip_roll_m() - pitch) / 3.0);
            spec.gear.flanks[0].tip_relief = relief((pair.gear.tip_roll_m() - (pair.line_of_action_m - pitch)) / 3.0);
        }
        _ => {}
    }
    reference::pair(&spec)
}

fn share_at(path: &[f64], share: &[f64], at: f64) -> f64 {
    let i = path.partition_point(|&p| p <= at).clamp(1, path.len() - 1);
    let t = (at - path[i - 1]) / (path[i] - path[i - 1]);
    share[i - 1] + t * (share[i] - share[i - 1])
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of_process();
    let text = include_str!("../../../tests/data/fe_pair_29_67.json");
    let reference: serde_json::Value = serde_json::from_str(text).expect("the reference file is JSON");
    let resolution = match arguments.word(0) {
        None | Some("analytic") => None,
        Some(word) => Some(resolution(word)?),
    };
    let slices = arguments.number(1)?;
    let positions = arguments.number(2)?.or(Some(64));
    let mut kept: Vec<((String, bool), Vec<FlankFlexibility>)> = Vec::new();
    println!(
        "{:26} {:>4} | {:>6} {:>6} | {:>6} {:>6} | {:>6} {:>6} | {:>6} {:>6} | {:>6} | share errors at p 0.05 0.1 0.25 0.5 1 | ms",
        "variant", "T", "ksec", "%", "ktan", "%", "TEpp", "%", "H1", "%", "w %"
    );
    for case in reference["cases"].as_array().expect("cases") {
        let variant = case["variant"].as_str().unwrap_or_default();
        let number = |key: &str| case[key].as_f64().unwrap_or(f64::NAN);
        let pair = reference_pair(variant);
        let settings = Settings {
            positions,
            slices,
            body: if variant == "nominal_rim_clamped" { BodyHold::Rim } else { BodyHold::Bore },
            corner_contact: variant == "nominal_ext",
            ..Settings::default()
        };
        let force = number("torque_nm") / pair.pinion.base_radius_m;
        let mut begin = Instant::now();
        let compliance = match resolution {
            None => Compliance::analytic(&pair, &settings, Watch::none())?,
            Some(resolution) => {
                let key = (format!("{:?}", settings.body), settings.corner_contact);
                if !kept.iter().any(|(k, _)| *k == key) {
                    let inputs = Compliance::finite_element_inputs(&pair, &settings, resolution);
                    let flanks = inputs.iter().map(|i| FlankFlexibility::new(i, Watch::none()).expect("a flexibility"));
                    kept.push((key.clone(), flanks.collect()));
                    println!("{key:?}: finite elements of both gears {:.2} s", begin.elapsed().as_secs_f64());
                }
                let flanks = &kept.iter().find(|(k, _)| *k == key).expect("kept").1;
                begin = Instant::now();
                Compliance::finite_elements(&pair, &settings, [&flanks[0], &flanks[1]], Watch::none())?
            }
        };
        let cycle = match solve_half(&pair, Half::Left, force, &compliance, &settings, Watch::none()) {
            Ok(cycle) => cycle,
            Err(error) => {
                println!("{variant:26} {:>4} | {error}", number("torque_nm"));
                continue;
            }
        };
        let elapsed = begin.elapsed().as_secs_f64() * 1e3;
        let percent = |value: f64, expected: f64| 100.0 * (value / expected - 1.0);
        let te = cycle.transmission_error;
        let shares: Vec<String> = case["share"]
            .as_array()
            .expect("shares")
            .iter()
            .map(|entry| {
                let got = share_at(&cycle.load_share_phase, &cycle.load_share, entry[0].as_f64().unwrap_or(0.0));
                format!("{:+.3}", got - entry[1].as_f64().unwrap_or(f64::NAN))
            })
            .collect();
        println!(
            "{variant:26} {:>4} | {:6.3} {:+6.1} | {:6.3} {:+6.1} | {:6.3} {:+6.0} | {:6.3} {:+6.1} | {:+6.1} | {} | {:.1}",
            number("torque_nm"),
            cycle.secant_stiffness.mean * 1e-8,
            percent(cycle.secant_stiffness.mean, number("secant_n_per_m")),
            cycle.stiffness.mean * 1e-8,
            percent(cycle.stiffness.mean, number("tangent_n_per_m")),
            (te.max - te.min) * 1e6,
            percent((te.max - te.min) * 1e6, number("te_pp_um")),
            cycle.transmission_error_harmonics_m[0] * 1e6,
            percent(cycle.transmission_error_harmonics_m[0] * 1e6, number("te_harmonic_1_um")),
            percent(cycle.max_line_load_interior_n_per_m * 1e-3, number("line_load_n_per_mm")),
            shares.join(" "),
            elapsed,
        );
    }
    Ok(())
}
