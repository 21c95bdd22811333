//! Tip, root, body, material and backlash.

use super::geometry::Basic;
use super::model::Handle;
use super::pair::{MEMBERS, Pair, listed, mean, spread};
use super::tools::tool_of;
use crate::draft::{Draft, Reading};
use crate::unit::{Quantity, clean};
use serde_json::Value;

/// Tip alteration coefficients that are plausible.
const PLAUSIBLE_TIP: f64 = 0.5;
const DEFAULT_DEDENDUM: f64 = 1.25;
const DEFAULT_FILLET: f64 = 0.38;

/// What further rules need of the teeth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Teeth {
    pub tip_mm: [f64; 2],
    pub root_mm: [f64; 2],
}

/// Writes tooth height, fillet, bore, material, mass and backlash.
pub(super) fn write(pair: &Pair, draft: &mut Draft, basic: &Basic) -> Teeth {
    let mut teeth = Teeth { tip_mm: [0.0; 2], root_mm: [0.0; 2] };
    for member in [0, 1] {
        let alteration = tip(pair, draft, basic, member);
        let shift = basic.profile_shift[member];
        let reference_mm = basic.reference_mm(member);
        teeth.tip_mm[member] = reference_mm + 2.0 * basic.module_mm * (1.0 + shift + alteration);
        let dedendum = dedendum(pair, draft, basic, member);
        teeth.root_mm[member] = reference_mm - 2.0 * basic.module_mm * (dedendum - shift);
        fillet(pair, draft, basic, member, dedendum);
        bore(pair, draft, member, teeth.root_mm[member]);
        mass(pair, draft, member);
    }
    materials(pair, draft);
    backlash(pair, draft, basic);
    let pitch: Vec<Reading> = [0, 1].iter().filter_map(|member| single_pitch_deviation(pair, *member)).collect();
    if let Some(largest) = pitch.iter().max_by(|a, b| a.value.total_cmp(&b.value)) {
        let why = "a deviation, not the design: it enters the impact only where it is wanted";
        draft.offer("/model/impact/base_pitch_error_um", largest, largest.value * 1e3, why);
    }
    teeth
}

fn single_pitch_deviation(pair: &Pair, member: usize) -> Option<Reading> {
    pair.numbers(&pair.gears(member), "single_pitch_deviation", Quantity::Length).into_iter().next()
}

/// The common value of the halves: the first one, with a warning where they differ.
fn of_halves(draft: &mut Draft, pointer: &str, readings: &[Reading], tolerance: f64) -> Option<f64> {
    let first = readings.first()?.value;
    if spread(readings) <= tolerance {
        return Some(first);
    }
    draft.warn("halves-differ", pointer, format!("the halves differ, their mean counts: {}", listed(readings)));
    Some(mean(readings))
}

fn tip(pair: &Pair, draft: &mut Draft, basic: &Basic, member: usize) -> f64 {
    let name = MEMBERS[member];
    let pointer = format!("/design/{name}/tip_alteration");
    draft.assume(
        &format!("/design/{name}/addendum"),
        1.0,
        "of the rack; the height of the teeth is the tip alteration's (the basic profile in a file is often the tool's)",
    );
    let readings = pair.numbers(&pair.gears(member), "tip_diameter", Quantity::Length);
    let mut plausible = Vec::new();
    let coefficient = |tip_mm: f64| {
        (tip_mm - basic.reference_mm(member)) / (2.0 * basic.module_mm) - basic.profile_shift[member] - 1.0
    };
    for reading in readings {
        let k = coefficient(reading.value.abs());
        if k.abs() <= PLAUSIBLE_TIP {
            plausible.push(reading);
        } else {
            let why =
                format!("not plausible for a reference circle of {:.3} mm: a placeholder", basic.reference_mm(member));
            let amount = format!("{} {}", reading.file_value, reading.file_unit);
            draft.warn("tip-diameter-ignored", &pointer, format!("{} is {amount}: {why}", reading.from()));
            draft.ignore(reading.from(), why, Some(amount));
        }
    }
    let Some(tip_mm) = of_halves(draft, &pointer, &plausible, 1e-6) else {
        draft.assume(&pointer, 0.0, "no plausible tip diameter in the file");
        return 0.0;
    };
    let k = coefficient(tip_mm.abs());
    let k = if k.abs() < 1e-9 { 0.0 } else { k };
    draft.take(&pointer, k, &plausible, "k = (d_a − d)/(2 m_n) − x − 1, with an addendum of 1 m_n");
    k
}

/// Tools of the halves of a member.
fn tools(pair: &Pair, member: usize) -> Vec<Handle> {
    pair.gears(member).into_iter().filter_map(|gear| tool_of(pair, gear)).collect()
}

/// A multiple of the normal module, from a factor or a length of the tools.
fn of_tools(
    pair: &Pair,
    tools: &[Handle],
    factors: &[&'static str],
    lengths: &[&'static str],
    module_mm: f64,
) -> Option<(Vec<Reading>, f64)> {
    let found = factors.iter().map(|id| pair.numbers(tools, id, Quantity::Number)).find(|found| !found.is_empty());
    if let Some(readings) = found {
        return Some((readings, 1.0));
    }
    let found = lengths.iter().map(|id| pair.numbers(tools, id, Quantity::Length)).find(|found| !found.is_empty())?;
    Some((found, module_mm))
}

fn dedendum(pair: &Pair, draft: &mut Draft, basic: &Basic, member: usize) -> f64 {
    let pointer = format!("/design/{}/dedendum", MEMBERS[member]);
    let tools = tools(pair, member);
    let plausible = |value: f64| (0.3..=3.0).contains(&value);
    let given = of_tools(
        pair,
        &tools,
        &["addendum_coefficient_reference_profile"],
        &["addendum_reference_profile"],
        basic.module_mm,
    );
    if let Some((readings, divisor)) = given
        && let Some(value) = of_halves(draft, &pointer, &readings, 1e-6 * divisor)
    {
        let value = if divisor == 1.0 { value } else { clean(value / divisor) };
        if plausible(value) {
            let mut why = "addendum of the last generating tool".to_owned();
            if divisor != 1.0 {
                why.push_str(" / m_n");
            }
            if tools.iter().any(|tool| pair.model().kind(*tool) == "cutter_wheel_tool") {
                why.push_str("; a pinion cutter leaves another root than a rack");
            }
            draft.take(&pointer, value, &readings, &why);
            return value;
        }
        let detail = format!("{} is not plausible: {value} normal modules", listed(&readings));
        draft.warn("dedendum-ignored", &pointer, detail);
    }
    let roots = pair.numbers(&pair.gears(member), "root_diameter", Quantity::Length);
    if let Some(root_mm) = of_halves(draft, &pointer, &roots, 1e-6) {
        let value =
            clean((basic.reference_mm(member) - root_mm) / (2.0 * basic.module_mm) + basic.profile_shift[member]);
        if plausible(value) {
            draft.take(&pointer, value, &roots, "(d − d_f)/(2 m_n) + x: no generating tool in the file");
            return value;
        }
        draft.warn(
            "dedendum-ignored",
            &pointer,
            format!("{} is not plausible: {value} normal modules", listed(&roots)),
        );
    }
    draft.assume(&pointer, DEFAULT_DEDENDUM, "no generating tool and no root diameter in the file");
    DEFAULT_DEDENDUM
}

/// Largest tip rounding of a rack, in normal modules: the arc's centre on its centreline, and an arc that ends below
/// the datum line.
fn largest_fillet(basic: &Basic, dedendum: f64) -> f64 {
    let (sin, cos) = basic.pressure_angle_deg.to_radians().sin_cos();
    let on_centreline = (std::f64::consts::FRAC_PI_4 - dedendum * sin / cos) * cos / (1.0 - sin);
    on_centreline.min(dedendum / (1.0 - sin)).clamp(0.0, 1.0)
}

fn fillet(pair: &Pair, draft: &mut Draft, basic: &Basic, member: usize, dedendum: f64) {
    let pointer = format!("/design/{}/fillet_radius", MEMBERS[member]);
    let most = largest_fillet(basic, dedendum);
    // Below the limit by more than rounding.
    let fitting = (most * 1e6).floor() / 1e6;
    let given = of_tools(
        pair,
        &tools(pair, member),
        &["tip_radius_factor", "tip_corner_radius_factor_reference_profile"],
        &["tip_radius", "tip_corner_radius_reference_profile"],
        basic.module_mm,
    );
    if let Some((readings, divisor)) = given
        && let Some(value) = of_halves(draft, &pointer, &readings, 1e-6 * divisor)
        && value >= 0.0
    {
        let value = if divisor == 1.0 { value } else { clean(value / divisor) };
        if value > most {
            draft.take(&pointer, fitting, &readings, "reduced to the largest rounding that the rack can have");
            let detail = format!(
                "is {value} in the file ({}); a rack of this height and angle has {fitting} at most",
                readings[0].from()
            );
            draft.warn("fillet-reduced", &pointer, detail);
        } else {
            let why = if divisor == 1.0 { "tip rounding of the tool" } else { "tip rounding of the tool / m_n" };
            draft.take(&pointer, value, &readings, why);
        }
        return;
    }
    match DEFAULT_FILLET <= most {
        true => draft.assume(&pointer, DEFAULT_FILLET, "no tip rounding of a tool in the file"),
        false => {
            let why = "no tip rounding of a tool in the file; less than the usual 0.38, which this rack cannot have";
            draft.assume(&pointer, fitting, why);
        }
    }
}

fn bore(pair: &Pair, draft: &mut Draft, member: usize, root_mm: f64) {
    let pointer = format!("/design/{}/bore_diameter_mm", MEMBERS[member]);
    let fits = |value: f64| value >= 0.0 && value < 0.98 * root_mm;
    let own = pair.numbers(&pair.gears(member), "inner_diameter", Quantity::Length);
    if let Some(value) = of_halves(draft, &pointer, &own, 1e-6) {
        if fits(value) {
            draft.take(&pointer, value, &own, "");
            return;
        }
        draft.warn("bore-ignored", &pointer, format!("{} is not inside of the root circle", listed(&own)));
    }
    let model = pair.model();
    let face = pair.faces(member).into_iter().flatten().next();
    let section = face.and_then(|face| {
        let sections = model.parts(pair.shaft(member)).into_iter().filter(|part| model.kind(*part) == "shaft_section");
        sections.into_iter().find(|section| {
            let start =
                pair.view.number(*section, "u_coordinate_on_shaft", Quantity::Length).map_or(0.0, |start| start.value);
            let length = pair.view.number(*section, "length", Quantity::Length).map_or(0.0, |length| length.value);
            (start..=start + length).contains(&face.middle_mm)
        })
    });
    if let Some(section) = section
        && let Some(outer) = pair.view.non_zero(section, "outer_diameter_begin", Quantity::Length)
    {
        if fits(outer.value) {
            draft.take(&pointer, outer.value, &[outer], "the gear sits on its shaft");
            return;
        }
        if let Some(inner) = pair.view.number(section, "inner_diameter_begin", Quantity::Length)
            && fits(inner.value)
        {
            draft.take(&pointer, inner.value, &[inner], "the gear is one with its shaft, whose bore it has");
            return;
        }
    }
    draft.assume(
        &pointer,
        Value::Null,
        "no inner diameter and no shaft section at the gear: left to the service (0.4 d)",
    );
}

fn mass(pair: &Pair, draft: &mut Draft, member: usize) {
    let gears = pair.gears(member);
    let readings: Vec<_> =
        gears.iter().filter_map(|gear| pair.view.non_zero(*gear, "mass_of_component", Quantity::Mass)).collect();
    if readings.is_empty() || readings.len() < gears.len() {
        return;
    }
    let sum = readings.iter().map(|reading| reading.value).sum::<f64>() * if pair.mirrored { 2.0 } else { 1.0 };
    let why = if pair.mirrored { "both halves" } else { "sum of the halves" };
    draft.take(&format!("/design/{}/mass_kg", MEMBERS[member]), clean(sum), &readings, why);
}

/// Fields of a material: name in the document, attribute, quantity, factor.
const MATERIAL: [(&str, &str, Quantity, f64); 3] = [
    ("youngs_modulus_gpa", "elastic_modulus", Quantity::Stress, 1e-3),
    ("poissons_ratio", "poisson_ratio", Quantity::Number, 1.0),
    ("density_kg_m3", "density", Quantity::Density, 1e3),
];

/// The material of a member: of its gears, else of its shaft.
fn material_of(pair: &Pair, member: usize) -> Option<Handle> {
    let model = pair.model();
    let mut of = pair.gears(member);
    of.push(pair.shaft(member));
    of.into_iter()
        .flat_map(|origin| model.related("reference", origin, "origin", "referenced"))
        .find(|referenced| model.kind(*referenced) == "material")
}

fn materials(pair: &Pair, draft: &mut Draft) {
    let materials = [0, 1].map(|member| material_of(pair, member));
    let both = materials[0].or(materials[1]);
    for (name, id, quantity, factor) in MATERIAL {
        let pointer = format!("/design/material/{name}");
        let read = |material: Option<Handle>| {
            material.and_then(|material| pair.view.number(material, id, quantity)).filter(|reading| reading.value > 0.0)
        };
        let value = |reading: &Reading| if factor == 1.0 { reading.value } else { clean(reading.value * factor) };
        let [pinion, gear] = materials.map(read);
        match read(both) {
            Some(reading) => draft.take(&pointer, value(&reading), &[reading], ""),
            None => {
                let (default, unit) = match name {
                    "youngs_modulus_gpa" => (206.0, "steel"),
                    "poissons_ratio" => (0.3, "steel"),
                    _ => (7850.0, "steel"),
                };
                draft.assume(&pointer, default, format!("no material with {id} in the file: {unit}"));
            }
        }
        if let (Some(pinion), Some(gear)) = (pinion, gear)
            && (pinion.value - gear.value).abs() > 1e-9 * pinion.value.abs()
        {
            let pointer = format!("/design/gear/material/{name}");
            draft.take(&pointer, value(&gear), &[gear], "the gear's own: it differs from the pinion's");
        }
    }
}

fn backlash(pair: &Pair, draft: &mut Draft, basic: &Basic) {
    let pointer = "/design/backlash_um";
    let stages = pair.stages();
    let play = |ids: [&'static str; 2]| -> Vec<Reading> {
        ids.iter().flat_map(|id| pair.numbers(&stages, id, Quantity::Length)).filter(|one| one.value >= 0.0).collect()
    };
    let normal = play(["minimum_normal_backlash", "maximum_normal_backlash"]);
    if !normal.is_empty() {
        let value = clean(mean(&normal) * 1e3);
        draft.take(
            pointer,
            value,
            &normal,
            "mean of the least and the largest normal backlash, the play along the path of contact",
        );
        return;
    }
    let transverse = play(["minimum_transverse_backlash", "maximum_transverse_backlash"]);
    let center_mm = pair
        .numbers(&stages, "center_distance", Quantity::Length)
        .first()
        .map(|reading| reading.value)
        .or_else(|| basic.play_free_mm(basic.profile_shift[0] + basic.profile_shift[1]));
    if !transverse.is_empty()
        && let Some(angle_rad) = center_mm.and_then(|center_mm| basic.working_angle_at(center_mm))
    {
        let value = clean(mean(&transverse) * 1e3 * angle_rad.cos() * basic.cos_base_helix());
        let why =
            "mean of the least and the largest transverse backlash at the working pitch circle · cos α_wt · cos β_b";
        draft.take(pointer, value, &transverse, why);
        return;
    }
    draft.assume(pointer, Value::Null, "no backlash in the file: the service's 2 µm");
}
