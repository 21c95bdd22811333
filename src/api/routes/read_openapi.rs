//! `GET /openapi.json`

use crate::api::openapi::openapi_json;
use axum::http::header::CONTENT_TYPE;
use axum::response::IntoResponse;
use std::sync::OnceLock;

/// Answers with the OpenAPI document, which is generated once.
pub(super) async fn read_openapi() -> impl IntoResponse {
    static DOCUMENT: OnceLock<String> = OnceLock::new();
    ([(CONTENT_TYPE, "application/json")], DOCUMENT.get_or_init(openapi_json).as_str())
}
