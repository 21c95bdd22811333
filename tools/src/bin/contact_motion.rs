//! Motions with the contact in the equations against references: a file of cases, each a document (`input`) and what is
//! expected.
//!
//! `scripts/tool contact_motion FILE`

use herringbone_job::parse_value;
use herringbone_job::study::{self, CheckedJob, SolveContext};
use herringbone_tools::Failure;
use herringbone_tools::arguments::Arguments;
use serde_json::Value;
use std::time::Instant;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of_process();
    let path = arguments.word(0).ok_or("the file of cases is missing")?;
    let cases: Value = serde_json::from_slice(&std::fs::read(path)?)?;
    println!(
        "{:55} {:>9} {:>8} {:>8} {:>9} {:>9} {:>8} {:>9} {:>8}",
        "case", "rms %", "peak %", "dfactor", "no contact", "te mean %", "te h1 %", "regime", "ms"
    );
    for case in cases["cases"].as_array().ok_or("no cases")? {
        let mut input = case["input"].clone();
        input["analysis"]["channels"] = serde_json::json!(["a_x_left", "f_n_left", "x_left"]);
        input["analysis"]["samples_per_mesh_period"] = serde_json::json!(1024);
        let job = parse_value(&input).and_then(CheckedJob::new).map_err(|e| format!("{e:?}"))?;
        let started = Instant::now();
        let outcome = match study::solve(
            &job,
            &SolveContext { clock_ms: &|| started.elapsed().as_secs_f64() * 1e3, ..SolveContext::none() },
        ) {
            Ok(outcome) => outcome,
            Err(error) => {
                println!("{}: {error}", case["name"]);
                continue;
            }
        };
        let ms = started.elapsed().as_secs_f64() * 1e3;
        let (result, expected) = (outcome.result, &case["expected"]);
        let response = result.response.ok_or("no response")?;
        let mesh = result.mesh.ok_or("no mesh")?;
        let of = |value: f64, pointer: &str| {
            100.0 * (value / expected.pointer(pointer).and_then(Value::as_f64).unwrap_or(f64::NAN) - 1.0)
        };
        let peak = outcome
            .series
            .iter()
            .find(|c| c.name == "a_x_left")
            .map_or(f64::NAN, |c| c.values.iter().fold(0.0f64, |m, v| m.max(v.abs())));
        let table = mesh.contact_force.map_or_else(String::new, |table| {
            format!("{} levels, {} phases, {:.4} %", table.levels, table.phases, table.error_percent)
        });
        let (numerics, wall) = (&result.numerics, &result.numerics.wall_ms);
        println!(
            "{:55} {:9.3} {:8.3} {:8.4} {:9.4} {:9.3} {:8.3} {:>9} {ms:8.1}  RMS {:.3} m/s2, error {:.1e}, table {table}, {} steps, mesh {:.1} ms, response {:.1} ms",
            case["name"].as_str().unwrap_or(""),
            of(response.rms.mesh_circumferential_acceleration_m_s2.left, "/rms_acceleration_m_s2"),
            of(peak, "/peak_acceleration_m_s2"),
            response.dynamic_factor.unwrap_or(f64::NAN) - expected["dynamic_factor"].as_f64().unwrap_or(f64::NAN),
            (1.0 - response.fraction_in_contact) - expected["fraction_without_contact"].as_f64().unwrap_or(f64::NAN),
            of(mesh.transmission_error_mean_um, "/static/transmission_error_mean_um"),
            of(mesh.transmission_error_harmonics_um[0], "/static/transmission_error_harmonics_um/0"),
            response.regime.as_str(),
            response.rms.mesh_circumferential_acceleration_m_s2.left,
            response.error_estimate,
            numerics.steps,
            wall.mesh,
            wall.response,
        );
    }
    Ok(())
}
