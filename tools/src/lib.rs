//! Common parts of the programs of this package: a plotter, stopwatches, repeatable random numbers, arguments, and
//! (feature
//! `service`) the running service as a process with a connection to it.

pub mod arguments;
pub mod plot;
pub mod random;
pub mod reference;
#[cfg(feature = "service")]
pub mod service;
pub mod statistics;
pub mod stopwatch;

/// Any error of a program.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;
