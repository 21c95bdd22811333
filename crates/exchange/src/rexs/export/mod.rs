//! Job documents as REXS 1.7, with results where there are some.

mod gears;
mod model;
mod results;
mod shafts;
mod write;

use herringbone_job::document::{Hand, JobDocument, PressureAnglePlane, RotationInput};
use herringbone_job::result::{Geometry, JobResult};
use herringbone_job::study::CheckedJob;
use herringbone_job::{DocumentError, Violation};
use model::{Model, Typed};

/// Ids of the components that others refer to.
const GEAR_UNIT: i64 = 1;
const CASING: i64 = 2;
const MATERIALS: [i64; 2] = [3, 4];
const SHAFTS: [i64; 2] = [10, 20];
const LOADS: [i64; 2] = [30, 31];
/// By member, then by half.
const GEARS: [[i64; 2]; 2] = [[40, 50], [41, 51]];
/// By half.
const STAGES: [i64; 2] = [60, 61];
/// By half, then by member.
const STAGE_DATA: [[i64; 2]; 2] = [[70, 71], [80, 81]];

const MEMBERS: [&str; 2] = ["Pinion", "Gear"];
const HALVES: [&str; 2] = ["left half", "right half"];

/// Attribute of a shaft whose sections are those of a document: the bodies of the gears are in them.
pub(super) const BODIES_INCLUDED: &str = "custom_herringbone_bodies_included";

/// Form of an exported model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportForm {
    Xml,
    Json,
}

/// What an exported model says beside the document.
#[derive(Debug, Clone, Copy)]
pub struct ExportOptions<'a> {
    pub form: ExportForm,
    /// Date with time and offset, as `2026-01-31T08:00:00+00:00`.
    pub date: &'a str,
    pub application_version: &'a str,
    /// Result of the document, and the id under which it is kept.
    pub result: Option<&'a JobResult>,
    pub result_id: Option<&'a str>,
}

/// What the parts of the model need.
struct Source<'a> {
    document: &'a JobDocument,
    geometry: Geometry,
    normal_pressure_angle_deg: f64,
    /// Sense of rotation of the pinion about the u-axis: 1 or -1.
    turning: f64,
}

impl Source<'_> {
    /// Helix angle of a gear, positive for a right hand.
    fn helix_deg(&self, member: usize, half: usize) -> f64 {
        let design = &self.document.design;
        let left = [&design.pinion, &design.gear][member].left_half_hand;
        let sign = if (left == Hand::Right) == (half == 0) { 1.0 } else { -1.0 };
        sign * design.helix_angle_deg
    }

    /// Face width of a half of a member.
    fn width_mm(&self, member: usize) -> f64 {
        let design = &self.document.design;
        [&design.pinion, &design.gear][member].face_width_mm.unwrap_or(design.face_width_mm)
    }

    /// Middle of a half from the middle of the gap.
    fn middle_mm(&self, half: usize) -> f64 {
        let design = &self.document.design;
        (if half == 0 { -0.5 } else { 0.5 }) * (design.gap_width_mm + design.face_width_mm)
    }
}

/// Writes a document as a REXS model.
///
/// # Errors
/// [`DocumentError`] for a document whose pair cannot exist.
pub fn export_rexs(document: &JobDocument, options: &ExportOptions) -> Result<String, DocumentError> {
    let job = CheckedJob::new(document.clone())?;
    let design = &document.design;
    let normal_pressure_angle_deg = match design.pressure_angle_plane {
        PressureAnglePlane::Normal => design.pressure_angle_deg,
        PressureAnglePlane::Transverse => (design.pressure_angle_deg.to_radians().tan()
            * design.helix_angle_deg.to_radians().cos())
        .atan()
        .to_degrees(),
    };
    let hand = if design.pinion.left_half_hand == Hand::Right { 1.0 } else { -1.0 };
    let turning = if document.operation.rotation == RotationInput::ApexLeading { hand } else { -hand };
    let source = Source { document, geometry: job.report().geometry, normal_pressure_angle_deg, turning };

    let mut model = Model::default();
    let name = document.name.as_deref().unwrap_or("Double-helical pair");
    let unit = model.add(GEAR_UNIT, "gear_unit", name);
    unit.place([0.0; 3], [0.0, 0.0, 1.0]);
    model.add(CASING, "gear_casing", "Casing");
    model.relate("assembly", &[("assembly", GEAR_UNIT), ("part", CASING)]);
    gears::materials(&source, &mut model);
    shafts::write(&source, &mut model);
    gears::write(&source, &mut model);
    results::write(&source, options, &mut model);
    match options.form {
        ExportForm::Json => Ok(write::json(&model, options)),
        ExportForm::Xml => write::xml(&model, options)
            .map_err(|error| DocumentError::Invalid(vec![Violation::new("", "conflict", error.to_string())])),
    }
}

/// A direction at a right angle to the shaft, turned about it from its default.
fn turned(angle_rad: f64) -> [f64; 3] {
    match angle_rad == 0.0 {
        true => [0.0, 0.0, 1.0],
        false => [0.0, -angle_rad.sin(), angle_rad.cos()],
    }
}

fn flag(value: bool) -> Typed {
    Typed::Flag(value)
}
