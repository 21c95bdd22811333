//! Places along shafts.

use super::model::Handle;
use super::view::{View, difference, dot};
use crate::draft::Reading;
use crate::unit::Quantity;

/// Difference above which a coordinate does not agree with the vectors, mm.
const AGREES_MM: f64 = 0.01;

/// Place of the middle of a gear's face on its shaft.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FacePlace {
    /// From the shaft's origin along its u-axis.
    pub middle_mm: f64,
    pub width_mm: f64,
    pub readings: Vec<Reading>,
    /// Why the coordinate was not used.
    pub note: Option<String>,
}

impl FacePlace {
    /// Smallest and largest coordinate of the face.
    pub(super) fn ends_mm(&self) -> [f64; 2] {
        [self.middle_mm - 0.5 * self.width_mm, self.middle_mm + 0.5 * self.width_mm]
    }
}

/// The place of a gear on its shaft; `None` without a face width, or without coordinate and vectors.
pub(super) fn face(view: &View, gear: Handle, shaft: Handle) -> Option<FacePlace> {
    let width = view.number(gear, "face_width", Quantity::Length)?;
    let coordinate = view.number(gear, "u_coordinate_on_shaft", Quantity::Length);
    let width_mm = width.value.abs();
    let is_lower_end = view.model.version_number().is_some_and(|version| version < (1, 1));
    let by_coordinate = coordinate.as_ref().map(|reading| match is_lower_end {
        true => reading.value + 0.5 * width_mm,
        false => reading.value,
    });
    let by_vectors = along(view, gear, shaft);
    let (middle_mm, note) = match (by_coordinate, by_vectors) {
        (Some(coordinate_mm), Some(vector_mm)) if (coordinate_mm - vector_mm).abs() > AGREES_MM => {
            let name = view.model.label(gear);
            let note = format!(
                "{name}: the middle of the face is at {coordinate_mm} mm by u_coordinate_on_shaft, at {vector_mm} mm by the support \
                 vectors, which are used"
            );
            (vector_mm, Some(note))
        }
        (Some(coordinate_mm), _) => (coordinate_mm, None),
        (None, vector) => (vector?, None),
    };
    Some(FacePlace { middle_mm, width_mm, readings: coordinate.into_iter().chain([width]).collect(), note })
}

/// Coordinate of a component on a shaft by the vectors of both.
fn along(view: &View, part: Handle, shaft: Handle) -> Option<f64> {
    let place = view.vector(part, "support_vector")?;
    let reference = view.reference(part, "reference_component_for_position");
    if reference == Some(view.model.id(shaft)) {
        return Some(place[0]);
    }
    let origin = view.vector(shaft, "support_vector")?;
    let other = view.reference(shaft, "reference_component_for_position");
    if reference.is_some() && other.is_some() && reference != other {
        return None;
    }
    let axis = view.direction(shaft, "u_axis_vector")?;
    Some(dot(difference(place, origin), axis))
}

/// Sign by which two u-axes point the same way, 1, or against each other, -1. Axes that are not given are parallel.
pub(super) fn axis_sign(view: &View, one: Handle, other: Handle) -> f64 {
    let directions = [one, other].map(|handle| view.direction(handle, "u_axis_vector"));
    match directions {
        [Some(one), Some(other)] if dot(one, other) < 0.0 => -1.0,
        _ => 1.0,
    }
}

/// Distance between two parallel axes by the support vectors of a point on each; `None` where they are not given or
/// relate to different components.
pub(super) fn axis_distance_mm(view: &View, one: Handle, other: Handle) -> Option<f64> {
    let references = [one, other].map(|handle| view.reference(handle, "reference_component_for_position"));
    if references[0] != references[1] {
        return None;
    }
    let places = [view.vector(one, "support_vector")?, view.vector(other, "support_vector")?];
    let axis = view.direction(one, "u_axis_vector").unwrap_or([1.0, 0.0, 0.0]);
    let apart = difference(places[1], places[0]);
    let along = dot(apart, axis);
    let distance_mm = (dot(apart, apart) - along * along).max(0.0).sqrt();
    (distance_mm > 0.0).then_some(distance_mm)
}
