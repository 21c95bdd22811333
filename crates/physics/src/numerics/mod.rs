//! Numerical methods that several modules share: Gauss–Legendre rules, interpolation, periodic splines, monotone cubics
//! and dense linear algebra on flat row-major slices.

pub(crate) mod dense;
pub(crate) mod gauss;
pub(crate) mod interpolation;
mod monotone;
mod periodic_spline;

pub(crate) use monotone::{PeriodicMonotoneCubic, monotone_cubics};
pub use periodic_spline::PeriodicSpline;
