//! Every way to follow the motion, behind one interface.

mod differential_equations;
mod diffsol;
mod ode_solvers;
mod own;
mod python;

use crate::case::{Case, SourceState};

/// Whose method it is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Whose {
    Own,
    Peer,
    Scipy,
}

/// Where a run got to.
pub struct Run {
    pub state: SourceState,
    /// What it took, if it was done elsewhere.
    pub seconds: Option<f64>,
}

impl From<SourceState> for Run {
    fn from(state: SourceState) -> Self {
        Self { state, seconds: None }
    }
}

/// One method with its settings but for the tolerance.
pub trait Method {
    fn name(&self) -> String;
    fn whose(&self) -> Whose;
    /// From coarse to fine.
    fn tolerances(&self) -> Vec<f64>;
    /// Operating points followed in a run.
    fn points(&self) -> usize {
        1
    }
    /// From the case's start through `periods`.
    fn run(&mut self, case: &Case, tolerance: f64, periods: u64) -> Result<Run, String>;
}

/// Ours and everybody's. SciPy and heyoka through `python`, when there is one.
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

/// What to say of a method that may be restarted at the edges of the impact.
fn straight_or_restarted(name: &str, restart: bool) -> String {
    format!("{name}{}", if restart { ", restarted" } else { "" })
}
