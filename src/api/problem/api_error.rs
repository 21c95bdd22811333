//! The error type of handlers.

use super::{Problem, ProblemCode};
use crate::api::config::{RETRY_FULL_S, RETRY_LIVE_S};
use crate::store::{StoreError, Unavailable};
use crate::work::SubmitError;
use axum::http::HeaderValue;
use axum::http::header::RETRY_AFTER;
use axum::response::{IntoResponse, Response};
use herringbone_exchange::Refusal;
use herringbone_job::DocumentError;

/// An error response. Its body is written by the request middleware, which knows the request id.
#[derive(Debug, Clone)]
pub(crate) struct ApiError(Box<ApiErrorContent>);

#[derive(Debug, Clone)]
struct ApiErrorContent {
    problem: Problem,
    retry_after_s: Option<u64>,
    /// Cause, for the log only.
    cause: Option<String>,
}

impl ApiError {
    pub(crate) fn new(code: ProblemCode, detail: impl Into<String>) -> Self {
        Problem::new(code, detail).into()
    }

    /// A failure of the service: the response has a fixed text, `cause` is logged.
    pub(crate) fn internal(cause: impl std::fmt::Display) -> Self {
        let mut error = Self::new(ProblemCode::Internal, "The request failed for a reason that lies in the service.");
        error.0.cause = Some(cause.to_string());
        error
    }

    pub(crate) fn not_found(detail: impl Into<String>) -> Self {
        Self::new(ProblemCode::NotFound, detail)
    }

    /// Returns this error with a `Retry-After` header.
    pub(crate) fn retry_after(mut self, seconds: u64) -> Self {
        self.0.retry_after_s = Some(seconds);
        self
    }

    pub(in crate::api) fn into_parts(self) -> (Problem, Option<String>) {
        (self.0.problem, self.0.cause)
    }
}

impl From<Problem> for ApiError {
    fn from(problem: Problem) -> Self {
        Self(Box::new(ApiErrorContent { problem, retry_after_s: None, cause: None }))
    }
}

impl From<DocumentError> for ApiError {
    fn from(error: DocumentError) -> Self {
        Problem::from(error).into()
    }
}

impl From<Refusal> for ApiError {
    fn from(refusal: Refusal) -> Self {
        Problem::from(refusal).into()
    }
}

impl From<StoreError> for ApiError {
    fn from(error: StoreError) -> Self {
        let Some(cause) = error.unavailable() else { return Self::internal(error) };
        let mut response = Self::new(ProblemCode::StorageUnavailable, public_detail(cause)).retry_after(RETRY_FULL_S);
        response.0.cause = Some(error.to_string());
        response
    }
}

/// The detail in the response; the message of the database is only logged.
fn public_detail(cause: Unavailable) -> &'static str {
    match cause {
        Unavailable::Full => "There is no room for more data.",
        Unavailable::Busy => "The database is held by another program.",
        Unavailable::Disk => "The disk did not read or write.",
        Unavailable::ReadOnly => "The database may not be written.",
        Unavailable::Memory => "There is not enough memory.",
        Unavailable::Lost => "The database file was moved or deleted.",
    }
}

impl From<SubmitError> for ApiError {
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

impl IntoResponse for ApiError {
    fn into_response(self) -> Response {
        let status = axum::http::StatusCode::from_u16(self.0.problem.status);
        let mut response = status.unwrap_or(axum::http::StatusCode::INTERNAL_SERVER_ERROR).into_response();
        let live = self.0.problem.code == ProblemCode::ResultNotReady.as_str();
        if let Some(seconds) = self.0.retry_after_s.or(live.then_some(RETRY_LIVE_S)) {
            response.headers_mut().insert(RETRY_AFTER, HeaderValue::from(seconds));
        }
        response.extensions_mut().insert(self);
        response
    }
}
