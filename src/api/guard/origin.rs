//! The site whose page made the browser send a request (cross-site request forgery).

use crate::api::problem::{ProblemCode, Refusal};
use axum::response::{IntoResponse, Response};
use tower_http::csrf::{CsrfLayer, ProtectionError};

/// Layer: what changes something comes from pages of this service, or from no browser at all, as `Sec-Fetch-Site` and
/// `Origin` tell. Methods that only read pass.
pub fn check_origin() -> CsrfLayer<fn(ProtectionError) -> Response> {
    CsrfLayer::new().with_rejection_response(refuse)
}

fn refuse(_: ProtectionError) -> Response {
    Refusal::new(ProblemCode::CrossOrigin, "A page of another site made the browser send this request.").into_response()
}
