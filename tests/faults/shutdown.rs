//! SIGTERM under load: an end in bounded time, and everything goes on after the restart.

use crate::audit::audit;
use crate::client;
use crate::documents;
use crate::load::Load;
use crate::program::{PATIENCE, Program};
use serde_json::json;
use std::io::Read;
use std::time::{Duration, Instant};

const DRAIN_S: u64 = 5;
/// Seconds of work on a fast machine: the sweep is not done before the shutdown is asked for.
const POINTS: u32 = 20_000;

#[test]
fn a_shutdown_under_load_ends_in_time_and_loses_nothing() {
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path()).with(&["--drain-s", &DRAIN_S.to_string(), "--sweep-workers", "1"]);
    let service = program.start();
    let sweep = service.submit(&documents::sweep(POINTS));
    let load = Load::start(3, 11, Duration::from_millis(20));
    load.serve_at(Some(service.address));
    let points = format!("{sweep}/points?limit=1");
    service.until(&points, |answer| answer.json()["n_solved"].as_u64() >= Some(20));
    let mut stream =
        client::open(service.address, "GET", &format!("{sweep}/events"), &[], "").expect("an event stream");
    let mut first = [0; 1];
    stream.read_exact(&mut first).expect("events");
    let asked = Instant::now();
    service.ask_to_end();
    // Still open to clients until it is gone; they are refused or cut off.
    let status = service.wait();
    let took = asked.elapsed();
    load.serve_at(None);
    assert!(status.success(), "{status}: {}", program.log());
    assert!(took < Duration::from_secs(DRAIN_S + 5), "the shutdown took {took:?}");
    let mut rest = String::new();
    stream.read_to_string(&mut rest).expect("the stream ends");
    let service = program.start();
    let kept = service.get(&points)["n_solved"].as_u64().expect("a number");
    assert!(kept >= 20, "{kept} points were kept");
    load.serve_at(Some(service.address));
    let answers = load.stop();
    let job = service.ended(&sweep);
    assert_eq!((job["state"].as_str(), job["attempt"].as_i64()), (Some("succeeded"), Some(2)), "{job}");
    let result = service.get(&format!("{sweep}/result"));
    assert_eq!(result["numerics"]["reused"], json!(["points"]));
    assert_eq!(result["sweep"]["points"].as_array().map(Vec::len), Some(POINTS as usize));
    let deadline = Instant::now() + PATIENCE;
    while service.get("/api/v1/jobs?state=queued,running&limit=1")["items"] != json!([]) {
        assert!(Instant::now() < deadline, "jobs do not end: {}", service.get("/api/v1/system"));
        std::thread::sleep(Duration::from_millis(50));
    }
    assert!(service.end().0.success());
    let findings = audit(program.database(), &answers.accepted);
    println!(
        "ended {:.2} s after SIGTERM; {} answers 202, {:?}, sweep went on with {kept} of {POINTS} points",
        took.as_secs_f64(),
        answers.accepted.ids.len(),
        findings.states
    );
    assert_eq!(findings.broken, [""; 0]);
    assert_eq!(answers.unexpected, [""; 0]);
    assert!(!program.log().contains("panicked"));
}
