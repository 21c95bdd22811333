//! Optimisations and tolerance studies: rows while they run, results, CSV, documents of rows, restarts.

use crate::support::*;
use serde_json::{Value, json};

/// The example with a given stiffness: an evaluation takes a fraction of a millisecond.
fn base() -> Value {
    let text = include_str!("../../examples/given_stiffness.json");
    let mut document: Value = serde_json::from_str(text).expect("JSON");
    document["model"] = json!({
        "mesh_stiffness": {"source": "given", "mean_n_per_um": 900.0, "harmonics": [{"amplitude": 0.1}]},
        "impact": {"source": "none"},
    });
    document["analysis"] = json!({"accuracy": 1e-3});
    document
}

fn search(evaluations: u32) -> Value {
    let mut document = base();
    document["kind"] = json!("optimise");
    document["operating_points"] = json!([{"pinion_torque_nm": 400.0}, {"pinion_torque_nm": 800.0}]);
    document["variables"] = json!([
        {"pointer": "/operation/pinion_speed_rpm", "from": 1500.0, "to": 4000.0, "step": 10.0},
        {"pointer": "/model/mesh_damping_ratio", "from": 0.02, "to": 0.1},
        {"pointer": "/design/supports/pinion_lateral_n_per_um", "from": 200.0, "to": 900.0},
        {"pointer": "/design/supports/gear_lateral_n_per_um", "from": 200.0, "to": 900.0},
    ]);
    document["objectives"] = json!([{"measure": "/response/rms/mesh_circumferential_acceleration_m_s2"}]);
    document["budget"] = json!({"evaluations": evaluations, "accuracy": 1e-9});
    document
}

fn study() -> Value {
    let mut document = base();
    document["kind"] = json!("tolerance");
    document["tolerances"] = json!([{"pointer": "/operation/pinion_torque_nm", "tolerance": 20.0}]);
    document["measures"] = json!([{"measure": "/response/rms/mesh_circumferential_acceleration_m_s2"}]);
    document["samples"] = json!(64);
    document
}

fn is_ended(job: &Value) -> bool {
    ["succeeded", "failed", "canceled"].iter().any(|state| job["state"] == *state)
}

/// The rows as they are answered.
fn rows(service: &Service, path: &str) -> Vec<String> {
    let answer = service.request("GET", &format!("{path}/points?limit=10000"), "");
    answer["items"].as_array().expect("rows").iter().map(|item| item["point"].to_string()).collect()
}

#[test]
fn rows_results_csv_and_documents_of_rows() {
    let directory = tempfile::tempdir().expect("temporary directory");
    let service = Service::start(directory.path());
    let checked = service.request("POST", "/api/v1/jobs/validate", &search(120).to_string());
    assert!(checked["estimate"]["points"].as_u64() > Some(240), "{checked}");
    let path = service.submit(&search(120));
    let job = service.until(&path, is_ended);
    assert_eq!((job["state"].as_str(), job["kind"].as_str()), (Some("succeeded"), Some("optimise")), "{job}");
    let result = service.request("GET", &format!("{path}/result"), "");
    let optimise = &result["optimise"];
    assert_eq!(optimise["verdict"], "improved");
    let points = optimise["points"].as_array().expect("rows");
    assert!(points.len() > 100 && optimise["numerics"]["evaluations"] == points.len());
    assert_eq!(rows(&service, &path), points.iter().map(Value::to_string).collect::<Vec<_>>());
    let (_, csv) = service.exchange("GET", &format!("{path}/points"), &[("accept", "text/csv")], "");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!(lines.len(), points.len() + 1);
    assert!(lines[0].contains("/operation/pinion_speed_rpm") && lines[0].contains("objective_1"), "{}", lines[0]);
    assert!(lines.iter().all(|line| line.split(',').count() == lines[0].split(',').count()));
    let columns = service.request("GET", &format!("{path}/points/columns?names=violation,objectives,phase"), "");
    assert_eq!(columns["columns"]["phase"][0], "input");
    assert_eq!(columns["n_points"], points.len());
    // The document of the best row leads to its numbers.
    let position = &optimise["best"]["position"];
    let document = service.request("GET", &format!("{path}/points/{position}/input"), "");
    assert_eq!(
        (document["kind"].as_str(), document["operation"]["pinion_torque_nm"].as_f64()),
        (Some("response"), Some(400.0))
    );
    let alone = service.submit(&document);
    service.until(&alone, is_ended);
    let alone = service.request("GET", &format!("{alone}/result"), "");
    let rms = &alone["response"]["rms"]["mesh_circumferential_acceleration_m_s2"];
    let larger = rms["left"].as_f64().unwrap().max(rms["right"].as_f64().unwrap());
    assert_eq!(points[position.as_u64().unwrap() as usize]["measures"][0].as_f64(), Some(larger));
    // The same document again: the result is there, with its rows.
    let again = service.submit(&search(120));
    let job = service.until(&again, is_ended);
    assert!(job["reused_from"].is_string(), "{job}");
    assert_eq!(rows(&service, &again).len(), points.len());

    let path = service.submit(&study());
    assert_eq!(service.until(&path, is_ended)["state"], "succeeded");
    let result = service.request("GET", &format!("{path}/result"), "");
    let measure = &result["tolerance"]["measures"][0];
    assert!(measure["percentiles"]["p90"]["value"].as_f64() > measure["percentiles"]["p50"]["value"].as_f64());
    assert_eq!(result["tolerance"]["points"].as_array().map(Vec::len), Some(65));
}

#[test]
fn what_is_wrong_is_refused_with_its_pointer() {
    let directory = tempfile::tempdir().expect("temporary directory");
    let service = Service::start(directory.path());
    let mut document = search(100);
    document["variables"][0]["pointer"] = json!("/operation/pinion_speed");
    document["objectives"][0]["measure"] = json!("/response/loudness");
    let problem = service.request("POST", "/api/v1/jobs", &document.to_string());
    let pointers: Vec<&str> =
        problem["errors"].as_array().expect("errors").iter().filter_map(|error| error["pointer"].as_str()).collect();
    assert_eq!(pointers, ["/variables/0/pointer", "/objectives/0/measure"], "{problem}");
}

#[test]
fn a_killed_search_goes_on_to_the_bit_and_a_canceled_one_stops() {
    let directory = tempfile::tempdir().expect("temporary directory");
    let document = search(3000);
    let service = Service::start(directory.path());
    let path = service.submit(&document);
    service.until(&path, |job| job["progress"].as_f64() > Some(0.1));
    drop(service);
    let service = Service::start(directory.path());
    let stored = rows(&service, &path).len();
    let job = service.until(&path, is_ended);
    assert_eq!((job["state"].as_str(), job["attempt"].as_i64()), (Some("succeeded"), Some(2)), "{job}");
    let resumed = rows(&service, &path);
    assert!(stored > 50 && stored < resumed.len(), "{stored} of {}", resumed.len());
    // The whole search in one go, elsewhere.
    let other = tempfile::tempdir().expect("temporary directory");
    let undisturbed = Service::start(other.path());
    let whole = undisturbed.submit(&document);
    assert_eq!(undisturbed.until(&whole, is_ended)["state"], "succeeded");
    assert!(rows(&undisturbed, &whole) == resumed);
    let path = undisturbed.submit(&search(100_000));
    undisturbed.until(&path, |job| job["progress"].as_f64() > Some(0.001));
    undisturbed.request("POST", &format!("{path}/cancel"), "");
    assert_eq!(undisturbed.until(&path, is_ended)["state"], "canceled");
}
