//! Headers with a meaning of their own.

use crate::api::config::{MAX_KEY_CHARS, MAX_WAIT_S};
use crate::api::problem::{Problem, ProblemCode, Refusal};
use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderName, header::IF_NONE_MATCH};
use herringbone_job::Violation;
use std::convert::Infallible;
use std::time::Duration;

/// Names a request in answers and logs; set by the envelope on every request.
#[derive(Debug, Clone)]
pub struct RequestId(pub String);

/// `Idempotency-Key`: the client's name for a submission.
#[derive(Debug, Clone)]
pub struct IdempotencyKey(pub Option<String>);

/// `Prefer: wait=N` (RFC 7240); longer waits than the service gives are cut, malformed preferences ignored.
#[derive(Debug, Clone, Copy)]
pub struct Prefer {
    pub wait: Option<Duration>,
}

/// `If-None-Match`.
#[derive(Debug, Clone)]
pub struct IfNoneMatch(Vec<String>);

impl IfNoneMatch {
    pub fn is_given(&self) -> bool {
        !self.0.is_empty()
    }

    /// Whether the client has this entity tag already (weak comparison).
    pub fn has(&self, etag: &str) -> bool {
        let opaque = |tag: &str| tag.trim().trim_start_matches("W/").to_owned();
        self.0.iter().any(|known| known == "*" || opaque(known) == opaque(etag))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for RequestId {
    type Rejection = Infallible;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Infallible> {
        Ok(parts.extensions.get().cloned().unwrap_or(Self(String::new())))
    }
}

impl<S: Send + Sync> FromRequestParts<S> for IdempotencyKey {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Refusal> {
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
        let wait = words(&parts.headers, HeaderName::from_static("prefer")).into_iter().find_map(|preference| {
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
        Ok(Self(words(&parts.headers, IF_NONE_MATCH)))
    }
}

/// The comma-separated members of a header that may stand several times.
fn words(headers: &HeaderMap, name: HeaderName) -> Vec<String> {
    let lines = headers.get_all(name).into_iter().filter_map(|value| value.to_str().ok());
    lines.flat_map(|line| line.split(',')).map(|word| word.trim().to_owned()).collect()
}
