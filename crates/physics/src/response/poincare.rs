//! Poincaré section of a motion and its periodicity.

use std::collections::VecDeque;

use crate::dynamics::{
    DynamicModel, DynamicsError, MotionState, Perturbation, RigidBodyModes, is_rigid_rotation, state_difference,
};

/// Longest period that is searched for, in mesh periods.
pub(super) const LONGEST_PERIOD: usize = 32;

/// States at the starts of the last mesh periods.
pub(super) struct PoincareSection<const D: usize> {
    states: VecDeque<MotionState<D>>,
    /// Size of each state, see [`PoincareSection::size`].
    sizes: VecDeque<f64>,
    rigid_body: RigidBodyModes<D>,
}

impl<const D: usize> PoincareSection<D> {
    /// Section of the complete states, for motions whose periodicity is not tested.
    pub(crate) fn new() -> Self {
        let room = LONGEST_PERIOD + 1;
        let (states, sizes) = (VecDeque::with_capacity(room), VecDeque::with_capacity(room));
        Self { states, sizes, rigid_body: RigidBodyModes::none() }
    }

    /// Section without rigid-body modes, whose drift does not prevent periodicity.
    ///
    /// # Errors
    /// [`DynamicsError`] of [`RigidBodyModes::new`].
    pub(crate) fn without_rigid_body(model: &DynamicModel<D>) -> Result<Self, DynamicsError> {
        Ok(Self { rigid_body: RigidBodyModes::new(model)?, ..Self::new() })
    }

    pub(crate) fn push(&mut self, mut state: MotionState<D>) {
        (state.x, state.v) = self.rigid_body.project_out(&(state.x, state.v));
        if self.states.len() > LONGEST_PERIOD {
            self.states.pop_front();
            self.sizes.pop_front();
        }
        let parts =
            |row: &[f64; D]| (0..D).filter(|c| !is_rigid_rotation(D, *c)).fold(0.0f64, |m, c| m.max(row[c].abs()));
        self.sizes.push_back(parts(&state.v).max(1e-9 * parts(&state.x)));
        self.states.push_back(state);
    }

    /// Size of the motion: its largest velocity in scaled time, or 1e-9 of the largest displacement if that is larger
    /// (below it is rounding).
    pub(crate) fn size(&self) -> f64 {
        self.sizes.iter().fold(f64::MIN_POSITIVE, |m, size| m.max(*size))
    }

    /// Relative change of the state over `n` mesh periods.
    pub(crate) fn change(&self, n: usize) -> Option<f64> {
        let last = self.states.len().checked_sub(1)?;
        let before = self.states.get(last.checked_sub(n)?)?;
        Some(largest_component(&state_difference(&self.states[last], before)) / self.size())
    }

    /// Shortest period, in mesh periods, over which the relative change is below `limit`, and that change. A multiple
    /// of a shorter period with a similar change is not taken.
    pub(crate) fn repeats(&self, limit: f64) -> Option<(usize, f64)> {
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
    pub(crate) fn settled_period(&self, limit: f64) -> Option<usize> {
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
    (0..D).filter(|c| !is_rigid_rotation(D, *c)).fold(0.0, |m, c| m.max(d.0[c].abs()).max(d.1[c].abs()))
}
