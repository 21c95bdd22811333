//! Numerical error and error of the model.

use super::ResultFields;
use serde::{Deserialize, Serialize};

/// Numerical error and model error, which are different things.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "accuracy#numerical-error-and-error-of-the-model")]
pub struct Accuracy {
    /// Relative error of the solution of the equations: the estimate for the RMS values (of a sweep the largest of its points; null where none
    /// was solved); without a response that of the contact's discretisation. 0 for a closed form.
    #[scalar(
        label = "numerical error, relative",
        change = Absolute,
        help = "The numerical error is relative and says how well the equations were solved; it says nothing about the gear."
    )]
    pub numerical: Option<f64>,
    pub model: ModelError,
}

/// How far the mesh of the model is from that of a gear pair with exact flanks, by the comparisons of docs/VALIDATION.md and docs/BENCHMARKS.md:
/// the largest difference found in pairs of the same kind. Supports, damping, friction and manufacture are not in it.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "accuracy#numerical-error-and-error-of-the-model")]
pub struct ModelError {
    /// Of the mean mesh stiffness; null where the model claims nothing.
    #[scalar(
        label = "error of the model, mesh stiffness",
        help = "The error of the model is the largest that comparisons with references found in pairs of this kind. Supports, damping, \
                friction and manufacture are not in it."
    )]
    pub mesh_stiffness_percent: Option<f64>,
    /// Of the first harmonic of the loaded transmission error, in per cent of itself; null where the model claims nothing.
    #[scalar(label = "error of the model, first harmonic of the transmission error")]
    pub transmission_error_harmonic_percent: Option<f64>,
    /// What the numbers rest on.
    #[scalar(label = "basis of the error of the model")]
    pub basis: String,
}
