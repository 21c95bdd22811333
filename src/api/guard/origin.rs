//! The check against cross-site request forgery.

use crate::api::problem::{ApiError, ProblemCode};
use axum::response::{IntoResponse, Response};
use tower_http::csrf::{CsrfLayer, ProtectionError};

/// Layer: refuses requests of other methods than GET, HEAD and OPTIONS that a page of another site made the browser
/// send, by the headers `Sec-Fetch-Site` and `Origin`.
pub(crate) fn check_origin() -> CsrfLayer<fn(ProtectionError) -> Response> {
    CsrfLayer::new().with_rejection_response(refuse)
}

fn refuse(_: ProtectionError) -> Response {
    ApiError::new(ProblemCode::CrossOrigin, "A page of another site made the browser send this request.")
        .into_response()
}
