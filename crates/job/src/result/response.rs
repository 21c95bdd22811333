//! The vibration response.

use super::{
    BearingForceResult, ContactStateResult, MethodResult, PerHalf, RegimeResult, ResultFields, RotorResult,
    ToothForceOrders,
};
use crate::document::Plane;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Response))]
#[scalar(theory = "vibration#steady-motion")]
pub struct ResponseResult {
    pub rms: RmsResult,
    /// Largest normal force on the teeth of a half (mesh force and applied impact) over the static one; null without torque. Never below 1.
    #[scalar(
        theory = "vibration#tooth-force-and-dynamic-factor",
        headline,
        lower_is_better,
        help = "Greatest normal force between the flanks over one period (or the record), impact included where one is applied, divided \
                by the force that the torque alone needs; that of the half where it is larger. Never below 1."
    )]
    pub dynamic_factor: Option<f64>,
    /// Normal force on the teeth of each half, impact included, along s of the plane in use.
    #[serde(default)]
    pub tooth_force_n: ToothForces,
    /// How the motion repeats: `period-1`, `period-2`, …, `quasi-periodic`, `chaotic`; `not-settled` where the record ended before the
    /// motion had settled, `unstable` where it grows without bound (its RMS values then mean nothing).
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    #[scalar(
        theory = "vibration#regime",
        label = "motion",
        help = "How the steady motion repeats. Period 1 follows the mesh; longer periods, quasi-periodic and chaotic motions come with \
                separation."
    )]
    pub regime: RegimeResult,
    /// `continuous`, `single-sided` (separation), `double-sided` (back flanks too), `apart` (no contact at all).
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    #[scalar(
        theory = "vibration#contact-and-separation",
        help = "Whether the working flanks keep touching while the pair vibrates. Separation makes the system nonlinear: several \
                motions may be possible at one speed, and impacts load the teeth."
    )]
    pub contact: ContactStateResult,
    #[scalar(
        theory = "vibration#contact-and-separation",
        label = "smallest mesh displacement",
        headline,
        change = Absolute,
        help = "Least displacement of the mesh along s, normal to the teeth; below half the backlash the teeth separate."
    )]
    pub min_displacement_um: f64,
    pub natural_frequencies_hz: Vec<f64>,
    #[scalar(label = "estimated relative error of the RMS values", theory = "vibration#error-estimate")]
    pub error_estimate: f64,
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    #[scalar(label = "method of the response")]
    pub method: MethodResult,
    #[scalar(label = "time in contact, mean of both halves", percent, theory = "vibration#contact-and-separation")]
    pub fraction_in_contact: f64,
    /// Whether the mesh damper acted in the gap (the printed law) or not.
    #[scalar(label = "mesh damper acts in the gap", theory = "vibration#mesh-force")]
    pub damping_in_gap: bool,
    /// Total play along s in the equations.
    #[serde(default)]
    #[scalar(label = "backlash along s, total", theory = "geometry#backlash")]
    pub backlash_um: Option<f64>,
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    #[scalar(label = "plane of the equations", theory = "vibration#equations-of-motion")]
    pub plane: Plane,
    #[scalar(theory = "geometry#speed-torque-and-mesh-frequency")]
    pub mesh_frequency_hz: f64,
    /// Mesh periods over which the means were taken.
    #[scalar(label = "mesh periods in the means", theory = "vibration#rms-values")]
    pub averaged_mesh_periods: u64,
    /// Displacement and velocity of the left mesh at each mesh period's start.
    pub poincare: Poincare,
    /// Amplitudes of the left half's circumferential acceleration by frequency.
    pub spectrum: Option<SpectrumResult>,
    /// Mesh periods after which the motion repeats; null when it does not.
    #[serde(default)]
    #[scalar(label = "motion repeats after", theory = "vibration#regime")]
    pub period_mesh_periods: Option<u64>,
    /// What small deviations are multiplied by over one period of the motion (`period_mesh_periods`), largest modulus first, motions that
    /// nothing holds left out; null when the motion was not found by the periodic method, and where nothing is left of any deviation after a
    /// mesh period.
    #[serde(default)]
    pub floquet_multipliers: Option<Vec<FloquetMultiplier>>,
    /// Modulus of the largest multiplier, as growth per mesh period; below 1 the motion is stable.
    #[serde(default)]
    #[scalar(label = "largest Floquet multiplier", theory = "vibration#stability")]
    pub floquet_modulus_per_mesh_period: Option<f64>,
    /// Largest Lyapunov exponent of a motion that does not repeat; above 0.01 it is called chaotic. Of an unstable one its growth rate.
    #[serde(default)]
    #[scalar(label = "largest Lyapunov exponent", change = Absolute, theory = "vibration#stability")]
    pub lyapunov_per_mesh_period: Option<f64>,
    /// Share of the recorded time in which each half's teeth touch, on either flank.
    #[serde(default)]
    #[scalar(label = "time in contact", percent, theory = "vibration#contact-and-separation")]
    pub contact_share: PerHalf,
    /// Where the true RMS values lie with a probability of 95 %, for a motion that does not repeat (batch means over the record); null for
    /// one that does, or when the record is too short against its correlation to say.
    #[serde(default)]
    pub confidence_interval_95: Option<RmsIntervalsResult>,
    /// Work-energy theorem over the recorded periods (the first 200 of a longer record): what the work of all forces does not explain of the change of kinetic
    /// energy, over the integral of the absolute power on each coordinate; null when nothing moves.
    #[serde(default)]
    #[scalar(label = "balance of work and energy, residual", theory = "vibration#energy-balance")]
    pub energy_balance_residual: Option<f64>,
    /// What each of `natural_frequencies_hz` is, in their order: undamped, contact closed, mean mesh stiffness.
    #[serde(default)]
    pub natural_modes: Vec<NaturalMode>,
    /// Force of each bearing on its shaft, pinion's first; absent without `design.shafts`.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub bearings: Vec<BearingForceResult>,
    /// Dynamic part of the force of that bearing where it is largest: root of the sum of squares of the RMS along x, y and z; absent without
    /// `design.shafts`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[scalar(
        label = "bearing force RMS, largest",
        headline,
        change = Level,
        lower_is_better,
        theory = "shafts#forced-vibration-of-the-full-model",
        help = "Root mean square of the dynamic force of a bearing, its three directions together, of the bearing where it is largest."
    )]
    pub largest_bearing_force_rms_n: Option<f64>,
    /// Of the geared rotor, undamped, at rest; absent without `design.shafts`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[scalar(label = "lowest natural frequency of the rotor", theory = "shafts#modes")]
    pub lowest_natural_frequency_hz: Option<f64>,
    /// Mesh orders of the tooth forces; absent without `design.shafts`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    #[scalar(skip)]
    pub tooth_force_orders_n: Option<ToothForceOrders>,
    /// Both shafts as a geared rotor; absent without `design.shafts`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub rotor: Option<RotorResult>,
}

/// Tooth force of each half, N, positive on driving flanks.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(halves)]
pub struct ToothForces {
    pub left: ToothForceResult,
    pub right: ToothForceResult,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = ToothForce))]
#[scalar(theory = "vibration#tooth-force-and-dynamic-factor")]
pub struct ToothForceResult {
    /// What the torque alone needs.
    #[serde(rename = "static")]
    #[scalar(label = "static tooth force", unit = "N")]
    pub static_n: f64,
    /// Largest and smallest over the record, exact between its steps.
    #[scalar(
        label = "largest tooth force",
        unit = "N",
        headline,
        lower_is_better,
        help = "Largest normal force on the teeth of a half over the record, impact included where one is applied."
    )]
    pub max: f64,
    #[scalar(label = "smallest tooth force", unit = "N", change = Absolute)]
    pub min: f64,
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
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = RmsIntervals))]
#[scalar(theory = "vibration#confidence-interval")]
pub struct RmsIntervalsResult {
    #[scalar(label = "mesh circumferential acceleration RMS")]
    pub mesh_circumferential_acceleration_m_s2: IntervalPerHalf,
    #[scalar(label = "pinion axial acceleration RMS")]
    pub pinion_axial_acceleration_m_s2: IntervalPerHalf,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(halves)]
pub struct IntervalPerHalf {
    pub left: IntervalResult,
    pub right: IntervalResult,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Interval))]
pub struct IntervalResult {
    #[scalar(label = "95 % confidence interval, lower end", unit = "m/s2")]
    pub low: f64,
    #[scalar(label = "95 % confidence interval, upper end", unit = "m/s2")]
    pub high: f64,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Rms))]
#[scalar(theory = "vibration#rms-values")]
pub struct RmsResult {
    #[scalar(
        label = "mesh circumferential acceleration RMS",
        headline,
        change = Level,
        lower_is_better,
        help = "Root mean square of the relative acceleration of pinion and gear at the mesh, along the circumference, mean removed; \
                exact over a whole number of periods."
    )]
    pub mesh_circumferential_acceleration_m_s2: PerHalf,
    #[scalar(
        label = "pinion axial acceleration RMS",
        headline,
        change = Level,
        lower_is_better,
        help = "Root mean square of the axial acceleration of each half of the pinion. Equal halves move against each other, so that \
                their axial forces cancel on the shaft."
    )]
    pub pinion_axial_acceleration_m_s2: PerHalf,
    /// Every recorded channel, in its SI unit (the catalogue of series names it).
    pub channels: BTreeMap<String, f64>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Poincare {
    pub x_left_m: Vec<f64>,
    pub v_x_left_m_s: Vec<f64>,
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Spectrum))]
pub struct SpectrumResult {
    pub frequency_hz: Vec<f64>,
    pub amplitude_m_s2: Vec<f64>,
}
