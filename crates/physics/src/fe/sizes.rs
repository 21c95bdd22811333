//! Sizes of elements and load cells at every resolution.

use super::input::Resolution;
use super::section::SectionSizes;

/// All that a resolution decides; lengths in normal modules.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Sizes {
    /// Load cell along the profile.
    pub profile_cell: f64,
    /// Load cell along the face.
    pub station_cell: f64,
    /// Spline cells per load cell along the face.
    pub splines_per_cell: usize,
    /// Cells along the face may be this many times as long as the distance from the loaded flank.
    pub reach: f64,
    /// Elements of the section.
    pub section: SectionSizes,
}

impl Sizes {
    /// Sizes at a resolution.
    pub(super) fn new(resolution: Resolution) -> Sizes {
        match resolution {
            Resolution::Coarse => Sizes {
                profile_cell: 0.4,
                station_cell: 1.14,
                splines_per_cell: 1,
                reach: 1.0,
                section: SectionSizes {
                    rows_per_cell: 1,
                    rows_per_end_cell: 2,
                    fillet_rows: 2,
                    columns: vec![0.28, 0.30, 0.26, 0.16],
                    land_columns: 1,
                    first_rim_row: 0.5,
                    held_row: 1.5,
                    growth: 1.8,
                },
            },
            Resolution::Medium => Sizes {
                profile_cell: 0.2,
                station_cell: 0.57,
                splines_per_cell: 1,
                reach: 0.7,
                section: SectionSizes {
                    rows_per_cell: 1,
                    rows_per_end_cell: 2,
                    fillet_rows: 3,
                    columns: vec![0.18, 0.22, 0.22, 0.18, 0.12, 0.08],
                    land_columns: 2,
                    first_rim_row: 0.35,
                    held_row: 1.0,
                    growth: 1.6,
                },
            },
            Resolution::Standard => Sizes {
                splines_per_cell: 2,
                section: SectionSizes { first_rim_row: 0.3, ..Sizes::new(Resolution::Medium).section },
                ..Sizes::new(Resolution::Medium)
            },
            Resolution::Fine => Sizes {
                profile_cell: 0.2,
                station_cell: 0.57,
                splines_per_cell: 2,
                reach: 0.6,
                section: SectionSizes {
                    rows_per_cell: 2,
                    rows_per_end_cell: 3,
                    fillet_rows: 6,
                    columns: vec![0.12, 0.14, 0.15, 0.14, 0.13, 0.11, 0.09, 0.06, 0.04, 0.02],
                    land_columns: 3,
                    first_rim_row: 0.2,
                    held_row: 0.5,
                    growth: 1.5,
                },
            },
        }
    }

    /// Load cells on a flank of `length` and `width`, both in normal modules.
    pub(super) fn load_cells(&self, length: f64, width: f64) -> (usize, usize) {
        let cells = |size: f64, cell: f64, range: (usize, usize)| {
            ((size / cell).round().clamp(range.0 as f64, range.1 as f64)) as usize
        };
        (cells(length, self.profile_cell, (4, 20)), cells(width, self.station_cell, (4, 64)))
    }
}

/// Nodes of the load grid along the profile and along the face, for a length of the involute and a face width in normal
/// modules.
pub(crate) fn load_grid_size(resolution: Resolution, involute_modules: f64, face_modules: f64) -> (usize, usize) {
    let (profile, stations) = Sizes::new(resolution).load_cells(involute_modules, face_modules);
    (profile + 1, stations + 1)
}
