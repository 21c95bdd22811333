//! Errors of the equations of motion and their integration.

use crate::watch::Canceled;

/// Error of the equations of motion or their integration. Times count from the start of the integration.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DynamicsError {
    /// A parameter outside its range of validity.
    #[error("{name} = {value} is not usable: {reason}")]
    InvalidParameter {
        /// Name of the parameter.
        name: &'static str,
        /// Its value, SI.
        value: f64,
        /// Reason, as a continuation of a sentence.
        reason: &'static str,
    },
    /// The motion diverged.
    #[error("the motion diverged at {time_s} s")]
    Diverged {
        /// Time at which it was detected, s.
        time_s: f64,
    },
    /// The step required by the tolerance is below the resolution of the time axis.
    #[error("a step of {step_s} s at {time_s} s is too small to advance the time")]
    StepSizeTooSmall {
        /// Time of the step, s.
        time_s: f64,
        /// Length of the step, s.
        step_s: f64,
    },
    /// The step limit was reached before the end of the integration.
    #[error(
        "{limit} steps were not enough, they reached {time_s} s: some part of the pair vibrates or decays very many times within a mesh \
         period. A stiffness or damper far too large for the mass it acts on, a mass or inertia far too small, or a very low speed \
         makes it so"
    )]
    TooManySteps {
        /// Time reached, s.
        time_s: f64,
        /// Limit of the steps.
        limit: u64,
    },
    /// The mean load has a component along a rigid-body mode (a rotation, or the axial screw motion of the pinion), so
    /// no steady state exists.
    #[error("a mean force of {force_n} N acts along a motion that nothing holds: no steady state exists")]
    Unbalanced {
        /// Mean force along the mode, N.
        force_n: f64,
    },
    /// No periodic motion was found.
    #[error("no periodic motion within {mesh_periods} mesh periods: the state still changes by {change} of its size")]
    NotPeriodic {
        /// Mesh periods integrated.
        mesh_periods: u64,
        /// Relative change of the state over the last mesh period.
        change: f64,
    },
    /// The calculation was canceled.
    #[error(transparent)]
    Canceled(#[from] Canceled),
}
