//! Memory of a loaded contact analysis, from the sizes that it grows with: upper estimates, in bytes.

use super::cycle::CURVE_POSITIONS;
use super::lines::{ContactPoint, MOST_PARTS_PER_SLICE};
use super::position::PARTS_PER_CORNER_WIDTH;
use super::refine::MOST_STATES;
use crate::compliance::{CORNER_REACH, compliance_memory, offsets, slices, station_count};
use crate::fe::Resolution;

/// Sizes of a loaded contact analysis; none below the real one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactSizes {
    /// Face width of one half in normal modules.
    pub face_modules: f64,
    /// Helix angle at the reference circle.
    pub helix_angle_rad: f64,
    /// Transverse contact ratio.
    pub transverse_contact_ratio: f64,
    /// Gaps that the load may close over the elastic deflection of a pair of teeth.
    pub gaps_per_deflection: f64,
    /// Slices, positions and corner contact of the settings.
    pub slices: Option<usize>,
    /// Positions of the settings.
    pub positions: Option<usize>,
    /// True where tip corners may touch outside the path of contact.
    pub corner_contact: bool,
    /// Height of the teeth in normal modules.
    pub tooth_height_modules: f64,
    /// Compliance of teeth and bodies.
    pub compliance: ComplianceModel,
}

/// Model of the compliance of teeth and bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ComplianceModel {
    /// Plates on an elastic ring.
    Analytic,
    /// Finite elements of both gears.
    FiniteElements(Resolution),
    /// Contact lines as a uniform elastic foundation.
    Uniform,
}

/// Memory of the parts of an analysis, bytes.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ContactMemory {
    /// A compliance that is kept.
    pub compliance: f64,
    /// Peak while a compliance is made, the kept one included; with finite elements without the elimination of a
    /// sector.
    pub compliance_peak: f64,
    /// One position while it is solved.
    pub position: f64,
    /// The solved positions of a mesh period.
    pub states: f64,
    /// Loads of the pairs along the path of contact: while they are put together, in a result and in its text.
    pub path: f64,
}

/// Deflection of the pair that carries most over the deflection that a uniform load causes.
const UNEVENNESS: f64 = 10.0;
/// Forms in which an entry of the path (phase and share, of two halves) is there at once: sorted, in the contact of a
/// half, of both, in the mesh of the result, as text of the stored stage and of the result.
const PATH_ENTRY_BYTES: f64 = 480.0;

impl ContactSizes {
    /// Overlap ratio b sinβ / (π m_n).
    fn overlap_ratio(&self) -> f64 {
        self.face_modules * self.helix_angle_rad.sin() / std::f64::consts::PI
    }

    /// Sum of transverse contact ratio and overlap ratio.
    pub(crate) fn total_contact_ratio(&self) -> f64 {
        self.transverse_contact_ratio + self.overlap_ratio()
    }

    /// Pairs that can be in contact at once.
    fn lines(&self) -> f64 {
        offsets(self.total_contact_ratio(), self.corner_contact) as f64 + 1.0
    }

    /// Part of the face that a line of contact of `pitches` base pitches takes.
    fn part_of_face(&self, pitches: f64) -> f64 {
        (pitches / self.overlap_ratio().max(1e-9)).min(1.0)
    }

    /// Points of one line of contact: slices on the path, and parts of slices at either corner.
    fn points_per_line(&self) -> f64 {
        let slices = slices(self.slices, self.face_modules, 1.0, self.overlap_ratio()) as f64;
        let on_path = slices * self.part_of_face(self.transverse_contact_ratio) + 2.0;
        if !self.corner_contact {
            return on_path;
        }
        // A corner's gap grows with the square of the overrun, and its parts are a fraction of the overrun under the
        // deflection alone.
        let widths = (1.25 * (UNEVENNESS + self.gaps_per_deflection)).sqrt();
        let beyond = slices * self.part_of_face(CORNER_REACH) + 1.0;
        let parts = (beyond + PARTS_PER_CORNER_WIDTH * widths).min(MOST_PARTS_PER_SLICE * beyond);
        on_path + 2.0 * parts
    }

    /// Memory of the analysis.
    pub fn memory(&self) -> ContactMemory {
        let compliance = compliance_memory(self);
        let lines = self.lines();
        let stations = station_count(self) as f64;
        let reach = if self.corner_contact { 2.0 * CORNER_REACH } else { 0.0 };
        let of_elements = matches!(self.compliance, ComplianceModel::FiniteElements(_));
        // The stations of finite elements are graded: closer at the ends of the face.
        let grading = if of_elements { 2.0 } else { 1.0 };
        let part = self.part_of_face(self.transverse_contact_ratio + reach);
        let stations_per_line = (grading * stations * part + 5.0).min(stations);
        let points_per_line = self.points_per_line();
        // Flexibility, matrix of the Newton step and, with coupled points, the weights of the stations; per line the
        // coupling, its factor, and the columns of the stations.
        let (matrices, coupled) = if of_elements {
            (3.0, points_per_line * (2.0 * points_per_line + stations_per_line + 2.0))
        } else {
            (2.0, 0.0)
        };
        let points = lines * points_per_line;
        let point_bytes = (size_of::<ContactPoint>() + size_of::<f64>()) as f64;
        // Halves without axial coupling are solved side by side, over positions of their own choice.
        let (positions, at_once) = match self.positions {
            Some(positions) => (positions, 2.0),
            None => (MOST_STATES.max(CURVE_POSITIONS), 1.0),
        };
        let states = at_once * positions as f64;
        ContactMemory {
            compliance: compliance.kept,
            compliance_peak: compliance.peak,
            position: 8.0 * (matrices * (lines * stations_per_line).powi(2) + lines * coupled) + 400.0 * points,
            states: states * points * point_bytes,
            path: PATH_ENTRY_BYTES * lines * positions as f64,
        }
    }
}
