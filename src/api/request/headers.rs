//! Extractors of request headers.

use crate::api::config::{MAX_KEY_CHARS, MAX_WAIT_S};
use crate::api::problem::{ApiError, Problem, ProblemCode};
use crate::work::is_traceparent;
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderName};
use headers::{ETag, HeaderMapExt};
use herringbone_job::Violation;
use std::convert::Infallible;
use std::time::Duration;

/// The id of a request in responses and logs; set by the request middleware.
#[derive(Debug, Clone)]
pub(crate) struct RequestId(pub String);

/// `traceparent` (W3C Trace Context, 3.2): the caller's trace, if the header is one.
#[derive(Debug, Clone)]
pub(crate) struct TraceParent(pub Option<String>);

/// `Idempotency-Key`: the client's identifier of a submission.
#[derive(Debug, Clone)]
pub(crate) struct IdempotencyKey(pub Option<String>);

/// `Prefer: wait=N` (RFC 7240), limited to the longest wait of the service; malformed preferences are ignored.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Prefer {
    pub wait: Option<Duration>,
}

/// `If-None-Match` (RFC 9110, 13.1.2).
#[derive(Debug, Clone)]
pub(crate) struct IfNoneMatch(Option<headers::IfNoneMatch>);

impl IfNoneMatch {
    /// Whether the request has the header.
    pub(crate) fn is_given(&self) -> bool {
        self.0.is_some()
    }

    /// Whether the header lists this entity tag (weak comparison) or is `*`.
    pub(crate) fn matches(&self, etag: &ETag) -> bool {
        self.0.as_ref().is_some_and(|header| !header.precondition_passes(etag))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for RequestId {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Infallible> {
        Ok(parts.extensions.get().cloned().unwrap_or(Self(String::new())))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for TraceParent {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Infallible> {
        let mut values = parts.headers.get_all("traceparent").into_iter();
        // Several count as none.
        let only = values.next().filter(|_| values.next().is_none());
        let given = only.and_then(|value| value.to_str().ok());
        Ok(Self(given.filter(|text| is_traceparent(text)).map(str::to_owned)))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for IdempotencyKey {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, ApiError> {
        let Some(value) = parts.headers.get("idempotency-key") else { return Ok(Self(None)) };
        let is_printable = value.as_bytes().iter().all(|byte| matches!(byte, b' '..=b'~'));
        match value.to_str() {
            Ok(key) if is_printable && (1..=MAX_KEY_CHARS).contains(&key.len()) => Ok(Self(Some(key.to_owned()))),
            _ => {
                let detail = format!("must be 1 to {MAX_KEY_CHARS} printable ASCII characters");
                let violation = Violation {
                    minimum: Some(1.0),
                    maximum: Some(MAX_KEY_CHARS as f64),
                    ..Violation::new("/Idempotency-Key", "out-of-range", detail)
                };
                let problem = Problem::new(ProblemCode::InvalidParameter, "The header Idempotency-Key is invalid");
                Err(problem.with_errors(vec![violation]).into())
            }
        }
    }
}

impl<S: Send + Sync> FromRequestParts<S> for Prefer {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Infallible> {
        let wait = list_members(&parts.headers, HeaderName::from_static("prefer")).into_iter().find_map(|preference| {
            let (name, value) = preference.split_once('=')?;
            let seconds: u64 = value.split(';').next()?.trim().trim_matches('"').parse().ok()?;
            name.trim().eq_ignore_ascii_case("wait").then(|| Duration::from_secs(seconds.min(MAX_WAIT_S)))
        });
        Ok(Self { wait: wait.filter(|wait| !wait.is_zero()) })
    }
}

impl<S: Send + Sync> FromRequestParts<S> for IfNoneMatch {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Infallible> {
        Ok(Self(parts.headers.typed_get()))
    }
}

/// The members of a comma-separated list header, which may occur several times.
fn list_members(headers: &HeaderMap, name: HeaderName) -> Vec<String> {
    let lines = headers.get_all(name).into_iter().filter_map(|value| value.to_str().ok());
    lines.flat_map(|line| line.split(',')).map(|member| member.trim().to_owned()).collect()
}
