//! Both halves on elastic shafts: deflections, load along the faces, bearing reactions, helix modifications.

use super::{PerHalf, ResultFields};
use serde::{Deserialize, Serialize};

/// The loaded contact of both halves together on their shafts; means over the mesh period unless said. Signs and axes: x from the pinion's axis
/// to the gear's, z along the shafts from left to right, y = z × x; positions along each shaft from its own left end.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Shafts))]
#[scalar(theory = "shafts#load-along-the-faces")]
pub struct ShaftsResult {
    /// Normal force of a half over the mean length of its lines of contact, mean of both halves.
    #[scalar(label = "line load on the shafts, mean")]
    pub line_load_mean_n_per_mm: f64,
    /// Total length of the lines of contact of one half.
    #[scalar(label = "length of the lines of contact of a half, mean")]
    pub contact_line_length_mean_mm: f64,
    pub transmission_error: CouplingTransmissionError,
    #[scalar(label = "axial displacement of the pinion")]
    pub pinion_axial_float_um: AxialFloat,
    /// Part of the length of the lines of contact that carries no load.
    #[scalar(label = "lines of contact without load", percent, lower_is_better)]
    pub open_fraction: f64,
    /// Load of the half that carries more over half of the total: 1 for an even split.
    #[scalar(
        label = "mesh load factor between the halves",
        symbol = "K_γ",
        headline,
        lower_is_better,
        theory = "shafts#axial-balance"
    )]
    pub k_gamma: f64,
    #[scalar(halves)]
    pub left: ShaftHalfResult,
    pub right: ShaftHalfResult,
    #[scalar(label = "pinion")]
    pub pinion: ShaftMemberResult,
    #[scalar(label = "gear")]
    pub gear: ShaftMemberResult,
    /// The axial balance at both limits of the friction in the pinion's coupling; null without friction, or where the pinion is held.
    #[serde(default)]
    pub axial_friction: Option<AxialFrictionResult>,
    /// The estimate of ISO 6336-1 for the deformation of the pinion and its shaft, beside the values above; null where the standard's formula does
    /// not apply.
    #[serde(default)]
    pub iso6336: Option<Iso6336FaceLoad>,
    /// Face load factors at other torques, with the flanks as designed and with the proposed helix modifications.
    #[serde(default)]
    pub at_torques: Vec<FaceLoadAtTorque>,
}

/// Displacement along the transverse base tangent between the two couplings: deflection of the teeth, wind-up and bending of the shafts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "shafts#transmission-error-between-the-couplings")]
pub struct CouplingTransmissionError {
    #[scalar(label = "transmission error between the couplings, mean", headline = 2)]
    pub between_couplings_mean_um: f64,
    #[scalar(label = "transmission error between the couplings, peak to peak", headline = 2, lower_is_better)]
    pub between_couplings_pp_um: f64,
    /// Amplitudes at multiples of the mesh frequency.
    #[scalar(label = "transmission error between the couplings, harmonic", items = 3)]
    pub harmonics_um: Vec<f64>,
}

/// Axial displacement of the pinion's section in the middle of the gap, positive to the right.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "shafts#axial-balance")]
pub struct AxialFloat {
    #[scalar(label = "mean", unit = "um", change = Absolute)]
    pub mean: f64,
    #[scalar(label = "peak to peak", unit = "um", change = Absolute)]
    pub pp: f64,
}

/// One half on the shafts.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = ShaftHalf))]
#[scalar(theory = "shafts#load-along-the-faces")]
pub struct ShaftHalfResult {
    #[scalar(label = "normal force of a half, mean", theory = "shafts#axial-balance")]
    pub normal_force_mean_n: f64,
    #[scalar(label = "normal force of a half, peak to peak", change = Absolute, theory = "shafts#axial-balance")]
    pub normal_force_pp_n: f64,
    /// Part of the torque that this half carries.
    #[scalar(label = "share of the torque", percent, theory = "shafts#axial-balance")]
    pub share: f64,
    /// Positive to the right.
    #[scalar(label = "axial force on the pinion", theory = "shafts#axial-balance")]
    pub axial_force_on_pinion_n: f64,
    #[scalar(label = "force along the base tangent, on the shafts", theory = "shafts#axial-balance")]
    pub base_tangent_force_n: f64,
    /// Largest mean line load along the face, ends included, over the mean.
    #[scalar(
        label = "face load factor",
        symbol = "K_Hβ",
        headline,
        lower_is_better,
        help = "Largest line load along the face, ends included, over its mean. The line load of a place is the mean over all lines of \
                contact that pass it in a mesh period."
    )]
    pub k_h_beta: f64,
    /// The same with means over pieces of the face of about 5 mm: the better number where corners carry peaks.
    #[scalar(label = "face load factor, means over 5 mm", symbol = "K_Hβ", headline = 1, lower_is_better)]
    pub k_h_beta_5mm: f64,
    #[scalar(label = "line load at the inner end")]
    pub line_load_inner_end_n_per_mm: f64,
    #[scalar(label = "line load at the outer end")]
    pub line_load_outer_end_n_per_mm: f64,
    /// Largest load of any piece of a line of contact over the mean line load, averaged over the positions.
    #[scalar(label = "line load, greatest of a position over the mean", lower_is_better)]
    pub line_load_peak_over_mean: f64,
    #[scalar(label = "centroid of the load, from the inner end", change = Absolute)]
    pub load_centroid_from_inner_end_mm: f64,
    /// Relative displacement of the two sections at mid-face along the transverse base tangent: the loaded approach that a single half knows.
    #[scalar(label = "approach at mid-face, mean", theory = "shafts#transmission-error-between-the-couplings")]
    pub approach_mid_face_mean_um: f64,
    #[scalar(
        label = "approach at mid-face, harmonic",
        items = 3,
        theory = "shafts#transmission-error-between-the-couplings"
    )]
    pub approach_mid_face_harmonics_um: Vec<f64>,
    /// Places along the face of the line loads below.
    pub station_from_inner_end_mm: Vec<f64>,
    /// Line load at each station, mean over all lines of contact that pass it.
    pub line_load_n_per_mm: Vec<f64>,
    /// Means over the pieces of the face around the stations.
    pub line_load_5mm_means_n_per_mm: Vec<f64>,
    /// The helix modification that evens the load at this torque; null where none was sought.
    #[serde(default)]
    pub helix_modification: Option<HelixModificationResult>,
}

/// A helix modification in place of the one designed, on the pinion, material removed along the base tangent in the transverse plane.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = HelixModification))]
#[scalar(theory = "shafts#helix-modification")]
pub struct HelixModificationResult {
    /// Zero at the inner end, this at the outer; the value for `helix_slope_um` of this half of the pinion, what is designed there included.
    #[scalar(label = "proposed helix slope", headline = 3, change = Absolute)]
    pub slope_um: f64,
    /// The value for `lead_crowning_um` of this half of the pinion, what is designed there included.
    #[scalar(label = "proposed crowning", headline = 3, change = Absolute)]
    pub crowning_um: f64,
    #[scalar(label = "face load factor with the proposed modification", lower_is_better)]
    pub k_h_beta: f64,
    #[scalar(
        label = "face load factor with the proposed modification, means over 5 mm",
        headline = 3,
        lower_is_better
    )]
    pub k_h_beta_5mm: f64,
}

/// Face load factors (means over 5 mm) at one torque.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct FaceLoadAtTorque {
    pub pinion_torque_nm: f64,
    /// With the flanks as designed.
    pub k_h_beta_5mm: PerHalf,
    /// With the helix modifications proposed for the torque of the document.
    pub k_h_beta_5mm_modified: PerHalf,
}

/// ISO 6336-1, method C: face load factor by the deformation of the pinion and its shaft, no manufacturing deviations, no running-in.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "shafts#estimate-of-iso-6336-1")]
pub struct Iso6336FaceLoad {
    /// Equivalent misalignment f_sh of the half nearer to the torque.
    #[scalar(label = "equivalent misalignment by ISO 6336-1", symbol = "f_sh", change = Absolute)]
    pub f_sh_um: f64,
    #[scalar(label = "face load factor by ISO 6336-1", symbol = "K_Hβ", lower_is_better)]
    pub k_h_beta: f64,
    /// Constant K' of the bearing arrangement.
    #[scalar(label = "constant of the bearing arrangement by ISO 6336-1", symbol = "K'")]
    pub k_prime: f64,
    /// The half nearer to the end where the torque enters: `left` or `right`.
    #[scalar(label = "half of the estimate by ISO 6336-1")]
    pub half: String,
    /// Values taken for the formula: arrangement of the standard, bearing span, offset, diameters.
    #[scalar(label = "basis of the estimate by ISO 6336-1")]
    pub basis: String,
}

/// What friction against axial displacement in the pinion's coupling can do: any state between both limits is possible.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = AxialFriction))]
#[scalar(theory = "shafts#axial-balance")]
pub struct AxialFrictionResult {
    #[scalar(label = "axial friction force of the coupling")]
    pub force_n: f64,
    /// The coupling pushes the pinion to the left with that force.
    #[scalar(label = "coupling pushes to the left")]
    pub pushed_left: AxialLimit,
    /// The coupling pushes the pinion to the right.
    #[scalar(label = "coupling pushes to the right")]
    pub pushed_right: AxialLimit,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "shafts#axial-balance")]
pub struct AxialLimit {
    #[scalar(label = "share of the torque", percent)]
    pub share: PerHalf,
    #[scalar(label = "mesh load factor between the halves", symbol = "K_γ", lower_is_better)]
    pub k_gamma: f64,
    #[scalar(label = "axial displacement of the pinion, mean", change = Absolute)]
    pub pinion_axial_float_um: f64,
    #[scalar(label = "face load factor", symbol = "K_Hβ", lower_is_better)]
    pub k_h_beta: PerHalf,
}

/// One shaft. Lists over the face ends have four values, in the order of `face_ends`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = ShaftMember))]
#[scalar(theory = "shafts#shafts-and-bearings")]
pub struct ShaftMemberResult {
    /// Face load factor of each half; that of the block's `left` and `right`.
    #[scalar(skip)]
    pub k_h_beta: PerHalf,
    #[scalar(skip)]
    pub k_h_beta_5mm: PerHalf,
    /// Nothing holds this shaft along its axis but the mesh.
    #[scalar(label = "floats axially", theory = "shafts#axial-balance")]
    pub floats_axially: bool,
    /// `left_outer`, `left_inner`, `right_inner`, `right_outer`.
    pub face_ends: Vec<String>,
    pub x_um: Vec<f64>,
    pub y_um: Vec<f64>,
    pub z_um: Vec<f64>,
    pub tilt_x_urad: Vec<f64>,
    pub tilt_y_urad: Vec<f64>,
    /// Rotation about +z relative to the section at this shaft's coupling.
    pub twist_from_coupling_urad: Vec<f64>,
    pub bearings: Vec<BearingReaction>,
    /// The deflected shaft, for a drawing.
    #[serde(default)]
    #[scalar(skip)]
    pub deflection: ShaftDeflection,
}

/// Force and moment of a bearing on its shaft.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct BearingReaction {
    pub position_mm: f64,
    /// Along x, y, z.
    pub force_on_shaft_n: [f64; 3],
    /// About x and y.
    pub moment_on_shaft_nm: [f64; 2],
}

/// Displacements of the centre line, at the stations.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ShaftDeflection {
    /// From the left end of the shaft.
    pub station_mm: Vec<f64>,
    pub x_um: Vec<f64>,
    pub y_um: Vec<f64>,
    pub z_um: Vec<f64>,
    pub twist_from_coupling_urad: Vec<f64>,
}
