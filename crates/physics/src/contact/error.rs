//! Errors of the loaded contact analysis.

use crate::gear::Half;
use crate::watch::Canceled;

/// Errors of a loaded contact analysis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ContactError {
    /// The torque is not a positive number.
    #[error("the pinion torque must be positive and finite for a loaded contact analysis; it is {torque_nm} N m")]
    Torque {
        /// Torque on the pinion, N m.
        torque_nm: f64,
    },
    /// Fewer than two positions.
    #[error("a mesh period needs at least 2 positions; {positions} were asked for")]
    Positions {
        /// Number of positions.
        positions: usize,
    },
    /// No tooth pair can touch.
    #[error("no tooth pair can touch at phase {phase} of the mesh period on the {half:?} half")]
    NoContact {
        /// The helix half.
        half: Half,
        /// Phase of the mesh period.
        phase: f64,
    },
    /// The load distribution did not converge.
    #[error(
        "the load distribution on the {half:?} half did not converge at phase {phase}: relative change {change:.3e} of the \
         forces after {iterations} iterations"
    )]
    NotConverged {
        /// The helix half.
        half: Half,
        /// Phase of the mesh period.
        phase: f64,
        /// Newton iterations.
        iterations: u32,
        /// Largest change of a force in the last iteration, as a part of the whole.
        change: f64,
    },
    /// The two halves of a spur-like pair (no axial coupling) found no common deflection.
    #[error("the halves did not settle on a common deflection at phase {phase}: relative difference {difference:.3e}")]
    HalvesNotBalanced {
        /// Phase of the mesh period.
        phase: f64,
        /// Difference of the deflections over their sum.
        difference: f64,
    },
    /// The calculation was canceled.
    #[error(transparent)]
    Canceled(#[from] Canceled),
}
