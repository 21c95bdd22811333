//! Input and result types of a response.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::channel::{Channel, ChannelId};
use super::confidence::ConfidenceInterval;
use super::orders::MeshOrder;
use super::statistics::Statistics;
use crate::dynamics::{Integrator, StepCounts};

/// Method by which the reported motion is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolutionMethod {
    /// The periodic solution without loss of contact if a stable one exists; otherwise integration until the motion
    /// nearly repeats, refined by Newton's method on the period map; otherwise a long record of a motion that does not
    /// repeat.
    #[default]
    Auto,
    /// As `Auto`, but a motion that does not repeat is an error.
    Periodic,
    /// Integration from the initial state over `mesh_periods`; the last `record_mesh_periods` are recorded.
    Integrate {
        /// Mesh periods integrated.
        mesh_periods: u64,
        /// Mesh periods recorded, the last ones.
        record_mesh_periods: u64,
    },
}

/// Settings of an analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Method by which the reported motion is found.
    pub method: SolutionMethod,
    /// Integrator of `Integrate`; the other methods use Taylor series.
    pub integrator: Integrator,
    /// Relative error of the RMS values, 1e-13 … 0.1.
    pub accuracy: f64,
    /// Sampling density of the time series; 0: none.
    pub samples_per_mesh_period: usize,
    /// Channels recorded as time series, with statistics.
    pub channels: Vec<ChannelId>,
    /// 12 displacements in the order of [the module](crate::dynamics), then 12 velocities. `Integrate` begins there; of
    /// several steady motions the other methods report the one reached from there. None: static deflection under the
    /// mean mesh stiffness, at rest; the other methods then prefer a motion without loss of contact.
    pub initial_state: Option<[f64; 24]>,
    /// Coordinates of a train, then their velocities (1/s), in its order: in place of `initial_state`, of which a train
    /// has more coordinates. Not used without a train.
    pub initial_modal_state: Option<Vec<f64>>,
    /// Limit of the steps of one integration.
    pub max_steps: u64,
    /// Whether to check the recorded motion by its energy balance.
    pub energy_balance: bool,
    /// Whether the Floquet multipliers are asked for. Without, they are computed only where nothing cheaper proves that
    /// the motion is stable.
    pub multipliers: bool,
    /// Poincaré points of a motion that does not repeat, at least; 0: those of its record.
    pub poincare_points: usize,
}

impl Default for Analysis {
    fn default() -> Self {
        Self {
            method: SolutionMethod::Auto,
            integrator: Integrator::Taylor,
            accuracy: 1e-6,
            samples_per_mesh_period: 256,
            channels: Vec::new(),
            initial_state: None,
            initial_modal_state: None,
            max_steps: 100_000_000,
            energy_balance: false,
            multipliers: true,
            poincare_points: 0,
        }
    }
}

/// Regime of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Regime {
    /// Repeats every mesh period.
    #[serde(rename = "period-1")]
    Period1,
    /// Repeats after several mesh periods, see [`Summary::period_mesh_periods`].
    #[serde(rename = "period-n")]
    PeriodN,
    /// Does not repeat; perturbations neither grow nor decay.
    #[serde(rename = "quasi-periodic")]
    QuasiPeriodic,
    /// Does not repeat; perturbations grow exponentially (positive Lyapunov exponent).
    #[serde(rename = "chaotic")]
    Chaotic,
    /// The record ended before the transient: a component still decays, or grows towards another motion.
    #[serde(rename = "not-settled")]
    NotSettled,
    /// Grows without bound by parametric instability.
    #[serde(rename = "unstable")]
    Unstable,
}

/// Method by which a motion was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AppliedMethod {
    /// Newton's method on the period map, or a motion known in closed form.
    Periodic,
    /// Integration in time.
    Integrate,
}

/// Contact of the teeth over the recorded periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactState {
    /// Always in contact on one flank.
    Continuous,
    /// Loss of contact, without contact on the opposite flank.
    SingleSided,
    /// Contact on both flanks.
    DoubleSided,
    /// No contact: a pair without load in the middle of its backlash.
    Apart,
}

/// Normal tooth force of a half, N, positive on driving flanks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ToothForce {
    /// T_p/(R_p cosβ) of the half's torque; of a train the force that carries its load at rest, closed with its
    /// reference stiffnesses.
    pub static_n: f64,
    /// Largest value of mesh force plus impact over the record.
    pub max_n: f64,
    /// Smallest value of mesh force plus impact over the record.
    pub min_n: f64,
}

/// One value per half.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Halves<T> {
    /// Left half.
    pub left: T,
    /// Right half.
    pub right: T,
}

/// RMS values, exact time means; without the mean except for accelerations (see [`Statistics::rms`]).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rms {
    /// x'' of each half.
    pub mesh_circumferential_acceleration_m_s2: Halves<f64>,
    /// z_p'' of each half.
    pub pinion_axial_acceleration_m_s2: Halves<f64>,
    /// All recorded channels by name, in the unit of the channel.
    pub channels: BTreeMap<String, f64>,
}

/// Confidence intervals of the RMS values of the two accelerations.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RmsIntervals {
    /// Of x'' of each half.
    pub mesh_circumferential_acceleration_m_s2: Halves<ConfidenceInterval>,
    /// Of z_p'' of each half.
    pub pinion_axial_acceleration_m_s2: Halves<ConfidenceInterval>,
}

/// A Floquet multiplier: factor of a perturbation in one direction over one period of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Multiplier {
    /// Modulus; above 1 the perturbation grows.
    pub modulus: f64,
    /// Argument, −π … π; ±π at a period doubling where the modulus reaches 1.
    pub angle_rad: f64,
}

/// Results of a response without its time series.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// RMS values.
    pub rms: Rms,
    /// Mean, RMS, minimum and maximum of every channel recorded as a time series.
    pub statistics: BTreeMap<String, Statistics>,
    /// Largest normal tooth force of either half (mesh force and impact) over the static one, T_p/(R_p cosβ); None
    /// without torque. At least 1: the mean tooth force of a periodic motion is the static one, and a record of a
    /// transient counts the static load.
    pub dynamic_factor: Option<f64>,
    /// Tooth force of each half.
    pub tooth_force: Halves<ToothForce>,
    /// Regime of the motion.
    pub regime: Regime,
    /// Mesh periods after which the motion repeats.
    pub period_mesh_periods: Option<u64>,
    /// Contact of the teeth over the record.
    pub contact: ContactState,
    /// Fraction of the recorded time in contact (either flank).
    pub contact_share: Halves<f64>,
    /// Smallest s of either half, m.
    pub min_displacement_m: f64,
    /// Natural frequencies, Hz, ascending.
    pub natural_frequencies_hz: Vec<f64>,
    /// Estimated relative error of the RMS values: of the integration for a periodic motion or a record that is
    /// integrated accurately, otherwise the standard error of the finite record.
    pub error_estimate: f64,
    /// Method by which the reported motion was found.
    pub method: AppliedMethod,
    /// Modulus of the largest Floquet multiplier over one mesh period, rigid-body modes excluded; None unless the
    /// motion was found as a periodic orbit.
    pub floquet_modulus: Option<f64>,
    /// All Floquet multipliers over one period of the motion, rigid-body modes excluded, largest modulus first; None
    /// unless the motion was found as a periodic orbit. For mirror-symmetric halves those of antisymmetric
    /// perturbations are included.
    pub floquet_multipliers: Option<Vec<Multiplier>>,
    /// Largest Lyapunov exponent per mesh period of a motion that does not repeat, averaged over at most 400 mesh
    /// periods; of an unstable motion its growth rate.
    pub lyapunov_per_mesh_period: Option<f64>,
    /// 95 % confidence intervals of the RMS values of a motion that does not repeat (module `confidence`); None for a
    /// periodic motion or a record too short for its correlation.
    pub rms_interval_95: Option<RmsIntervals>,
    /// Difference between the change of kinetic energy and the work of the forces, relative to the integral of the
    /// absolute power; None unless requested, or when nothing moves.
    pub energy_balance_residual: Option<f64>,
    /// Mesh periods of the record.
    pub recorded_mesh_periods: u64,
    /// 6 for mirror-symmetric halves, otherwise 12; of a train the number of its coordinates.
    pub degrees_of_freedom: u32,
    /// Whether the mesh damper acts in the gap.
    pub damping_in_gap: bool,
    /// Work of all integrations.
    pub counts: StepCounts,
}

/// Point of the Poincaré section at the start of a mesh period: displacement and velocity of the left half's mesh.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PoincarePoint {
    /// x of the left half, m.
    pub x_left_m: f64,
    /// dx/dt of the left half, m/s.
    pub v_x_left_m_s: f64,
}

/// A further quantity of a train over the record, for example a bearing force.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OutputResponse {
    /// Name and unit, as the train gives them.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Time mean.
    pub mean: f64,
    /// RMS of the dynamic part, without the mean.
    pub rms: f64,
    /// Mesh orders from the first, by integrals over the record.
    pub orders: Vec<MeshOrder>,
}

/// Response of a pair at one operating point.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Results without time series.
    pub summary: Summary,
    /// Time series of the requested channels, in their order.
    pub channels: Vec<Channel>,
    /// The further quantities of a train, in its order.
    pub outputs: Vec<OutputResponse>,
    /// Mesh orders of the total normal tooth forces, N; of a train only.
    pub tooth_force_orders: Option<Halves<Vec<MeshOrder>>>,
    /// One point per recorded mesh period.
    pub poincare: Vec<PoincarePoint>,
    /// State at the end of the record: 12 displacements (m, rad), then 12 velocities (m/s, rad/s). The integration of a
    /// neighbouring operating point can start from it. Of a train the motion has further coordinates, which a start
    /// from this state takes at least energy.
    pub final_state: [f64; 24],
    /// State of a train at the end of the record: its coordinates, then their velocities (1/s), in its order. Empty
    /// without a train.
    pub final_modal_state: Vec<f64>,
}
