//! What the resolution of the contact analysis costs and what it brings: the source paper's example pair at several numbers of
//! positions and slices, each against the finest. Prints the table of docs/BENCHMARKS.md.
//!
//! `cargo run --release --no-default-features --example mesh_resolution`

use herringbone::job::parse_value;
use herringbone::job::result::Mesh;
use herringbone::study::{self, NoStageStore, Surroundings};
use serde_json::{Value, json};
use std::time::Instant;

/// Runs timed of each resolution; the median is printed.
const RUNS: usize = 5;
const FINEST: (u32, u32) = (512, 120);

fn main() {
    let (reference, _) = solve(FINEST, 1);
    println!("| positions | slices | time, ms | mean stiffness | TE peak to peak | share at mesh-in, difference |");
    println!("|---|---|---|---|---|---|");
    for (positions, slices) in [(16, 16), (32, 24), (64, 24), (64, 36), (64, 48), (128, 64), (256, 96)] {
        let (mesh, time_ms) = solve((positions, slices), RUNS);
        let percent = |of: fn(&Mesh) -> f64| 100.0 * (of(&mesh) / of(&reference) - 1.0);
        let share = |mesh: &Mesh| mesh.load_share_at_mesh_in.unwrap_or(f64::NAN);
        println!(
            "| {positions} | {slices} | {time_ms:.1} | {:+.3} % | {:+.1} % | {:+.4} |",
            percent(|mesh| mesh.stiffness_mean_n_per_um),
            percent(|mesh| mesh.transmission_error_pp_um),
            share(&mesh) - share(&reference)
        );
    }
}

/// The mesh at one resolution, and the median time of the whole job in ms.
fn solve((positions, slices): (u32, u32), runs: usize) -> (Mesh, f64) {
    let mut value: Value = serde_json::from_str(include_str!("table1.json")).expect("the example is JSON");
    value["kind"] = json!("mesh");
    value["model"]["mesh_stiffness"]["positions"] = json!(positions);
    value["model"]["mesh_stiffness"]["slices"] = json!(slices);
    let document = parse_value(&value).expect("a valid document");
    let surroundings =
        Surroundings { stages: &NoStageStore, progress: &|_, _| {}, canceled: &|| false, clock_ms: &|| 0.0 };
    let mut times_ms = Vec::new();
    let mut mesh = None;
    for _ in 0..runs {
        let started = Instant::now();
        mesh = study::solve(&document, &surroundings).expect("the example solves").result.mesh;
        times_ms.push(started.elapsed().as_secs_f64() * 1e3);
    }
    times_ms.sort_by(f64::total_cmp);
    (mesh.expect("a mesh"), times_ms[runs / 2])
}
