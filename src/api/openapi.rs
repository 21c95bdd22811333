//! The description of the interface, generated from the endpoints.

use super::routes;
use super::state::AppState;
use crate::job::schema::job_document_schema;
use serde_json::{Value, json};
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;

/// What is said about the interface as a whole.
#[derive(OpenApi)]
#[openapi(
    info(
        title = "herringbone",
        description = "Contact, mesh-in impact and nonlinear vibration of double-helical gear pairs. Submit a job document, \
            wait for it, read its result and series. Every answer with a status of 400 or above is \
            `application/problem+json` in one schema; codes are explained under `/problems/{code}`.",
        license(name = "MIT OR Apache-2.0", identifier = "MIT OR Apache-2.0")
    ),
    components(schemas(super::problem::Problem)),
    tags(
        (name = "jobs", description = "Submit, follow, cancel and delete jobs"),
        (name = "results", description = "What succeeded jobs leave behind"),
        (name = "service", description = "What can be asked for, and the state of the service"),
        (name = "operation", description = "Health, metrics and the meaning of problem codes"),
    )
)]
struct Interface;

/// The endpoints with their descriptions.
pub(super) fn described_routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::with_openapi(Interface::openapi()).nest("/api/v1", routes::versioned()).merge(routes::operational())
}

/// What every endpoint under `/api/v1` may answer besides what it says itself.
const COMMON: [(&str, &str); 3] = [
    ("406", "No representation fits the header Accept (`not-acceptable`)."),
    ("408", "The request took too long (`request-timeout`)."),
    ("500", "The service failed (`internal`)."),
];

/// What every endpoint but the probes may answer before it is asked.
const GUARDS: [(&str, &str); 4] = [
    ("401", "The service has a token, and the request shows neither it nor a session (`unauthenticated`)."),
    ("403", "A page of another site made a browser send the request (`cross-origin`)."),
    ("421", "The header Host names another host (`misdirected-request`)."),
    ("429", "Wrong tokens come too fast (`too-many-attempts`); `Retry-After` says when to try again."),
];

/// The OpenAPI document as JSON text.
pub fn openapi_json() -> String {
    let (_, document) = described_routes().split_for_parts();
    let mut document = serde_json::to_value(document).unwrap_or_default();
    let schema = job_document_schema();
    document["components"]["schemas"]["JobDocument"] = schema;
    document["components"]["securitySchemes"]["token"] = json!({
        "type": "http", "scheme": "bearer", "description": "The token of a service that was started with one.",
    });
    document["security"] = json!([{}, {"token": []}]);
    if let Some(paths) = document["paths"].as_object_mut() {
        for (path, operations) in paths {
            let Some(operations) = operations.as_object_mut() else { continue };
            operations.values_mut().for_each(|operation| complete(path, operation));
        }
    }
    // Builds differ in whether maps keep the order of insertion; the text must not.
    document.sort_all_objects();
    let mut text = serde_json::to_string_pretty(&document).unwrap_or_default();
    text.push('\n');
    text
}

/// Names the document's schema where documents go in and out, and the problem's wherever something goes wrong.
fn complete(path: &str, operation: &mut Value) {
    let document = json!({"$ref": "#/components/schemas/JobDocument"});
    if let Some(body) = operation.pointer_mut("/requestBody/content/application~1json") {
        body["schema"] = document.clone();
    }
    if path.ends_with("/input") {
        operation["responses"]["200"]["content"]["application/json"]["schema"] = document;
    }
    let Some(responses) = operation["responses"].as_object_mut() else { return };
    if path.starts_with("/api/v1") {
        for (status, description) in COMMON {
            responses.entry(status).or_insert_with(|| json!({"description": description}));
        }
    }
    if !["/healthz", "/readyz"].contains(&path) {
        for (status, description) in GUARDS {
            responses.entry(status).or_insert_with(|| json!({"description": description}));
        }
    }
    let problem = json!({"application/problem+json": {"schema": {"$ref": "#/components/schemas/Problem"}}});
    for (status, response) in responses {
        if status.as_str() >= "400" {
            response["content"] = problem.clone();
        }
    }
}
