//! All methods behind one interface.

mod differential_equations;
mod diffsol;
mod ode_solvers;
mod own;
mod python;

use crate::case::{PhysicalState, ReferenceCase};

/// Group of a method.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Origin {
    Own,
    Peer,
    Scipy,
}

/// Result of a run.
pub struct RunResult {
    pub state: PhysicalState,
    /// Time measured by the method itself, s, if it runs in another process.
    pub seconds: Option<f64>,
}

impl From<PhysicalState> for RunResult {
    fn from(state: PhysicalState) -> Self {
        Self { state, seconds: None }
    }
}

/// One method with its settings except the tolerance.
pub trait Method {
    fn name(&self) -> String;
    fn origin(&self) -> Origin;
    /// From coarse to fine.
    fn tolerances(&self) -> Vec<f64>;
    /// Operating points per run.
    fn points(&self) -> usize {
        1
    }
    /// Integrates from the case's start through `periods`.
    fn run(&mut self, case: &ReferenceCase, tolerance: f64, periods: u64) -> Result<RunResult, String>;
}

/// All methods; those of SciPy and heyoka through `python`, if given.
pub fn all(python: Option<&str>) -> Vec<Box<dyn Method>> {
    let mut out = own::all();
    out.extend(ode_solvers::all());
    out.extend(differential_equations::all());
    out.extend(diffsol::all());
    out.extend(python.map(python::all).unwrap_or_default());
    out
}

/// 10^-`from`, 10^-(`from` + 0.5) … 10^-`to`.
fn ladder(from: i32, to: i32) -> Vec<f64> {
    (2 * from..=2 * to).map(|half| 10f64.powf(-0.5 * f64::from(half))).collect()
}

/// Name of a method that may be restarted at the edges of the impact.
fn straight_or_restarted(name: &str, restart: bool) -> String {
    format!("{name}{}", if restart { ", restarted" } else { "" })
}
