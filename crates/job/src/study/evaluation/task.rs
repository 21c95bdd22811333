//! Evaluations to be made, here or on another machine.

use crate::result::EvaluationPhase;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How an evaluation is made: evaluations of the same values with the same settings have the same row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EvaluationSettings {
    /// The document as it is: its violations have their numbers too.
    Input,
    /// With the settings of the document.
    Own,
    /// With the coarser contact of the search.
    Search,
    /// With values of the tolerances besides, and no constraints; the settings of the document.
    OwnSample,
    /// The same with the coarser contact of the search.
    SearchSample,
    /// At a neighbouring speed, by its place.
    Speed(u8),
}

/// An evaluation to be made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EvaluationTask {
    pub settings: EvaluationSettings,
    /// Values of the inputs, the first of each.
    pub values: Vec<f64>,
    /// Values of further inputs that are not in the row.
    pub further: Vec<f64>,
    pub phase: EvaluationPhase,
    pub generation: Option<u32>,
}

/// Evaluations that do not depend on each other.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct EvaluationBatch {
    /// Measures of the document itself, to which objectives may be related; `None` if it could not be evaluated.
    pub measures_of_input: Option<Vec<f64>>,
    /// By the positions of their rows.
    pub tasks: BTreeMap<u64, EvaluationTask>,
}
