//! The bearings of a shaft.

use super::super::model::Handle;
use super::super::pair::Pair;
use super::{MAX_BEARINGS, Mounted, rounded};
use crate::draft::{Draft, Reading};
use crate::unit::{Quantity, clean};
use serde_json::{Value, json};

/// Stiffness from which on a bearing of a file is rigid, N/µm, and what it is taken for.
const RIGID_N_PER_UM: f64 = 1e6;
/// Tilting stiffness from which on it is a placeholder, N·m/rad.
const RIGID_NM_PER_RAD: f64 = 1e9;
/// Radial stiffness over the shaft's diameter where none is given, N/µm per mm, as the service assumes it.
const RADIAL_PER_DIAMETER: f64 = 10.0;
/// Damping over stiffness, N·s/m per N/µm, as in the service's arrangements.
const DAMPING_PER_STIFFNESS: f64 = 10.0;
/// Bearings nearer to each other stand at one place, mm.
const SAME_PLACE_MM: f64 = 1e-3;

fn is_bearing(kind: &str) -> bool {
    matches!(
        kind,
        "concept_bearing"
            | "rolling_bearing_with_catalog_geometry"
            | "rolling_bearing_with_detailed_geometry"
            | "slide_bearing"
            | "hydrodynamic_radial_plain_bearing"
    )
}

/// A bearing on a shaft: the component, its coordinate, and the shaft beyond it where it is not the housing.
struct Place {
    bearing: Handle,
    coordinate: Reading,
    beyond: Option<Handle>,
}

fn places(pair: &Pair, draft: &mut Draft, shaft: Handle) -> Vec<Place> {
    let (model, view) = (pair.model(), pair.view);
    let mut places: Vec<Place> = Vec::new();
    for relation in model.relations_of(shaft).filter(|relation| relation.kind == "side") {
        let Some(bearing) = relation.role("assembly").filter(|bearing| is_bearing(model.kind(*bearing))) else {
            continue;
        };
        let (inner, outer) = (relation.role("inner_part"), relation.role("outer_part"));
        let (id, far) = match inner == Some(shaft) {
            true => ("u_coordinate_on_shaft_inner_side", outer),
            false => ("u_coordinate_on_shaft_outer_side", inner),
        };
        let Some(coordinate) = view.number(bearing, id, Quantity::Length) else {
            draft.warn(
                "bearing-without-place",
                super::SHAFTS,
                format!("{}: {id} is missing; not taken", model.label(bearing)),
            );
            continue;
        };
        let beyond = far.filter(|part| model.kind(*part) == "shaft");
        places.push(Place { bearing, coordinate, beyond });
    }
    places.sort_by(|one, other| one.coordinate.value.total_cmp(&other.coordinate.value));
    places
}

/// A stiffness with its origin; `None` for one that the file leaves open.
fn given(
    pair: &Pair,
    bearing: Handle,
    id: &'static str,
    results: &[&'static str],
) -> Option<(f64, Vec<Reading>, &'static str)> {
    let view = pair.view;
    if let Some(reading) = view.non_zero(bearing, id, Quantity::LinearStiffness).filter(|reading| reading.value > 0.0) {
        return Some((clean(reading.value * 1e-6), vec![reading], ""));
    }
    let of_point: Vec<_> =
        results.iter().filter_map(|id| view.non_zero(bearing, id, Quantity::LinearStiffness)).collect();
    if of_point.is_empty() {
        return None;
    }
    let mean = of_point.iter().map(|reading| reading.value.abs()).sum::<f64>() / of_point.len() as f64;
    Some((clean(mean * 1e-6), of_point, "stiffness at the operating point of the file"))
}

/// Writes the bearings of a shaft.
pub(super) fn write(pair: &Pair, draft: &mut Draft, mounted: &Mounted) {
    let model = pair.model();
    let mut places = places(pair, draft, mounted.shaft);
    if mounted.sign < 0.0 {
        places.reverse();
    }
    if places.len() > MAX_BEARINGS {
        let detail = format!(
            "{}: {} bearings; the document has {MAX_BEARINGS} at most",
            model.label(mounted.shaft),
            places.len()
        );
        draft.warn("too-many-bearings", super::SHAFTS, detail);
        places.truncate(MAX_BEARINGS);
    }
    draft.set(&mounted.pointer("/bearings"), json!([]));
    let mut written: Vec<f64> = Vec::new();
    for place in places {
        let position_mm = mounted.position_mm(place.coordinate.value);
        let label = model.label(place.bearing);
        if written.last().is_some_and(|before| (before - position_mm).abs() < SAME_PLACE_MM) {
            draft.warn(
                "bearings-at-one-place",
                super::SHAFTS,
                format!("{label} stands where another bearing does: not taken"),
            );
            draft.ignore(label, "stands at the place of another bearing", None);
            continue;
        }
        let index = written.len();
        written.push(position_mm);
        if let Some(list) = draft.document.pointer_mut(&mounted.pointer("/bearings")).and_then(Value::as_array_mut) {
            list.push(json!({}));
        }
        if let Some(shaft) = place.beyond {
            let detail = format!(
                "{label} carries {} on {}: taken as a bearing in the housing",
                model.label(mounted.shaft),
                model.label(shaft)
            );
            draft.warn("bearing-between-shafts", &mounted.pointer(&format!("/bearings/{index}")), detail);
        }
        write_bearing(pair, draft, mounted, &place, index, position_mm);
    }
}

fn write_bearing(pair: &Pair, draft: &mut Draft, mounted: &Mounted, place: &Place, index: usize, position_mm: f64) {
    let (view, bearing) = (pair.view, place.bearing);
    let label = pair.model().label(bearing);
    let at = |name: &str| mounted.pointer(&format!("/bearings/{index}/{name}"));
    let put = |draft: &mut Draft, name: &str, value: f64, line: Line| {
        let pointer = at(name);
        // The list has objects already; a pointer with a number needs no more.
        if let Some(object) = draft.document.pointer_mut(&mounted.pointer(&format!("/bearings/{index}"))) {
            object[name] = value.into();
        }
        match line {
            Line::Taken(readings, why) => draft.note_taken(&pointer, value.into(), &readings, why),
            Line::Assumed(why) => draft.note_assumed(&pointer, value.into(), why),
        }
    };
    put(
        draft,
        "position_mm",
        position_mm,
        Line::Taken(vec![place.coordinate.clone()], "from the left end of the shaft"),
    );
    let is_rolling = pair.model().kind(bearing).starts_with("rolling_bearing");
    let diameter_mm = mounted.outline.diameter_mm(place.coordinate.value);
    let usual = rounded(RADIAL_PER_DIAMETER * diameter_mm);
    let results = ["operating_point_stiffness_f_v_d_v", "operating_point_stiffness_f_w_d_w"];
    let radial = match view.flag(bearing, "radial_force_absorption") {
        Some(false) => {
            put(
                draft,
                "radial_n_per_um",
                0.0,
                Line::Assumed("carries no radial force (radial_force_absorption)".to_owned()),
            );
            0.0
        }
        _ => match given(pair, bearing, "radial_stiffness", &results) {
            // What is to be calculated stands as a huge number in rolling bearings.
            Some((value, readings, why)) if value < RIGID_N_PER_UM || !is_rolling => {
                let (value, why) = if value < RIGID_N_PER_UM {
                    (value, why)
                } else {
                    (RIGID_N_PER_UM, "as good as rigid in the file")
                };
                put(draft, "radial_n_per_um", value, Line::Taken(readings, why));
                value
            }
            Some(_) => {
                put(
                    draft,
                    "radial_n_per_um",
                    usual,
                    Line::Assumed(format!(
                        "{label} is as good as rigid in the file, a placeholder: 10 N/µm per mm of shaft diameter"
                    )),
                );
                usual
            }
            None => {
                put(
                    draft,
                    "radial_n_per_um",
                    usual,
                    Line::Assumed(format!(
                        "{label} has no radial stiffness in the file: 10 N/µm per mm of shaft diameter"
                    )),
                );
                usual
            }
        },
    };
    let absorbs = view.word(bearing, "axial_force_absorption");
    let axial = match absorbs.as_deref() {
        Some("no_direction") => 0.0,
        other => {
            let one_way = matches!(other, Some("positive" | "negative"));
            match given(pair, bearing, "axial_stiffness", &["operating_point_stiffness_f_u_d_u"]) {
                Some((value, readings, _)) => {
                    let value = value.min(RIGID_N_PER_UM);
                    let why = if one_way { "acts one way in the file, both ways here" } else { "" };
                    put(draft, "axial_n_per_um", value, Line::Taken(readings, why));
                    value
                }
                None if other.is_some() => {
                    let value = rounded(radial.max(usual) / 3.0);
                    let way = if one_way { ", which acts one way in the file, both ways here" } else { "" };
                    put(
                        draft,
                        "axial_n_per_um",
                        value,
                        Line::Assumed(format!(
                            "{label} holds axially without a stiffness in the file{way}: a third of the radial one"
                        )),
                    );
                    value
                }
                None => 0.0,
            }
        }
    };
    let tilting =
        view.non_zero(bearing, "bending_stiffness", Quantity::AngularStiffness).filter(|reading| reading.value > 0.0);
    if let Some(reading) = tilting {
        let value = clean(reading.value * 1e-3);
        if value < RIGID_NM_PER_RAD {
            put(draft, "tilting_nm_per_rad", value, Line::Taken(vec![reading], ""));
        } else {
            let amount = format!("{} {}", reading.file_value, reading.file_unit);
            draft.ignore(reading.from(), "not a tilting stiffness of a bearing: a placeholder", Some(amount));
        }
    }
    let why = "no damping in the format: 10 N·s/m for each N/µm of stiffness";
    for (name, stiffness) in [("radial_damping_ns_per_m", radial), ("axial_damping_ns_per_m", axial)] {
        if stiffness > 0.0 {
            put(draft, name, rounded(DAMPING_PER_STIFFNESS * stiffness), Line::Assumed(why.to_owned()));
        }
    }
}

/// The line of the report for a field.
enum Line {
    Taken(Vec<Reading>, &'static str),
    Assumed(String),
}
