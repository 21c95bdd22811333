//! The result document: what comes out. Names and units are the public contract; stages that did not run are null.

use crate::warning::Warning;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct JobResult {
    pub geometry: Option<Geometry>,
    pub mesh: Option<Mesh>,
    pub impact: Option<Impact>,
    pub response: Option<Response>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub sweep: Option<Sweep>,
    pub numerics: Numerics,
    /// Springs of the equations of motion; null for a job without a response.
    #[serde(default)]
    pub supports: Option<Supports>,
    /// How far the numbers may be off: from the solution of their own equations, and from a gear pair.
    #[serde(default)]
    pub accuracy: Option<Accuracy>,
    #[cfg_attr(feature = "schema", schema(value_type = Vec<WarningEntry>))]
    pub warnings: Vec<Warning>,
}

/// A warning: what an engineer should know, and which field it is about.
#[cfg(feature = "schema")]
#[derive(utoipa::ToSchema)]
pub struct WarningEntry {
    pub code: String,
    pub detail: String,
    pub pointer: String,
}

/// Supports of each half and couplings between the halves of a gear, as they stand in the equations; of a sweep those of its base document.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Supports {
    pub pinion_lateral_n_per_um: SpringValue,
    pub gear_lateral_n_per_um: SpringValue,
    pub gear_axial_n_per_um: SpringValue,
    pub pinion_halves_axial_n_per_um: SpringValue,
    pub gear_halves_axial_n_per_um: SpringValue,
    pub pinion_halves_lateral_n_per_um: SpringValue,
    pub gear_halves_lateral_n_per_um: SpringValue,
    pub pinion_halves_torsional_nm_per_rad: SpringValue,
    pub gear_halves_torsional_nm_per_rad: SpringValue,
}

/// A stiffness in the unit of its name, and where it came from.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SpringValue {
    pub value: f64,
    /// `given` by the document, `derived` from the gear body, or `assumed` after the size of the pair.
    pub origin: String,
}

/// Numerical error and model error, which are different things.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Accuracy {
    /// Relative error of the solution of the equations: the estimate for the RMS values (of a sweep the largest of its points; null where none
    /// was solved); without a response that of the contact's discretisation. 0 for a closed form.
    pub numerical: Option<f64>,
    pub model: ModelError,
}

/// How far the mesh of the model is from that of a gear pair with exact flanks, by the comparisons of docs/VALIDATION.md and docs/BENCHMARKS.md:
/// the largest difference found in pairs of the same kind. Supports, damping, friction and manufacture are not in it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ModelError {
    /// Of the mean mesh stiffness; null where the model claims nothing.
    pub mesh_stiffness_percent: Option<f64>,
    /// Of the first harmonic of the loaded transmission error, in per cent of itself; null where the model claims nothing.
    pub transmission_error_harmonic_percent: Option<f64>,
    /// What the numbers rest on.
    pub basis: String,
}

/// Two values, one per helix half.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct PerHalf {
    pub left: f64,
    pub right: f64,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Geometry {
    pub transverse_contact_ratio: f64,
    pub overlap_ratio: f64,
    pub total_contact_ratio: f64,
    pub working_pressure_angle_deg: f64,
    pub center_distance_mm: f64,
    pub mesh_frequency_hz: f64,
    pub transverse_pressure_angle_deg: f64,
    pub normal_pressure_angle_deg: f64,
    pub base_helix_angle_deg: f64,
    pub transverse_base_pitch_mm: f64,
    pub path_of_contact_mm: f64,
    /// Face width of one half that both gears have in common, and the gap between those of the halves.
    #[serde(default)]
    pub face_width_mm: Option<f64>,
    #[serde(default)]
    pub gap_width_mm: Option<f64>,
    pub pinion: GearGeometry,
    pub gear: GearGeometry,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct GearGeometry {
    pub reference_diameter_mm: f64,
    pub base_diameter_mm: f64,
    pub tip_diameter_mm: f64,
    pub root_diameter_mm: f64,
    pub root_form_diameter_mm: f64,
    pub tip_thickness_normal_mm: f64,
    pub bore_diameter_mm: f64,
    /// Face width of one half of this gear.
    #[serde(default)]
    pub face_width_mm: Option<f64>,
    pub mass_kg: f64,
    pub inertia_kg_m2: f64,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Mesh {
    /// Tangent stiffness dF_bt/dδ of one half in the base plane (mean of both halves where they differ).
    pub stiffness_mean_n_per_um: f64,
    pub stiffness_min_n_per_um: f64,
    pub stiffness_max_n_per_um: f64,
    pub secant_stiffness_mean_n_per_um: f64,
    /// Loaded transmission error: displacement of the flanks in contact along the transverse base tangent, in the sense of the mesh displacement s:
    /// positive where the pinion's drive flanks carry (the pinion leads), negative where its coast flanks do (negative torque).
    pub transmission_error_mean_um: f64,
    pub transmission_error_pp_um: f64,
    pub load_share_at_mesh_in: Option<f64>,
    pub loaded_contact_ratio: Option<f64>,
    /// Amplitudes of the first harmonics of the transmission error.
    pub transmission_error_harmonics_um: Vec<f64>,
    pub max_line_load_n_per_mm: Option<f64>,
    /// The same without the ends of the lines of contact (three quarters of a normal module each), where edge effects rule.
    #[serde(default)]
    pub max_line_load_interior_n_per_mm: Option<f64>,
    pub max_contact_pressure_mpa: Option<f64>,
    pub pairs_in_contact_min: Option<u32>,
    pub pairs_in_contact_max: Option<u32>,
    /// Transverse base-tangent force of one half; negative, as the axial force, under negative torque.
    pub force_n: f64,
    pub axial_force_n: PerHalf,
    /// Axial position that the floating pinion takes, mean over the mesh period.
    pub pinion_axial_shift_um: f64,
    /// What an axial shift of the pinion against the gear (an apex error) does where the pinion cannot float.
    #[serde(default)]
    pub apex_sensitivity: Option<ApexSensitivity>,
    /// How far the numbers above are from those of finer positions and slices.
    #[serde(default)]
    pub convergence: Option<Convergence>,
    /// Where the stiffness came from: `ltca`, `iso6336` or `given`.
    pub source: String,
    /// How the force of the contact over approach and phase was tabulated for the equations of motion; null where they do not contain it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub contact_force: Option<ContactForceTable>,
    pub curve: MeshCurve,
    /// Curves of the right half where the halves differ.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub right_curve: Option<MeshCurve>,
}

/// Change per micrometre of axial shift with the pinion held axially; means over the mesh period.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ApexSensitivity {
    /// Part of the torque that moves from one half to the other.
    pub load_split_percent_per_um: f64,
    /// Change of the transmission error; zero for equal halves.
    pub transmission_error_um_per_um: f64,
}

/// Discretisation of the contact analysis and what it costs in accuracy.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Convergence {
    /// Positions solved over one mesh period of a half.
    pub positions: u32,
    /// Change of mean and harmonics of stiffness and transmission error, in per cent of the means, by the positions that confirmed the others;
    /// null for a given number of positions.
    pub position_error_percent: Option<f64>,
    pub slices: u32,
    /// Change of stiffness and transmission error, in per cent of the means, with half as many slices.
    pub slice_error_percent: f64,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ContactForceTable {
    /// Levels of approach above that of no load.
    pub levels: u32,
    /// Positions over the mesh period.
    pub phases: u32,
    /// Largest difference from contact analyses between levels and positions, as a part of the force (at least of a fifth of the static one).
    pub error_percent: f64,
    /// Force along the transverse base tangent up to which the contact was solved at every position; beyond it the force goes on with the stiffness
    /// there.
    pub largest_force_n: f64,
}

/// Line load over the flank, for a heat map: a row for each place on the roll path, in it the columns along the face width from the inner end.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct FlankLoad {
    /// Distance from the inner end of the common face width.
    pub face_mm: Vec<f64>,
    /// Roll length of the pinion's flank in contact.
    pub roll_mm: Vec<f64>,
    pub line_load_n_per_mm: Vec<Vec<f64>>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Impact {
    /// Force buffered by the pairs in mesh, or the given one. What only a calculated impact has is null for a given one.
    pub force_n: f64,
    pub zhou2008_force_n: Option<f64>,
    pub reduction_percent: Option<f64>,
    pub velocity_m_s: Option<f64>,
    /// Length of the pulse in the equations.
    pub duration_us: f64,
    /// Half the period of the equivalent mass on the compliance of the impact.
    pub energy_balance_duration_us: Option<f64>,
    pub theta_deg: Option<f64>,
    pub equivalent_mass_kg: Option<f64>,
    pub single_pair_stiffness_n_per_um: Option<f64>,
    pub other_pairs_stiffness_n_per_um: Option<f64>,
    /// Deflection of the pairs in mesh at the first contact, which the corner gap equals.
    pub corner_deflection_um: Option<f64>,
    /// Roll before the theoretical start of contact at which the tip corner touches.
    pub corner_overrun_mm: Option<f64>,
    pub start_mesh_periods: f64,
    /// Which law excites the response: `corner_contact`, `zhou2008`, `none` or `given`.
    pub source: String,
    /// Whether the pulse is put on the equations of motion; false: it is only reported.
    #[serde(default = "always_applied")]
    pub applied: bool,
    /// What it moves: `torsion` or `all` (bending and axial motion too).
    #[serde(default)]
    pub acts_on: String,
}

/// Of results stored before impacts could be reported alone.
fn always_applied() -> bool {
    true
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Response {
    pub rms: Rms,
    /// Largest normal force on the teeth of a half (mesh force and applied impact) over the static one; null without torque. Never below 1.
    pub dynamic_factor: Option<f64>,
    /// Normal force on the teeth of each half, impact included, along s of the plane in use.
    #[serde(default)]
    pub tooth_force_n: ToothForces,
    /// How the motion repeats: `period-1`, `period-2`, …, `quasi-periodic`, `chaotic`; `not-settled` where the record ended before the
    /// motion had settled, `unstable` where it grows without bound (its RMS values then mean nothing).
    pub regime: String,
    /// `continuous`, `single-sided` (separation), `double-sided` (back flanks too), `apart` (no contact at all).
    pub contact: String,
    pub min_displacement_um: f64,
    pub natural_frequencies_hz: Vec<f64>,
    pub error_estimate: f64,
    pub method: String,
    pub fraction_in_contact: f64,
    /// Whether the mesh damper acted in the gap (the printed law) or not.
    pub damping_in_gap: bool,
    /// Total play along s in the equations.
    #[serde(default)]
    pub backlash_um: Option<f64>,
    pub plane: String,
    pub mesh_frequency_hz: f64,
    /// Mesh periods over which the means were taken.
    pub averaged_mesh_periods: u64,
    /// Displacement and velocity of the left mesh at each mesh period's start.
    pub poincare: Poincare,
    /// Amplitudes of the left half's circumferential acceleration by frequency.
    pub spectrum: Option<Spectrum>,
    /// Mesh periods after which the motion repeats; null when it does not.
    #[serde(default)]
    pub period_mesh_periods: Option<u64>,
    /// What small deviations are multiplied by over one period of the motion (`period_mesh_periods`), largest modulus first, motions that
    /// nothing holds left out; null when the motion was not found by the periodic method, and where nothing is left of any deviation after a
    /// mesh period.
    #[serde(default)]
    pub floquet_multipliers: Option<Vec<FloquetMultiplier>>,
    /// Modulus of the largest multiplier, as growth per mesh period; below 1 the motion is stable.
    #[serde(default)]
    pub floquet_modulus_per_mesh_period: Option<f64>,
    /// Largest Lyapunov exponent of a motion that does not repeat; above 0.01 it is called chaotic. Of an unstable one its growth rate.
    #[serde(default)]
    pub lyapunov_per_mesh_period: Option<f64>,
    /// Share of the recorded time in which each half's teeth touch, on either flank.
    #[serde(default)]
    pub contact_share: PerHalf,
    /// Where the true RMS values lie with a probability of 95 %, for a motion that does not repeat (batch means over the record); null for
    /// one that does, or when the record is too short against its correlation to say.
    #[serde(default)]
    pub confidence_interval_95: Option<RmsIntervals>,
    /// Work-energy theorem over the recorded periods (the first 200 of a longer record): what the work of all forces does not explain of the change of kinetic
    /// energy, over the integral of the absolute power on each coordinate; null when nothing moves.
    #[serde(default)]
    pub energy_balance_residual: Option<f64>,
    /// What each of `natural_frequencies_hz` is, in their order: undamped, contact closed, mean mesh stiffness.
    #[serde(default)]
    pub natural_modes: Vec<NaturalMode>,
}

/// Tooth force of each half, N, positive on driving flanks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ToothForces {
    pub left: ToothForce,
    pub right: ToothForce,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct ToothForce {
    /// What the torque alone needs.
    #[serde(rename = "static")]
    pub static_n: f64,
    /// Largest and smallest over the record, exact between its steps.
    #[serde(rename = "max")]
    pub max_n: f64,
    #[serde(rename = "min")]
    pub min_n: f64,
}

/// A natural mode and what it is made of.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct NaturalMode {
    /// 0 for a motion that nothing holds.
    pub frequency_hz: f64,
    /// After the springs with at least half of the strain energy, else the two largest groups; `meshes in phase` where the halves mirror each
    /// other, `meshes opposed` where they do the opposite.
    pub name: String,
    /// The 12 displacements in the source's order (y, z, rotation of pinion and gear; left, then right half), rotations as arcs at the radii of
    /// the plane in use; the largest is 1.
    pub shape: Vec<f64>,
    /// Modal mass of that shape.
    pub modal_mass_kg: f64,
    /// Damping ratio as far as damping does not couple the modes; null for a motion that nothing holds.
    pub damping_ratio: Option<f64>,
    /// Share of each group of springs in the strain energy: `mesh_left`, `mesh_right`, supports (`pinion_lateral`, `gear_lateral`, `pinion_axial`,
    /// `gear_axial`) and shafts between the halves (`pinion_halves_axial`, …).
    pub strain_energy: BTreeMap<String, f64>,
    /// Share of each kind of displacement in the kinetic energy: `pinion_lateral`, `pinion_axial`, `pinion_rotation`, `gear_lateral`,
    /// `gear_axial`, `gear_rotation`.
    pub kinetic_energy: BTreeMap<String, f64>,
}

/// A Floquet multiplier in polar form.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct FloquetMultiplier {
    pub modulus: f64,
    /// -π to π: 0 towards a fold, ±π towards a period doubling.
    pub angle_rad: f64,
}

/// Intervals of the RMS values.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct RmsIntervals {
    pub mesh_circumferential_acceleration_m_s2: IntervalPerHalf,
    pub pinion_axial_acceleration_m_s2: IntervalPerHalf,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct IntervalPerHalf {
    pub left: Interval,
    pub right: Interval,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Rms {
    pub mesh_circumferential_acceleration_m_s2: PerHalf,
    pub pinion_axial_acceleration_m_s2: PerHalf,
    /// Every recorded channel, in its SI unit (the catalogue of series names it).
    pub channels: BTreeMap<String, f64>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Poincare {
    pub x_left_m: Vec<f64>,
    pub v_x_left_m_s: Vec<f64>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Spectrum {
    pub frequency_hz: Vec<f64>,
    pub amplitude_m_s2: Vec<f64>,
}

/// A sweep: one row per point, in the order solved.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Sweep {
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
    pub differ: Vec<String>,
    /// Largest ratio of the mesh accelerations' RMS, the stronger over the weaker motion.
    pub largest_rms_ratio: f64,
}

/// Two neighbouring points of a branch between which the motion jumps: the RMS of the mesh acceleration changes by more than a tenth
/// and three times as much as between the points before and after.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Jump {
    /// `up` or `down`.
    pub branch: String,
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

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct SweepPoint {
    /// Value of each axis.
    pub values: Vec<f64>,
    pub mesh_circumferential_acceleration_rms_m_s2: Option<PerHalf>,
    pub pinion_axial_acceleration_rms_m_s2: Option<PerHalf>,
    pub dynamic_factor: Option<f64>,
    pub regime: Option<String>,
    pub contact: Option<String>,
    pub min_displacement_um: Option<f64>,
    pub stiffness_mean_n_per_um: Option<f64>,
    pub impact_force_n: Option<f64>,
    pub total_contact_ratio: Option<f64>,
    pub loaded_contact_ratio: Option<f64>,
    /// Estimated relative error of the RMS values.
    pub error_estimate: Option<f64>,
    /// Largest normal force on the teeth of each half, impact included.
    #[serde(default)]
    pub tooth_force_max_n: Option<PerHalf>,
    /// Why this point has no response.
    pub error: Option<String>,
    /// With continuation: the direction that found the point, `up` or `down`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub branch: Option<String>,
    /// Left mesh at the starts of the last mesh periods (at most 200), where `record` asks for it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub poincare: Option<Poincare>,
    /// Amplitudes of the left half's circumferential acceleration at `spectrum_mesh_orders`, where `record` asks for it: each the root of the
    /// sum of squares of the spectral lines nearest to that order.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub acceleration_spectrum_m_s2: Option<Vec<f64>>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Numerics {
    pub wall_ms: WallMs,
    /// Stages that were taken from the store instead of computed: `result`, `mesh`, `finite_elements`, `points` (some of a sweep).
    pub reused: Vec<String>,
    pub steps: u64,
    pub rejected_steps: u64,
    pub force_evaluations: u64,
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

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct WallMs {
    pub geometry: f64,
    pub mesh: f64,
    pub impact: f64,
    pub response: f64,
}
