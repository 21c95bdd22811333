//! Shafts with sections, bearings, couplings and masses.

mod bearings;
mod drive;
mod outline;

use super::geometry::Basic;
use super::model::Handle;
use super::pair::{MEMBERS, Pair};
use super::position::axis_sign;
use super::tooth::Teeth;
use crate::draft::Draft;
use crate::unit::clean;
use outline::Outline;
use serde_json::{Value, json};

/// Where the shafts stand in the document.
pub(super) const SHAFTS: &str = "/design/shafts";
/// Most segments and bearings of a shaft of the document.
const MAX_SEGMENTS: usize = 64;
const MAX_BEARINGS: usize = 16;

/// One shaft of the file, as the document measures it.
struct Mounted<'a> {
    member: usize,
    shaft: Handle,
    outline: &'a Outline,
    /// 1 where the u-axis points from left to right, else -1.
    sign: f64,
}

impl Mounted<'_> {
    /// Position in the document from the shaft's left end.
    fn position_mm(&self, u_mm: f64) -> f64 {
        let from_left = if self.sign > 0.0 { u_mm - self.outline.start_mm } else { self.outline.end_mm - u_mm };
        clean((from_left * 1e9).round() / 1e9)
    }

    fn pointer(&self, rest: &str) -> String {
        format!("{SHAFTS}/{}{rest}", MEMBERS[self.member])
    }
}

/// Writes the shafts, as far as the file has sections of them.
pub(super) fn write(pair: &Pair, draft: &mut Draft, basic: &Basic, teeth: &Teeth) {
    let model = pair.model();
    if pair.mirrored {
        for member in [0, 1] {
            let why = "shafts and bearings of a single-helical stage do not fit the wider mirrored pair";
            draft.ignore(model.label(pair.shaft(member)), why, None);
        }
        draft.warn(
            "shafts-not-taken",
            SHAFTS,
            "are not taken: those of a single-helical stage do not fit the mirrored pair",
        );
        return;
    }
    let mut found = 0;
    for member in [0, 1] {
        let shaft = pair.shaft(member);
        let Some(outline) = outline::of(pair, draft, basic, teeth, member) else {
            draft.ignore(
                model.label(shaft),
                "has no shaft sections, or its gears no place: no shaft for the document",
                None,
            );
            continue;
        };
        let sign = if member == 0 { 1.0 } else { axis_sign(pair.view, pair.shaft(0), shaft) };
        let mounted = Mounted { member, shaft, outline: &outline, sign };
        write_shaft(pair, draft, basic, teeth, &mounted);
        found += 1;
    }
    match found {
        0 => {
            draft.warn(
                "no-shafts",
                SHAFTS,
                "are not in the file (no shaft sections): the halves stand on the supports",
            );
        }
        1 => draft.assume(
            &format!("{SHAFTS}/arrangement"),
            json!({}),
            "the file has sections of one shaft only: the other one after a usual arrangement",
        ),
        _ => held_axially(draft),
    }
}

fn write_shaft(pair: &Pair, draft: &mut Draft, basic: &Basic, teeth: &Teeth, mounted: &Mounted) {
    let outline = mounted.outline;
    let mut segments: Vec<Value> = outline
        .segments
        .iter()
        .map(|segment| {
            json!({
                "length_mm": clean(segment.length_mm()), "diameter_mm": clean(segment.diameter_mm),
                "bore_mm": clean(segment.bore_mm),
            })
        })
        .collect();
    if mounted.sign < 0.0 {
        segments.reverse();
    }
    let pointer = mounted.pointer("/segments");
    let from = outline.sections.iter().map(|section| pair.model().label(*section)).collect::<Vec<_>>().join(", ");
    let count = segments.len();
    let why = "sections from left to right; over the faces the body of the gear, up to the root circle";
    draft.take_word(&pointer, Value::Array(segments), &from, count.into(), why);
    let pointer = mounted.pointer("/gear_position_mm");
    let middle_mm = mounted.position_mm(outline.middle_mm);
    draft.take(&pointer, middle_mm, &outline.readings, "middle between the halves, from the left end of the shaft");
    bearings::write(pair, draft, mounted);
    drive::write(pair, draft, mounted);
    half_body(draft, basic, teeth, mounted);
}

/// The teeth of a half as a ring between root and reference circle.
fn half_body(draft: &mut Draft, basic: &Basic, teeth: &Teeth, mounted: &Mounted) {
    let [outer_m, inner_m, width_m] =
        [basic.reference_mm(mounted.member), teeth.root_mm[mounted.member], basic.face_width_mm].map(|mm| 1e-3 * mm);
    let pointer = format!("/design/{}/material/density_kg_m3", MEMBERS[mounted.member]);
    let density = |pointer: &str| draft.document.pointer(pointer).and_then(Value::as_f64);
    let density_kg_m3 = density(&pointer).or_else(|| density("/design/material/density_kg_m3")).unwrap_or(7850.0);
    let mass_kg = density_kg_m3 * std::f64::consts::FRAC_PI_4 * (outer_m * outer_m - inner_m * inner_m) * width_m;
    if mass_kg <= 0.0 {
        return;
    }
    let squares = outer_m * outer_m + inner_m * inner_m;
    let body = json!({
        "mass_kg": rounded(mass_kg), "polar_inertia_kg_m2": rounded(mass_kg * squares / 8.0),
        "diametral_inertia_kg_m2": rounded(mass_kg * (squares / 16.0 + width_m * width_m / 12.0)),
    });
    draft.assume(
        &mounted.pointer("/half_body"),
        body,
        "the teeth of a half as a ring between root and reference circle",
    );
}

/// A derived value with four significant digits, as people give one.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// One of the shafts has to be held along its axis.
fn held_axially(draft: &mut Draft) {
    let bearings = |draft: &Draft, member: &str| -> Vec<(f64, f64)> {
        let list = draft.document.pointer(&format!("{SHAFTS}/{member}/bearings")).and_then(Value::as_array);
        let number = |bearing: &Value, name: &str| bearing[name].as_f64().unwrap_or(0.0);
        list.into_iter().flatten().map(|one| (number(one, "radial_n_per_um"), number(one, "axial_n_per_um"))).collect()
    };
    let held = MEMBERS.iter().any(|member| {
        let coupling = draft.document.pointer(&format!("{SHAFTS}/{member}/coupling/axial_n_per_um"));
        coupling.and_then(Value::as_f64).is_some_and(|axial| axial > 0.0)
            || bearings(draft, member).iter().any(|(_, axial)| *axial > 0.0)
    });
    let of_gear = bearings(draft, "gear");
    if held || of_gear.is_empty() {
        return;
    }
    let value = rounded(of_gear[0].0.max(1.0) / 3.0);
    let why =
        "no bearing in the file holds a shaft axially: the gear's first one does, with a third of its radial stiffness";
    draft.assume(&format!("{SHAFTS}/gear/bearings/0/axial_n_per_um"), Value::from(value), why);
}
