//! Calculations that go wrong or are not wanted any more concern their own job only.

use crate::documents;
use crate::program::Program;
use rstest::rstest;
use serde_json::{Value, json};
use std::time::{Duration, Instant};

#[test]
fn a_motion_that_diverges_fails_its_own_job_only() {
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path());
    let service = program.start();
    let mut diverging = documents::integration(300);
    diverging["analysis"]["initial_state"] = json!(vec![1e6; 24]);
    let others: Vec<_> = (0..4).map(|_| service.submit(&documents::response())).collect();
    let job = service.ended(&service.submit(&diverging));
    assert_eq!((job["state"].as_str(), job["error"]["code"].as_str()), (Some("failed"), Some("diverged")), "{job}");
    assert!(job["error"]["sim_time_s"].as_f64() > Some(0.0), "{job}");
    for path in &others {
        assert_eq!(service.ended(path)["state"], "succeeded");
    }
    assert!(service.end().0.success());
    assert!(!program.log().contains("panicked"));
}

#[rstest]
#[case::finite_elements(documents::elements(), "mesh")]
#[case::contact(documents::contact(), "mesh")]
#[case::a_million_periods(documents::integration(1_000_000), "response")]
#[case::sweep(documents::sweep(100_000), "sweep")]
fn a_running_job_of_each_stage_is_canceled(#[case] document: Value, #[case] stage: &str) {
    let directory = tempfile::tempdir().expect("a directory");
    let service = Program::at(directory.path()).start();
    let path = service.submit(&document);
    let running = service.until(&path, |answer| {
        let job = answer.json();
        assert!(!crate::program::is_ended(&job), "ended before it could be canceled: {job}");
        job["stage"] == stage
    });
    assert_eq!(running.json()["state"], "running");
    let asked = service.send("POST", &format!("{path}/cancel"), "");
    assert_eq!(asked.status, 202, "{}", asked.text);
    service.in_state(&path, "canceled");
    // The worker is free again.
    assert_eq!(service.ended(&service.submit(&documents::response()))["state"], "succeeded");
}

const LIMIT_S: u64 = 5;
const DRAIN_S: u64 = 10;
/// Far more than a stop takes, far less than one position of the mesh.
const PROMPT: Duration = Duration::from_secs(10);

/// Jobs whose single positions take longer than all the limits: too large ones are refused for the memory that they
/// would take; those that fill all workers keep the time limit, obey a cancellation and a shutdown, and let others have
/// their turn.
#[test]
fn contact_over_hundreds_of_pitches_keeps_every_limit() {
    let directory = tempfile::tempdir().expect("a directory");
    let unlimited = Program::at(directory.path()).with(&["--job-memory-mib", "1024", "--workers", "2"]);
    let unlimited = unlimited.with(&["--drain-s", &DRAIN_S.to_string()]);
    let limited = unlimited.clone().with(&["--job-time-limit-s", &LIMIT_S.to_string()]);
    let service = limited.start();
    for face_width_mm in [500.0, 2000.0] {
        let document = documents::wide_contact(face_width_mm).to_string();
        let refused = service.send("POST", "/api/v1/jobs", &document);
        assert_eq!(refused.status, 422, "{}", refused.text);
        let violation = &refused.json()["errors"][0];
        assert_eq!(violation["pointer"], "/design/face_width_mm", "{}", refused.text);
        assert!(violation["detail"].as_str().is_some_and(|detail| detail.contains("MiB")), "{}", refused.text);
    }
    let wide_contact = || documents::wide_contact(150.0);
    // Nobody stops them, and another job waits behind them.
    let wide = [0, 1].map(|_| service.submit(&wide_contact()));
    let began = Instant::now();
    let waiting = service.submit(&documents::response());
    for path in &wide {
        let job = service.ended(path);
        assert_eq!(
            (job["state"].as_str(), job["error"]["code"].as_str()),
            (Some("failed"), Some("time-limit")),
            "{job}"
        );
    }
    let ran = began.elapsed();
    assert!(ran < Duration::from_secs(LIMIT_S) + PROMPT, "both ran for {ran:?}");
    assert_eq!(service.ended(&waiting)["state"], "succeeded");
    assert!(service.end().0.success());
    let service = unlimited.start();
    let running = || {
        let paths = [0, 1].map(|_| service.submit(&wide_contact()));
        for path in &paths {
            service.until(path, |answer| answer.json()["stage"] == "mesh");
        }
        paths
    };
    // Canceled.
    let wide = running();
    let asked = Instant::now();
    for path in &wide {
        assert_eq!(service.send("POST", &format!("{path}/cancel"), "").status, 202);
    }
    for path in &wide {
        service.in_state(path, "canceled");
    }
    assert!(asked.elapsed() < PROMPT, "canceled after {:?}", asked.elapsed());
    // Shut down.
    let wide = running();
    let (status, took) = service.end();
    assert!(status.success(), "{status}: {}", limited.log());
    assert!(took < Duration::from_secs(DRAIN_S), "the shutdown took {took:?}");
    let service = limited.start();
    for path in &wide {
        let job = service.ended(path);
        // Begun again from the start, and stopped by the time limit.
        assert_eq!((job["error"]["code"].as_str(), job["attempt"].as_i64()), (Some("time-limit"), Some(2)), "{job}");
    }
}
