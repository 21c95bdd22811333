//! Parts of responses that endpoints have in common.

use crate::api::config::MAX_REQUEST_ID_CHARS;
use crate::api::parquet;
use crate::api::problem::CODES;
use serde_json::{Value, json};

/// Responses of every endpoint.
const COMMON: [(&str, &str); 3] = [
    ("408", "The request took too long (`request-timeout`)."),
    ("413", "The body is larger than 1 MiB (`payload-too-large`)."),
    ("500", "The service failed (`internal`)."),
];

/// Responses of access control, on every endpoint but the probes.
const GUARDS: [(&str, &str); 4] = [
    ("401", "The service has a token, and the request shows neither it nor a session (`unauthenticated`)."),
    ("403", "A page of another site made a browser send the request (`cross-origin`)."),
    ("421", "The header Host names another host (`misdirected-request`)."),
    ("429", "Wrong tokens come too fast (`too-many-attempts`)."),
];

/// Endpoints without access control.
const PROBES: [&str; 2] = ["/healthz", "/readyz"];

/// Response of every endpoint under `/api/v1`.
const NOT_ACCEPTABLE: (&str, &str) = ("406", "No representation fits the header Accept (`not-acceptable`).");

/// Response of every endpoint that uses the database.
const STORED: (&str, &str) = ("503", "The database cannot be used for now (`storage-unavailable`).");

/// Endpoints that do not use the database.
const WITHOUT_DATABASE: [&str; 6] =
    ["/api/v1/kinds", "/api/v1/jobs/validate", "/api/v1/import", "/healthz", "/metrics", "/problems/{code}"];

/// Statuses of responses that may have the header `Retry-After`.
const RETRIED: [&str; 3] = ["409", "429", "503"];

/// Adds headers, the schemas of events and the security scheme to the components.
pub(super) fn add_components(description: &mut Value) {
    // A service without a token requires none.
    description["security"] = json!([{}, {"token": []}]);
    let components = &mut description["components"];
    components["headers"]["RequestId"] = json!({
        "description": "Names the request in the log.",
        "required": true,
        "schema": {"type": "string", "minLength": 1, "maxLength": MAX_REQUEST_ID_CHARS},
    });
    components["headers"]["Credentials"] = json!({
        "description": "How credentials are shown: `Bearer`.",
        "required": true,
        "schema": {"type": "string"},
    });
    components["headers"]["RetryAfter"] = json!({
        "description": "Seconds after which to try again.",
        "schema": {"type": "integer", "minimum": 0},
    });
    components["securitySchemes"]["token"] = json!({
        "type": "http", "scheme": "bearer", "description": "The token of a service that was started with one.",
    });
    // The form in which OpenAPI 3.2 describes one event of a stream.
    components["schemas"]["JobsEvent"] = json!({
        "type": "object",
        "description": "One server-sent event about any job.",
        "required": ["event", "data"],
        "properties": {
            "event": {"type": "string", "enum": ["reload", "state", "progress", "done", "deleted"]},
            "data": {
                "type": "string",
                "contentMediaType": "application/json",
                "contentSchema": {"anyOf": [
                    {"$ref": "#/components/schemas/Job"},
                    {"$ref": "#/components/schemas/DeletedJob"},
                    {"type": "object", "description": "Of `reload`: empty.", "additionalProperties": false},
                ]},
            },
        },
    });
    components["schemas"]["DeletedJob"] = json!({
        "type": "object",
        "description": "Of `deleted`: which job is gone.",
        "required": ["id"],
        "properties": {"id": {"type": "string", "format": "uuid"}},
        "additionalProperties": false,
    });
    components["schemas"]["JobEvent"] = json!({
        "type": "object",
        "description": "One server-sent event about a job.",
        "required": ["event", "id", "data"],
        "properties": {
            "event": {"type": "string", "enum": ["state", "progress", "done"]},
            "id": {"type": "string", "pattern": "^[0-9]+$", "description": "The job's revision."},
            "data": {
                "type": "string",
                "contentMediaType": "application/json",
                "contentSchema": {"$ref": "#/components/schemas/Job"},
            },
        },
    });
}

/// Adds the common responses, the schema of errors and the headers to an operation.
pub(super) fn add_common(path: &str, operation: &mut Value) {
    if let Some(parameters) = operation.get_mut("parameters").and_then(Value::as_array_mut) {
        parameters.iter_mut().for_each(|parameter| simplify(&mut parameter["schema"]));
        // The codes are a closed list.
        for parameter in parameters.iter_mut().filter(|parameter| parameter["name"] == "code") {
            parameter["schema"]["enum"] = json!(CODES.iter().map(|entry| entry.name).collect::<Vec<_>>());
        }
    }
    let Some(responses) = operation["responses"].as_object_mut() else { return };
    let versioned = path.starts_with("/api/v1").then_some(NOT_ACCEPTABLE);
    let guards = GUARDS.into_iter().filter(|_| !PROBES.contains(&path));
    let stored = (!WITHOUT_DATABASE.contains(&path)).then_some(STORED);
    for (status, description) in COMMON.into_iter().chain(versioned).chain(stored).chain(guards) {
        responses.entry(status).or_insert_with(|| json!({"description": description}));
    }
    for (status, response) in responses {
        if let Some(headers) = response.get_mut("headers").and_then(Value::as_object_mut) {
            headers.values_mut().for_each(|header| simplify(&mut header["schema"]));
        }
        response["headers"]["X-Request-Id"] = json!({"$ref": "#/components/headers/RequestId"});
        if status.as_str() >= "400" {
            response["content"] =
                json!({"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}});
            if status == "401" {
                response["headers"]["WWW-Authenticate"] = json!({"$ref": "#/components/headers/Credentials"});
            }
            if RETRIED.contains(&status.as_str()) {
                response["headers"]["Retry-After"] = json!({"$ref": "#/components/headers/RetryAfter"});
            }
        }
        if let Some(stream) = response.pointer_mut("/content/text~1event-stream") {
            let name = if path == "/api/v1/jobs/events" { "JobsEvent" } else { "JobEvent" };
            stream["schema"] = json!({"$ref": format!("#/components/schemas/{name}")});
        }
    }
}

/// Simplifies the schema of a parameter or header: it may be absent but not null, and integers have no width.
fn simplify(schema: &mut Value) {
    let Some(schema) = schema.as_object_mut() else { return };
    if let Some(Value::Array(types)) = schema.get_mut("type") {
        types.retain(|name| name != "null");
        if let [name] = types.as_slice() {
            let name = name.clone();
            schema.insert("type".to_owned(), name);
        }
    }
    if schema.get("format").and_then(Value::as_str).is_some_and(|format| format.starts_with("int")) {
        schema.remove("format");
    }
}

/// Media types of files that are no text.
const BINARY: [&str; 5] = [
    "application/x-npz",
    "application/x-matlab-data",
    "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    "application/vnd.apache.parquet",
    "audio/wav",
];

/// Leaves out the form of answers that this program was built without: what is described is what it serves.
pub(super) fn leave_out_missing(operation: &mut Value) {
    if parquet::IS_BUILT {
        return;
    }
    if let Some(content) = operation.pointer_mut("/responses/200/content").and_then(Value::as_object_mut) {
        content.remove(parquet::MEDIA_TYPE);
    }
    // By index a missing member would come in as null.
    let parameters = operation.get_mut("parameters").and_then(Value::as_array_mut);
    for parameter in parameters.into_iter().flatten() {
        if let Some(Value::String(pattern)) = parameter.pointer_mut("/schema/pattern") {
            *pattern = pattern.replace(&format!("|{}", parquet::NAME), "");
        }
    }
}

/// Describes the bodies of responses that are files as such.
pub(super) fn set_binary(operation: &mut Value) {
    let Some(responses) = operation["responses"].as_object_mut() else { return };
    for response in responses.values_mut() {
        let Some(content) = response.get_mut("content").and_then(Value::as_object_mut) else { continue };
        for (_, body) in content.iter_mut().filter(|(media_type, _)| BINARY.contains(&media_type.as_str())) {
            body["schema"] = json!({"type": "string", "format": "binary"});
        }
    }
}
