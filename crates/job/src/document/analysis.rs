//! Accuracy and method of the analysis.

use crate::reader::ObjectPlace;
use herringbone_macros::{Input, Words};
use serde::Serialize;

/// Largest number of samples per recorded channel.
pub const MAX_SERIES_SAMPLES: u64 = 4_000_000;

/// Accuracy and method of the analysis of a response.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(group = "analysis", rules = analysis_rules)]
pub struct AnalysisInput {
    /// Relative error of the reported RMS values that the solver has to reach.
    #[input(min = 1e-12, max = 1e-2, default = 1e-6)]
    pub accuracy: f64,
    /// auto (the cheapest that is right), periodic, or integrate over mesh_periods.
    #[input(default = MethodInput::Auto)]
    pub method: MethodInput,
    /// Time integration: event-exact Taylor series, or the variable-step fourth-order Runge-Kutta of the source.
    #[input(default = IntegratorInput::Taylor)]
    pub integrator: IntegratorInput,
    /// Mesh periods to integrate.
    #[input(min = 1, max = 10_000_000, default = 300)]
    pub mesh_periods: u32,
    /// Last mesh periods of them that are recorded.
    #[input(min = 1, max = 100_000, default = 100)]
    pub record_mesh_periods: u32,
    /// Samples per mesh period of each series.
    #[input(min = 8, max = 4096, default = 256)]
    pub samples_per_mesh_period: u32,
    /// Channels to record as series, such as a_x_left; all when null.
    #[input(max_items = 64)]
    pub channels: Option<Vec<String>>,
    /// Start of the motion: 12 displacements in the source's order (m, rad), then 12 velocities; at rest under the mean load when null.
    /// Of several steady motions, auto and periodic report the one reached from there.
    #[input(unit = "SI", min = -1e6, max = 1e6, min_items = 24, max_items = 24)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub initial_state: Option<Vec<f64>>,
}

fn analysis_rules(analysis: &mut AnalysisInput, place: &ObjectPlace) {
    let recorded = analysis.record_mesh_periods;
    if recorded > analysis.mesh_periods && place.gives("record_mesh_periods") {
        let detail = format!("is {recorded}; permitted: 1 to mesh_periods, which is {}", analysis.mesh_periods);
        place.conflict("record_mesh_periods", detail);
    }
    let samples = u64::from(recorded) * u64::from(analysis.samples_per_mesh_period);
    if samples > MAX_SERIES_SAMPLES {
        let detail = format!(
            "times record_mesh_periods gives {samples} samples per channel; permitted: at most {MAX_SERIES_SAMPLES}"
        );
        place.conflict("samples_per_mesh_period", detail);
    }
    analysis.record_mesh_periods = recorded.min(analysis.mesh_periods);
}

/// Method by which the steady motion is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum MethodInput {
    /// The cheapest that is right.
    Auto,
    /// As a periodic orbit.
    Periodic,
    /// By integration from the initial state over the given number of mesh periods.
    Integrate,
}

/// Time integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum IntegratorInput {
    /// Event-exact Taylor series on the piecewise-linear equations.
    Taylor,
    /// Variable-step fourth-order Runge–Kutta, as the source paper used.
    #[words(rename = "runge_kutta_4", label = "Runge–Kutta 4")]
    RungeKutta4,
}
