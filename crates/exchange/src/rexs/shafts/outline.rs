//! The outline of a shaft: sections and gear bodies as pieces of one diameter.

use super::super::export::BODIES_INCLUDED;
use super::super::geometry::Basic;
use super::super::model::Handle;
use super::super::pair::Pair;
use super::super::tooth::Teeth;
use super::MAX_SEGMENTS;
use crate::draft::{Draft, Reading};
use crate::unit::Quantity;

/// Pieces into which a cone is cut.
const CONE_PIECES: usize = 4;
/// Shortest segment of the document, mm.
const SHORTEST_MM: f64 = 0.1;

/// A piece of one diameter, on the shaft's u-axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    start_mm: f64,
    end_mm: f64,
    pub diameter_mm: f64,
    pub bore_mm: f64,
}

impl Piece {
    pub(super) fn length_mm(&self) -> f64 {
        self.end_mm - self.start_mm
    }
}

/// A shaft with the bodies of its gears.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outline {
    pub start_mm: f64,
    pub end_mm: f64,
    /// Middle between the halves.
    pub middle_mm: f64,
    pub segments: Vec<Piece>,
    pub sections: Vec<Handle>,
    /// Of the places of the faces.
    pub readings: Vec<Reading>,
}

impl Outline {
    /// Smallest diameter at a place.
    pub(super) fn diameter_mm(&self, u_mm: f64) -> f64 {
        let touching =
            self.segments.iter().filter(|piece| (piece.start_mm - 1e-3..=piece.end_mm + 1e-3).contains(&u_mm));
        let least = touching.map(|piece| piece.diameter_mm).min_by(f64::total_cmp);
        least.or(self.segments.first().map(|piece| piece.diameter_mm)).unwrap_or(1.0)
    }

    /// Moment of inertia about the axis, for a density in kg/m³.
    pub(super) fn polar_inertia_kg_m2(pieces: &[Piece], density_kg_m3: f64) -> f64 {
        let of_piece = |piece: &Piece| {
            let [outer_m, inner_m] = [piece.diameter_mm, piece.bore_mm].map(|mm| mm * 1e-3);
            std::f64::consts::PI / 32.0 * density_kg_m3 * (outer_m.powi(4) - inner_m.powi(4)) * piece.length_mm() * 1e-3
        };
        pieces.iter().map(of_piece).sum()
    }
}

/// The sections of a shaft as pieces; cones are cut.
pub(super) fn sections(pair: &Pair, shaft: Handle) -> (Vec<Handle>, Vec<Piece>) {
    let (model, view) = (pair.model(), pair.view);
    let handles: Vec<_> = model.parts(shaft).into_iter().filter(|part| model.kind(*part) == "shaft_section").collect();
    let mut pieces = Vec::new();
    let mut used = Vec::new();
    let mut next_mm = 0.0;
    for section in handles {
        let length = |id: &'static str| view.number(section, id, Quantity::Length).map(|reading| reading.value);
        let Some(long_mm) = length("length").filter(|long_mm| *long_mm > 0.0) else { continue };
        let start_mm = length("u_coordinate_on_shaft").unwrap_or(next_mm);
        next_mm = start_mm + long_mm;
        let outer = [length("outer_diameter_begin"), length("outer_diameter_end")];
        let inner = [length("inner_diameter_begin"), length("inner_diameter_end")];
        let both = |[begin, end]: [Option<f64>; 2]| Some([begin.or(end)?, end.or(begin)?]);
        let Some(outer) = both(outer).filter(|[begin, end]| *begin > 0.0 && *end > 0.0) else { continue };
        let inner = both(inner).unwrap_or([0.0; 2]).map(|inner| inner.max(0.0));
        used.push(section);
        let is_cone = outer[0] != outer[1] || inner[0] != inner[1];
        let count = if is_cone { CONE_PIECES } else { 1 };
        for index in 0..count {
            let [from, to] = [index, index + 1].map(|index| index as f64 / count as f64);
            let middle = 0.5 * (from + to);
            let at = |[begin, end]: [f64; 2]| begin + (end - begin) * middle;
            pieces.push(Piece {
                start_mm: start_mm + from * long_mm,
                end_mm: start_mm + to * long_mm,
                diameter_mm: at(outer),
                bore_mm: at(inner),
            });
        }
    }
    (used, pieces)
}

/// The outline of a member's shaft; `None` without sections, or without the places of both halves.
pub(super) fn of(pair: &Pair, draft: &mut Draft, basic: &Basic, teeth: &Teeth, member: usize) -> Option<Outline> {
    let shaft = pair.shaft(member);
    let (handles, pieces) = sections(pair, shaft);
    let faces: Vec<_> = pair.faces(member).into_iter().flatten().collect();
    let [one, other] = faces.as_slice() else { return None };
    if pieces.is_empty() {
        return None;
    }
    let middle_mm = 0.5 * (one.middle_mm + other.middle_mm);
    let root_mm = teeth.root_mm[member];
    let bodies: Vec<[f64; 2]> = faces.iter().map(|face| face.ends_mm()).collect();
    let mut cuts: Vec<f64> = pieces.iter().flat_map(|piece| [piece.start_mm, piece.end_mm]).collect();
    cuts.extend(bodies.iter().flatten());
    cuts.sort_by(f64::total_cmp);
    let mut places: Vec<f64> = Vec::new();
    for cut in cuts {
        // Cuts nearer to each other than a segment can be are one.
        if places.last().is_none_or(|last| cut - last >= SHORTEST_MM) {
            places.push(cut);
        }
    }
    // Sections that this program wrote have the bodies in them.
    let is_complete = pair.view.flag(shaft, BODIES_INCLUDED) == Some(true);
    let mut segments: Vec<Piece> = Vec::new();
    let mut has_hole = false;
    for ends in places.windows(2) {
        let at_mm = 0.5 * (ends[0] + ends[1]);
        let covering: Vec<_> = pieces.iter().filter(|piece| piece.start_mm <= at_mm && at_mm <= piece.end_mm).collect();
        let outer = covering.iter().map(|piece| piece.diameter_mm).max_by(f64::total_cmp);
        let mut bore_mm = covering.iter().map(|piece| piece.bore_mm).min_by(f64::total_cmp).unwrap_or(0.0);
        let is_body = bodies.iter().any(|[start, end]| *start <= at_mm && at_mm <= *end);
        let diameter_mm = match (outer, is_body) {
            (Some(outer), true) if is_complete => outer,
            (Some(outer), true) => outer.max(root_mm).min(teeth.tip_mm[member]),
            (None, true) => root_mm,
            (Some(outer), false) => outer,
            (None, false) => {
                has_hole = true;
                segments.last().map_or(pieces[0].diameter_mm, |before| before.diameter_mm)
            }
        };
        if bore_mm >= diameter_mm {
            bore_mm = 0.0;
        }
        match segments.last_mut() {
            Some(before) if before.diameter_mm == diameter_mm && before.bore_mm == bore_mm => before.end_mm = ends[1],
            _ => segments.push(Piece { start_mm: ends[0], end_mm: ends[1], diameter_mm, bore_mm }),
        }
    }
    let name = pair.model().label(shaft);
    if has_hole {
        draft.warn(
            "shaft-has-holes",
            super::SHAFTS,
            format!("{name}: between its sections is nothing; the thickness beside it goes on"),
        );
    }
    if segments.len() > MAX_SEGMENTS {
        let detail =
            format!("{name}: {} pieces of one diameter; the document has {MAX_SEGMENTS} at most", segments.len());
        draft.warn("shaft-too-fine", super::SHAFTS, detail);
        return None;
    }
    let (start_mm, end_mm) = (segments.first()?.start_mm, segments.last()?.end_mm);
    if (one.width_mm - basic.face_width_mm).abs() > 0.5 * basic.face_width_mm {
        draft.warn("faces-shifted", super::SHAFTS, format!("{name}: the face is much wider than the common width"));
    }
    let readings = faces.iter().flat_map(|face| face.readings.iter().take(1).cloned()).collect();
    Some(Outline { start_mm, end_mm, middle_mm, segments, sections: handles, readings })
}
