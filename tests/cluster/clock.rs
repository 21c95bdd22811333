//! Workers whose clocks are wrong: no time of a worker decides anything. Needs libfaketime; without it the test says
//! that it is skipped.

use crate::documents;
use crate::program::Program;
use crate::setting::{Setting, outcome, slow_sweep, wait_for_rows};
use crate::worker::Worker;
use jiff::{SignedDuration, Timestamp};
use serde_json::json;
use std::path::Path;

/// Where Debian has the library, for both kinds of machines.
const LIBRARIES: [&str; 2] =
    ["/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1", "/usr/lib/aarch64-linux-gnu/faketime/libfaketime.so.1"];

/// A worker whose wall clock is off by so many seconds; its steady clock is right.
fn worker_off_by(setting: &Setting, library: &str, offset: &str) -> Worker {
    let variables = [
        ("LD_PRELOAD", library),
        ("FAKETIME", offset),
        ("FAKETIME_DONT_FAKE_MONOTONIC", "1"),
        ("DONT_FAKE_MONOTONIC", "1"),
    ];
    Worker::start_with(setting.folder(), &setting.nats.url(), &["--space", "test"], &variables)
}

/// How far the clock of a worker is ahead, by the first line of its log.
fn ahead(worker: &Worker) -> SignedDuration {
    let log = worker.log();
    let first = log.split_whitespace().next().expect("a line");
    first.parse::<Timestamp>().expect("a time").duration_since(Timestamp::now())
}

#[test]
fn a_clock_that_is_an_hour_off_has_no_effect() {
    let Some(library) = LIBRARIES.into_iter().find(|library| Path::new(library).is_file()) else {
        println!("skipped: no libfaketime here (scripts/prerequisites libfaketime)");
        return;
    };
    let Some(setting) = Setting::new(&[]) else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let alone = Program::at(folder.path()).start();
    let service = setting.program.start();
    let workers = [worker_off_by(&setting, library, "+3600"), worker_off_by(&setting, library, "-3600")];
    let documents = [slow_sweep(300), documents::integration(3000)];
    let jobs = documents.each_ref().map(|document| service.submit(document));
    wait_for_rows(&setting, 20);
    let machines = service.get("/api/v1/system")["machines"].clone();
    for machine in machines.as_array().expect("machines") {
        let last: Timestamp = machine["last_beat_at"].as_str().expect("a time").parse().expect("a time");
        assert!(Timestamp::now().duration_since(last).abs() < SignedDuration::from_secs(60), "{machine}");
        assert_eq!(machine["lost"], json!(false), "{machine}");
    }
    // One of them dies: its work is given to the other after the same wait.
    let [fast, slow] = workers;
    let offsets = [ahead(&fast), ahead(&slow)].map(|ahead| ahead.as_secs());
    assert!(offsets[0] > 3000 && offsets[1] < -3000, "the clocks are not off: {offsets:?}");
    fast.kill();
    for (path, document) in jobs.iter().zip(&documents) {
        let job = service.ended(path);
        assert_eq!((&job["state"], &job["attempt"]), (&json!("succeeded"), &json!(1)), "{job}");
        let expected = alone.submit(document);
        alone.ended(&expected);
        assert_eq!(outcome(&service, path), outcome(&alone, &expected));
    }
    let findings = setting.audit(service, &[&jobs[0], &jobs[1]]);
    assert_eq!((findings.points, findings.restarted), (300, 0));
}
