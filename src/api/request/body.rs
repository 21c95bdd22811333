//! The extractor of job documents.

use crate::api::config::{MAX_BODY_BYTES, MAX_IMPORT_BYTES};
use crate::api::problem::{ApiError, ProblemCode};
use axum::body::Bytes;
use axum::extract::{FromRequest, Request};
use axum::http::header::{CONTENT_ENCODING, CONTENT_TYPE};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use herringbone_job::document::JobDocument;

/// A parsed job document from the body of a request; the feasibility of the gear is not checked.
#[derive(Debug)]
pub(crate) struct DocumentBody(pub JobDocument);

impl<S: Send + Sync> FromRequest<S> for DocumentBody {
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &S) -> Result<Self, ApiError> {
        let bytes = read_json_body(request, state).await?;
        Ok(Self(herringbone_job::parse(&bytes)?))
    }
}

/// Reads a body whose media type is that of JSON.
///
/// # Errors
/// 413 for a body that is too large, 415 for another media type or encoding.
pub(super) async fn read_json_body<S: Send + Sync>(request: Request, state: &S) -> Result<Bytes, ApiError> {
    let is_json = |essence: &str| {
        essence == "application/json" || (essence.starts_with("application/") && essence.ends_with("+json"))
    };
    check_media_type(request.headers(), is_json, "application/json")?;
    read_body(request, state, MAX_BODY_BYTES).await
}

/// Reads a file: a body of a media type of models.
///
/// # Errors
/// 413 for a file that is too large, 415 for another media type or encoding.
pub(crate) async fn read_file<S: Send + Sync>(request: Request, state: &S) -> Result<Bytes, ApiError> {
    let is_model = |essence: &str| {
        let plain = ["application/octet-stream", "application/json", "application/xml", "text/xml"];
        let archive = ["application/zip", "application/x-zip-compressed"];
        plain.contains(&essence)
            || archive.contains(&essence)
            || (essence.starts_with("application/")
                && ["+json", "+xml", "+zip"].iter().any(|end| essence.ends_with(end)))
    };
    let needed = "application/xml, application/json, application/zip or application/octet-stream";
    check_media_type(request.headers(), is_model, needed)?;
    read_body(request, state, MAX_IMPORT_BYTES).await
}

async fn read_body<S: Send + Sync>(request: Request, state: &S, most_bytes: usize) -> Result<Bytes, ApiError> {
    Bytes::from_request(request, state).await.map_err(|rejection| match rejection.status() {
        StatusCode::PAYLOAD_TOO_LARGE => {
            let detail = format!("The body is larger than {most_bytes} bytes.");
            ApiError::new(ProblemCode::PayloadTooLarge, detail)
        }
        _ => ApiError::new(ProblemCode::MalformedJson, rejection.body_text()),
    })
}

fn check_media_type(headers: &HeaderMap, is_taken: impl Fn(&str) -> bool, needed: &str) -> Result<(), ApiError> {
    let text = |value: &HeaderValue| value.to_str().unwrap_or("unreadable").to_owned();
    let refuse = |detail: String| Err(ApiError::new(ProblemCode::UnsupportedMediaType, detail));
    let media_type = headers.get(CONTENT_TYPE).map(text).unwrap_or_default();
    let essence = media_type.split(';').next().unwrap_or_default().trim().to_ascii_lowercase();
    if !is_taken(&essence) {
        return refuse(format!("Content-Type is \"{media_type}\"; needed: {needed}"));
    }
    match headers.get_all(CONTENT_ENCODING).into_iter().map(text).find(|encoding| encoding != "identity") {
        Some(encoding) => refuse(format!("Content-Encoding is \"{encoding}\"; needed: none")),
        None => Ok(()),
    }
}
