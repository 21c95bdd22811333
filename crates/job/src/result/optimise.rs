//! An optimisation: the best design beside the input, what limits it, and how it was found.

use super::SweepPoint;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The outcome of an optimisation.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Optimisation))]
pub struct OptimiseResult {
    /// `improved`, `no better design within the bounds` or `no feasible design`.
    pub verdict: String,
    /// The best design; null where no design is feasible. Of several objectives that at the knee of the front.
    pub best: Option<BestDesign>,
    /// The document as it was given.
    pub input: InputDesign,
    pub objectives: Vec<ObjectiveResult>,
    /// Constraints of the best design, in the order of the document.
    pub constraints: Vec<ConstraintResult>,
    /// What limits the best design.
    pub active: Vec<ActiveLimit>,
    /// Range of each variable among the evaluated designs whose first objective is within 2 % of the best.
    pub flatness: Vec<Flatness>,
    /// The best design at neighbouring speeds: how near it stands to a jump. Empty without a response, and where the speed is a variable.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub neighbours: Vec<SpeedNeighbour>,
    pub history: SearchHistory,
    /// With several objectives: designs none of which is better in every objective, along the first one.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub front: Vec<FrontDesign>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub robust: Option<RobustResult>,
    pub numerics: SearchNumerics,
    /// Every evaluation, in order; a variable's value is that of its first pointer.
    pub points: Vec<SweepPoint>,
}

/// The best design.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BestDesign {
    /// Value of each variable, by its pointer.
    pub values: BTreeMap<String, f64>,
    /// Its row: `…/points/{position}/input` is its document.
    pub position: u64,
}

/// The design of the document.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct InputDesign {
    /// Value of each variable, by its pointer; null where the document has none.
    pub values: BTreeMap<String, Option<f64>>,
    pub feasible: bool,
    /// Sum of its normalised violations.
    pub violation: f64,
    /// Why it could not be evaluated.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub error: Option<String>,
}

/// An objective before and after.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ObjectiveResult {
    pub measure: String,
    /// Name for people.
    pub label: String,
    pub unit: String,
    /// `minimise`, `maximise` or `target`; over the operating points `worst`, `mean`, `rms` or `weighted`.
    pub goal: String,
    pub over: String,
    /// `input`: input and best are ratios to the values of the input, those of the operating points are not.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub relative_to: Option<String>,
    /// Value of the input and of the best design: of goal target the distance from it.
    pub input: Option<f64>,
    pub best: Option<f64>,
    /// Improvement in per cent of the input's value.
    pub gain_percent: Option<f64>,
    pub per_point: Vec<PointGain>,
}

/// A measure at one operating point.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct PointGain {
    pub pinion_speed_rpm: f64,
    pub pinion_torque_nm: f64,
    pub input: Option<f64>,
    pub best: Option<f64>,
    pub gain_percent: Option<f64>,
}

/// A constraint of the best design.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ConstraintResult {
    /// The measure or margin.
    pub constraint: String,
    /// Value nearest to the limit over the operating points; null of a word.
    pub value: Option<f64>,
    /// Distance from the limit, negative beyond it; null of a word.
    pub slack: Option<f64>,
    pub met: bool,
}

/// A bound or constraint at which the best design stands.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ActiveLimit {
    /// Pointer of a variable at a bound.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub pointer: Option<String>,
    /// `lower bound` or `upper bound`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub at: Option<String>,
    /// Measure or margin of a constraint.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub constraint: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub slack: Option<f64>,
}

/// How far a variable can go.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Flatness {
    pub pointer: String,
    pub range_within_2_percent: [f64; 2],
    /// Designs within 2 %.
    pub designs: u32,
    /// By how much the first objective is worse, in per cent, with this variable alone at the lower and the upper end of the range: more
    /// than 2 where the variables have to move together. Null at the best value itself, and where the design is infeasible.
    #[serde(default)]
    pub rise_at_ends_percent: [Option<f64>; 2],
}

/// The best design at another speed.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SpeedNeighbour {
    /// Speed of every operating point over that of the document, in per cent, less 100.
    pub speed_percent: f64,
    /// First objective; null where it could not be evaluated.
    pub objective: Option<f64>,
    /// Whether a jump lies between this speed and the next one towards the speed of the document: the measure of a point changes by more than
    /// a half.
    pub jump: bool,
}

/// The course of the search, an entry for each batch of evaluations.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SearchHistory {
    /// Evaluations up to the end of the batch.
    pub evaluations: Vec<u32>,
    /// Best value of the first objective so far among feasible designs.
    pub best: Vec<Option<f64>>,
    /// Spread of the search, as a part of the ranges; null outside of runs.
    pub sigma: Vec<Option<f64>>,
    /// With several objectives: part of the improvements up to nothing that the designs so far reach (hypervolume of the front against the
    /// input, in units of the input's values); empty where the input has no values.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub hypervolume: Vec<f64>,
}

/// A design of the front.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct FrontDesign {
    pub position: u64,
    pub objectives: Vec<f64>,
    /// The design farthest from the line through the ends.
    #[serde(default)]
    pub knee: bool,
}

/// The first objective over the tolerances.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct RobustResult {
    /// Statistic by which the candidates were ranked: `mean`, `p50`, …
    pub measure: String,
    /// Candidates: their rows, their first objective, and the statistic over the common sample, best first.
    pub candidates: Vec<RobustCandidate>,
    /// Points of the sample with which the input and the winner were compared, none of which the search had seen.
    pub sample: u32,
    pub input: Option<RobustStatistics>,
    pub best: Option<RobustStatistics>,
    /// The best design without deviations, where it is not the winner.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub nominal_best: Option<RobustStatistics>,
    /// The search on the statistic, where it was asked for.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub search: Option<RobustSearch>,
    /// Improvement of the statistic in per cent of the input's.
    pub gain_percent: Option<f64>,
}

/// The search on the statistic over the common sample.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct RobustSearch {
    /// Designs that were tried.
    pub designs: u32,
    /// The statistic over the common sample, of the best candidate before and of the best design after.
    pub before: Option<f64>,
    pub after: Option<f64>,
    /// Why it ended: as in numerics.
    pub stopped_by: String,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct RobustCandidate {
    pub position: u64,
    pub nominal: f64,
    /// Null where a point of the sample could not be evaluated.
    pub robust: Option<f64>,
}

/// Statistics of the first objective over a sample.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct RobustStatistics {
    pub mean: f64,
    pub p50: f64,
    pub p90: f64,
    pub p95: f64,
    pub max: f64,
    /// 95 % interval of the 90th percentile.
    pub p90_interval: Option<[f64; 2]>,
    /// Points that could not be evaluated.
    pub failed: u32,
}

/// Effort of the search.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SearchNumerics {
    pub evaluations: u32,
    pub infeasible: u32,
    /// Designs whose evaluation failed.
    pub failed: u32,
    /// Batches of evaluations.
    pub generations: u32,
    /// `tolerance` (further runs found nothing better), `budget` or `time`.
    pub stopped_by: String,
    /// `cma_es` or `nelder_mead`.
    pub method: String,
    pub seed: u32,
    /// Positions of the contact analysis during the search, where it differs from that of the document.
    pub search_positions: Option<u32>,
    /// Accuracy of the contact during the search, where it differs from that of the document.
    #[serde(default)]
    pub search_accuracy: Option<f64>,
}
