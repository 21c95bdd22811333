//! Optimisations of the loaded contact against grids, random points and known cures. They take minutes: run them with
//! `--ignored --nocapture`; docs/VALIDATION.md has what they print.

use super::{CheckedJob, SolveContext, solve};
use crate::result::{JobResult, OptimiseResult};
use serde_json::{Value, json};
use std::time::Instant;

fn solved(value: &Value) -> JobResult {
    let document = crate::parse_value(value).unwrap_or_else(|error| panic!("{error:?}"));
    solve(&CheckedJob::new(document).unwrap(), &SolveContext::none()).expect("solved").result
}

fn optimised(value: &Value) -> OptimiseResult {
    let started = Instant::now();
    let result = solved(value).optimise.expect("an optimisation");
    let evaluations = result.numerics.evaluations;
    let seconds = started.elapsed().as_secs_f64();
    println!("  {evaluations} evaluations in {seconds:.1} s, {:.1} ms each", 1e3 * seconds / f64::from(evaluations));
    result
}

fn example(name: &str) -> Value {
    let path = format!("{}/../../examples/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn values(result: &OptimiseResult) -> Vec<f64> {
    result.best.as_ref().map(|best| best.values.values().copied().collect()).unwrap_or_default()
}

#[test]
#[ignore = "seconds of loaded contact"]
fn f94_helix_slopes_cure_a_misalignment() {
    let mut document = example("optimise_misalignment");
    for variable in document["variables"].as_array_mut().unwrap() {
        variable.as_object_mut().unwrap().remove("step");
    }
    let result = optimised(&document);
    let found = values(&result);
    let mut aligned = document.clone();
    aligned["kind"] = json!("response");
    for name in ["variables", "objectives", "budget"] {
        aligned.as_object_mut().unwrap().remove(name);
    }
    aligned["design"].as_object_mut().unwrap().remove("assembly");
    let of_aligned = solved(&aligned).mesh.unwrap();
    println!(
        "  slopes {found:?} um, exact -20 and 20 um; line load {:?} -> {:?} N/mm, aligned {:?}",
        result.objectives[0].input, result.objectives[0].best, of_aligned.max_line_load_n_per_mm
    );
    println!("  {:?}", result.flatness);
    assert!((found[0] + 20.0).abs() < 1.0 && (found[1] - 20.0).abs() < 1.0, "{found:?}");
    let ratio = result.objectives[0].best.unwrap() / of_aligned.max_line_load_n_per_mm.unwrap();
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
}

/// Relief amount and length of both gears at three torques; on request crowning.
fn relief(with_crowning: bool) -> Value {
    let mut document = example("optimise_relief");
    let variables = document["variables"].as_array_mut().unwrap();
    variables.iter_mut().for_each(|variable| drop(variable.as_object_mut().unwrap().remove("step")));
    variables.truncate(if with_crowning { 3 } else { 2 });
    document.as_object_mut().unwrap().remove("constraints");
    document["budget"] = json!({"evaluations": 200});
    document["model"]["mesh_stiffness"]["positions"] = json!(32);
    document
}

/// Every evaluation on a grid, by a search of which the first sample is not used: documents one after the other.
fn best_of_grid(document: &Value, counts: &[usize]) -> (f64, Vec<f64>) {
    use rayon::prelude::*;
    let total: usize = counts.iter().product();
    let variables = document["variables"].as_array().unwrap();
    (0..total)
        .into_par_iter()
        .map(|index| {
            let (mut rest, mut values) = (index, Vec::new());
            for (variable, count) in variables.iter().zip(counts) {
                let [from, to] = ["from", "to"].map(|name| variable[name].as_f64().unwrap());
                values.push(from + (to - from) * (rest % count) as f64 / (count - 1) as f64);
                rest /= count;
            }
            let mut worst: f64 = 0.0;
            for point in document["operating_points"].as_array().unwrap() {
                let mut single = document.clone();
                single["kind"] = json!("response");
                for name in ["variables", "objectives", "budget", "operating_points"] {
                    single.as_object_mut().unwrap().remove(name);
                }
                single["operation"]["pinion_torque_nm"] = point["pinion_torque_nm"].clone();
                single["analysis"]["channels"] = json!([]);
                for (variable, value) in variables.iter().zip(&values) {
                    let also = variable["also"].as_array().into_iter().flatten();
                    for pointer in std::iter::once(&variable["pointer"]).chain(also) {
                        let (parent, name) = pointer.as_str().unwrap().rsplit_once('/').unwrap();
                        single.pointer_mut(parent).unwrap()[name] = json!(value);
                    }
                }
                let rms = solved(&single).response.unwrap().rms.mesh_circumferential_acceleration_m_s2;
                worst = worst.max(rms.left.max(rms.right));
            }
            (worst, values)
        })
        .reduce(|| (f64::INFINITY, Vec::new()), |a, b| if a.0 <= b.0 { a } else { b })
}

#[test]
#[ignore = "minutes of loaded contact"]
fn f95_relief_against_a_grid() {
    let document = relief(false);
    let result = optimised(&document);
    let found = result.objectives[0].best.unwrap();
    println!("  search: {found} m/s2 at {:?}; input {:?}", values(&result), result.objectives[0].input);
    let (least, at) = best_of_grid(&document, &[41, 41]);
    println!("  grid 41 x 41: {least} m/s2 at {at:?}");
    assert!(found <= 1.01 * least && result.numerics.evaluations <= 201, "{found} {least}");
}

#[test]
#[ignore = "minutes of loaded contact"]
fn f95_relief_and_crowning_against_a_grid() {
    let document = relief(true);
    let result = optimised(&document);
    let found = result.objectives[0].best.unwrap();
    println!("  search: {found} m/s2 at {:?}", values(&result));
    let (least, at) = best_of_grid(&document, &[21, 21, 21]);
    println!("  grid 21 x 21 x 21: {least} m/s2 at {at:?}");
    assert!(found <= 1.01 * least, "{found} {least}");
}

/// Reliefs of both gears apart, crowning and stagger of the example pair at three torques.
fn promise() -> Value {
    let mut document = relief(true);
    let contact = example("contact");
    document["design"] = contact["design"].clone();
    document["model"] = contact["model"].clone();
    for gear in ["pinion", "gear"] {
        document["design"][gear]["tip_relief"] = json!({"amount_um": 0.0, "length_mm": 6.0});
    }
    document["variables"] = json!([
        {"pointer": "/design/pinion/tip_relief/amount_um", "from": 0, "to": 40},
        {"pointer": "/design/pinion/tip_relief/length_mm", "from": 2, "to": 12},
        {"pointer": "/design/gear/tip_relief/amount_um", "from": 0, "to": 40},
        {"pointer": "/design/gear/tip_relief/length_mm", "from": 2, "to": 12},
        {"pointer": "/design/pinion/lead_crowning_um", "from": 0, "to": 15},
        {"pointer": "/design/half_stagger", "from": 0, "to": 0.5},
    ]);
    document["budget"] = json!({"evaluations": 400});
    document
}

#[test]
#[ignore = "minutes of loaded contact"]
fn f96_the_pair_of_the_source_at_three_torques() {
    let result = optimised(&promise());
    let objective = &result.objectives[0];
    println!(
        "  {}: {:?} -> {:?} m/s2, {:?} %",
        result.verdict, objective.input, objective.best, objective.gain_percent
    );
    println!("  {:?}", result.best.as_ref().map(|best| &best.values));
    for point in &objective.per_point {
        println!("  {} N m: {:?} -> {:?} m/s2", point.pinion_torque_nm, point.input, point.best);
    }
    println!("  active {:?}, stopped by {}", result.active, result.numerics.stopped_by);
    assert!(objective.gain_percent.unwrap() >= 30.0 || result.verdict.starts_with("no better"));
}

#[test]
#[ignore = "minutes of loaded contact"]
fn f97_a_robust_design_has_a_lower_percentile() {
    let mut document = relief(false);
    document["tolerances"] = json!([
        {"pointer": "/design/pinion/tip_relief/amount_um", "tolerance": 6},
        {"pointer": "/design/gear/tip_relief/amount_um", "tolerance": 6},
        {"pointer": "/design/assembly/in_plane_misalignment_um", "tolerance": 15},
    ]);
    document["robust"] = json!({"samples": 32, "candidates": 10, "confirm_samples": 128});
    let result = optimised(&document);
    let robust = result.robust.expect("robust");
    println!("  candidates {:?}", robust.candidates);
    println!("  input {:?}\n  best {:?}, gain {:?} %", robust.input, robust.best, robust.gain_percent);
    // The nominal optimum over the sample of the confirmation.
    let least = robust.candidates.iter().map(|candidate| candidate.nominal).fold(f64::INFINITY, f64::min);
    let winner = &robust.candidates[0];
    println!("  the winner is {} % above the nominal optimum", 100.0 * (winner.nominal / least - 1.0));
    assert!(robust.gain_percent.unwrap() > 0.0);
}
