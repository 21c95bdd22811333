//! Calculations that go wrong or are not wanted any more concern their own job only.

use crate::documents;
use crate::program::Program;
use rstest::rstest;
use serde_json::{Value, json};

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
