//! Flank modifications.

use super::geometry::Basic;
use super::model::Handle;
use super::pair::{MEMBERS, Pair};
use super::stages::flanks_of;
use super::tooth::Teeth;
use crate::draft::{Draft, Reading};
use crate::unit::{Quantity, clean};

/// Modifications of one flank, in the terms of the document, with their origins.
#[derive(Debug, Clone, Default, PartialEq)]
struct Flank {
    tip_amount_um: f64,
    tip_length_mm: f64,
    tip_shape: Option<&'static str>,
    crowning_um: f64,
    /// From the inner end of the half to the outer.
    slope_um: f64,
    end_amount_um: f64,
    end_length_mm: f64,
    /// Readings by field of the document.
    tip: Vec<Reading>,
    crowning: Vec<Reading>,
    slope: Vec<Reading>,
    end: Vec<Reading>,
    notes: Vec<(&'static str, String)>,
}

impl Flank {
    /// Whether two flanks are modified alike.
    fn is_like(&self, other: &Flank) -> bool {
        let close = |one: f64, other: f64| (one - other).abs() <= 1e-6 * one.abs().max(other.abs()).max(1e-3);
        close(self.tip_amount_um, other.tip_amount_um)
            && close(self.tip_length_mm, other.tip_length_mm)
            && self.tip_shape == other.tip_shape
            && close(self.crowning_um, other.crowning_um)
            && close(self.slope_um, other.slope_um)
            && close(self.end_amount_um, other.end_amount_um)
            && close(self.end_length_mm, other.end_length_mm)
    }

    /// Sum of the amounts, by which the larger one of two flanks is chosen.
    fn size_um(&self) -> f64 {
        self.tip_amount_um.abs() + self.crowning_um.abs() + self.slope_um.abs() + self.end_amount_um.abs()
    }

    fn is_plain(&self) -> bool {
        self.size_um() == 0.0
    }
}

/// Writes the modifications of both members.
pub(super) fn write(pair: &Pair, draft: &mut Draft, basic: &Basic, teeth: &Teeth) {
    let mut is_modified = false;
    for (member, name) in MEMBERS.into_iter().enumerate() {
        let halves: Vec<Flank> =
            (0..pair.halves.len()).map(|half| of_half(pair, draft, basic, teeth, half, member)).collect();
        is_modified |= halves.iter().any(|flank| !flank.is_plain());
        let [first, rest @ ..] = halves.as_slice() else { continue };
        if rest.iter().all(|other| first.is_like(other)) {
            let all: Vec<&Flank> = halves.iter().collect();
            put(draft, &format!("/design/{name}"), &all);
        } else {
            for (side, flank) in ["left", "right"].into_iter().zip(&halves) {
                put(draft, &format!("/design/{name}/{side}"), &[flank]);
            }
        }
    }
    if is_modified {
        let detail = "amounts of flank modifications are taken as stated in the transverse plane along the base tangent (ISO 21771); \
                      amounts normal to the flank would have to be divided by cos β_b";
        draft.warn("modification-section", "/design", detail);
    }
}

/// Writes the modifications of flanks that are alike.
fn put(draft: &mut Draft, pointer: &str, flanks: &[&Flank]) {
    let Some(flank) = flanks.first() else { return };
    let readings = |pick: fn(&Flank) -> &Vec<Reading>| -> Vec<Reading> {
        flanks.iter().flat_map(|flank| pick(flank).clone()).collect()
    };
    let note = |field: &str| -> String {
        let notes = flank.notes.iter().filter(|(of, _)| *of == field).map(|(_, note)| note.clone());
        notes.collect::<Vec<_>>().join("; ")
    };
    if flank.tip_amount_um != 0.0 {
        let readings = readings(|flank| &flank.tip);
        draft.take(&format!("{pointer}/tip_relief/amount_um"), flank.tip_amount_um, &readings, &note("tip_amount"));
        draft.take(&format!("{pointer}/tip_relief/length_mm"), flank.tip_length_mm, &readings, &note("tip_length"));
        let shape = flank.tip_shape.unwrap_or("linear");
        let from = readings.first().map(|reading| reading.of.clone()).unwrap_or_default();
        draft.take_word(&format!("{pointer}/tip_relief/shape"), shape, &from, shape.into(), &note("tip_shape"));
    }
    if flank.crowning_um != 0.0 {
        let readings = readings(|flank| &flank.crowning);
        draft.take(&format!("{pointer}/lead_crowning_um"), flank.crowning_um, &readings, &note("crowning"));
    }
    if flank.slope_um != 0.0 {
        let readings = readings(|flank| &flank.slope);
        draft.take(&format!("{pointer}/helix_slope_um"), flank.slope_um, &readings, &note("slope"));
        let detail = "is the size of the file's helix slope on the outer end; its sign is to be confirmed: the format does not say \
                      which end loses material";
        draft.warn("slope-sign", &format!("{pointer}/helix_slope_um"), detail);
    }
    if flank.end_amount_um != 0.0 {
        let readings = readings(|flank| &flank.end);
        draft.take(&format!("{pointer}/end_relief/amount_um"), flank.end_amount_um, &readings, &note("end"));
        draft.take(&format!("{pointer}/end_relief/length_mm"), flank.end_length_mm, &readings, &note("end"));
    }
}

/// The modifications of a half: of the loaded flank, else of both, which have to be alike.
fn of_half(pair: &Pair, draft: &mut Draft, basic: &Basic, teeth: &Teeth, half: usize, member: usize) -> Flank {
    let gear = pair.gears(member)[half];
    let flanks: Vec<(&str, Flank)> = flanks_of(pair.model(), gear)
        .into_iter()
        .map(|(side, flank)| (side, of_flank(pair, draft, basic, teeth, half, member, flank)))
        .collect();
    let loaded = pair.stage_data(half, member).and_then(|data| pair.view.word(data, "loaded_tooth_flank"));
    if let Some((_, flank)) = flanks.iter().find(|(side, _)| Some(*side) == loaded.as_deref()) {
        return flank.clone();
    }
    match flanks.as_slice() {
        [] => Flank::default(),
        [(_, only)] => only.clone(),
        [(left_name, left), (right_name, right), ..] => {
            if left.is_like(right) {
                let mut both = left.clone();
                both.tip.extend(right.tip.iter().cloned());
                both.crowning.extend(right.crowning.iter().cloned());
                both.slope.extend(right.slope.iter().cloned());
                both.end.extend(right.end.iter().cloned());
                return both;
            }
            let (name, larger) = if right.size_um() > left.size_um() { (right_name, right) } else { (left_name, left) };
            let detail = format!(
                "the flanks of {} are modified differently, and which is loaded does not stand in the file: the {name} one, with the \
                 larger amounts, is taken",
                pair.model().label(gear)
            );
            draft.warn("flanks-differ", &format!("/design/{}", MEMBERS[member]), detail);
            larger.clone()
        }
    }
}

/// Which end of the half the datum face is: `Some(true)` for the outer one.
fn datum_is_outer(pair: &Pair, half: usize, gear: Handle, shaft: Handle) -> Option<bool> {
    let orientation = pair.view.word(gear, "datum_face_orientation")?;
    let sign = super::position::axis_sign(pair.view, gear, shaft);
    let at_upper_end = (orientation == "positive") == (sign > 0.0);
    // The left half's outer end is its lower one.
    Some((half == 0) != at_upper_end)
}

fn of_flank(
    pair: &Pair,
    draft: &mut Draft,
    basic: &Basic,
    teeth: &Teeth,
    half: usize,
    member: usize,
    flank: Handle,
) -> Flank {
    let model = pair.model();
    let view = pair.view;
    let gear = pair.gears(member)[half];
    let mut sum = Flank::default();
    let mut ends = [(0.0, 0.0); 2];
    let width_mm = view.number(gear, "face_width", Quantity::Length).map_or(basic.face_width_mm, |width| width.value);
    for modification in model.related("reference", flank, "origin", "referenced") {
        let adds = view.flag(modification, "is_additive_modification").unwrap_or(false);
        let length = |id: &'static str| view.number(modification, id, Quantity::Length);
        // One of several of a kind replaces the one before, unless it is added.
        let keep = |before: f64, value: f64| if adds { before + value } else { value };
        let kind = model.kind(modification);
        match kind {
            "tip_relief" | "triangular_tip_relief" => {
                let triangular = kind != "tip_relief";
                let id = if triangular { "triangular_tip_relief_depth" } else { "tip_relief_depth" };
                let Some(depth) = view.non_zero(modification, id, Quantity::Length) else { continue };
                let Some((roll_mm, how)) = relief_length(pair, basic, teeth, member, modification, triangular) else {
                    let why = "the relief has no length (datum diameter or length)";
                    draft.warn("relief-without-length", "/design", format!("{}: {why}", model.label(modification)));
                    draft.ignore(depth.from(), why, Some(format!("{} {}", depth.file_value, depth.file_unit)));
                    continue;
                };
                if triangular {
                    sum.notes.push(("tip_amount", "triangular: taken over the whole face width".to_owned()));
                }
                sum.tip_amount_um = clean(keep(sum.tip_amount_um, depth.value * 1e3));
                sum.tip_length_mm = roll_mm;
                sum.notes.push(("tip_length", how.to_owned()));
                let word = view.word(modification, "shape_of_relief");
                sum.tip_shape = Some(match word.as_deref() {
                    Some("parabolic" | "circular") => "parabolic",
                    Some("linear") => "linear",
                    None => {
                        sum.notes.push(("tip_shape", "no shape in the file: linear".to_owned()));
                        "linear"
                    }
                    Some(other) => {
                        let detail = format!("{} is {other} in the file: parabolic here", model.label(modification));
                        draft.warn("relief-shape", "/design", detail);
                        "parabolic"
                    }
                });
                sum.tip.push(depth);
            }
            "helix_crowning" => {
                let amounts = ["helix_crowning_amount_datum_face", "helix_crowning_amount_non_datum_face"].map(length);
                let places = [
                    "coordinate_where_helix_crowning_is_specified_datum_face",
                    "coordinate_where_helix_crowning_is_specified_non_datum_face",
                ]
                .map(length);
                let mut values = [0, 1].map(|end| {
                    let amount_um =
                        amounts[end].as_ref().or(amounts[1 - end].as_ref()).map_or(0.0, |amount| amount.value * 1e3);
                    let place_mm = places[end].as_ref().map_or(0.5 * width_mm, |place| place.value.abs());
                    let scale = (0.5 * width_mm / place_mm).powi(2);
                    if place_mm > 0.0 && (scale - 1.0).abs() > 1e-9 { amount_um * scale } else { amount_um }
                });
                if places.iter().flatten().any(|place| (place.value.abs() - 0.5 * width_mm).abs() > 1e-6) {
                    sum.notes.push((
                        "crowning",
                        "scaled from its coordinates to the ends of the face by (b/2 / y)²".to_owned(),
                    ));
                }
                if !values.iter().all(|value| value.is_finite()) {
                    continue;
                }
                sum.crowning_um = clean(keep(sum.crowning_um, 0.5 * (values[0] + values[1])));
                sum.crowning.extend(amounts.into_iter().flatten());
                if (values[0] - values[1]).abs() > 1e-9 {
                    let outer = datum_is_outer(pair, half, gear, pair.shaft(member));
                    if outer == Some(false) {
                        values.swap(0, 1);
                    }
                    sum.slope_um = clean(sum.slope_um + values[0] - values[1]);
                    sum.slope.extend(sum.crowning.clone());
                    let side = if outer.is_none() { "; the datum face is taken as the outer one" } else { "" };
                    sum.notes
                        .push(("slope", format!("difference of the crowning at the outer and the inner end{side}")));
                    sum.notes.push(("crowning", "mean of both ends".to_owned()));
                }
            }
            "helix_slope" => {
                let Some(slope) = view.non_zero(modification, "helix_slope", Quantity::Length) else { continue };
                sum.slope_um = clean(keep(sum.slope_um, slope.value * 1e3));
                sum.notes.push(("slope", "sign to be confirmed".to_owned()));
                sum.slope.push(slope);
            }
            "end_relief_datum_face" | "end_relief_non_datum_face" => {
                let (end, depth, long) = match kind {
                    "end_relief_datum_face" => (0, "end_relief_depth_datum_face", "end_relief_length_datum_face"),
                    _ => (1, "end_relief_depth_non_datum_face", "end_relief_length_non_datum_face"),
                };
                let Some(depth) = view.non_zero(modification, depth, Quantity::Length) else { continue };
                let Some(long) = view.non_zero(modification, long, Quantity::Length) else {
                    draft.ignore(depth.from(), "the end relief has no length", None);
                    continue;
                };
                ends[end] = (clean(keep(ends[end].0, depth.value * 1e3)), long.value);
                sum.end.extend([depth, long]);
            }
            "material" | "rack_shaped_tool" | "cutter_wheel_tool" | "cylindrical_gear_flank" => {}
            other => {
                let amounts = model.components[modification].attributes.iter().filter_map(|attribute| {
                    let value = match &attribute.value {
                        super::model::Value::Number(number) => number.to_string(),
                        super::model::Value::Text(text) => crate::refusal::short(text),
                        _ => return None,
                    };
                    let unit = attribute.unit.as_deref().unwrap_or_default();
                    Some(format!("{} = {value} {unit}", crate::refusal::short(&attribute.id)).trim().to_owned())
                });
                let amount = amounts.take(8).collect::<Vec<_>>().join(", ");
                let why = format!("the document has no {}", crate::refusal::short(other).replace('_', " "));
                draft.ignore(model.label(modification), why, Some(amount).filter(|amount| !amount.is_empty()));
            }
        }
    }
    if ends[0] != (0.0, 0.0) || ends[1] != (0.0, 0.0) {
        let larger = if ends[1].0 > ends[0].0 { ends[1] } else { ends[0] };
        if ends[0] != ends[1] {
            let detail = format!(
                "{}: the reliefs of the ends differ ({} and {} µm); the document has one for both, the larger",
                model.label(flank),
                ends[0].0,
                ends[1].0
            );
            draft.warn("ends-differ", "/design", detail);
        }
        (sum.end_amount_um, sum.end_length_mm) = larger;
    }
    sum
}

/// Roll length of a tip relief along the path of contact, and how it was found.
fn relief_length(
    pair: &Pair,
    basic: &Basic,
    teeth: &Teeth,
    member: usize,
    modification: Handle,
    triangular: bool,
) -> Option<(f64, &'static str)> {
    let view = pair.view;
    let length = |id: &'static str| view.non_zero(modification, id, Quantity::Length);
    let (diameter, end, direct) = match triangular {
        false => ("tip_relief_datum_diameter", "tip_relief_evaluation_reference", "tip_relief_datum_length"),
        true => (
            "triangular_tip_relief_datum_diameter",
            "triangular_tip_relief_evaluation_reference",
            "triangular_tip_relief_datum_length",
        ),
    };
    if let Some(start) = length(diameter) {
        let base_mm = basic.base_mm(member);
        let roll_mm = |diameter_mm: f64| (diameter_mm * diameter_mm - base_mm * base_mm).max(0.0).sqrt();
        let end_mm = length(end).map_or(teeth.tip_mm[member], |end| end.value);
        let roll_mm = 0.5 * (roll_mm(end_mm) - roll_mm(start.value));
        if roll_mm > 0.0 {
            return Some((clean(roll_mm), "½(√(d_e² − d_b²) − √(d_s² − d_b²)) from the diameters"));
        }
    }
    let direct = length(direct)?;
    (direct.value > 0.0).then_some((direct.value, "length along the roll"))
}
