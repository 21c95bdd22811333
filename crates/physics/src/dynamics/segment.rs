//! Polynomial segments of a motion and their observers.

use super::excitation::{Coefficients, MAX_ORDER};
use super::model::{ContactSide, DynamicModel};
use super::taylor::evaluate_rows;

/// One step of a motion: coordinates as polynomials in scaled time since the start of the step.
pub(crate) struct Segment<'a, const D: usize> {
    pub model: &'a DynamicModel<D>,
    /// Whole mesh periods since the start, and the phase at the start of the segment.
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
    /// Displacements and velocities at scaled time `t` since the start of the segment.
    pub(crate) fn at(&self, t: f64) -> ([f64; D], [f64; D]) {
        evaluate_rows(&self.rows[..=self.degree], t)
    }
}

/// Observer of the segments of a motion, in order of time.
pub(crate) trait Observer<const D: usize> {
    fn segment(&mut self, segment: &Segment<'_, D>);
}

/// Observer without effect.
pub(crate) struct Unobserved;

impl<const D: usize> Observer<D> for Unobserved {
    #[inline(always)]
    fn segment(&mut self, _: &Segment<'_, D>) {}
}
