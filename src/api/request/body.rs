//! The extractor of job documents.

use crate::api::config::MAX_BODY_BYTES;
use crate::api::problem::{ApiError, ProblemCode};
use axum::body::Bytes;
use axum::extract::{FromRequest, Request};
use axum::http::header::{CONTENT_ENCODING, CONTENT_TYPE};
use axum::http::{HeaderMap, StatusCode};
use herringbone_job::document::JobDocument;

/// A parsed job document from the body of a request; the feasibility of the gear is not checked.
#[derive(Debug)]
pub(crate) struct DocumentBody(pub JobDocument);

impl<S: Send + Sync> FromRequest<S> for DocumentBody {
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &S) -> Result<Self, ApiError> {
        check_media_type(request.headers())?;
        let bytes = Bytes::from_request(request, state).await.map_err(|rejection| match rejection.status() {
            StatusCode::PAYLOAD_TOO_LARGE => {
                let detail = format!("The body is larger than {MAX_BODY_BYTES} bytes.");
                ApiError::new(ProblemCode::PayloadTooLarge, detail)
            }
            _ => ApiError::new(ProblemCode::MalformedJson, rejection.body_text()),
        })?;
        Ok(Self(herringbone_job::parse(&bytes)?))
    }
}

fn check_media_type(headers: &HeaderMap) -> Result<(), ApiError> {
    let text = |name| headers.get(name).map(|value| value.to_str().unwrap_or("unreadable").to_owned());
    let refuse = |detail: String| Err(ApiError::new(ProblemCode::UnsupportedMediaType, detail));
    let media_type = text(CONTENT_TYPE).unwrap_or_default();
    let essence = media_type.split(';').next().unwrap_or_default().trim().to_ascii_lowercase();
    let is_json = essence == "application/json" || (essence.starts_with("application/") && essence.ends_with("+json"));
    if !is_json {
        return refuse(format!("Content-Type is \"{media_type}\"; needed: application/json"));
    }
    match text(CONTENT_ENCODING) {
        Some(encoding) if encoding != "identity" => refuse(format!("Content-Encoding is \"{encoding}\"; needed: none")),
        _ => Ok(()),
    }
}
