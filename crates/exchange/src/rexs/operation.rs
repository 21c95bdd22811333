//! Speed, torque and sense of rotation; load cases.

use super::geometry::Basic;
use super::model::Handle;
use super::pair::Pair;
use super::train::{Link, Train, loads_of};
use super::view::View;
use crate::draft::{Draft, Reading};
use crate::report::OperatingPoint;
use crate::unit::{Quantity, clean};
use crate::{ImportOptions, PointChoice};

const DEFAULT_SPEED_RPM: f64 = 1000.0;

/// A value of the pinion with its origin.
#[derive(Debug, Clone, PartialEq)]
struct Carried {
    value: f64,
    reading: Reading,
    why: String,
}

/// The operating point of one load case, or of the model.
#[derive(Debug, Clone, Default, PartialEq)]
struct Point {
    /// With its sign about the u-axis of the pinion's shaft; whether the sign is known.
    speed: Option<(Carried, bool)>,
    /// Positive where the pinion drives.
    torque: Option<Carried>,
    share: Option<f64>,
    /// Further loads and speeds that say something else.
    others: Vec<String>,
}

/// Number of the load case that the document takes, from 0; `None` without a load spectrum.
pub(super) fn chosen_case(pair: &Pair, train: &Train, choice: PointChoice) -> Result<Option<usize>, String> {
    let cases = pair.model().cases.len();
    match choice {
        PointChoice::First => Ok((cases > 0).then_some(0)),
        PointChoice::Number(number) => {
            let most = cases.max(1);
            match usize::try_from(number).ok().filter(|number| (1..=most).contains(number)) {
                Some(number) => Ok((cases > 0).then(|| number - 1)),
                None => Err(format!("is {number}; the file has {most} operating point(s): 1 to {most}")),
            }
        }
        PointChoice::Heaviest => {
            let torque = |case: usize| {
                let view = pair.view.in_case(case);
                point(pair, &view, train).torque.map_or(0.0, |torque| torque.value.abs())
            };
            Ok((0..cases).max_by(|one, other| torque(*one).total_cmp(&torque(*other)).then(other.cmp(one))))
        }
    }
}

/// Writes the operating point and lists those of all load cases.
pub(super) fn write(
    pair: &Pair,
    draft: &mut Draft,
    basic: &Basic,
    train: &Train,
    options: &ImportOptions,
) -> Vec<OperatingPoint> {
    let factor = if pair.mirrored { 2.0 } else { 1.0 };
    let own = point(pair, pair.view, train);
    write_speed(pair, draft, basic, &own);
    write_torque(pair, draft, &own, options, factor);
    for other in &own.others {
        draft.ignore(other.clone(), "another value was taken for the pinion", None);
    }
    let listed = |case: Option<usize>, number: usize, point: &Point, chosen: bool, shares: f64| OperatingPoint {
        number,
        load_case: case.map(|case| pair.model().cases[case].id),
        pinion_speed_rpm: point.speed.as_ref().map(|(speed, _)| speed.value.abs()),
        pinion_torque_nm: options
            .torque_nm
            .or_else(|| point.torque.as_ref().map(|torque| clean(torque.value * factor))),
        share: point.share.map(|share| clean(share / shares)),
        chosen,
    };
    if pair.model().cases.is_empty() {
        return vec![listed(None, 1, &Point { share: None, ..own }, true, 1.0)];
    }
    let points: Vec<_> =
        (0..pair.model().cases.len()).map(|case| (case, point(pair, &pair.view.in_case(case), train))).collect();
    // Hours are made parts of their sum; percentages stay what they are.
    let is_hours = points.iter().any(|(case, _)| share(&pair.view.in_case(*case)).is_some_and(|(_, hours)| hours));
    let shares = match is_hours {
        true => points.iter().filter_map(|(_, point)| point.share).sum::<f64>().max(f64::MIN_POSITIVE),
        false => 1.0,
    };
    points
        .iter()
        .map(|(case, point)| listed(Some(*case), case + 1, point, pair.view.case == Some(*case), shares))
        .collect()
}

/// Part of the time of a load case; whether it is in hours.
fn share(view: &View) -> Option<(f64, bool)> {
    let units: Vec<Handle> = view.model.of_kind("gear_unit").collect();
    let read = |id, quantity| units.iter().find_map(|unit| view.number(*unit, id, quantity));
    let part =
        read("load_duration_fraction", Quantity::Share).or_else(|| read("operating_time_fraction", Quantity::Share));
    match part {
        Some(part) => Some((clean(part.value / 100.0), false)),
        None => read("operating_time", Quantity::Time).map(|time| (time.value, true)),
    }
}

/// The operating point of a view.
fn point(pair: &Pair, view: &View, train: &Train) -> Point {
    let mut others = Vec::new();
    let speed = speed(view, train, &mut others);
    let torque = torque(pair, view, train, speed.as_ref().map(|(speed, known)| (speed.value, *known)), &mut others);
    Point { speed, torque, share: share(view).map(|(share, _)| share), others }
}

fn by_way(link: &Link) -> String {
    match link.way.as_slice() {
        [] => String::new(),
        way => format!("carried to the pinion through {}", way.join(", ")),
    }
}

/// Speed of the pinion: of the shaft that defines it, else of the nearest that has one.
fn speed(view: &View, train: &Train, others: &mut Vec<String>) -> Option<(Carried, bool)> {
    let found: Vec<_> = train
        .shafts()
        .into_iter()
        .filter_map(|shaft| {
            let reading = view.non_zero(shaft, "rotational_speed", Quantity::Speed)?;
            let defines = view.flag(shaft, "defines_speed") == Some(true);
            Some((defines, reading, train.link(shaft)?))
        })
        .collect();
    let index = found.iter().position(|(defines, ..)| *defines).unwrap_or(0);
    let (_, reading, link) = found.get(index)?;
    let value = reading.value * link.ratio;
    for (_, other, other_link) in &found {
        let carried = other.value * other_link.ratio;
        if (carried.abs() - value.abs()).abs() > 1e-4 * value.abs() {
            others.push(format!("{} = {} {}", other.from(), other.file_value, other.file_unit));
        }
    }
    let value = if link.steps == 0 { value } else { clean(value) };
    Some((Carried { value, reading: reading.clone(), why: by_way(link) }, link.sign_known))
}

/// Torque of the pinion, positive where it drives.
fn torque(
    pair: &Pair,
    view: &View,
    train: &Train,
    speed: Option<(f64, bool)>,
    others: &mut Vec<String>,
) -> Option<Carried> {
    let mut found = Vec::new();
    for shaft in train.shafts() {
        let Some(link) = train.link(shaft) else { continue };
        for load in loads_of(view, shaft) {
            let defines = view.flag(load, "defines_torque");
            let torque = view.number(load, "torque_around_u_axis", Quantity::Torque);
            let power = view.non_zero(load, "power", Quantity::Power);
            let rank = match defines {
                Some(true) => 0,
                None => 1,
                Some(false) => 2,
            };
            let reading = match (torque, power) {
                (Some(torque), None) => torque,
                (Some(torque), Some(_)) if torque.value != 0.0 => torque,
                (_, Some(power)) => power,
                (None, None) => continue,
            };
            if reading.value == 0.0 && rank > 0 {
                continue;
            }
            found.push((rank, link.beyond_mesh, link.steps, reading, link));
        }
    }
    found.sort_by_key(|(rank, beyond, steps, ..)| (*rank, *beyond, *steps));
    let Some((_, _, _, reading, link)) = found.first() else { return torque_of_results(pair, view) };
    let turning = |link: &Link| speed.map(|(speed, _)| speed / link.ratio);
    let carried = |reading: &Reading, link: &Link| {
        let is_power = reading.attribute == "power";
        let size = match is_power {
            // P = T ω at the pinion, whatever the shaft.
            true => reading.value.abs() * 1e3 / (speed?.0.abs() * std::f64::consts::PI / 30.0),
            false => (reading.value / link.ratio).abs(),
        };
        // Where speed and torque have one sign, power enters.
        let enters = match (is_power, turning(link), link.sign_known && speed.is_some_and(|(_, known)| known)) {
            (true, ..) => reading.value > 0.0,
            (false, Some(turning), true) => turning * reading.value >= 0.0,
            _ => true,
        };
        Some(if enters == link.beyond_mesh { -size } else { size })
    };
    let value = carried(reading, link)?;
    for (_, _, _, other, other_link) in &found[1..] {
        let same =
            carried(other, other_link).is_some_and(|other| (other.abs() - value.abs()).abs() <= 0.05 * value.abs());
        if !same {
            others.push(format!("{} = {} {}", other.from(), other.file_value, other.file_unit));
        }
    }
    let mut why: Vec<String> = Some(by_way(link)).filter(|way| !way.is_empty()).into_iter().collect();
    if reading.attribute == "power" {
        why.push("P · 1000/ω".to_owned());
    }
    if value < 0.0 {
        why.push("negative: the gear drives".to_owned());
    }
    let value = if value == reading.value { value } else { clean(value) };
    Some(Carried { value, reading: reading.clone(), why: why.join("; ") })
}

/// Torque among the results of the stages.
fn torque_of_results(pair: &Pair, view: &View) -> Option<Carried> {
    let mut readings = Vec::new();
    for half in 0..pair.halves.len() {
        readings.push(view.non_zero(pair.stage_data(half, 0)?, "torque", Quantity::Torque)?);
    }
    let sum: f64 = readings.iter().map(|reading| reading.value.abs()).sum();
    Some(Carried {
        value: clean(sum),
        reading: readings.first()?.clone(),
        why: "a result of the stage: no external load defines a torque".to_owned(),
    })
}

fn write_speed(pair: &Pair, draft: &mut Draft, basic: &Basic, point: &Point) {
    let pointer = "/operation/pinion_speed_rpm";
    let rotation = "/operation/rotation";
    let Some((speed, sign_known)) = &point.speed else {
        draft.assume(pointer, DEFAULT_SPEED_RPM, "no speed of a shaft that turns with the pinion in the file");
        draft.warn("speed-assumed", pointer, format!("is not in the file: {DEFAULT_SPEED_RPM} r/min assumed"));
        draft.assume(rotation, "apex_leading", "without a speed the sense of rotation is not known");
        return;
    };
    let mut why = vec![speed.why.clone()];
    if speed.value < 0.0 {
        why.push("size; the sign is that of the rotation".to_owned());
    }
    why.retain(|why| !why.is_empty());
    draft.take(pointer, speed.value.abs(), std::slice::from_ref(&speed.reading), &why.join("; "));
    if !sign_known || basic.left_helix_deg == 0.0 {
        let why = "the sense of rotation of the pinion does not follow from the file";
        draft.assume(rotation, "apex_leading", why);
        draft.warn("rotation-assumed", rotation, format!("is apex_leading: {why}"));
        return;
    }
    let word = if speed.value * basic.left_helix_deg > 0.0 { "apex_leading" } else { "apex_trailing" };
    let mut why =
        "speed about the u-axis times the helix angle of the pinion's left half: positive is apex_leading".to_owned();
    if pair.mirrored {
        why.push_str("; the stage is the left half");
    }
    draft.take_word(rotation, word, &speed.reading.from(), speed.reading.file_value.into(), &why);
}

fn write_torque(pair: &Pair, draft: &mut Draft, point: &Point, options: &ImportOptions, factor: f64) {
    let pointer = "/operation/pinion_torque_nm";
    if let Some(torque_nm) = options.torque_nm {
        draft.assume(pointer, torque_nm, "chosen at import");
        if let Some(torque) = &point.torque {
            let amount = format!("{} {}", torque.reading.file_value, torque.reading.file_unit);
            draft.ignore(torque.reading.from(), "another torque was chosen at import", Some(amount));
        }
        return;
    }
    let Some(torque) = &point.torque else {
        let reason =
            pair.view.unreadable().into_iter().find(|(_, id, _)| id == "torque_around_u_axis" || id == "power");
        let detail = match reason {
            Some((of, id, reason)) => format!("{}.{id} {reason}; give it with torque_nm", pair.model().label(of)),
            None => {
                "no external load with a torque or power on a shaft that turns with the pinion; give it with torque_nm"
                    .to_owned()
            }
        };
        draft.refuse(pointer, "missing", detail);
        return;
    };
    let value = if factor == 1.0 { torque.value } else { clean(torque.value * factor) };
    let mut why = vec![torque.why.clone()];
    if pair.mirrored {
        why.push("doubled: each half carries the torque of the stage".to_owned());
    }
    why.retain(|why| !why.is_empty());
    draft.take(pointer, value, std::slice::from_ref(&torque.reading), &why.join("; "));
}
