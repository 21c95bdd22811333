//! Optimisations with workers: the search runs in the service, and workers make its evaluations.

use crate::documents;
use crate::program::{Program, Service};
use crate::setting::{Setting, number, outcome, wait_for_rows, wait_until};
use serde_json::{Value, json};

/// Two variables, an objective relative to the input over two torques, and tolerances: evaluations of some ten
/// milliseconds, of all settings that there are.
fn search(evaluations: u32) -> Value {
    let mut document = documents::response();
    document["kind"] = json!("optimise");
    document["operating_points"] = json!([{"pinion_torque_nm": 400.0}, {"pinion_torque_nm": 800.0}]);
    document["variables"] = json!([
        {"pointer": "/model/mesh_damping_ratio", "from": 0.02, "to": 0.1},
        {"pointer": "/design/supports/pinion_lateral_n_per_um", "from": 300.0, "to": 900.0},
    ]);
    document["objectives"] = json!([{
        "measure": "/response/rms/mesh_circumferential_acceleration_m_s2", "over": "worst", "relative_to": "input",
    }]);
    document["constraints"] = json!([{"measure": "/geometry/total_contact_ratio", "at_least": 1.5}]);
    document["tolerances"] = json!([
        {"pointer": "/operation/pinion_speed_rpm", "distribution": "normal", "tolerance": 60.0},
    ]);
    document["robust"] = json!({"samples": 16, "confirm_samples": 16, "candidates": 3});
    document["budget"] = json!({"evaluations": evaluations});
    document["analysis"] = json!({"method": "integrate", "mesh_periods": 1000, "record_mesh_periods": 20});
    document
}

/// The outcome of a process without workers.
fn alone(document: &Value) -> (Value, Value) {
    let folder = tempfile::tempdir().expect("a folder");
    let service = Program::at(folder.path()).start();
    let path = service.submit(document);
    assert_eq!(service.ended(&path)["state"], "succeeded");
    outcome_and_rows(&service, &path)
}

fn outcome_and_rows(service: &Service, path: &str) -> (Value, Value) {
    (outcome(service, path).0, service.get(&format!("{path}/points?limit=10000")))
}

/// Waits until the service knows so many workers.
fn wait_for_workers(service: &Service, count: usize) {
    service
        .until("/api/v1/system", |answer| answer.json()["machines"].as_array().is_some_and(|all| all.len() == count));
}

fn chunks(setting: &Setting) -> i64 {
    number(setting.program.database(), "SELECT COUNT(*) FROM chunks WHERE json_extract(part, '$.kind') = 'evaluations'")
}

#[test]
fn workers_make_the_evaluations_and_one_that_is_killed_is_replaced() {
    let Some(setting) = Setting::new(&[]) else { return };
    let document = search(60);
    let expected = alone(&document);
    let service = setting.program.start();
    let (first, second) = (setting.worker(), setting.worker());
    wait_for_workers(&service, 2);
    let path = service.submit(&document);
    wait_until("both compute", || {
        [&first, &second].iter().all(|worker| worker.log().matches("chunk computed").count() > 2)
    });
    first.kill();
    let job = service.ended(&path);
    assert_eq!((&job["state"], &job["attempt"]), (&json!("succeeded"), &json!(1)), "{job}");
    assert_eq!(outcome_and_rows(&service, &path), expected);
    assert!(second.log().matches("chunk computed").count() > 5);
    setting.audit(service, &[&path]);
}

#[test]
fn a_search_goes_on_after_the_service_has_died() {
    let Some(setting) = Setting::new(&[]) else { return };
    let document = search(60);
    let expected = alone(&document);
    let service = setting.program.start();
    let _worker = setting.worker();
    wait_for_workers(&service, 1);
    let path = service.submit(&document);
    wait_for_rows(&setting, 30);
    assert!(chunks(&setting) > 0);
    service.kill();
    let service = setting.program.start();
    let job = service.ended(&path);
    assert_eq!((&job["state"], &job["attempt"]), (&json!("succeeded"), &json!(2)), "{job}");
    let (mut result, rows) = outcome_and_rows(&service, &path);
    // Says that rows of an earlier attempt were taken.
    assert_eq!(result["numerics"]["reused"], json!(["points"]));
    result["numerics"]["reused"] = expected.0["numerics"]["reused"].clone();
    assert_eq!((result, rows), expected);
    setting.audit(service, &[&path]);
}

#[test]
fn a_canceled_search_and_one_without_workers_end() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let worker = setting.worker();
    wait_for_workers(&service, 1);
    let mut endless = search(5000);
    endless["analysis"]["mesh_periods"] = json!(20_000);
    let path = service.submit(&endless);
    wait_until("it computes", || worker.log().contains("chunk computed"));
    assert_eq!(service.send("POST", &format!("{path}/cancel"), "").status, 202);
    assert_eq!(service.ended(&path)["state"], "canceled");
    // The last worker leaves in the middle of a batch: the service goes on by itself.
    let document = search(40);
    let next = service.submit(&document);
    wait_until("its chunks are taken", || chunks(&setting) > 2);
    assert!(worker.end().success());
    assert_eq!(service.ended(&next)["state"], "succeeded");
    assert_eq!(outcome_and_rows(&service, &next), alone(&document));
    setting.audit(service, &[&path, &next]);
}
