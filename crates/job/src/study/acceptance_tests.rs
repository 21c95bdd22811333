//! An optimisation of the loaded contact against a known cure: run it with `--ignored --nocapture`. What takes minutes
//! is in `scripts/optimise-study`.

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
