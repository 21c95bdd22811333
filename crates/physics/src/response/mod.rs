//! From a motion to what is reported of it: RMS values, extremes, contact, regime, series, spectra.

// Loops over coordinates and Taylor orders read as the formulas do with an index.
#![allow(clippy::needless_range_loop)]

mod analysis;
mod budget;
mod channel;
mod confidence;
mod energy;
mod recorder;
mod recording;
mod regime;
mod report;
mod rest;
mod settling;
mod solve;
mod spectrum;
mod statistics;
mod steady;

pub use analysis::{
    Analysis, ContactState, Halves, Method, Multiplier, PoincarePoint, Regime, Response, Rms, RmsIntervals, Summary,
    ToothForce,
};
pub use channel::{Channel, ChannelId, Quantity};
pub use confidence::Interval;
pub use solve::{solve, solve_many};
pub use spectrum::Spectrum;
pub use statistics::Statistics;

#[cfg(test)]
mod properties;
#[cfg(test)]
mod tests;
