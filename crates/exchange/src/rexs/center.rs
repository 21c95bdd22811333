//! Profile shifts and centre distance.

use super::geometry::Basic;
use super::model::Handle;
use super::pair::{MEMBERS, Pair, listed, mean, spread};
use super::position::axis_distance_mm;
use crate::draft::{Draft, Reading};
use crate::unit::{Quantity, clean};
use serde_json::Value;

/// Centre distance that is that of play-free mesh, mm: profile shifts in files are rounded.
pub(crate) const SAME_DISTANCE_MM: f64 = 0.5e-3;

/// Writes both; the profile shifts also for further rules.
pub(super) fn write(pair: &Pair, draft: &mut Draft, basic: &mut Basic) {
    let center = center_distance(pair, draft);
    profile_shifts(pair, draft, basic, center.as_ref());
    write_center(draft, basic, center);
}

/// Profile shift of one gear: the mean of its flanks.
fn profile_shift(
    pair: &Pair,
    draft: &mut Draft,
    pointer: &str,
    gear: Handle,
    module_mm: f64,
) -> Option<(f64, Vec<Reading>)> {
    let mut of = pair.flanks(gear);
    of.push(gear);
    let mut readings = pair.numbers(&of, "addendum_modification_coefficient", Quantity::Number);
    let mut divisor = 1.0;
    if readings.is_empty() {
        readings = pair.numbers(&of, "addendum_modification", Quantity::Length);
        divisor = module_mm;
    }
    if readings.is_empty() {
        return None;
    }
    if spread(&readings) > 1e-6 * divisor {
        let detail = format!("the flanks of a gear differ, their mean counts: {}", listed(&readings));
        draft.warn("flanks-differ", pointer, detail);
    }
    let value = if spread(&readings) == 0.0 { readings[0].value } else { mean(&readings) };
    let value = if divisor == 1.0 { value } else { value / divisor };
    Some((value, readings))
}

fn profile_shifts(pair: &Pair, draft: &mut Draft, basic: &mut Basic, center: Option<&(f64, Vec<Reading>)>) {
    let mut known: [Option<f64>; 2] = [None; 2];
    for (member, name) in MEMBERS.into_iter().enumerate() {
        let pointer = format!("/design/{name}/profile_shift");
        let halves: Vec<_> = pair
            .gears(member)
            .into_iter()
            .filter_map(|gear| profile_shift(pair, draft, &pointer, gear, basic.module_mm))
            .collect();
        let Some((first, _)) = halves.first() else { continue };
        let readings: Vec<_> = halves.iter().flat_map(|(_, readings)| readings.clone()).collect();
        let alike = halves.iter().all(|(value, _)| (value - first).abs() <= 1e-6);
        let value = match alike {
            true => *first,
            false => halves.iter().map(|(value, _)| value).sum::<f64>() / halves.len() as f64,
        };
        if !alike {
            let detail = format!("the halves differ, their mean counts: {}", listed(&readings));
            draft.warn("halves-differ", &pointer, detail);
        }
        let value = clean(value);
        let why = if readings[0].attribute == "addendum_modification" { "addendum modification / m_n" } else { "" };
        draft.take(&pointer, value, &readings, why);
        known[member] = Some(value);
    }
    let sum = center.and_then(|(center_mm, _)| basic.shifts_at(*center_mm)).filter(|sum| sum.abs() < 4.0);
    let total = basic.teeth[0] + basic.teeth[1];
    for member in [0, 1] {
        if known[member].is_some() {
            continue;
        }
        let pointer = format!("/design/{}/profile_shift", MEMBERS[member]);
        let (value, why) = match (sum, known[1 - member]) {
            (Some(sum), Some(other)) => {
                (sum - other, "what the centre distance leaves beside the mate's profile shift")
            }
            (Some(sum), None) => (
                sum * basic.teeth[member] / total,
                "the sum that belongs to the centre distance, divided in proportion to the numbers of teeth",
            ),
            (None, _) => (0.0, "neither a profile shift nor a centre distance in the file"),
        };
        let value = clean(value);
        draft.assume(&pointer, value, why);
        draft.warn("profile-shift-assumed", &pointer, format!("is not in the file: {value} assumed"));
        basic.profile_shift[member] = value;
    }
    for member in [0, 1] {
        if let Some(value) = known[member] {
            basic.profile_shift[member] = value;
        }
    }
}

/// The centre distance of the file.
fn center_distance(pair: &Pair, draft: &mut Draft) -> Option<(f64, Vec<Reading>)> {
    let pointer = "/design/center_distance_mm";
    let readings = pair.numbers(&pair.stages(), "center_distance", Quantity::Length);
    if spread(&readings) > 1e-6 {
        draft.refuse(pointer, "conflict", format!("the centre distances of the halves differ: {}", listed(&readings)));
        return None;
    }
    match readings.first() {
        Some(first) if first.value > 0.0 => Some((first.value, readings.clone())),
        Some(first) => {
            let detail = format!("{} is {} {}: no centre distance", first.from(), first.file_value, first.file_unit);
            draft.warn("center-distance-ignored", pointer, detail);
            None
        }
        None => {
            let half = &pair.halves[0];
            let distance_mm = axis_distance_mm(pair.view, half.pinion, half.wheel)
                .or_else(|| axis_distance_mm(pair.view, half.pinion_shaft, half.wheel_shaft))?;
            Some((clean(distance_mm), Vec::new()))
        }
    }
}

fn write_center(draft: &mut Draft, basic: &Basic, center: Option<(f64, Vec<Reading>)>) {
    let pointer = "/design/center_distance_mm";
    let play_free_mm = basic.play_free_mm(basic.profile_shift[0] + basic.profile_shift[1]);
    let Some((center_mm, readings)) = center else {
        draft.assume(pointer, Value::Null, "not in the file: that of play-free mesh by the profile shifts");
        return;
    };
    let is_play_free = play_free_mm.is_some_and(|play_free_mm| (play_free_mm - center_mm).abs() <= SAME_DISTANCE_MM);
    if is_play_free {
        draft.set(pointer, Value::Null);
        let why = format!(
            "{center_mm} mm is that of play-free mesh by the profile shifts, within 0.5 µm: left to follow from them"
        );
        match readings.is_empty() {
            true => draft.assume(pointer, Value::Null, why),
            false => draft.note_taken(pointer, Value::Null, &readings, &why),
        }
        return;
    }
    match readings.is_empty() {
        true => draft.assume(pointer, center_mm, "distance of the axes by their support vectors"),
        false => draft.take(pointer, center_mm, &readings, ""),
    }
    if let Some(play_free_mm) = play_free_mm
        && (play_free_mm - center_mm).abs() > 0.05 * basic.module_mm
    {
        let detail = format!(
            "is {center_mm} mm, while the profile shifts belong to {play_free_mm:.4} mm without play; the backlash is what is given"
        );
        draft.warn("center-distance-differs", pointer, detail);
    }
}
