//! The calculations that users wait for, one at a time, for `scripts/instructions` and profilers.
//!
//! `key_paths NAME [REPETITIONS]` solves the path NAME so many times after a first time (0: only the first time);
//! `key_paths` alone lists the names. All of it runs on the threads of the pool (`RAYON_NUM_THREADS=1`: on one).

use herringbone_job::parse_value;
use herringbone_job::study::{self, CheckedJob, SolveContext};
use herringbone_tools::Failure;
use herringbone_tools::arguments::Arguments;
use serde_json::{Value, json};
use std::hint::black_box;

/// Names of the paths, with what each calculates.
const PATHS: [(&str, &str); 10] = [
    ("check", "geometry, feasibility and warnings of examples/table1.json, 100 times"),
    ("mesh", "the loaded contact of examples/table1.json, cold"),
    ("mesh-shafts", "the loaded contact of examples/shafts.json, cold"),
    ("response", "examples/table1.json, cold: contact, impact and motion, mesh_force \"stiffness\""),
    ("response-contact", "examples/contact.json, cold: the contact in the equations"),
    ("response-iso6336", "examples/table1.json with the stiffness of ISO 6336-1, 10 times"),
    ("sweep-linear", "100 speeds of reference case A by document"),
    ("sweep-separating", "20 speeds of reference case C by document, 100 mesh periods integrated"),
    ("sweep-contact", "40 speeds of examples/contact.json, cold"),
    ("sweep-shafts", "5 speeds of examples/shafts_arrangement.json, cold"),
];

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of_process();
    let Some(name) = arguments.word(0) else {
        PATHS.iter().for_each(|(name, meaning)| println!("{name:18} {meaning}"));
        return Ok(());
    };
    let repetitions = arguments.number::<usize>(1)?.unwrap_or(1);
    let run = path(name)?;
    for _ in 0..=repetitions {
        run()?;
    }
    Ok(())
}

type Run = Box<dyn Fn() -> Result<(), Failure>>;

fn path(name: &str) -> Result<Run, Failure> {
    let table1 = include_str!("../../../examples/table1.json");
    let contact = include_str!("../../../examples/contact.json");
    match name {
        "check" => {
            let document = job(table1, |_| {})?.into_document();
            Ok(Box::new(move || {
                (0..100).try_for_each(|_| {
                    let job = CheckedJob::new(black_box(&document).clone()).map_err(|e| format!("{e:?}"))?;
                    black_box(job.report());
                    Ok(())
                })
            }))
        }
        "mesh" => solving(job(table1, |value| value["kind"] = json!("mesh"))?, 1),
        "mesh-shafts" => solving(job(include_str!("../../../examples/shafts.json"), |v| v["kind"] = json!("mesh"))?, 1),
        "response" => solving(job(table1, |_| {})?, 1),
        "response-contact" => solving(job(contact, |_| {})?, 1),
        "response-iso6336" => {
            solving(job(table1, |v| v["model"]["mesh_stiffness"] = json!({"source": "iso6336"}))?, 10)
        }
        "sweep-linear" => solving(reference_case("A", 100)?, 1),
        "sweep-separating" => solving(reference_case("C", 20)?, 1),
        "sweep-contact" => solving(job(contact, |value| sweep(value, [500.0, 12_000.0], 40))?, 1),
        "sweep-shafts" => {
            let arrangement = include_str!("../../../examples/shafts_arrangement.json");
            solving(job(arrangement, |value| sweep(value, [500.0, 6000.0], 5))?, 1)
        }
        _ => Err(format!("there is no path \"{name}\"").into()),
    }
}

fn job(text: &str, change: impl FnOnce(&mut Value)) -> Result<CheckedJob, Failure> {
    let mut value: Value = serde_json::from_str(text)?;
    value["analysis"]["channels"] = json!([]);
    change(&mut value);
    Ok(parse_value(&value).and_then(CheckedJob::new).map_err(|e| format!("{e:?}"))?)
}

fn solving(job: CheckedJob, times: usize) -> Result<Run, Failure> {
    Ok(Box::new(move || {
        for _ in 0..times {
            black_box(study::solve(black_box(&job), &SolveContext::none())?);
        }
        Ok(())
    }))
}

fn sweep(value: &mut Value, speeds_rpm: [f64; 2], points: usize) {
    value["kind"] = json!("sweep");
    let [from, to] = speeds_rpm;
    value["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": from, "to": to, "points": points}]);
}

/// Speeds of reference case A (contact kept) or C (contact lost and closed) of tests/data/dynamics_reference.json, as a
/// document: the pair and supports are those of examples/given_stiffness.json.
fn reference_case(name: &str, points: usize) -> Result<CheckedJob, Failure> {
    let linear = name == "A";
    job(include_str!("../../../examples/given_stiffness.json"), |value| {
        let (torque_nm, backlash_um, damping, amplitude) =
            if linear { (800.0, 2.0, 0.1, 0.12) } else { (80.0, 40.0, 0.03, 0.24) };
        value["operation"]["pinion_torque_nm"] = json!(torque_nm);
        value["design"]["backlash_um"] = json!(backlash_um);
        value["model"]["mesh_damping_ratio"] = json!(damping);
        let harmonics = [(1.0, 0.3), (0.05 / 0.12, 1.1), (0.25, 2.0), (0.125, 0.7)];
        value["model"]["mesh_stiffness"]["harmonics"] =
            harmonics.map(|(a, phase_rad)| json!({"amplitude": a * amplitude, "phase_rad": phase_rad})).into();
        value["analysis"] = if linear {
            json!({"accuracy": 1e-6, "channels": []})
        } else {
            json!({"accuracy": 1e-6, "channels": [], "method": "integrate", "mesh_periods": 100, "record_mesh_periods": 50})
        };
        sweep(value, [500.0, 6000.0], points);
    })
}
