//! One step of a solution as polynomials: what observers of a motion see.

use super::excitation::{Coefficients, MAX_ORDER};
use super::model::{ContactSide, DynamicModel};
use super::taylor::evaluate_rows;

/// The motion over one step: coordinates as polynomials in scaled time since the step's start.
pub(crate) struct Segment<'a, const D: usize> {
    pub model: &'a DynamicModel<D>,
    /// Whole mesh periods since the start, and the phase at which the segment begins.
    pub period: u64,
    pub phase: f64,
    /// Length in scaled time.
    pub h: f64,
    /// Highest power in `rows`.
    pub degree: usize,
    pub rows: &'a [[f64; D]; MAX_ORDER + 1],
    /// Normal mesh force of each half, N, powers 0 to `degree` − 2.
    pub force: &'a [Coefficients; 2],
    pub contact: [ContactSide; 2],
}

impl<const D: usize> Segment<'_, D> {
    /// Displacements and velocities at scaled time `t` since the segment's start.
    pub fn at(&self, t: f64) -> ([f64; D], [f64; D]) {
        evaluate_rows(&self.rows[..=self.degree], t)
    }
}

/// Sees every step of a motion in order.
pub(crate) trait Observer<const D: usize> {
    fn segment(&mut self, segment: &Segment<'_, D>);
}

/// Looks at nothing.
pub(crate) struct Unobserved;

impl<const D: usize> Observer<D> for Unobserved {
    #[inline(always)]
    fn segment(&mut self, _: &Segment<'_, D>) {}
}
