//! The stored error of a failed job.

use herringbone_job::Violation;
use serde::{Deserialize, Serialize};

/// The error of a failed job, shown as its `error` in the HTTP interface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Failure {
    /// Code of the problem, from the closed list of the HTTP interface.
    pub code: String,
    pub detail: String,
    /// Stage that failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stage: Option<String>,
    /// Simulated time of the failure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sim_time_s: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub step: Option<u64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<Violation>,
}

impl Failure {
    /// A failure with code and detail only.
    pub fn new(code: &str, detail: impl Into<String>) -> Self {
        Self {
            code: code.to_owned(),
            detail: detail.into(),
            stage: None,
            sim_time_s: None,
            step: None,
            errors: Vec::new(),
        }
    }
}
