//! `GET /api/v1/kinds`

use crate::api::config::MAX_BODY_BYTES;
use axum::Json;
use herringbone_job::document::JobKind;
use herringbone_job::schema::job_document_schema_of;
use herringbone_job::{MAX_SERIES_SAMPLES, MAX_SWEEP_POINTS};
use serde::Serialize;
use serde_json::{Map, Value, json};
use utoipa::ToSchema;

/// The kinds of jobs.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct KindList {
    pub items: Vec<KindEntry>,
}

/// A kind of job: what its document may say.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct KindEntry {
    pub kind: JobKind,
    pub description: &'static str,
    /// JSON Schema (2020-12) of the document: ranges, defaults, units (`x-unit`).
    pub schema: Value,
    /// The default of every field that has one, in the shape of the document.
    pub defaults: Value,
    pub limits: KindLimits,
}

/// Limits beside the ranges of single fields.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct KindLimits {
    pub max_body_bytes: usize,
    /// Points of all axes together; null for other kinds.
    pub max_sweep_points: Option<usize>,
    /// Samples of each recorded channel; null where none are recorded.
    pub max_series_samples: Option<u64>,
}

/// List the kinds of jobs with schema, defaults and limits.
#[utoipa::path(
    get, path = "/kinds", tag = "service",
    responses((status = 200, description = "The kinds of jobs.", body = KindList))
)]
pub(super) async fn list_kinds() -> Json<KindList> {
    Json(KindList { items: JobKind::ALL.iter().map(|(_, kind)| entry(*kind)).collect() })
}

fn entry(kind: JobKind) -> KindEntry {
    let schema = job_document_schema_of(kind);
    let defaults = defaults_of(&schema).unwrap_or_else(|| json!({}));
    let limits = KindLimits {
        max_body_bytes: MAX_BODY_BYTES,
        max_sweep_points: (kind == JobKind::Sweep).then_some(MAX_SWEEP_POINTS),
        max_series_samples: (kind == JobKind::Response).then_some(MAX_SERIES_SAMPLES),
    };
    KindEntry { kind, description: description(kind), schema, defaults, limits }
}

fn description(kind: JobKind) -> &'static str {
    match kind {
        JobKind::Mesh => "Geometry, loaded tooth contact and mesh-in impact.",
        JobKind::Response => "Everything of a mesh job, and the vibration response at one operating point.",
        JobKind::Sweep => "A response over the values of one or two inputs.",
    }
}

/// The defaults in a schema, arranged as in the document that it describes; `None` without any.
fn defaults_of(schema: &Value) -> Option<Value> {
    if let Some(value) = schema.get("default").or_else(|| schema.get("const")) {
        return Some(value.clone());
    }
    let properties = schema.get("properties")?.as_object()?;
    let defaults: Map<String, Value> =
        properties.iter().filter_map(|(name, field)| Some((name.clone(), defaults_of(field)?))).collect();
    (!defaults.is_empty()).then_some(Value::Object(defaults))
}
