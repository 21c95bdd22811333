//! Numerical methods that several modules share: Gauss–Legendre rules, Fourier series, interpolation, periodic splines,
//! monotone cubics, dense linear algebra on flat row-major slices, eigenvalues of matrices without symmetry, systems of
//! which only products are known.

pub(crate) mod dense;
pub(crate) mod eigen;
pub(crate) mod fourier;
pub(crate) mod gauss;
pub(crate) mod gmres;
pub(crate) mod interpolation;
mod monotone;
mod periodic_spline;

pub(crate) use monotone::{PeriodicMonotoneCubic, monotone_cubics};
pub use periodic_spline::PeriodicSpline;
