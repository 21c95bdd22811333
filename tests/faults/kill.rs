//! kill −9: nothing that was accepted is lost or done twice, whenever the process dies.

use crate::audit::audit;
use crate::chance::{Chance, setting};
use crate::documents;
use crate::load::Load;
use crate::program::{PATIENCE, Program};
use serde_json::json;
use std::time::{Duration, Instant};

/// `FAULTS_SEED` and `FAULTS_KILLS` change the moments and their number.
#[test]
fn no_job_is_lost_or_done_twice_in_two_hundred_kills_under_load() {
    let (seed, kills) = (setting("FAULTS_SEED", 20_261_122), setting("FAULTS_KILLS", 200));
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path()).with(&["--max-losses", "100"]);
    let mut chance = Chance::new(seed);
    let load = Load::start(4, seed, Duration::from_millis(20));
    let began = Instant::now();
    for kill in 0..kills {
        let service = program.start();
        load.serve_at(Some(service.address));
        // Mostly before a sweep writes its points for the first time, now and then after it.
        let alive_ms = if kill % 10 == 9 { 300 + chance.below(400) } else { chance.below(150) };
        std::thread::sleep(Duration::from_millis(alive_ms));
        service.kill();
        load.serve_at(None);
    }
    let killing_s = began.elapsed().as_secs_f64();
    let service = program.start();
    load.serve_at(Some(service.address));
    let answers = load.stop();
    let deadline = Instant::now() + PATIENCE;
    while service.get("/api/v1/jobs?state=queued,running&limit=1")["items"] != json!([]) {
        assert!(Instant::now() < deadline, "jobs do not end: {}", service.get("/api/v1/system"));
        std::thread::sleep(Duration::from_millis(50));
    }
    let drained_s = began.elapsed().as_secs_f64() - killing_s;
    for id in answers.accepted.ids.iter().step_by(7) {
        let job = service.get(&format!("/api/v1/jobs/{id}"));
        assert!(crate::program::is_ended(&job), "{job}");
    }
    assert!(service.end().0.success());
    let findings = audit(program.database(), &answers.accepted);
    println!(
        "seed {seed}: {kills} kills in {killing_s:.0} s, all ended {drained_s:.0} s later; answers 202: {}, jobs: {:?}, started more \
         than once: {}, sweeps gone on with: {}, points: {}; connections broken: {}, sent again under a key: {}, canceled: {}, 503: {}",
        answers.accepted.ids.len(),
        findings.states,
        findings.restarted,
        findings.resumed_sweeps,
        findings.points,
        answers.broken_connections,
        answers.sent_again,
        answers.canceled,
        answers.refused,
    );
    assert_eq!(findings.broken, [""; 0], "seed {seed}");
    assert_eq!(answers.unexpected, [""; 0], "seed {seed}");
    // The kills met what they were meant to meet.
    assert!(
        findings.restarted > 0 && answers.sent_again > 0 && answers.accepted.ids.len() as u64 > kills,
        "{findings:?}"
    );
    assert!(!program.log().contains("panicked"), "{}", program.log());
}

#[test]
fn a_job_whose_process_dies_again_and_again_is_given_up() {
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path()).with(&["--max-losses", "2"]);
    let mut service = program.start();
    let path = service.submit(&documents::integration(10_000_000));
    for attempt in 1..=2 {
        service.until(&path, |job| job.json()["state"] == "running" && job.json()["attempt"] == attempt);
        service.kill();
        service = program.start();
    }
    let job = service.get(&path);
    assert_eq!((job["state"].as_str(), job["error"]["code"].as_str()), (Some("failed"), Some("worker-lost")), "{job}");
    // Whoever comes after is served.
    assert_eq!(service.ended(&service.submit(&documents::response()))["state"], "succeeded");
}
