//! The log of the real program: every line of a request or a job says which, and none says what was in them.

use crate::support::{Service, document};
use serde_json::{Value, json};

const REQUEST: &str = "request-of-the-test";

/// A job that is solved in milliseconds, with a name that must not be logged.
fn job() -> Value {
    let mut document = document();
    document["kind"] = json!("mesh");
    document["name"] = json!("confidential gearbox");
    document["model"] = json!({"mesh_stiffness": {"source": "iso6336"}, "impact": {"source": "none"}});
    document
}

/// Submits a job and reads its result under a request id; the job's id and the log.
fn logged(arguments: &[&str]) -> (String, Vec<String>) {
    let directory = tempfile::tempdir().expect("temporary directory");
    let service = Service::start_with(directory.path(), arguments);
    let (status, body) = service.exchange("POST", "/api/v1/jobs", &[("x-request-id", REQUEST)], &job().to_string());
    assert_eq!(status, 202, "{body}");
    let job: Value = serde_json::from_str(&body).expect("JSON");
    let path = job["links"]["self"].as_str().expect("a path");
    service.until(path, |job| job["state"] == "succeeded");
    service.exchange("GET", "/api/v1/jobs/x", &[("authorization", "Bearer confidential-token")], "");
    (job["id"].as_str().expect("an id").to_owned(), service.stop())
}

#[test]
fn every_json_line_of_a_job_names_the_job_and_the_request() {
    let (id, lines) = logged(&["--log", "debug", "--log-json"]);
    let lines: Vec<Value> =
        lines.iter().map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"))).collect();
    let spans = |line: &Value| line["spans"].as_array().cloned().unwrap_or_default();
    let of_the_job: Vec<_> =
        lines.iter().filter(|line| spans(line).iter().any(|span| span["name"] == "job" && span["job"] == id)).collect();
    assert!(of_the_job.len() >= 2, "{lines:#?}");
    for line in &of_the_job {
        let span = spans(line).into_iter().find(|span| span["name"] == "job").expect("the span");
        assert_eq!(
            (&span["request_id"], &span["kind"], &span["attempt"]),
            (&json!(REQUEST), &json!("mesh"), &json!(1))
        );
    }
    let said = |text: &str| of_the_job.iter().any(|line| line["message"] == text);
    assert!(said("job started") && said("job ended"), "{of_the_job:#?}");
    let of_the_request =
        lines.iter().find(|line| line["message"] == "request" && line["status"] == 202).expect("a line");
    let span = &spans(of_the_request)[0];
    assert_eq!(
        (&span["name"], &span["request_id"], &span["method"], &span["route"]),
        (&json!("request"), &json!(REQUEST), &json!("POST"), &json!("/api/v1/jobs"))
    );
}

#[test]
fn text_lines_name_them_too() {
    let (id, lines) = logged(&["--log", "info"]);
    let line = lines.iter().find(|line| line.contains("job ended")).unwrap_or_else(|| panic!("{lines:#?}"));
    assert!(line.contains(&id) && line.contains(REQUEST), "{line}");
}

#[test]
fn nothing_confidential_is_logged() {
    for arguments in [&["--log", "trace"][..], &["--log", "trace", "--log-json"]] {
        let (_, lines) = logged(arguments);
        assert!(lines.len() > 10);
        // What libraries say at this level is theirs; ours says nothing of documents and credentials.
        let ours = lines.iter().filter(|line| line.contains("herringbone"));
        for line in ours {
            assert!(!line.contains("confidential") && !line.contains("normal_module_mm"), "{line}");
        }
    }
}
