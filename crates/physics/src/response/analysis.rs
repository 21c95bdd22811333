//! What is asked of a response, and what comes back.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::channel::{Channel, ChannelId};
use super::confidence::Interval;
use super::statistics::Statistics;
use crate::dynamics::{Integrator, Numerics};

/// How the steady state is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// The periodic solution without loss of contact if there is a stable one, else integration until the motion repeats (made
    /// exact by Newton's method on the period map), else a long record of a motion that does not repeat.
    #[default]
    Auto,
    /// As `Auto`, but a motion that does not repeat is an error.
    Periodic,
    /// From the initial state through `mesh_periods`, the last `record_mesh_periods` of which are recorded.
    Integrate { mesh_periods: u64, record_mesh_periods: u64 },
}

/// What is asked of a response.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    pub method: Method,
    /// For `Integrate`; the other methods use Taylor series.
    pub integrator: Integrator,
    /// Relative error of the RMS values, 1e-13 … 0.1.
    pub accuracy: f64,
    /// Density of the series; 0: none.
    pub samples_per_mesh_period: usize,
    /// Channels to record as series (and to give statistics of).
    pub channels: Vec<ChannelId>,
    /// 12 displacements in the source's order, then 12 velocities. `Integrate` begins there; the other methods report the steady motion
    /// that is reached from there, of several. None: static deflection under the mean mesh stiffness, at rest; the other
    /// methods then prefer the motion that keeps contact.
    pub initial_state: Option<[f64; 24]>,
    /// Steps after which an integration gives up.
    pub max_steps: u64,
    /// Whether to check the recorded motion by its energy balance.
    pub energy_balance: bool,
}

impl Default for Analysis {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            integrator: Integrator::Taylor,
            accuracy: 1e-6,
            samples_per_mesh_period: 256,
            channels: Vec::new(),
            initial_state: None,
            max_steps: 100_000_000,
            energy_balance: false,
        }
    }
}

/// How the motion repeats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Regime {
    /// Repeats every mesh period.
    #[serde(rename = "period-1")]
    Period1,
    /// Repeats after several mesh periods (how many: [`Summary::period_mesh_periods`]).
    #[serde(rename = "period-n")]
    PeriodN,
    #[serde(rename = "quasi-periodic")]
    QuasiPeriodic,
    #[serde(rename = "chaotic")]
    Chaotic,
    /// The record ended before the motion did: what is left of its start still decays (or grows towards another motion).
    #[serde(rename = "not-settled")]
    NotSettled,
    /// Grows without bound: the stiffness's fluctuation feeds the vibration more than the dampers take (parametric instability).
    #[serde(rename = "unstable")]
    Unstable,
}

/// What the teeth do over the recorded periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ContactState {
    /// Always in contact on one flank.
    Continuous,
    /// They separate and come back to the same flank.
    SingleSided,
    /// They separate and reach the back flanks too.
    DoubleSided,
    /// They never touch: a pair without load in the middle of its backlash.
    Apart,
}

/// Normal force on the teeth of a half, N, positive on driving flanks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ToothForce {
    /// T_p/(R_p cosβ) of the half's torque.
    pub static_n: f64,
    /// Extremes over the record of everything that acts between the teeth: mesh force and, where one is applied, the impact.
    pub max_n: f64,
    pub min_n: f64,
}

/// A value of each half.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Halves<T> {
    pub left: T,
    pub right: T,
}

/// RMS values, exact time means; the mean removed except of accelerations (see [`Statistics::rms`]).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rms {
    /// x'' of each half.
    pub mesh_circumferential_acceleration_m_s2: Halves<f64>,
    /// z_p'' of each half.
    pub pinion_axial_acceleration_m_s2: Halves<f64>,
    /// Every channel that was recorded, by name, in the channel's unit.
    pub channels: BTreeMap<String, f64>,
}

/// Intervals of the two accelerations' RMS values.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct RmsIntervals {
    pub mesh_circumferential_acceleration_m_s2: Halves<Interval>,
    pub pinion_axial_acceleration_m_s2: Halves<Interval>,
}

/// A Floquet multiplier: what a small perturbation of its kind is multiplied by over one period of the motion.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Multiplier {
    pub modulus: f64,
    /// −π … π; 0 grows or decays on one side, ±π changes sides every period (a period doubling where the modulus reaches 1).
    pub angle_rad: f64,
}

/// The numbers of a response, without its series.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    pub rms: Rms,
    /// Mean, RMS, minimum and maximum of every channel recorded as a series.
    pub statistics: BTreeMap<String, Statistics>,
    /// Largest normal force on the teeth of either half (mesh force and impact) over the static one, T_p/(R_p cosβ); None without
    /// torque. Never below 1: the mean of the tooth force is the static one over a motion that repeats, and a record of a motion on its way
    /// there counts the load it goes to.
    pub dynamic_factor: Option<f64>,
    pub tooth_force: Halves<ToothForce>,
    pub regime: Regime,
    /// Mesh periods after which the motion repeats, when it does.
    pub period_mesh_periods: Option<u64>,
    pub contact: ContactState,
    /// Share of the recorded time in contact (either flank).
    pub contact_share: Halves<f64>,
    /// Smallest s of either half, m.
    pub min_displacement_m: f64,
    pub natural_frequencies_hz: Vec<f64>,
    /// Estimated relative error of the RMS values: of the method for a motion that repeats (or whose record is followed
    /// exactly), of the finite record (standard error over its parts) for one that does not.
    pub error_estimate: f64,
    /// `periodic` or `integrate`: how the reported motion was found.
    pub method: String,
    /// Modulus of the largest Floquet multiplier over one mesh period, free motions apart; only from the periodic method.
    pub floquet_modulus: Option<f64>,
    /// All Floquet multipliers over one period of the motion, free motions apart, largest modulus first; only from the periodic
    /// method. With mirror-symmetric halves those against the symmetry are among them.
    pub floquet_multipliers: Option<Vec<Multiplier>>,
    /// Largest Lyapunov exponent per mesh period, where the motion did not repeat; of one that grows without bound its growth rate.
    pub lyapunov_per_mesh_period: Option<f64>,
    /// Where the true RMS values lie with a probability of 95 %, for a motion that does not repeat (see `confidence`); None for
    /// one that does, or when the record is too short to say.
    pub rms_interval_95: Option<RmsIntervals>,
    /// What the work of the forces does not explain of the change of kinetic energy, as a part of the energy that changed hands;
    /// None when not asked for or when nothing moves.
    pub energy_balance_residual: Option<f64>,
    pub recorded_mesh_periods: u64,
    /// 6 when the halves mirror each other, else 12.
    pub degrees_of_freedom: u32,
    pub damping_in_gap: bool,
    pub numerics: Numerics,
}

/// A motion at the start of a mesh period: the left half's mesh displacement and velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PoincarePoint {
    pub x_left_m: f64,
    pub v_x_left_m_s: f64,
}

/// The response of a pair at one operating point.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    pub summary: Summary,
    /// The channels asked for, in their order.
    pub channels: Vec<Channel>,
    /// One point per recorded mesh period.
    pub poincare: Vec<PoincarePoint>,
    /// State at the end of the record: 12 displacements in the source's order, then 12 velocities. A neighbouring operating
    /// point can continue from it.
    pub final_state: [f64; 24],
}
