//! The loaded mesh: stiffness, transmission error, load distribution.

use super::{PerHalf, ResultFields};
use crate::document::MeshStiffnessSource;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "contact#mesh-stiffness")]
pub struct Mesh {
    /// Tangent stiffness dF_bt/dδ of one half in the base plane (mean of both halves where they differ).
    #[scalar(
        label = "mesh stiffness of one half, mean",
        headline,
        help = "Change of the tooth force with the deflection along the transverse base tangent (the tangent at the working load), \
                mean over the mesh period."
    )]
    pub stiffness_mean_n_per_um: f64,
    #[scalar(label = "mesh stiffness of one half, min", headline)]
    pub stiffness_min_n_per_um: f64,
    #[scalar(label = "mesh stiffness of one half, max", headline)]
    pub stiffness_max_n_per_um: f64,
    #[scalar(label = "secant stiffness of one half, mean")]
    pub secant_stiffness_mean_n_per_um: f64,
    /// Loaded transmission error: displacement of the flanks in contact along the transverse base tangent, in the sense of the mesh displacement s:
    /// positive where the pinion's drive flanks carry (the pinion leads), negative where its coast flanks do (negative torque).
    #[scalar(label = "transmission error, mean", headline, theory = "contact#transmission-error")]
    pub transmission_error_mean_um: f64,
    #[scalar(
        theory = "contact#transmission-error",
        label = "transmission error, peak to peak",
        headline,
        help = "How much the loaded deflection along the base tangent varies over a mesh period: what excites the vibration of a pair \
                whose teeth stay in contact."
    )]
    pub transmission_error_pp_um: f64,
    #[scalar(label = "load share at mesh-in", headline = 1, percent, theory = "contact#load-shares")]
    pub load_share_at_mesh_in: Option<f64>,
    #[scalar(headline, theory = "contact#loaded-contact-ratio")]
    pub loaded_contact_ratio: Option<f64>,
    /// Amplitudes of the first harmonics of the transmission error.
    #[scalar(
        theory = "contact#transmission-error",
        label = "transmission error, harmonic",
        items = 3,
        help = "Amplitude of the part of the transmission error at this multiple of the mesh frequency."
    )]
    pub transmission_error_harmonics_um: Vec<f64>,
    #[scalar(label = "line load, greatest", theory = "contact#line-load-and-contact-pressure")]
    pub max_line_load_n_per_mm: Option<f64>,
    /// The same without the ends of the lines of contact (three quarters of a normal module each), where edge effects rule.
    #[serde(default)]
    #[scalar(
        label = "line load, greatest away from the ends of the lines of contact",
        theory = "contact#line-load-and-contact-pressure"
    )]
    pub max_line_load_interior_n_per_mm: Option<f64>,
    #[scalar(label = "contact pressure, greatest", theory = "contact#line-load-and-contact-pressure")]
    pub max_contact_pressure_mpa: Option<f64>,
    #[scalar(label = "pairs in contact, least", change = Absolute, theory = "contact#loaded-contact-ratio")]
    pub pairs_in_contact_min: Option<u32>,
    #[scalar(label = "pairs in contact, most", change = Absolute, theory = "contact#loaded-contact-ratio")]
    pub pairs_in_contact_max: Option<u32>,
    /// Transverse base-tangent force of one half; negative, as the axial force, under negative torque.
    #[scalar(label = "force of a half along the base tangent", theory = "contact#forces-and-the-floating-pinion")]
    pub force_n: f64,
    #[scalar(label = "axial force of a half", theory = "contact#forces-and-the-floating-pinion")]
    pub axial_force_n: PerHalf,
    /// Axial position that the floating pinion takes, mean over the mesh period.
    #[scalar(label = "axial shift of the floating pinion", change = Absolute, theory = "contact#forces-and-the-floating-pinion")]
    pub pinion_axial_shift_um: f64,
    /// What an axial shift of the pinion against the gear (an apex error) does where the pinion cannot float.
    #[serde(default)]
    pub apex_sensitivity: Option<ApexSensitivity>,
    /// How far the numbers above are from those of finer positions and slices.
    #[serde(default)]
    pub convergence: Option<Convergence>,
    /// Where the stiffness came from: `ltca`, `iso6336` or `given`.
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    #[scalar(label = "source of the mesh stiffness")]
    pub source: MeshStiffnessSource,
    /// How the force of the contact over approach and phase was tabulated for the equations of motion; null where they do not contain it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub contact_force: Option<ContactForceTable>,
    pub curve: MeshCurve,
    /// Curves of the right half where the halves differ.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub right_curve: Option<MeshCurve>,
}

/// Change per micrometre of axial shift with the pinion held axially; means over the mesh period.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "contact#forces-and-the-floating-pinion")]
pub struct ApexSensitivity {
    /// Part of the torque that moves from one half to the other.
    #[scalar(label = "load moved by an apex offset")]
    pub load_split_percent_per_um: f64,
    /// Change of the transmission error; zero for equal halves.
    #[scalar(label = "transmission error by an apex offset", change = Absolute)]
    pub transmission_error_um_per_um: f64,
}

/// Discretisation of the contact analysis and what it costs in accuracy.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "contact#discretisation")]
pub struct Convergence {
    /// Positions solved over one mesh period of a half.
    #[scalar(label = "contact analysis: positions per mesh period", change = Absolute)]
    pub positions: u32,
    /// Change of mean and harmonics of stiffness and transmission error, in per cent of the means, by the positions that confirmed the others;
    /// null for a given number of positions.
    #[scalar(label = "contact analysis: change with finer positions")]
    pub position_error_percent: Option<f64>,
    #[scalar(label = "contact analysis: slices", change = Absolute)]
    pub slices: u32,
    /// Change of stiffness and transmission error, in per cent of the means, with half as many slices.
    #[scalar(label = "contact analysis: change with half the slices")]
    pub slice_error_percent: f64,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct MeshCurve {
    /// Position in the mesh period, 0 to 1; 0 is the theoretical start of contact of a pair's drive flanks. Under negative torque the curves are
    /// those of the coast flanks at the same positions of the pinion.
    pub phase: Vec<f64>,
    pub stiffness_n_per_um: Vec<f64>,
    pub transmission_error_um: Vec<f64>,
    /// Share of the load of one pair over its whole path, one list per half solved.
    pub load_share: Vec<Vec<f64>>,
    /// Base pitches since the theoretical start of contact of the pair (of its flanks in contact), for `load_share`.
    pub load_share_phase: Vec<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub flank: Option<FlankLoad>,
}

/// The mesh force of one half as a function of approach and phase.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "vibration#contact-force-table")]
pub struct ContactForceTable {
    /// Levels of approach above that of no load.
    #[scalar(label = "contact force: levels tabulated", change = Absolute)]
    pub levels: u32,
    /// Positions over the mesh period.
    #[scalar(label = "contact force: phases tabulated", change = Absolute)]
    pub phases: u32,
    /// Largest difference from contact analyses between levels and positions, as a part of the force (at least of a fifth of the static one).
    #[scalar(label = "contact force: largest difference from the contact analysis")]
    pub error_percent: f64,
    /// Force along the transverse base tangent up to which the contact was solved at every position; beyond it the force goes on with the stiffness
    /// there.
    #[scalar(label = "contact force: largest force tabulated")]
    pub largest_force_n: f64,
}

/// Line load over the flank, for a heat map: a row for each place on the roll path, in it the columns along the face width from the inner end.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct FlankLoad {
    /// Distance from the inner end of the common face width.
    pub face_mm: Vec<f64>,
    /// Roll length of the pinion's flank in contact.
    pub roll_mm: Vec<f64>,
    pub line_load_n_per_mm: Vec<Vec<f64>>,
}
