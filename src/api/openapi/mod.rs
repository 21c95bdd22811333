//! The OpenAPI document, generated from the endpoints.

mod documents;
mod generators;
mod links;
mod responses;

use super::routes;
use super::state::AppState;
use serde_json::Value;
use utoipa::OpenApi;
use utoipa_axum::router::OpenApiRouter;

/// The general part of the OpenAPI document.
#[derive(OpenApi)]
#[openapi(
    info(
        title = "herringbone",
        description = "Contact, mesh-in impact and nonlinear vibration of double-helical gear pairs. Submit a job document, \
            wait for it, read its result and series. Every answer with a status of 400 or above is \
            `application/problem+json` in one schema; codes are explained under `/problems/{code}`. Every answer carries \
            `X-Request-Id`, the client's own where it sent one that is short and plain.",
        license(name = "MIT OR Apache-2.0", identifier = "MIT OR Apache-2.0")
    ),
    paths(routes::read_sound::read_sound),
    components(schemas(
        super::problem::Problem,
        super::csv::Decimal,
        super::downsample::DownsampleMethod,
        super::columns::ColumnName,
        routes::ListSort,
        routes::ListDirection
    )),
    tags(
        (name = "jobs", description = "Submit, follow, cancel and delete jobs"),
        (name = "results", description = "What succeeded jobs leave behind"),
        (name = "service", description = "What can be asked for, and the state of the service"),
        (name = "operation", description = "Health, metrics and the meaning of problem codes"),
    )
)]
struct GeneralDescription;

/// The endpoints with their descriptions, without that of files.
pub(super) fn document_routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::with_openapi(GeneralDescription::openapi())
        .nest("/api/v1", routes::versioned())
        .merge(routes::operational())
}

/// The endpoint that takes files, larger than documents.
pub(super) fn import_routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().nest("/api/v1", routes::imports())
}

/// The OpenAPI document as JSON text.
pub fn openapi_json() -> String {
    to_text(description())
}

/// The OpenAPI document as JSON text, in the terms that generators of clients understand.
pub fn openapi_for_generators() -> String {
    let mut document = description();
    generators::simplify(&mut document);
    to_text(document)
}

fn description() -> Value {
    let (_, document) = document_routes().merge(import_routes()).split_for_parts();
    let mut document = serde_json::to_value(document).unwrap_or_default();
    documents::add_schemas(&mut document);
    responses::add_components(&mut document);
    if let Some(paths) = document["paths"].as_object_mut() {
        for (path, operations) in paths {
            let Some(operations) = operations.as_object_mut() else { continue };
            for operation in operations.values_mut() {
                documents::set_schemas(path, operation);
                responses::leave_out_missing(operation);
                responses::set_binary(operation);
                responses::add_common(path, operation);
                links::add(operation);
            }
        }
    }
    document
}

fn to_text(mut document: Value) -> String {
    // Whether maps keep the order of insertion depends on the features of the build; the text must not.
    document.sort_all_objects();
    let mut text = serde_json::to_string_pretty(&document).unwrap_or_default();
    text.push('\n');
    text
}
