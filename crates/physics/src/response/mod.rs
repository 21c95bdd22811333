//! From a motion to what is reported of it: RMS values, extremes, contact, regime, series, spectra.

// Loops over coordinates and Taylor orders read as the formulas do with an index.
#![allow(clippy::needless_range_loop)]

mod analysis;
mod budget;
mod channel;
mod classification;
mod confidence;
mod energy;
mod quadrature;
mod recorder;
mod recording;
mod regime;
mod report;
mod rest;
mod solve;
mod spectrum;
mod statistics;
mod steady;

pub use analysis::{
    Analysis, ContactState, Halves, Multiplier, PoincarePoint, Regime, Response, Rms, RmsIntervals, SolutionMethod,
    Summary, ToothForce,
};
pub use channel::{Channel, ChannelId, Quantity};
pub use confidence::ConfidenceInterval;
pub use solve::{solve, solve_many};
pub use spectrum::Spectrum;
pub use statistics::Statistics;

#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
