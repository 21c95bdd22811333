//! Poincaré section of a motion, its periodicity, and Lyapunov exponents.

use std::collections::VecDeque;

use crate::dynamics::{
    DynamicModel, DynamicsError, Motion, MotionState, ObserverPair, PER_HALF, Perturbation, RigidBodyModes, Unobserved,
    Variation, W, state_difference,
};
use crate::watch::Watch;

/// Longest period that is searched for, in mesh periods.
pub(super) const LONGEST_PERIOD: usize = 32;

/// Lyapunov exponent per mesh period above which a motion counts as chaotic. The computed exponent of a regular motion
/// scatters around zero by a few thousandths.
pub(super) const CHAOS_PER_MESH_PERIOD: f64 = 0.01;

/// States at the starts of the last mesh periods.
pub(super) struct PoincareSection<const D: usize> {
    states: VecDeque<MotionState<D>>,
    rigid_body: RigidBodyModes<D>,
}

impl<const D: usize> PoincareSection<D> {
    /// Section of the complete states, for motions whose periodicity is not tested.
    pub fn new() -> Self {
        Self { states: VecDeque::with_capacity(LONGEST_PERIOD + 1), rigid_body: RigidBodyModes::none() }
    }

    /// Section without rigid-body modes, whose drift does not prevent periodicity.
    ///
    /// # Errors
    /// [`DynamicsError`] of [`RigidBodyModes::new`].
    pub fn without_rigid_body(model: &DynamicModel<D>) -> Result<Self, DynamicsError> {
        Ok(Self { rigid_body: RigidBodyModes::new(model)?, ..Self::new() })
    }

    pub fn push(&mut self, mut state: MotionState<D>) {
        (state.x, state.v) = self.rigid_body.project_out(&(state.x, state.v));
        if self.states.len() > LONGEST_PERIOD {
            self.states.pop_front();
        }
        self.states.push_back(state);
    }

    /// Size of the motion: its largest velocity in scaled time, or 1e-9 of the largest displacement if that is larger
    /// (below it is rounding).
    pub fn size(&self) -> f64 {
        let parts = |row: &[f64; D]| (0..D).filter(|c| c % PER_HALF != W).fold(0.0f64, |m, c| m.max(row[c].abs()));
        self.states.iter().fold(f64::MIN_POSITIVE, |m, s| m.max(parts(&s.v)).max(1e-9 * parts(&s.x)))
    }

    /// Relative change of the state over `n` mesh periods.
    pub fn change(&self, n: usize) -> Option<f64> {
        let last = self.states.len().checked_sub(1)?;
        let before = self.states.get(last.checked_sub(n)?)?;
        Some(largest_component(&state_difference(&self.states[last], before)) / self.size())
    }

    /// Shortest period, in mesh periods, over which the relative change is below `limit`, and that change. A multiple
    /// of a shorter period with a similar change is not taken.
    pub fn repeats(&self, limit: f64) -> Option<(usize, f64)> {
        let best = (1..=LONGEST_PERIOD).filter_map(|n| self.change(n)).fold(f64::INFINITY, f64::min);
        if best > limit {
            return None;
        }
        // Within ten times the smallest change, or far below the limit, counts as repeating.
        let accepted = (10.0 * best).max(1e-3 * limit).min(limit);
        (1..=LONGEST_PERIOD).find_map(|n| self.change(n).filter(|c| *c <= accepted).map(|c| (n, c)))
    }

    /// Period of a motion that is not refined to a periodic orbit: the shortest one over which the relative change is
    /// at most `limit`. A period of more than one mesh period must have a much smaller change than all shorter ones,
    /// because a decaying oscillation returns closer to itself after some numbers of mesh periods than after others.
    pub fn settled_period(&self, limit: f64) -> Option<usize> {
        const STANDS_OUT: f64 = 0.03;
        let mut least = f64::INFINITY;
        let mut close = None;
        for n in 1..=LONGEST_PERIOD {
            let Some(change) = self.change(n) else { break };
            if change <= limit {
                if n == 1 || change <= STANDS_OUT * least {
                    return Some(n);
                }
                close = close.or(Some(1));
            }
            least = least.min(change);
        }
        close
    }
}

/// Largest component of a perturbation, rigid rotation excluded.
pub(super) fn largest_component<const D: usize>(d: &Perturbation<D>) -> f64 {
    (0..D).filter(|c| c % PER_HALF != W).fold(0.0, |m, c| m.max(d.0[c].abs()).max(d.1[c].abs()))
}

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
