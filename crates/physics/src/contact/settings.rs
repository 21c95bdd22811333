//! What can be chosen about a loaded contact analysis, and what can go wrong in it.

use serde::{Deserialize, Serialize};

use super::flank::BodyHold;
use crate::gear::{Half, Pair};
use crate::watch::Canceled;

/// Choices of the analysis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Positions over one mesh period, equally spaced from phase 0; `None`: where `accuracy` needs them.
    pub positions: Option<usize>,
    /// Agreement of stiffness and transmission error between positions, as a part of their means, that chosen positions have to reach.
    pub accuracy: f64,
    /// Slices of the contact lines over the face width of a half; `None`: as many as the width and the overlap need.
    pub slices: Option<usize>,
    /// Where the gear bodies are held.
    pub body: BodyHold,
    /// Whether tip corners may touch outside the theoretical path of contact.
    pub corner_contact: bool,
}

impl Default for Settings {
    /// Positions and slices as needed, held at the rim, corner contact.
    fn default() -> Settings {
        Settings { positions: None, accuracy: 2e-3, slices: None, body: BodyHold::Rim, corner_contact: true }
    }
}

impl Settings {
    /// Slices in use for `pair`: three and a half per normal module of face width and sixteen per unit of overlap, 28 to 140. The contact lines'
    /// ends are cut exactly and corner contacts finer, so that more change the mean stiffness by less than 0.1 %.
    pub fn slice_count(&self, pair: &Pair) -> usize {
        let per_width = 3.5 * pair.spec.face_width_m / pair.spec.normal_module_m;
        let per_overlap = 16.0 * pair.overlap_ratio;
        self.slices.unwrap_or(per_width.max(per_overlap).ceil().clamp(28.0, 140.0) as usize).clamp(4, 256)
    }

    /// Stations of the bulk flexibility over the face width: one and a half per normal module, 10 to 48; four for every wave of the analytic model's Legendre functions. Its decay along the face is one and a half
    /// normal modules.
    pub fn station_count(&self, pair: &Pair) -> usize {
        (1.5 * pair.spec.face_width_m / pair.spec.normal_module_m).ceil().clamp(10.0, 48.0) as usize
    }
}

/// Why a loaded contact analysis gave no result.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ContactError {
    /// The torque is not a positive number.
    #[error("the pinion torque must be positive and finite for a loaded contact analysis; it is {torque_nm} N m")]
    Torque { torque_nm: f64 },
    /// Fewer than two positions.
    #[error("a mesh period needs at least 2 positions; {positions} were asked for")]
    Positions { positions: usize },
    /// No tooth pair can touch.
    #[error("no tooth pair can touch at phase {phase} of the mesh period on the {half:?} half")]
    NoContact { half: Half, phase: f64 },
    /// The load distribution did not converge.
    #[error(
        "the load distribution on the {half:?} half did not converge at phase {phase}: relative change {change:.3e} of the \
         forces after {iterations} iterations"
    )]
    NotConverged { half: Half, phase: f64, iterations: u32, change: f64 },
    /// The two halves of a spur-like pair (no axial coupling) found no common deflection.
    #[error("the halves did not settle on a common deflection at phase {phase}: relative difference {difference:.3e}")]
    HalvesNotBalanced { phase: f64, difference: f64 },
    #[error(transparent)]
    Canceled(#[from] Canceled),
}
