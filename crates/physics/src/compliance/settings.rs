//! Settings of a loaded contact analysis.

use serde::{Deserialize, Serialize};

use super::member::BodyHold;
use crate::gear::Pair;

/// Choices of the analysis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Positions over one mesh period, equally spaced from phase 0; `None`: where `accuracy` needs them.
    pub positions: Option<usize>,
    /// Agreement of stiffness and transmission error between positions, as a part of their means, that chosen positions
    /// have to reach.
    pub accuracy: f64,
    /// Slices of the contact lines over the face width of a half; `None`: as many as the width and the overlap need.
    pub slices: Option<usize>,
    /// Surface on which the gear bodies are held.
    pub body: BodyHold,
    /// True where tip corners may touch outside the theoretical path of contact.
    pub corner_contact: bool,
}

impl Default for Settings {
    /// Positions and slices as needed, held at the rim, corner contact.
    fn default() -> Settings {
        Settings { positions: None, accuracy: 2e-3, slices: None, body: BodyHold::Rim, corner_contact: true }
    }
}

impl Settings {
    /// Slices in use for `pair`: three and a half per normal module of face width and sixteen per unit of overlap, 28
    /// to 140. The contact lines' ends are cut exactly and corner contacts finer, so that more change the mean
    /// stiffness by less than 0.1 %.
    pub fn slice_count(&self, pair: &Pair) -> usize {
        slices(self.slices, pair.spec.face_width_m, pair.spec.normal_module_m, pair.overlap_ratio)
    }

    /// Stations of the bulk flexibility over the face width: one and a half per normal module, 10 to 48; four for every
    /// wave of the analytic model's Legendre functions. Its decay along the face is one and a half normal modules.
    pub fn station_count(&self, pair: &Pair) -> usize {
        stations(pair.spec.face_width_m, pair.spec.normal_module_m)
    }
}

/// [`Settings::slice_count`] for a face width and a normal module in one unit and an overlap ratio.
pub(crate) fn slices(given: Option<usize>, face_width: f64, normal_module: f64, overlap_ratio: f64) -> usize {
    let per_width = 3.5 * face_width / normal_module;
    let per_overlap = 16.0 * overlap_ratio;
    given.unwrap_or(per_width.max(per_overlap).ceil().clamp(28.0, 140.0) as usize).clamp(4, 256)
}

/// [`Settings::station_count`] for a face width and a normal module in one unit.
pub(crate) fn stations(face_width: f64, normal_module: f64) -> usize {
    (1.5 * face_width / normal_module).ceil().clamp(10.0, 48.0) as usize
}
