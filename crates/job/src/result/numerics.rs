//! Effort of the calculation, and reuse.

use super::{ResultFields, ReusedStage};
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Numerics))]
#[scalar(theory = "accuracy#computing-effort")]
pub struct NumericsResult {
    pub wall_ms: WallMs,
    /// Stages that were taken from the store instead of computed: `result`, `mesh`, `finite_elements`, `points` (some of a sweep).
    #[cfg_attr(feature = "schema", schema(value_type = Vec<String>))]
    pub reused: Vec<ReusedStage>,
    pub steps: u64,
    pub rejected_steps: u64,
    #[scalar(label = "evaluations of the forces")]
    pub force_evaluations: u64,
    #[scalar(label = "degrees of freedom solved", change = Absolute)]
    pub degrees_of_freedom: u32,
    pub solver_version: String,
    /// Numbers that are null because they are not finite.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub not_finite: Vec<NotFinite>,
}

/// A number that JSON cannot hold.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct NotFinite {
    /// Where it stands in the result.
    pub pointer: String,
    pub reason: String,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "accuracy#computing-effort")]
pub struct WallMs {
    #[scalar(label = "computing time, geometry", unit = "ms")]
    pub geometry: f64,
    #[scalar(label = "computing time, tooth contact", unit = "ms")]
    pub mesh: f64,
    #[scalar(label = "computing time, mesh-in impact", unit = "ms")]
    pub impact: f64,
    #[scalar(label = "computing time, vibration", unit = "ms")]
    pub response: f64,
}
