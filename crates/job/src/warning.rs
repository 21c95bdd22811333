//! Warnings of results and answers.

use serde::{Deserialize, Serialize};

/// A property of a job that is solved all the same, and the field it comes from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Warning {
    /// Stable code in kebab case.
    pub code: String,
    /// JSON pointer to the field of the document.
    pub pointer: String,
    /// One sentence with value, limit and unit.
    pub detail: String,
}
