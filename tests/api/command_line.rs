//! The command line solves a document as the service does.

use crate::support::Service;
use serde_json::{Value, json};
use std::io::Write;
use std::process::{Command, Stdio};

fn example(name: &str) -> Value {
    let path = format!("{}/examples/{name}", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("an example")).expect("JSON")
}

/// The result that `herringbone solve` prints.
fn solved(document: &Value) -> Value {
    let mut process = Command::new(env!("CARGO_BIN_EXE_herringbone"))
        .args(["solve", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    process.stdin.take().expect("input").write_all(document.to_string().as_bytes()).expect("written");
    serde_json::from_slice(&process.wait_with_output().expect("it ends").stdout).expect("JSON")
}

#[test]
fn a_document_has_one_result() {
    let mut few_channels = example("given_stiffness.json");
    few_channels["analysis"]["channels"] = json!(["a_x_left", "y_p_left"]);
    let mut mesh = example("tip_relief.json");
    mesh["kind"] = json!("mesh");
    let mut sweep = example("given_stiffness.json");
    sweep["kind"] = json!("sweep");
    sweep["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "values": [1000.0, 1500.0, 2000.0]}]);
    sweep["continuation"] = json!("both");
    sweep["record"] = json!(["poincare", "spectrum"]);
    let directory = tempfile::tempdir().expect("a directory");
    let service = Service::start(directory.path());
    let mut channels = Vec::new();
    for document in [example("given_stiffness.json"), few_channels, example("assembly_errors.json"), mesh, sweep] {
        let path = service.submit(&document);
        let job = service.until(&path, |job| !job["ended_at"].is_null());
        assert_eq!(job["state"], "succeeded", "{job}");
        let mut of_service = service.request("GET", &format!("{path}/result"), "");
        let mut of_command = solved(&document);
        for result in [&mut of_service, &mut of_command] {
            assert!(result["numerics"]["wall_ms"].take().is_object());
        }
        let names = |result: &Value| -> Vec<String> {
            let channels = result.pointer("/response/rms/channels").and_then(Value::as_object);
            channels.map(|channels| channels.keys().cloned().collect()).unwrap_or_default()
        };
        assert_eq!(names(&of_command), names(&of_service));
        assert!(of_command == of_service, "{}", differences(&of_command, &of_service, ""));
        channels.push(names(&of_service).len());
    }
    assert!(channels[0] > channels[1] && channels[1] > 0, "{channels:?}");
}

/// The pointers of values that differ.
fn differences(a: &Value, b: &Value, pointer: &str) -> String {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) if a.keys().eq(b.keys()) => {
            a.iter().map(|(key, value)| differences(value, &b[key], &format!("{pointer}/{key}"))).collect()
        }
        _ if a == b => String::new(),
        _ => format!("{pointer}\n"),
    }
}
