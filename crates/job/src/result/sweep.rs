//! A sweep: a row per point, and what its branches show.

use super::{
    BranchDifference, BranchDirection, ContactStateResult, EvaluationPhase, NaturalMode, PerHalf, Poincare,
    RegimeResult, ResultFields, SweepColumns,
};
use serde::{Deserialize, Serialize};

/// A sweep: one row per point, in the order solved.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Sweep))]
pub struct SweepResult {
    pub axes: Vec<SweepAxis>,
    pub points: Vec<SweepPoint>,
    /// Mesh orders of the rows' `acceleration_spectrum_m_s2`, where `record` asks for it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub spectrum_mesh_orders: Option<Vec<f64>>,
    /// With continuation in both directions: where they lead to different motions.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub hysteresis: Option<Vec<Hysteresis>>,
    /// With continuation: where a branch jumps between neighbouring points.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub jumps: Option<Vec<Jump>>,
    /// For a sweep over the speed: natural frequencies against mesh orders; one for every value of the other axis.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub campbell: Vec<Campbell>,
}

/// An interval of the first axis in which the motions found from below and from above differ.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Hysteresis {
    /// Value of the second axis, where there is one.
    pub second_axis_value: Option<f64>,
    /// First and last point that differ.
    pub from: f64,
    pub to: f64,
    /// What differs: `rms` (mesh acceleration, by more than 1 % and three times the errors), `regime`, `contact`.
    #[cfg_attr(feature = "schema", schema(value_type = Vec<String>))]
    pub differ: Vec<BranchDifference>,
    /// Largest ratio of the mesh accelerations' RMS, the stronger over the weaker motion.
    pub largest_rms_ratio: f64,
}

/// Two neighbouring points of a branch between which the motion jumps: the RMS of the mesh acceleration changes by more than a tenth
/// and three times as much as between the points before and after.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Jump {
    /// `up` or `down`.
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    pub branch: BranchDirection,
    /// Value of the second axis, where there is one.
    pub second_axis_value: Option<f64>,
    /// Values of the first axis before and after, in the direction of the branch.
    pub from: f64,
    pub to: f64,
    pub rms_before_m_s2: f64,
    pub rms_after_m_s2: f64,
}

/// Natural frequencies against the orders of the mesh frequency over the swept speeds.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Campbell {
    /// Value of the other axis, where there is one.
    pub other_axis_value: Option<f64>,
    /// Least and greatest speed of the sweep, and the mesh frequencies there; order n is n times as high.
    pub pinion_speed_rpm: [f64; 2],
    pub mesh_frequency_hz: [f64; 2],
    pub mesh_orders: Vec<u32>,
    pub natural_modes: Vec<NaturalMode>,
    /// Speeds at which an order meets a natural frequency, ascending.
    pub crossings: Vec<CampbellCrossing>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct CampbellCrossing {
    pub pinion_speed_rpm: f64,
    pub frequency_hz: f64,
    pub mesh_order: u32,
    /// Place in `natural_modes`, from 0.
    pub mode: u32,
    /// Share of the meshes in the mode's strain energy: how much the mesh excites it.
    pub mesh_strain_energy: f64,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SweepAxis {
    pub pointer: String,
    /// Further inputs that take the same values.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub also: Vec<String>,
    pub values: Vec<f64>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, SweepColumns)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SweepPoint {
    /// Value of each axis.
    pub values: Vec<f64>,
    #[column(from = "/response/rms/mesh_circumferential_acceleration_m_s2/{half}")]
    pub mesh_circumferential_acceleration_rms_m_s2: Option<PerHalf>,
    #[column(from = "/response/rms/pinion_axial_acceleration_m_s2/{half}")]
    pub pinion_axial_acceleration_rms_m_s2: Option<PerHalf>,
    #[column(from = "/response/dynamic_factor")]
    pub dynamic_factor: Option<f64>,
    #[cfg_attr(feature = "schema", schema(value_type = Option<String>))]
    #[column(from = "/response/regime")]
    pub regime: Option<RegimeResult>,
    #[cfg_attr(feature = "schema", schema(value_type = Option<String>))]
    #[column(from = "/response/contact")]
    pub contact: Option<ContactStateResult>,
    #[column(from = "/response/min_displacement_um")]
    pub min_displacement_um: Option<f64>,
    #[column(from = "/mesh/stiffness_mean_n_per_um")]
    pub stiffness_mean_n_per_um: Option<f64>,
    #[column(from = "/mesh/transmission_error_pp_um")]
    pub transmission_error_pp_um: Option<f64>,
    #[column(from = "/mesh/transmission_error_harmonics_um/0")]
    pub transmission_error_harmonic_1_um: Option<f64>,
    #[column(from = "/mesh/transmission_error_harmonics_um/1")]
    pub transmission_error_harmonic_2_um: Option<f64>,
    #[column(from = "/mesh/transmission_error_harmonics_um/2")]
    pub transmission_error_harmonic_3_um: Option<f64>,
    #[column(from = "/mesh/max_contact_pressure_mpa")]
    pub max_contact_pressure_mpa: Option<f64>,
    #[column(from = "/mesh/max_line_load_n_per_mm")]
    pub max_line_load_n_per_mm: Option<f64>,
    #[column(from = "/mesh/max_line_load_interior_n_per_mm")]
    pub max_line_load_interior_n_per_mm: Option<f64>,
    #[column(from = "/impact/force_n")]
    pub impact_force_n: Option<f64>,
    #[column(from = "/geometry/total_contact_ratio")]
    pub total_contact_ratio: Option<f64>,
    #[column(from = "/mesh/loaded_contact_ratio")]
    pub loaded_contact_ratio: Option<f64>,
    /// Estimated relative error of the RMS values.
    #[column(from = "/response/error_estimate")]
    pub error_estimate: Option<f64>,
    /// Largest normal force on the teeth of each half, impact included.
    #[serde(default)]
    #[column(from = "/response/tooth_force_n/{half}/max")]
    pub tooth_force_max_n: Option<PerHalf>,
    /// Of both halves on their shafts, like those below; null without `design.shafts`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(from = "/shafts/{half}/k_h_beta_5mm")]
    pub k_h_beta_5mm: Option<PerHalf>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(from = "/shafts/k_gamma")]
    pub k_gamma: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(from = "/shafts/transmission_error/between_couplings_mean_um")]
    pub between_couplings_mean_um: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(from = "/shafts/transmission_error/harmonics_um/0")]
    pub between_couplings_harmonic_1_um: Option<f64>,
    /// Dynamic part of the bearing force that is largest.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(from = "/response/largest_bearing_force_rms_n")]
    pub largest_bearing_force_rms_n: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(from = "/response/lowest_natural_frequency_hz")]
    pub lowest_natural_frequency_hz: Option<f64>,
    /// Why this point has no response.
    #[column]
    pub error: Option<String>,
    /// With continuation: the direction that found the point, `up` or `down`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[cfg_attr(feature = "schema", schema(value_type = Option<String>))]
    #[column(on_request)]
    pub branch: Option<BranchDirection>,
    /// Left mesh at the starts of the last mesh periods (at most 200), where `record` asks for it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(on_request, lists(x_left_m, v_x_left_m_s))]
    pub poincare: Option<Poincare>,
    /// Amplitudes of the left half's circumferential acceleration at `spectrum_mesh_orders`, where `record` asks for it: each the root of the
    /// sum of squares of the spectral lines nearest to that order.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(on_request)]
    pub acceleration_spectrum_m_s2: Option<Vec<f64>>,
    /// optimise, tolerance: what the evaluation is for. The numbers above are those of its first operating point.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[cfg_attr(feature = "schema", schema(value_type = Option<String>))]
    #[column(on_request)]
    pub phase: Option<EvaluationPhase>,
    /// optimise: number of the batch of evaluations.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(on_request)]
    pub generation: Option<u32>,
    /// optimise: objectives in the order of the document; of goal target the distance from it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(on_request)]
    pub objectives: Option<Vec<f64>>,
    /// optimise: sum of the normalised violations of the constraints; 0 of a feasible design.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(on_request)]
    pub violation: Option<f64>,
    /// optimise, tolerance: values of the measures of objectives and constraints, or of `measures`: one measure after the other, in each
    /// the operating points. A constraint on a word has 1 where it is met.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[column(on_request)]
    pub measures: Option<Vec<f64>>,
}
