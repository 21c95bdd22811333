//! Response of a pair at an operating point: steady-state search, RMS values, extremes, contact state, regime, time
//! series, spectra.
//!
//! [`solve`] integrates the [equations of motion](crate::dynamics) by the chosen [`SolutionMethod`] and returns a
//! [`Response`]; [`solve_many`] does so for many operating points in parallel.

// Loops over coordinates and Taylor orders are written with an index, as the formulas are.
#![allow(clippy::needless_range_loop)]

mod analysis;
mod budget;
mod channel;
mod classification;
mod confidence;
mod energy;
mod harmonic;
mod lyapunov;
mod orders;
mod poincare;
mod recorder;
mod recording;
mod report;
mod rest;
mod solve;
mod spectrum;
mod statistics;
mod steady;

pub use analysis::{
    Analysis, AppliedMethod, ContactState, Halves, Multiplier, OutputResponse, PoincarePoint, Regime, Response, Rms,
    RmsIntervals, SolutionMethod, Summary, ToothForce,
};
pub use channel::{Channel, ChannelId, ChannelQuantity};
pub use confidence::ConfidenceInterval;
pub use orders::{MESH_ORDERS, MeshOrder};
pub use solve::{solve, solve_many};
pub use spectrum::Spectrum;
pub use statistics::Statistics;

#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
