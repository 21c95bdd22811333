//! Lyapunov exponents and the decay of perturbations.

use super::poincare::largest_component;
use crate::dynamics::{
    DynamicModel, DynamicsError, Motion, MotionState, ObserverPair, Perturbation, RigidBodyModes, Unobserved, Variation,
};
use crate::watch::Watch;

/// Mesh periods over which a Lyapunov exponent is averaged, at most.
pub(super) const LYAPUNOV_MESH_PERIODS: u64 = 400;

/// Lyapunov exponent per mesh period above which a motion counts as chaotic. The computed exponent of a regular motion
/// scatters around zero by a few thousandths.
pub(super) const CHAOS_PER_MESH_PERIOD: f64 = 0.01;

/// Largest Lyapunov exponent per mesh period, from one perturbation integrated over `periods` mesh periods of the
/// motion. The first tenth is not averaged; it aligns the perturbation with the direction of fastest growth.
///
/// Rigid-body modes are projected out of the perturbation after every mesh period. Along them it stays constant or
/// grows linearly, so that over any finite time the average would tend to 0 like ln(t)/t and hide negative exponents.
///
/// # Errors
/// [`DynamicsError`].
pub(super) fn lyapunov_exponent<const D: usize>(
    motion: &mut Motion<'_, D>,
    variation_model: &DynamicModel<D>,
    periods: u64,
    watch: &Watch<'_>,
) -> Result<f64, DynamicsError> {
    lyapunov_exponent_with(motion, variation_model, periods, watch, |_, _| ())
}

/// As [`lyapunov_exponent`]; `on_period` receives the logarithmic growth of the perturbation over each mesh period and
/// the state at its end.
pub(super) fn lyapunov_exponent_with<const D: usize>(
    motion: &mut Motion<'_, D>,
    variation_model: &DynamicModel<D>,
    periods: u64,
    watch: &Watch<'_>,
    mut on_period: impl FnMut(f64, &MotionState<D>),
) -> Result<f64, DynamicsError> {
    let start = generic_perturbation(variation_model);
    let rigid_body = RigidBodyModes::new(variation_model)?;
    let mut variation = Variation::new(variation_model, vec![rigid_body.project_out(&start)], 1e-9);
    let (mut sum, mut counted) = (0.0, 0u64);
    for period in 0..periods {
        let before = largest_component(&variation.columns[0]);
        motion.advance_period(&mut ObserverPair(&mut Unobserved, &mut variation), watch, 0.0)?;
        variation.columns[0] = rigid_body.project_out(&variation.columns[0]);
        let (x, v) = &mut variation.columns[0];
        let after = largest_component(&(*x, *v));
        if !(after > 0.0 && after.is_finite()) {
            return Ok(f64::NEG_INFINITY);
        }
        on_period((after / before).ln(), &motion.state);
        if period >= periods / 10 {
            sum += (after / before).ln();
            counted += 1;
        }
        x.iter_mut().chain(v.iter_mut()).for_each(|c| *c /= after);
    }
    Ok(sum / counted.max(1) as f64)
}

/// Ratio of a perturbation after and before one mesh period of the motion, rigid-body modes excluded, by its largest
/// component.
pub(super) fn perturbation_decay<const D: usize>(
    motion: &mut Motion<'_, D>,
    variation_model: &DynamicModel<D>,
    rigid_body: &RigidBodyModes<D>,
    watch: &Watch<'_>,
) -> Result<f64, DynamicsError> {
    let start = rigid_body.project_out(&generic_perturbation(variation_model));
    let mut variation = Variation::new(variation_model, vec![start], 1e-6);
    motion.advance_period(&mut ObserverPair(&mut Unobserved, &mut variation), watch, 0.0)?;
    let left = largest_component(&rigid_body.project_out(&variation.columns[0])) / largest_component(&start);
    // NaN: the perturbation does not decay.
    Ok(if left.is_nan() { f64::INFINITY } else { left })
}

/// A perturbation with a component along every active displacement.
fn generic_perturbation<const D: usize>(model: &DynamicModel<D>) -> Perturbation<D> {
    let mut start = ([0.0; D], [0.0; D]);
    for (i, c) in model.active().enumerate() {
        start.0[c] = 1.0 / (i + 1) as f64;
    }
    start
}
