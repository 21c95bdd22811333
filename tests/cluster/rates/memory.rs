//! Memory of a service that knows a hundred thousand chunks: a sweep of as many points, each so long that it is a chunk
//! of its own, and workers with enough threads for all. Neither is there: the test speaks for the workers.

use super::{Bench, sweep};
use crate::setting::{number, wait_until};
use serde_json::{Value, json};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Workers that are pretended, of 4096 threads each: the service has twice as many chunks out as there are threads.
const WORKERS: usize = 13;
const CHUNKS: i64 = 99_992;

fn resident_mb(id: u32) -> f64 {
    let text = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
    let line = text.lines().find(|line| line.starts_with("VmRSS:")).unwrap_or_default();
    line.split_whitespace().nth(1).and_then(|word| word.parse::<f64>().ok()).unwrap_or_default() * 1e-3
}

fn beat(number: usize, version: &str) -> String {
    json!({
        "schema": 1, "worker": format!("pretended-{number}"), "host": "", "version": "", "solver_version": version,
        "solvers": [version.replace('.', "_")], "slots": 4096, "running": [],
    })
    .to_string()
}

/// A message of results, as workers pack them: the length of the compressed JSON, and that.
fn packed(message: &Value) -> Vec<u8> {
    let head = zstd::bulk::compress(message.to_string().as_bytes(), 3).expect("compressed");
    [&(head.len() as u32).to_le_bytes()[..], &head].concat()
}

/// Sends the scout's rows, and says that they took long.
async fn scout(jetstream: &async_nats::jetstream::Context, job: &str) {
    let message = |content: Value| {
        packed(&json!({
            "schema": 1, "job": job, "attempt": 1, "chunk": 0, "run": "one", "worker": "pretended-0", "content": content,
        }))
    };
    let row = |index: u64| json!({"position": index * 99_999 / 7, "body": "{\"values\":[]}", "end_state": null});
    let rows = message(json!({"kind": "rows", "rows": (0..8).map(row).collect::<Vec<_>>()}));
    let end = json!({"kind": "end", "points": 8, "work_s": 80.0, "line_end": null, "pieces": 0});
    for payload in [rows, message(end)] {
        let sent = jetstream.publish("hb.test.result.0", payload.into()).await.expect("sent");
        sent.await.expect("acknowledged");
    }
}

pub(super) fn of_a_hundred_thousand_chunks() -> Option<()> {
    let bench = Bench::new(1)?;
    let service = bench.program.start();
    let version = service.get("/api/v1/system")["solver_version"].as_str().expect("a version").to_owned();
    let mut document = sweep(200);
    document["axes"][0]["points"] = json!(100_000);
    document["analysis"] = json!({"record_mesh_periods": 1, "samples_per_mesh_period": 8});
    let path = service.submit(&document);
    let job = path.rsplit('/').next().expect("an id").to_owned();
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    let client = runtime.block_on(async_nats::connect(&bench.url)).expect("connected");
    let is_over = Arc::new(AtomicBool::new(false));
    let (beats, over, of_version) = (client.clone(), Arc::clone(&is_over), version.clone());
    runtime.spawn(async move {
        while !over.load(Ordering::Relaxed) {
            for number in 0..WORKERS {
                let _ = beats.publish("hb.test.beat", beat(number, &of_version).into()).await;
            }
            tokio::time::sleep(Duration::from_secs(3)).await;
        }
    });
    service.until("/api/v1/system", |answer| answer.json()["machines"].as_array().map(Vec::len) == Some(WORKERS));
    let chunks = || number(bench.program.database(), "SELECT COUNT(*) FROM chunks WHERE state <> 'stored'");
    wait_until("the scout is out", || chunks() == 1);
    let before_mb = resident_mb(service.id());
    runtime.block_on(async { scout(&async_nats::jetstream::new(client), &job).await });
    wait_until("all chunks are known", || chunks() >= CHUNKS);
    let with_mb = resident_mb(service.id());
    std::thread::sleep(Duration::from_secs(5));
    let later_mb = resident_mb(service.id()).max(with_mb);
    is_over.store(true, Ordering::Relaxed);
    println!(
        "memory of the service: {before_mb:.0} MB with one chunk, {later_mb:.0} MB with {}: {:.0} MB more",
        chunks(),
        later_mb - before_mb
    );
    assert_eq!(service.send("POST", &format!("{path}/cancel"), "").status, 202);
    service.ended(&path);
    Some(())
}
