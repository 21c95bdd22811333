//! Errors as problem details (RFC 9457).

mod api_error;
mod codes;
mod convert;

pub(super) use api_error::ApiError;
pub use codes::ProblemCode;
pub(super) use codes::{CODES, CodeEntry};

use herringbone_job::Violation;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A problem as it is answered (`application/problem+json`), and as the `error` of a failed job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// `/problems/{code}`: a page that explains the code.
    #[serde(rename = "type")]
    #[schema(example = "/problems/invalid-design")]
    pub type_uri: String,
    pub title: String,
    /// HTTP status.
    #[schema(example = 422)]
    pub status: u16,
    /// One of a closed list.
    #[schema(example = "invalid-design")]
    pub code: String,
    /// What happened this time.
    pub detail: String,
    /// Names the request in the log; for a failed job the request that submitted it.
    pub request_id: Option<String>,
    /// Every violation found: pointers lead into the job document, or are the name of a query parameter after a slash.
    pub errors: Vec<Violation>,
    /// Stage that failed, of a failed job.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub stage: Option<String>,
    /// Simulated time at which a job failed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub sim_time_s: Option<f64>,
    /// Time step at which a job failed.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub step: Option<u64>,
}

impl Problem {
    pub fn new(code: ProblemCode, detail: impl Into<String>) -> Self {
        let entry = code.entry();
        Self {
            type_uri: format!("/problems/{}", entry.name),
            title: entry.title.to_owned(),
            status: entry.status,
            code: entry.name.to_owned(),
            detail: detail.into(),
            request_id: None,
            errors: Vec::new(),
            stage: None,
            sim_time_s: None,
            step: None,
        }
    }

    /// Returns this problem with the given violations.
    pub fn with_errors(self, errors: Vec<Violation>) -> Self {
        Self { errors, ..self }
    }
}
