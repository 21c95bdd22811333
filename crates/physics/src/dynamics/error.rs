//! What can go wrong in the equations of motion; every error carries its numbers.

use crate::watch::Canceled;

/// Why the equations of motion have no answer. Times are counted from the start of the integration.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DynamicsError {
    /// A parameter is outside the range in which the equations mean something.
    #[error("{name} = {value} is not usable: {reason}")]
    InvalidParameter { name: &'static str, value: f64, reason: &'static str },
    /// The motion grew beyond every bound.
    #[error("the motion diverged at {time_s} s")]
    Diverged { time_s: f64 },
    /// The step the tolerance asks for is below the resolution of the time axis.
    #[error("a step of {step_s} s at {time_s} s is too small to advance the time")]
    StepSizeTooSmall { time_s: f64, step_s: f64 },
    /// The step budget is used up: the stiffest motion is too fast for the time that was asked for.
    #[error(
        "{limit} steps were not enough, they reached {time_s} s: some part of the pair vibrates or decays very many times within a mesh \
         period. A stiffness or damper far too large for the mass it acts on, a mass or inertia far too small, or a very low speed \
         makes it so"
    )]
    TooManySteps { time_s: f64, limit: u64 },
    /// The mean load has a component along a motion that nothing holds (a rigid rotation or the axial screw motion of
    /// the pinion), so no steady state exists.
    #[error("a mean force of {force_n} N acts along a motion that nothing holds: no steady state exists")]
    Unbalanced { force_n: f64 },
    /// No periodic motion was found.
    #[error("no periodic motion within {mesh_periods} mesh periods: the state still changes by {change} of its size")]
    NotPeriodic { mesh_periods: u64, change: f64 },
    /// The caller no longer wants the result.
    #[error(transparent)]
    Canceled(#[from] Canceled),
}
