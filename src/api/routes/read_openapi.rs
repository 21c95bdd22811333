//! `GET /openapi.json` and `GET /openapi-generators.json`

use crate::api::openapi::{openapi_for_generators, openapi_json};
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use std::sync::OnceLock;

/// Answers with the OpenAPI document, which is generated once.
pub(super) async fn read_openapi() -> impl IntoResponse {
    static DOCUMENT: OnceLock<String> = OnceLock::new();
    ([(CONTENT_TYPE, "application/json")], DOCUMENT.get_or_init(openapi_json).as_str())
}

/// Answers with the OpenAPI document for generators of clients.
pub(super) async fn read_openapi_for_generators() -> impl IntoResponse {
    static DOCUMENT: OnceLock<String> = OnceLock::new();
    ([(CONTENT_TYPE, "application/json")], DOCUMENT.get_or_init(openapi_for_generators).as_str())
}
