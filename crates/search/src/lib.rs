//! Search for the best of several variables, and statistics of samples. No gears, no I/O, no clock: callers ask for
//! points, evaluate them in any way they like, and tell the scores.
//!
//! Variables are in \[0, 1\]. Every random number follows from a seed and a place, so that the same scores lead to the
//! same points, on any number of threads and after any interruption: a search is restored by telling it the scores of
//! before once more.

mod cma_es;
mod front;
mod nelder_mead;
mod normal;
mod polish;
mod random;
mod score;
mod search;
mod sobol;
pub mod statistics;
#[cfg(test)]
mod tests;

pub use cma_es::CmaEs;
pub use front::{crowded_front, hypervolume, knee};
pub use nelder_mead::NelderMead;
pub use normal::{correlated, normal_distribution, normal_quantile};
pub use random::CounterRandom;
pub use score::Score;
pub use search::{Batch, Method, Phase, Search, SearchSettings, StoppedBy};
pub use sobol::{MAX_SOBOL_POINTS, sobol_point};
