//! A motion from a start through a number of mesh periods, without statistics or series: what work is measured on.

use super::error::DynamicsError;
use super::integrate::{Integrator, Motion, Numerics};
use super::model::Model;
use super::parameters::Parameters;
use super::segment::Unobserved;
use crate::watch::Watch;

/// Where a motion has got to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// 12 displacements in the source's order (m, rad), then 12 velocities (m/s, rad/s).
    pub state: [f64; 24],
    pub numerics: Numerics,
}

/// Follows the motion from `start` (12 displacements, then 12 velocities, in the source's order, SI) through `mesh_periods`. `tolerance`:
/// local error of a step relative to the size of the motion. Mirrored motions of equal halves are solved in six coordinates.
///
/// # Errors
/// [`DynamicsError`] for parameters the equations cannot use and motions that cannot be followed.
pub fn advance(
    p: &Parameters,
    start: &[f64; 24],
    mesh_periods: u64,
    integrator: Integrator,
    tolerance: f64,
    watch: &Watch<'_>,
) -> Result<Reached, DynamicsError> {
    fn run<const D: usize>(
        p: &Parameters,
        start: &[f64; 24],
        mesh_periods: u64,
        (integrator, tolerance): (Integrator, f64),
        watch: &Watch<'_>,
    ) -> Result<Reached, DynamicsError> {
        let model = Model::<D>::new(p)?;
        let mut motion = Motion::new(&model, model.state_from(start), integrator, tolerance, u64::MAX);
        for period in 0..mesh_periods {
            let fraction = period as f64 / mesh_periods as f64;
            motion.advance_period(&mut Unobserved, watch, fraction)?;
            watch.checkpoint(fraction)?;
        }
        Ok(Reached { state: model.source_state(&motion.state), numerics: motion.numerics })
    }
    if p.is_symmetric() && is_mirrored(start) {
        run::<6>(p, start, mesh_periods, (integrator, tolerance), watch)
    } else {
        run::<12>(p, start, mesh_periods, (integrator, tolerance), watch)
    }
}

/// z of one half the opposite of the other's, the rest equal, displacements and velocities.
pub(crate) fn is_mirrored(state: &[f64; 24]) -> bool {
    [0, 12].iter().all(|&at| {
        (0..6).all(|c| {
            let (left, right) = (state[at + c], state[at + 6 + c]);
            left == if c == 1 || c == 4 { -right } else { right }
        })
    })
}
