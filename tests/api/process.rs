//! The real program as a process of its own, killed in the middle of a job.

use crate::support::Service;
use serde_json::{Value, json};

#[test]
fn a_job_outlives_the_process_that_was_killed() {
    let directory = tempfile::tempdir().expect("temporary directory");
    let mut sweep: Value = serde_json::from_str(include_str!("../../examples/speed_sweep.json")).expect("JSON");
    sweep["axes"][0]["points"] = json!(100_000);
    let service = Service::start(directory.path());
    let path = service.submit(&sweep);
    service.running(&path, 1);
    drop(service);
    let service = Service::start(directory.path());
    service.running(&path, 2);
    let asked = service.request("POST", &format!("{path}/cancel"), "");
    assert!(asked["cancel_requested_at"].is_string(), "{asked}");
    service.until(&path, |job| job["state"] == "canceled");
}
