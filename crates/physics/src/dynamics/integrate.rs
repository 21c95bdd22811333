//! Integration of a motion over mesh periods by either method.

use serde::{Deserialize, Serialize};

use super::equations::is_rigid_rotation;
use super::error::DynamicsError;
use super::model::{DynamicModel, MotionState};
use super::runge_kutta::RungeKutta;
use super::segment::Observer;
use super::taylor::{Taylor, order_for};
use crate::watch::Watch;

/// Method of numerical integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// Taylor series of high order with event location at every change of contact.
    #[default]
    Taylor,
    /// Embedded Runge–Kutta 4(5) with variable step, without event location, as in the source paper.
    RungeKutta,
}

/// Work of an integration.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct StepCounts {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps (Runge–Kutta only).
    pub rejected_steps: u64,
    /// Evaluations of the mesh forces; for the Taylor method of their derivatives of each order.
    pub force_evaluations: u64,
}

impl std::ops::AddAssign for StepCounts {
    fn add_assign(&mut self, other: Self) {
        self.steps += other.steps;
        self.rejected_steps += other.rejected_steps;
        self.force_evaluations += other.force_evaluations;
    }
}

/// Steps between two calls of [`Watch::checkpoint`]: well below 50 ms of work for either method.
const STEPS_PER_CHECKPOINT: u64 = 1024;

/// Displacement (or velocity in scaled time) beyond which a motion counts as diverged, m.
pub(crate) const DIVERGENCE_LIMIT_M: f64 = 1e3;

enum Stepper<const D: usize> {
    Taylor(Taylor<D>),
    RungeKutta(RungeKutta<D>),
}

/// Numerical integration of one motion.
pub(crate) struct Motion<'a, const D: usize> {
    pub model: &'a DynamicModel<D>,
    pub state: MotionState<D>,
    pub counts: StepCounts,
    /// Whether the contact of a half has changed since the start.
    pub contact_changed: bool,
    stepper: Stepper<D>,
    max_steps: u64,
    since_checkpoint: u64,
}

impl<'a, const D: usize> Motion<'a, D> {
    /// `tolerance`: local error of a step relative to the size of the motion. `max_steps`: limit over all mesh periods.
    pub(crate) fn new(
        model: &'a DynamicModel<D>,
        state: MotionState<D>,
        integrator: Integrator,
        tolerance: f64,
        max_steps: u64,
    ) -> Self {
        let stepper = match integrator {
            Integrator::Taylor => Stepper::Taylor(Taylor::new(tolerance, order_for(tolerance), None)),
            Integrator::RungeKutta => Stepper::RungeKutta(RungeKutta::new(tolerance, None)),
        };
        Self {
            model,
            state,
            counts: StepCounts::default(),
            contact_changed: false,
            stepper,
            max_steps,
            since_checkpoint: 0,
        }
    }

    #[cfg(test)]
    pub(crate) fn with_fixed_taylor(mut self, order: usize, step_tau: f64) -> Self {
        self.stepper = Stepper::Taylor(Taylor::new(1.0, order, Some(step_tau)));
        self
    }

    #[cfg(test)]
    pub(crate) fn with_fixed_runge_kutta(mut self, step_tau: f64) -> Self {
        self.stepper = Stepper::RungeKutta(RungeKutta::new(1.0, Some(step_tau)));
        self
    }

    /// Integrates to the end of the current mesh period. `fraction`: completed fraction reported to the watch.
    ///
    /// # Errors
    /// [`DynamicsError`].
    pub(crate) fn advance_period(
        &mut self,
        observer: &mut impl Observer<D>,
        watch: &Watch<'_>,
        fraction: f64,
    ) -> Result<(), DynamicsError> {
        let mut from = 0.0;
        for &end in &self.model.breakpoints {
            let interior = 0.5 * (from + end);
            while self.state.phase < end {
                let contact = self.state.contact;
                match &mut self.stepper {
                    Stepper::Taylor(t) => {
                        t.step(self.model, &mut self.state, end, interior, &mut self.counts, observer)?;
                    }
                    Stepper::RungeKutta(r) => {
                        r.step(self.model, &mut self.state, end, interior, &mut self.counts, observer)?;
                    }
                }
                self.contact_changed |= contact != self.state.contact;
                self.since_checkpoint += 1;
                if self.since_checkpoint >= STEPS_PER_CHECKPOINT {
                    self.since_checkpoint = 0;
                    watch.checkpoint(fraction)?;
                    if self.counts.steps + self.counts.rejected_steps > self.max_steps {
                        return Err(DynamicsError::TooManySteps { time_s: self.time_s(), limit: self.max_steps });
                    }
                }
            }
            from = end;
        }
        if has_diverged(&self.state) {
            return Err(DynamicsError::Diverged { time_s: self.time_s() });
        }
        self.state.period += 1;
        self.state.phase = 0.0;
        Ok(())
    }

    /// Time since the start of the integration, s.
    pub(crate) fn time_s(&self) -> f64 {
        (self.state.period as f64 + self.state.phase) * self.model.period_tau / self.model.omega_ref
    }
}

/// Whether a component exceeds the limit or is not finite. Rigid rotation is not limited.
pub(super) fn has_diverged<const D: usize>(state: &MotionState<D>) -> bool {
    [&state.x, &state.v].iter().any(|row| {
        row.iter()
            .enumerate()
            .any(|(c, v)| !v.is_finite() || (!is_rigid_rotation(D, c) && v.abs() > DIVERGENCE_LIMIT_M))
    })
}
