//! `GET /api/v1/kinds`

use crate::api::config::MAX_BODY_BYTES;
use axum::Json;
use herringbone_job::document::JobKind;
use herringbone_job::result::{Quantity, quantities};
use herringbone_job::schema::job_document_schema_of;
use herringbone_job::study::is_measure;
use herringbone_job::{MAX_EVALUATIONS, MAX_SERIES_SAMPLES, MAX_SWEEP_POINTS};
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
    /// Quantities of the result that can be measures; empty for kinds that have none.
    pub measures: Vec<MeasureEntry>,
}

/// A quantity of the result that objectives, constraints and tolerance studies can name.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct MeasureEntry {
    /// JSON pointer; without its last member where each half has a value of its own.
    pub measure: String,
    pub label: &'static str,
    /// Unit in ASCII; empty where there is none.
    pub unit: &'static str,
    /// Whether each half has a value of its own: `halves` says which counts.
    pub per_half: bool,
}

/// Limits beside the ranges of single fields.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct KindLimits {
    pub max_body_bytes: usize,
    /// Points of all axes together; null for other kinds.
    pub max_sweep_points: Option<usize>,
    /// Evaluations of an optimisation or a tolerance study; null for other kinds.
    pub max_evaluations: Option<u32>,
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
        max_evaluations: matches!(kind, JobKind::Optimise | JobKind::Tolerance).then_some(MAX_EVALUATIONS),
        max_series_samples: (kind == JobKind::Response).then_some(MAX_SERIES_SAMPLES),
    };
    let measures = if matches!(kind, JobKind::Optimise | JobKind::Tolerance) { measures() } else { Vec::new() };
    KindEntry { kind, description: description(kind), schema, defaults, limits, measures }
}

fn measures() -> Vec<MeasureEntry> {
    let entry = |quantity: &'static Quantity| {
        let whole = quantity.pointer.strip_suffix("/{half}");
        MeasureEntry {
            measure: whole.unwrap_or(&quantity.pointer).to_owned(),
            label: &quantity.label,
            unit: quantity.unit,
            per_half: quantity.pointer.contains("{half}"),
        }
    };
    quantities().iter().filter(|quantity| is_measure(quantity)).map(entry).collect()
}

fn description(kind: JobKind) -> &'static str {
    match kind {
        JobKind::Mesh => "Geometry, loaded tooth contact and mesh-in impact.",
        JobKind::Response => "Everything of a mesh job, and the vibration response at one operating point.",
        JobKind::Sweep => "A response over the values of one or two inputs.",
        JobKind::Optimise => "The values of up to twelve inputs for which quantities of the result are best.",
        JobKind::Tolerance => {
            "The scatter of quantities of the result by the tolerances of inputs, and what it comes from."
        }
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
