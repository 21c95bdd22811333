//! Work limit of a steady-state search.

use crate::dynamics::{DynamicModel, DynamicsError, IntegrationLimits, PER_HALF, StepCounts, is_train};

/// Work of all parts of a search: transient, period maps, exponents. One unit is one step of the six coordinates of one
/// half, or of one perturbation integrated along with them: 0.5 to 2 µs on a processor of 2020, so that a search ends
/// within about 20 s, and within 30 s with its record and error estimate. It counts steps, not time, so that the result
/// does not depend on the machine.
const SEARCH_UNITS: u64 = 10_000_000;

/// Remaining work.
pub(super) struct Budget {
    left: u64,
    /// Step limit of a single integration.
    max_steps: u64,
    /// Units per step of the motion itself.
    per_step: u64,
}

impl Budget {
    pub(crate) fn new<const D: usize>(limits: &IntegrationLimits<'_>) -> Self {
        // Measured: the perturbations of a train are propagated together and cost less than its motion.
        let per_step = if is_train(D) { D / (2 * PER_HALF) } else { D / PER_HALF } as u64;
        Self {
            left: SEARCH_UNITS.min(limits.max_steps.saturating_mul(per_step)),
            max_steps: limits.max_steps,
            per_step,
        }
    }

    /// Remaining steps of a motion with `perturbations`.
    pub(crate) fn steps(&self, perturbations: usize) -> u64 {
        (self.left / (self.per_step * (1 + perturbations as u64))).min(self.max_steps)
    }

    /// Whether `steps` steps of a motion with `perturbations` are within the remaining work.
    pub(crate) fn affords(&self, steps: u64, perturbations: usize) -> bool {
        steps <= self.steps(perturbations)
    }

    /// Integration limits of a motion with `perturbations` within the remaining work.
    pub(crate) fn limits<'a>(&self, of: &IntegrationLimits<'a>, perturbations: usize) -> IntegrationLimits<'a> {
        IntegrationLimits { max_steps: self.steps(perturbations), ..*of }
    }

    /// Subtracts the work of a motion with `perturbations`.
    pub(crate) fn spend(&mut self, counts: &StepCounts, perturbations: usize) {
        let steps = counts.steps + counts.rejected_steps;
        self.left = self.left.saturating_sub(steps * self.per_step * (1 + perturbations as u64));
    }
}

/// Rough upper estimate of the steps per mesh period from the highest natural frequency, the fastest decay and the
/// number of breakpoints.
pub(super) fn steps_per_period<const D: usize>(model: &DynamicModel<D>) -> f64 {
    /// Scaled time (of the fastest rate) that a step of the usual order covers.
    const REACH: f64 = 3.0;
    let masses = model.masses_kg();
    let rest = model.acceleration(0.5, 0.5, &[0.0; D], &[0.0; D]);
    // The Frobenius norm of the mass-normalised damping matrix bounds all decay rates. At rest in mid-gap the mesh
    // damper may not act, so the norm is evaluated in contact too.
    let mut norm = 0.0f64;
    for pressed in [0.0, 1.0] {
        let mut x = [0.0; D];
        let mut at = rest;
        if DynamicModel::<D>::IS_TRAIN {
            norm = norm.max(model.damping_norm_of_train(pressed > 0.0));
            continue;
        }
        if pressed > 0.0 {
            for j in 0..DynamicModel::<D>::HALVES {
                x[j * PER_HALF + crate::dynamics::U] = 2.0 * model.b / model.cos + f64::MIN_POSITIVE;
            }
            at = model.acceleration(0.5, 0.5, &x, &[0.0; D]);
        }
        let mut sum = 0.0;
        for c in 0..D {
            let mut v = [0.0; D];
            v[c] = 1.0;
            let a = model.acceleration(0.5, 0.5, &x, &v);
            sum += (0..D).map(|r| (a[r] - at[r]).powi(2) * masses[r] / masses[c]).sum::<f64>();
        }
        norm = norm.max(sum.sqrt());
    }
    model.period_tau * norm.max(1.0) / REACH + model.breakpoints.len() as f64
}

/// Error of a search whose work limit is reached at `time_s`.
pub(super) fn budget_exhausted(steps: u64, time_s: f64) -> DynamicsError {
    DynamicsError::TooManySteps { time_s, limit: steps }
}
