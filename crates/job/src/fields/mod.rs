//! The declaration of every field of the job document: name, range, unit, default, help. Read once to parse a
//! document, once over nothing to publish its schema.

mod analysis;
mod design;
mod model;
mod sweep;

use super::document::*;
use super::json;
use super::reader::{Number, Object, Reading};
use super::violation::{DocumentError, Violation};
use serde_json::Value;

/// Largest number of points of a sweep.
pub const MAX_SWEEP_POINTS: usize = 100_000;
/// Largest number of points of a sweep whose rows carry more than numbers.
pub const MAX_RECORDED_POINTS: usize = 5_000;
/// Largest number of samples per recorded channel.
pub const MAX_SERIES_SAMPLES: u64 = 4_000_000;

const fn number(min: f64, max: f64, unit: &'static str, default: Option<f64>, help: &'static str) -> Number {
    Number { min, max, unit, default, help }
}

/// Parses the bytes of a job document (UTF-8, with or without a byte order mark); finds every violation in one pass.
///
/// # Errors
/// [`DocumentError::Malformed`] when the bytes are not JSON in UTF-8 or repeat a member, [`DocumentError::Invalid`] with all violations otherwise.
/// Whether the gear can exist is not checked here (see `study::prepare`).
pub fn parse(bytes: &[u8]) -> Result<JobDocument, DocumentError> {
    let value = json::read(bytes).map_err(|json::NotJson { detail, line, column }| DocumentError::Malformed {
        detail,
        line,
        column,
    })?;
    parse_value(&value)
}

/// As [`parse`], from JSON that is already read.
pub fn parse_value(value: &Value) -> Result<JobDocument, DocumentError> {
    let reading = Reading::read();
    let document = read(reading.root(value));
    let violations = reading.violations();
    if violations.is_empty() { Ok(document) } else { Err(DocumentError::Invalid(violations)) }
}

/// Reads the whole document (or, with [`Reading::describe`], declares all of its fields).
pub fn read(root: Object) -> JobDocument {
    let kind =
        root.choice("kind", &JobKind::ALL, JobKind::Response, "response", "What to compute: mesh, response or sweep.");
    let name = root.text("name", 200, "A name for people.");
    let label = root.text("label", 100, "A label to find jobs by.");
    let design = design::design(root.object("design", true, "The gear pair."));
    let operation = analysis::operation(root.object("operation", true, "The operating point."));
    let model = model::model(root.object("model", false, "Choices of the physical model."));
    let analysis = analysis::analysis(root.object("analysis", false, "Accuracy and method."));
    let axes = sweep::axes(&root, kind);
    let continuation = sweep::continuation(&root, kind);
    let record = sweep::record(&root, kind, &axes);
    root.finish();
    JobDocument { kind, name, label, design, operation, model, analysis, axes, continuation, record }
}

fn conflict(object: &Object, name: &str, detail: &str) {
    object.reading().violate(Violation::new(object.pointer_to(name), "conflict", detail));
}
