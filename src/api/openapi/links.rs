//! OpenAPI links: values of a response that are parameters of further requests.

use serde_json::{Value, json};

/// Operations whose response is one job.
const RETURN_JOB: [&str; 4] = ["submit_job", "read_job", "update_job", "cancel_job"];

/// Operations with the id of a job as their parameter.
const TAKE_JOB_ID: [&str; 10] = [
    "read_job",
    "update_job",
    "watch_job",
    "cancel_job",
    "read_input",
    "read_gear_data",
    "read_result",
    "list_series",
    "list_points",
    "delete_job",
];

/// Adds the links of an operation's responses.
pub(super) fn add(operation: &mut Value) {
    let source = operation["operationId"].as_str().unwrap_or_default().to_owned();
    let mut links: Vec<(&str, Value)> = Vec::new();
    if RETURN_JOB.contains(&source.as_str()) {
        links.extend(TAKE_JOB_ID.map(|target| (target, json!({"id": "$response.body#/id"}))));
    }
    match source.as_str() {
        "list_jobs" => {
            links.push(("read_job", json!({"id": "$response.body#/items/0/id"})));
            links.push(("list_jobs", json!({"cursor": "$response.body#/next_cursor"})));
        }
        "list_series" => {
            let parameters = json!({"id": "$request.path.id", "channel": "$response.body#/items/0/name"});
            links.push(("read_series", parameters));
        }
        _ => {}
    }
    let Some(responses) = operation["responses"].as_object_mut() else { return };
    for (_, response) in responses.iter_mut().filter(|(status, _)| ["200", "202"].contains(&status.as_str())) {
        for (target, parameters) in &links {
            response["links"][*target] = json!({"operationId": target, "parameters": parameters});
        }
    }
}
