//! Measured rates for docs/SCALING.md: `cargo test --release --test cluster -- --ignored --nocapture rates`.

use crate::documents;
use crate::program::{Program, Service};
use crate::setting::{Setting, number, slow_sweep};
use crate::worker::Worker;
use jiff::Timestamp;
use serde_json::{Value, json};
use std::time::Instant;

/// Time until a job has succeeded.
fn seconds(service: &Service, document: &Value) -> f64 {
    let started = Instant::now();
    let path = service.submit(document);
    assert_eq!(service.ended(&path)["state"], "succeeded");
    started.elapsed().as_secs_f64()
}

/// Times of a worker between the end of a chunk and the start of the next one, ascending, and its computing time.
fn gaps_s(worker: &Worker) -> Vec<f64> {
    let log = worker.log();
    let at = |line: &str| line.split_whitespace().next().and_then(|word| word.parse::<Timestamp>().ok());
    let (mut gaps, mut ended) = (Vec::new(), None);
    for line in log.lines() {
        if line.contains("chunk computed") {
            ended = at(line);
        } else if line.contains("chunk taken")
            && let (Some(from), Some(to)) = (ended.take(), at(line))
        {
            gaps.push(to.duration_since(from).as_secs_f64());
        }
    }
    gaps.sort_by(f64::total_cmp);
    gaps
}

fn median_ms(gaps: &[f64]) -> f64 {
    1e3 * gaps.get(gaps.len() / 2).copied().unwrap_or_default()
}

#[test]
#[ignore = "measures for a minute or two"]
fn rates() {
    let Some(setting) = Setting::new(&[]) else { return };
    let sweep = |torque_nm: f64| {
        let mut document = slow_sweep(1000);
        document["operation"]["pinion_torque_nm"] = json!(torque_nm);
        document
    };
    let folder = tempfile::tempdir().expect("a folder");
    let alone = Program::at(folder.path()).with(&["--threads", "2"]).start();
    let alone_s = seconds(&alone, &sweep(801.0));
    drop(alone);
    let service = setting.program.start();
    let first = setting.worker();
    let one_s = seconds(&service, &sweep(801.0));
    let second = setting.worker();
    let two_s = seconds(&service, &sweep(802.0));
    println!("1000 points: process with two threads {alone_s:.1} s, one worker {one_s:.1} s, two workers {two_s:.1} s");
    let gaps = gaps_s(&first);
    println!("between two chunks of a worker: median {:.1} ms, of {}", median_ms(&gaps), gaps.len());
    let mut many = documents::sweep(50_000);
    many["operation"]["pinion_torque_nm"] = json!(803.0);
    let before = number(setting.program.database(), "SELECT COUNT(*) FROM sweep_points");
    let many_s = seconds(&service, &many);
    let rows = number(setting.program.database(), "SELECT COUNT(*) FROM sweep_points") - before;
    let bytes = number(setting.program.database(), "SELECT SUM(LENGTH(body)) FROM sweep_points") as f64;
    let row_bytes = bytes / (before + rows) as f64;
    println!("{rows} rows of {row_bytes:.0} bytes in {many_s:.1} s: {:.0} rows/s", rows as f64 / many_s);
    let mut recorded = documents::integration(400);
    recorded["analysis"] = json!({
        "method": "integrate", "mesh_periods": 300, "record_mesh_periods": 300, "samples_per_mesh_period": 256,
    });
    let recorded_s = seconds(&service, &recorded);
    let samples = number(setting.program.database(), "SELECT SUM(LENGTH(samples)) FROM series_samples");
    println!("a job with {:.1} MB of compressed series: {recorded_s:.2} s", samples as f64 * 1e-6);
    drop((first, second));
}
