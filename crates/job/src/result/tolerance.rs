//! A tolerance study: the scatter of measures, and what it comes from.

use super::SweepPoint;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The outcome of a tolerance study.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = ToleranceStudy))]
pub struct ToleranceResult {
    pub measures: Vec<MeasureScatter>,
    pub sensitivity: Vec<InputSensitivity>,
    /// Points of the sample that could not be evaluated.
    pub failed: u32,
    /// Values that were cut at the range of their field.
    pub clipped: u32,
    /// Points that were taken from an earlier study of the same document with other samples.
    #[serde(default)]
    pub points_reused: u32,
    pub samples: u32,
    pub sampling: String,
    pub seed: u32,
    /// Every evaluation: the document itself, then the sample. A tolerance's value is that of its first pointer.
    pub points: Vec<SweepPoint>,
}

/// The scatter of a measure.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct MeasureScatter {
    pub measure: String,
    /// Name for people.
    pub label: String,
    pub unit: String,
    pub over: String,
    /// Value without deviations.
    pub nominal: Option<f64>,
    pub mean: Option<f64>,
    pub std: Option<f64>,
    /// `p5`, `p10`, `p25`, `p50`, `p75`, `p90`, `p95`, `p99`.
    pub percentiles: BTreeMap<String, PercentileValue>,
    pub histogram: Option<Histogram>,
    pub beyond_limit: Option<BeyondLimit>,
    /// The same with the first half of the sample: how far the numbers have settled.
    pub convergence: Option<HalfSample>,
    /// Position of the point with the largest value.
    pub worst_position: Option<u64>,
}

/// A percentile with its 95 % interval.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct PercentileValue {
    pub value: f64,
    /// Null where the sample is too small.
    pub low: Option<f64>,
    pub high: Option<f64>,
}

/// Numbers of values between equidistant edges.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Histogram {
    pub from: f64,
    pub to: f64,
    pub counts: Vec<u32>,
}

/// Share of the sample beyond a limit, with its 95 % interval (Wilson).
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BeyondLimit {
    pub at_least: Option<f64>,
    pub at_most: Option<f64>,
    pub count: u32,
    pub share: f64,
    pub low: f64,
    pub high: f64,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct HalfSample {
    pub samples: u32,
    pub mean: f64,
    pub p90: f64,
}

/// Influence of an input on a measure.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct InputSensitivity {
    pub measure: String,
    /// First pointer of the tolerance.
    pub input: String,
    pub rank_correlation: Option<f64>,
    /// Share of the variance by this input alone.
    pub first_order: Option<f64>,
    /// Share of the variance by this input with its interactions.
    pub total: Option<f64>,
    /// Level that the rank correlation and the first-order share of an input without influence stay below in 95 of 100 samples.
    pub rank_noise: Option<f64>,
    pub first_order_noise: Option<f64>,
    /// 90th percentile with the tolerance of this input halved, by weighting the sample, and the number of points of an unweighted sample
    /// that say as much; null below 100 of them and for triangular distributions and fixed values.
    #[serde(default)]
    pub halved_p90: Option<f64>,
    #[serde(default)]
    pub halved_effective_samples: Option<f64>,
    /// Mean magnitude and standard deviation of the elementary effects, over the range of the deviation between its quantiles 0.05 and 0.95.
    pub effect: Option<f64>,
    pub effect_deviation: Option<f64>,
}
