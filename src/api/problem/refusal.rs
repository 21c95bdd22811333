//! A problem on its way out of a handler.

use super::{Problem, ProblemCode};
use crate::api::config::{RETRY_FULL_S, RETRY_LIVE_S};
use crate::store::{StoreError, Unavailable};
use crate::work::SubmitError;
use axum::http::HeaderValue;
use axum::http::header::RETRY_AFTER;
use axum::response::{IntoResponse, Response};
use herringbone_job::DocumentError;

/// What a handler answers instead of its result. The body is written by the envelope, which knows the request's id.
#[derive(Debug, Clone)]
pub struct Refusal(Box<Content>);

#[derive(Debug, Clone)]
struct Content {
    problem: Problem,
    retry_after_s: Option<u64>,
    /// For the log only.
    cause: Option<String>,
}

impl Refusal {
    pub fn new(code: ProblemCode, detail: impl Into<String>) -> Self {
        Problem::new(code, detail).into()
    }

    /// A failure of the service: a fixed text outside, the cause in the log.
    pub fn internal(cause: impl std::fmt::Display) -> Self {
        let mut refusal = Self::new(ProblemCode::Internal, "The request failed for a reason that lies in the service.");
        refusal.0.cause = Some(cause.to_string());
        refusal
    }

    pub fn not_found(what: impl Into<String>) -> Self {
        Self::new(ProblemCode::NotFound, what)
    }

    /// The same, saying when to try again.
    pub fn retry_after(mut self, seconds: u64) -> Self {
        self.0.retry_after_s = Some(seconds);
        self
    }

    pub(in crate::api) fn into_parts(self) -> (Problem, Option<String>) {
        (self.0.problem, self.0.cause)
    }
}

impl From<Problem> for Refusal {
    fn from(problem: Problem) -> Self {
        Self(Box::new(Content { problem, retry_after_s: None, cause: None }))
    }
}

impl From<DocumentError> for Refusal {
    fn from(error: DocumentError) -> Self {
        Problem::from(error).into()
    }
}

impl From<StoreError> for Refusal {
    fn from(error: StoreError) -> Self {
        let Some(why) = error.unavailable() else { return Self::internal(error) };
        let mut refusal = Self::new(ProblemCode::StorageUnavailable, reason(why)).retry_after(RETRY_FULL_S);
        refusal.0.cause = Some(error.to_string());
        refusal
    }
}

/// What is said outside; the words of the database stay in the log.
fn reason(why: Unavailable) -> &'static str {
    match why {
        Unavailable::Full => "There is no room for more data.",
        Unavailable::Busy => "The database is held by another program.",
        Unavailable::Disk => "The disk did not read or write.",
        Unavailable::ReadOnly => "The database may not be written.",
        Unavailable::Memory => "There is not enough memory.",
    }
}

impl From<SubmitError> for Refusal {
    fn from(error: SubmitError) -> Self {
        let text = error.to_string();
        match error {
            SubmitError::Document(error) => error.into(),
            SubmitError::KeyReused => Self::new(ProblemCode::IdempotencyKeyReused, text),
            SubmitError::Full { .. } => Self::new(ProblemCode::QueueFull, text).retry_after(RETRY_FULL_S),
            SubmitError::Closing => Self::new(ProblemCode::ShuttingDown, text).retry_after(RETRY_FULL_S),
            SubmitError::Store(error) => error.into(),
            SubmitError::Unwritable(_) | SubmitError::Threads(_) => Self::internal(text),
        }
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        let status = axum::http::StatusCode::from_u16(self.0.problem.status);
        let mut response = status.unwrap_or(axum::http::StatusCode::INTERNAL_SERVER_ERROR).into_response();
        let live = self.0.problem.code == ProblemCode::ResultNotReady.word();
        if let Some(seconds) = self.0.retry_after_s.or(live.then_some(RETRY_LIVE_S)) {
            response.headers_mut().insert(RETRY_AFTER, HeaderValue::from(seconds));
        }
        response.extensions_mut().insert(self);
        response
    }
}
