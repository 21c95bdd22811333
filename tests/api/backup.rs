//! A backup of the real program while it takes and solves jobs, and serving from the copy.

use crate::support::{Service, document};
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

fn backup(database: &Path, target: &Path, more: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_herringbone"))
        .args(["backup", "--database"])
        .args([database, target])
        .args(more)
        .output()
        .expect("the program runs")
}

/// A job that is solved in milliseconds.
fn small_job() -> Value {
    let mut document = document();
    document["kind"] = json!("mesh");
    document["model"] = json!({"mesh_stiffness": {"source": "iso6336"}, "impact": {"source": "none"}});
    document
}

fn jobs(service: &Service) -> Vec<Value> {
    service.request("GET", "/api/v1/jobs?limit=200", "")["items"].as_array().expect("items").clone()
}

#[test]
fn a_backup_taken_at_work_is_whole_and_serves() {
    let (here, there) = (tempfile::tempdir().expect("a folder"), tempfile::tempdir().expect("a folder"));
    let (database, copy) = (here.path().join("jobs.db"), there.path().join("jobs.db"));
    let mut sweep: Value = serde_json::from_str(include_str!("../../examples/speed_sweep.json")).expect("JSON");
    sweep["axes"][0]["points"] = json!(100_000);
    let service = Service::start(here.path());
    let long = service.submit(&sweep);
    service.running(&long, 1);
    let first = service.submit(&small_job());
    service.until(&first, |job| job["state"] == "succeeded");
    // Jobs are taken and solved while the copies are made.
    let output = std::thread::scope(|scope| {
        let submitting = scope.spawn(|| (0..60).map(|_| service.submit(&small_job())).collect::<Vec<_>>());
        let mut output = backup(&database, &copy, &[]);
        while !submitting.is_finished() {
            output = backup(&database, &copy, &["--force"]);
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        }
        assert_eq!(submitting.join().expect("submits").len(), 60);
        output
    });
    let said = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(said.contains(" MB, ") && said.contains(" running"), "{said}");
    let again = backup(&database, &copy, &[]);
    assert_eq!(again.status.code(), Some(1), "a copy is not overwritten by chance");
    assert!(String::from_utf8_lossy(&again.stderr).contains("--force"));
    drop(service);

    let restored = Service::start(there.path());
    // The job that ran when the copy was made runs again.
    restored.running(&long, 2);
    let kept = jobs(&restored);
    assert!(kept.len() >= 2 && said.contains(&format!("{} jobs", kept.len())), "{said} {}", kept.len());
    for job in &kept {
        let path = job["links"]["self"].as_str().expect("a path");
        if path == long {
            continue;
        }
        // What had ended has its result, what waited is solved.
        restored.until(path, |job| job["state"] == "succeeded");
        let (status, result) = restored.exchange("GET", &format!("{path}/result"), &[], "");
        assert_eq!(status, 200, "{result}");
        assert!(serde_json::from_str::<Value>(&result).expect("JSON")["mesh"].is_object());
        assert_eq!(restored.exchange("GET", &format!("{path}/input"), &[], "").0, 200);
    }
    let unfinished: Vec<_> = std::fs::read_dir(there.path())
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().into_string().expect("UTF-8"))
        .filter(|name| name.contains("partial"))
        .collect();
    assert!(unfinished.is_empty(), "{unfinished:?}");
}
