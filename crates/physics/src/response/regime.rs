//! Does a motion repeat, and how fast do neighbours leave it?

use std::collections::VecDeque;

use crate::dynamics::{
    DynamicModel, DynamicsError, Motion, MotionState, ObserverPair, PER_HALF, Perturbation, RigidBodyModes, Unobserved,
    Variation, W, state_difference,
};
use crate::watch::Watch;

/// The longest period that is looked for, in mesh periods.
pub(super) const LONGEST_PERIOD: usize = 32;

/// A Lyapunov exponent above this, per mesh period, is taken for chaos: the exponent of a motion that does not grow
/// scatters around zero by a few thousandths over the mesh periods it is averaged.
pub(super) const CHAOS_PER_MESH_PERIOD: f64 = 0.01;

/// States at the starts of the last mesh periods.
pub(super) struct PoincareSection<const D: usize> {
    states: VecDeque<MotionState<D>>,
    rigid_body: RigidBodyModes<D>,
}

impl<const D: usize> PoincareSection<D> {
    /// States as they are: for motions of which it is not asked whether they repeat.
    pub fn new() -> Self {
        Self { states: VecDeque::with_capacity(LONGEST_PERIOD + 1), rigid_body: RigidBodyModes::none() }
    }

    /// States without their free motions, whose drift keeps no motion from repeating.
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

    /// Size of the motion: its largest scaled velocity, or a billionth of the deflection when it hardly moves (what is
    /// smaller is rounding).
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

    /// The shortest period over which the state changes by less than `limit`, and by how much. A multiple of a shorter
    /// period that repeats nearly as well is not taken.
    pub fn repeats(&self, limit: f64) -> Option<(usize, f64)> {
        let best = (1..=LONGEST_PERIOD).filter_map(|n| self.change(n)).fold(f64::INFINITY, f64::min);
        if best > limit {
            return None;
        }
        // Within ten times the best or far below the limit counts as repeating.
        let accepted = (10.0 * best).max(1e-3 * limit).min(limit);
        (1..=LONGEST_PERIOD).find_map(|n| self.change(n).filter(|c| *c <= accepted).map(|c| (n, c)))
    }

    /// The period of a motion that is followed without being made exact: the shortest over which the state changes by no
    /// more than `limit`. A longer one than a mesh period has to stand out from the shorter ones: what is left of a
    /// transient turns and decays, and comes closer to itself after some numbers of periods than after others.
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

/// Largest component of a perturbation, free rotation apart.
pub(super) fn largest_component<const D: usize>(d: &Perturbation<D>) -> f64 {
    (0..D).filter(|c| c % PER_HALF != W).fold(0.0, |m, c| m.max(d.0[c].abs()).max(d.1[c].abs()))
}

/// Largest Lyapunov exponent per mesh period, from one perturbation carried along `periods` mesh periods of the motion (the first
/// tenth only turns it into the fastest direction).
///
/// Perturbations along free motions are taken out after every mesh period: they stay for ever (or grow with time, not
/// exponentially), so over any finite time they would hide every exponent below zero: a mean that tends to 0 like
/// ln(t)/t from whatever the motion's own is.
pub(super) fn lyapunov_exponent<const D: usize>(
    motion: &mut Motion<'_, D>,
    variation_model: &DynamicModel<D>,
    periods: u64,
    watch: &Watch<'_>,
) -> Result<f64, DynamicsError> {
    lyapunov_exponent_with(motion, variation_model, periods, watch, |_, _| ())
}

/// The same; `on_period` is told the logarithm of the perturbation's growth over each mesh period and the state at its end.
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

/// What is left of a perturbation after one mesh period of the motion, free motions apart: its largest component over what it was.
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
    // An infinite or undefined answer is no sign of fading.
    Ok(if left.is_nan() { f64::INFINITY } else { left })
}

/// A perturbation that prefers no direction and leaves none out.
fn generic_perturbation<const D: usize>(model: &DynamicModel<D>) -> Perturbation<D> {
    let mut start = ([0.0; D], [0.0; D]);
    for (i, c) in model.active().enumerate() {
        start.0[c] = 1.0 / (i + 1) as f64;
    }
    start
}
