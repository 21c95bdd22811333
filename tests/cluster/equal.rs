//! Results of workers are those of a single process, byte for byte.

use crate::documents;
use crate::program::Program;
use crate::setting::{Setting, outcome, slow_sweep};
use serde_json::{Value, json};

/// Sweeps without and with continuation, with a second axis, and jobs of one operating point with series.
fn all_documents() -> Vec<Value> {
    let mut plane = slow_sweep(12);
    plane["axes"]
        .as_array_mut()
        .expect("axes")
        .push(json!({"pointer": "/operation/pinion_torque_nm", "from": 500.0, "to": 1500.0, "points": 4}));
    let mut followed = plane.clone();
    followed["continuation"] = json!("both");
    // A scout has eight points: this one is all scout, and its axis runs downwards.
    let mut short = documents::sweep(5);
    short["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "values": [5000.0, 1000.0, 3000.0]}]);
    let mut impossible = documents::sweep(40);
    impossible["axes"] = json!([{"pointer": "/design/face_width_mm", "from": 5.0, "to": 400.0, "points": 40}]);
    let mut recorded = documents::integration(400);
    recorded["analysis"]["channels"] = json!(["a_x_left", "f_n_left"]);
    recorded["analysis"]["record_mesh_periods"] = json!(300);
    recorded["analysis"]["samples_per_mesh_period"] = json!(512);
    let mut contact = documents::mesh();
    contact["model"]["mesh_stiffness"] = json!({"source": "ltca"});
    vec![
        plane,
        followed,
        short,
        documents::sweep(300),
        impossible,
        recorded,
        documents::mesh(),
        contact,
        study("jansen"),
        study("morris"),
    ]
}

/// A tolerance study at two operating points.
fn study(sensitivity: &str) -> Value {
    let mut document = documents::response();
    document["kind"] = json!("tolerance");
    document["operating_points"] = json!([{"pinion_torque_nm": 400.0}, {"pinion_torque_nm": 800.0}]);
    document["tolerances"] = json!([
        {"pointer": "/operation/pinion_speed_rpm", "distribution": "normal", "tolerance": 100.0},
        {"pointer": "/model/mesh_damping_ratio", "distribution": "uniform", "plus": 0.05},
    ]);
    document["measures"] = json!([{"measure": "/response/rms/mesh_circumferential_acceleration_m_s2"}]);
    document["sensitivity"] = json!(sensitivity);
    if sensitivity != "morris" {
        document["samples"] = json!(64);
    }
    document["analysis"] = json!({"method": "integrate", "mesh_periods": 200, "record_mesh_periods": 20});
    document
}

#[test]
fn results_of_workers_are_those_of_one_process() {
    let Some(setting) = Setting::new(&[]) else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let alone = Program::at(folder.path()).start();
    let service = setting.program.start();
    let _workers = [setting.worker(), setting.worker()];
    let documents = all_documents();
    let jobs: Vec<[String; 2]> =
        documents.iter().map(|document| [&alone, &service].map(|service| service.submit(document))).collect();
    for [path_alone, path] in &jobs {
        let (expected, job) = (alone.ended(path_alone), service.ended(path));
        assert_eq!((&job["state"], &job["attempt"]), (&expected["state"], &json!(1)), "{job}");
        assert_eq!(outcome(&service, path), outcome(&alone, path_alone), "{job}");
        let series = service.get(&format!("{path}/series"));
        for channel in series["items"].as_array().or_else(|| series.as_array()).into_iter().flatten() {
            let name = channel["channel"].as_str().or_else(|| channel["name"].as_str()).expect("a name");
            let samples = |service: &crate::program::Service, path: &str| {
                service.send("GET", &format!("{path}/series/{name}?method=none"), "").text
            };
            assert_eq!(samples(&service, path), samples(&alone, path_alone), "{name}");
        }
    }
    let paths: Vec<&str> = jobs.iter().map(|[_, path]| path.as_str()).collect();
    let findings = setting.audit(service, &paths);
    assert_eq!((findings.states["succeeded"], findings.restarted), (documents.len(), 0));
    // The workers computed: the service has no workers of its own.
    assert!(findings.points > 400, "{findings:?}");
}
