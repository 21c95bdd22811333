//! Violations: the errors of a document, each with the field it is about.

use serde::{Deserialize, Serialize};

/// One thing wrong with one field: where, what, and what would be permitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Violation {
    /// JSON pointer (RFC 6901) into the submitted document; empty for the document as a whole.
    pub pointer: String,
    /// Closed list: `missing`, `unknown-field`, `wrong-type`, `out-of-range`, `not-one-of`, `too-long`, `conflict`, `further`
    /// (more than are listed), or the code of an infeasible geometry (`pointed-tip`, `tip-interference`, …).
    pub code: String,
    /// One sentence for a person, with the value found, the permitted range and its unit.
    pub detail: String,
    /// Smallest permitted value, in `unit`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub minimum: Option<f64>,
    /// Largest permitted value, in `unit`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub maximum: Option<f64>,
    /// Unit of the field, as in its name.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub unit: Option<String>,
}

impl Violation {
    pub fn new(pointer: impl Into<String>, code: &str, detail: impl Into<String>) -> Self {
        Self {
            pointer: pointer.into(),
            code: code.to_owned(),
            detail: detail.into(),
            minimum: None,
            maximum: None,
            unit: None,
        }
    }
}

/// Refusal of bytes or a document: not JSON, invalid fields, or an unsupported calculation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DocumentError {
    /// The bytes are not JSON.
    #[error("the body is not valid JSON: {detail} (line {line}, column {column})")]
    Malformed { detail: String, line: usize, column: usize },
    /// JSON, but fields are missing, unknown, of the wrong type or out of range, or the gear cannot exist.
    #[error("the document has {} invalid field(s)", .0.len())]
    Invalid(Vec<Violation>),
    /// A valid document that requests a calculation not supported by this version.
    #[error("the document asks for something that is not supported")]
    Unsupported(Vec<Violation>),
}
