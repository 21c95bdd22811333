//! Calculation files of KISSsoft for cylindrical gear pairs (`.Z12`): what such files of version 20 hold. Lengths in
//! mm, angles in rad, speeds in r/min, torques in N m, powers in kW, moduli in N/mm², densities in kg/m³.

mod operation;
mod text;
mod tooth;

use crate::draft::{Draft, Reading};
use crate::refusal::{Refusal, short};
use crate::report::{Import, ImportSource, ImportedPair};
use crate::rexs::{Basic, DEFAULT_GAP_MM, SAME_DISTANCE_MM, checked, parsed};
use crate::unit::clean;
use crate::{FaceWidth, ImportOptions};
use herringbone_job::Violation;
use serde_json::Value;
pub(crate) use text::recognise;
use text::{Key, Values};

/// The module of the program for cylindrical gear pairs.
const PAIR: &str = "Z012";
const MEMBERS: [&str; 2] = ["pinion", "gear"];

/// What the rules share.
struct File<'t, 'o> {
    values: Values<'t>,
    options: &'o ImportOptions,
    /// Indices of pinion and gear in the file.
    gears: [usize; 2],
    mirrored: bool,
}

/// Makes a document of a calculation file.
///
/// # Errors
/// [`Refusal`] with every reason found.
pub(crate) fn import(text: &str, options: &ImportOptions) -> Result<Import, Refusal> {
    let values = Values::read(text);
    let module = values.text("MODULE").unwrap_or("none");
    if module != PAIR {
        let detail = format!("is of module {}; needed: {PAIR}, cylindrical gear pair", short(module));
        let error = Violation::new("", "unsupported-module", detail);
        return Err(Refusal::unsupported(
            "The file is a calculation of KISSsoft, but not of a gear pair.",
            vec![error],
        ));
    }
    if let Some(pair) = options.pair.filter(|pair| *pair != 1) {
        let error = Violation::new("/pair", "out-of-range", format!("is {pair}; the file has one pair"));
        return Err(Refusal::invalid("There is no such pair in the file.", vec![error]));
    }
    let mut draft = Draft::default();
    let Some((file, teeth)) = File::new(values, options, &mut draft)? else { return Err(draft.refused("pair")) };
    let label = format!("{} / {}", teeth[0], teeth[1]);
    draft.set("/name", format!("KISSsoft {label}"));
    let basic = file.basic(&mut draft, teeth);
    let mut operating_points = Vec::new();
    if let Some(basic) = &basic {
        file.teeth(&mut draft, basic);
        file.material(&mut draft);
        operating_points = file.operation(&mut draft);
        file.backlash(&mut draft, basic);
    }
    file.left_over(&mut draft);
    if !draft.errors.is_empty() {
        return Err(draft.refused("pair"));
    }
    let document = parsed(&mut draft)?;
    checked(&document, &mut draft);
    let document = serde_json::to_value(&document).map_err(|error| {
        Refusal::invalid("The document cannot be written.", vec![Violation::new("", "conflict", error.to_string())])
    })?;
    let source = ImportSource {
        format: "z12".to_owned(),
        version: short(file.values.text("VERSION").unwrap_or_default()),
        application: format!("KISSsoft {}", short(file.values.text("KSOFTVERSION").unwrap_or_default())),
        ..ImportSource::default()
    };
    let pair = ImportedPair { number: 1, label, stages: vec![1], mirrored: file.mirrored };
    Ok(draft.into_import(source, (pair, Vec::new()), (document, operating_points)))
}

impl<'t, 'o> File<'t, 'o> {
    /// The pair with its teeth; `None` where they are not complete.
    fn new(
        values: Values<'t>,
        options: &'o ImportOptions,
        draft: &mut Draft,
    ) -> Result<Option<(Self, [f64; 2])>, Refusal> {
        let mut file = Self { values, options, gears: [0, 1], mirrored: false };
        let readings = [0, 1].map(|gear| file.read(draft, "/design", &Key::of_gear(gear, "z", ""), 1.0));
        let [Some(first), Some(second)] = &readings else {
            for (reading, name) in readings.iter().zip(["ZR[0].z", "ZR[1].z"]) {
                if reading.is_none() {
                    draft.refuse("/design", "missing", format!("{name} is not in the file"));
                }
            }
            return Ok(None);
        };
        if first.value < 0.0 || second.value < 0.0 {
            let detail = format!("pair 1: z {} / {}, an internal gear", first.value, second.value);
            let error = Violation::new("/pair/1", "unsupported-stage", detail);
            return Err(Refusal::unsupported("The file has an internal gear, which is not calculated.", vec![error]));
        }
        let mut ordered = [first.clone(), second.clone()];
        if second.value < first.value {
            file.gears = [1, 0];
            ordered.reverse();
        }
        for (reading, name) in ordered.iter().zip(MEMBERS) {
            let pointer = format!("/design/{name}/teeth");
            if reading.value.fract() != 0.0 || !(1.0..=10_000.0).contains(&reading.value) {
                draft.refuse(&pointer, "out-of-range", format!("{} is {}", reading.from(), reading.value));
                return Ok(None);
            }
            draft.set(&pointer, reading.value as u64);
            draft.note_taken(&pointer, (reading.value as u64).into(), std::slice::from_ref(reading), "");
        }
        let is_double = file.values.text("ZS.PfeilZahn").is_some_and(|flag| flag == "1");
        file.mirrored = !is_double;
        if file.mirrored && !options.mirror {
            let detail = format!(
                "pair 1: z {} / {}, single-helical (ZS.PfeilZahn is not 1); mirror makes a double-helical pair of it",
                ordered[0].value, ordered[1].value
            );
            let error = Violation::new("/pair/1", "single-helical", detail);
            return Err(Refusal::unsupported("The pair of the file is single-helical.", vec![error]));
        }
        if file.mirrored {
            let detail = "the pair is single-helical: each half is a copy of it, and the torque is doubled";
            draft.warn("mirrored", "", detail);
        }
        Ok(Some((file, ordered.map(|reading| reading.value))))
    }

    /// A number; what is none is refused.
    fn read(&self, draft: &mut Draft, pointer: &str, key: &Key, factor: f64) -> Option<Reading> {
        self.values.number(key, factor).unwrap_or_else(|detail| {
            draft.refuse(pointer, "wrong-type", detail);
            None
        })
    }

    fn of_member(&self, member: usize, attribute: &'static str, unit: &'static str) -> Key {
        Key::of_gear(self.gears[member], attribute, unit)
    }

    /// A number that must be there.
    fn needed(&self, draft: &mut Draft, pointer: &str, key: &Key, factor: f64) -> Option<Reading> {
        let before = draft.errors.len();
        let reading = self.read(draft, pointer, key, factor);
        if reading.is_none() && draft.errors.len() == before {
            draft.refuse(pointer, "missing", format!("{} is not in the file", key.name()));
        }
        reading
    }

    /// The macro-geometry; `None` where it is not complete.
    fn basic(&self, draft: &mut Draft, teeth: [f64; 2]) -> Option<Basic> {
        let degrees = 180.0 / std::f64::consts::PI;
        let geometry = |attribute, unit| Key::of_pair("ZS.Geo", attribute, unit);
        let module = self.needed(draft, "/design/normal_module_mm", &geometry("mn", "mm"), 1.0);
        let angle = self.needed(draft, "/design/pressure_angle_deg", &geometry("alfn", "rad"), degrees);
        let helix = self.needed(draft, "/design/helix_angle_deg", &geometry("beta", "rad"), degrees);
        let sides = ["alfnLeft", "alfnRight"].map(|side| self.read(draft, "/design", &geometry(side, "rad"), degrees));
        if let [Some(left), Some(right)] = &sides
            && (left.value - right.value).abs() > 1e-6
        {
            let detail =
                format!("the flanks differ: {} = {}°, {} = {}°", left.from(), left.value, right.from(), right.value);
            draft.refuse("/design/pressure_angle_deg", "asymmetric", detail);
        }
        let width_mm = self.widths(draft);
        let (module, angle, helix, face_width_mm) = (module?, angle?, helix?, width_mm?);
        draft.take("/design/normal_module_mm", module.value, std::slice::from_ref(&module), "");
        draft.set("/design/pressure_angle_plane", "normal");
        draft.take("/design/pressure_angle_deg", angle.value, std::slice::from_ref(&angle), "");
        let helix_deg = helix.value.abs();
        draft.take("/design/helix_angle_deg", helix_deg, std::slice::from_ref(&helix), "size");
        let hand_sign = self.hands(draft);
        let mut basic = Basic {
            module_mm: module.value,
            pressure_angle_deg: angle.value,
            helix_angle_deg: helix_deg,
            left_helix_deg: hand_sign * helix_deg,
            teeth,
            profile_shift: [0.0; 2],
            face_width_mm,
        };
        let possible = module.value > 0.0 && helix_deg < 85.0 && (0.0..60.0).contains(&angle.value);
        if !possible {
            let detail = format!(
                "has module {} mm, helix angle {helix_deg}°, pressure angle {}°: no gear",
                module.value, angle.value
            );
            draft.refuse("/design", "out-of-range", detail);
            return None;
        }
        for (member, name) in MEMBERS.into_iter().enumerate() {
            let pointer = format!("/design/{name}/profile_shift");
            match self.read(draft, &pointer, &self.of_member(member, "x.nul", ""), 1.0) {
                Some(reading) => {
                    basic.profile_shift[member] = reading.value;
                    draft.take(&pointer, reading.value, &[reading], "");
                }
                None => draft.assume(&pointer, 0.0, "no profile shift in the file"),
            }
        }
        self.center_distance(draft, &basic);
        Some(basic)
    }

    /// Hand of the pinion's left half: 1 right, −1 left.
    fn hands(&self, draft: &mut Draft) -> f64 {
        let key = self.of_member(0, "Schrage", "");
        let word = |right: bool| if right { "right" } else { "left" };
        let Some(reading) = self.read(draft, "/design/pinion/left_half_hand", &key, 1.0) else {
            draft.assume("/design/pinion/left_half_hand", word(true), "no hand in the file");
            draft.assume("/design/gear/left_half_hand", word(false), "opposite of the pinion's");
            return 1.0;
        };
        let right = reading.value == 0.0;
        let why = if self.mirrored {
            "0 is right, 1 left; the stage is the left half"
        } else {
            "0 is right, 1 left; of the left half, as far as is known"
        };
        let from = reading.from();
        draft.take_word("/design/pinion/left_half_hand", word(right), &from, reading.file_value.into(), why);
        draft.take_word(
            "/design/gear/left_half_hand",
            word(!right),
            &from,
            reading.file_value.into(),
            "opposite of the pinion's",
        );
        if right { 1.0 } else { -1.0 }
    }

    /// Face width of a half and the gap.
    fn widths(&self, draft: &mut Draft) -> Option<f64> {
        let pointer = "/design/face_width_mm";
        let readings = [0, 1].map(|member| self.needed(draft, pointer, &self.of_member(member, "b", "mm"), 1.0));
        let [Some(pinion), Some(gear)] = readings else { return None };
        let least = pinion.value.min(gear.value);
        let both = [pinion, gear];
        let gap_pointer = "/design/gap_width_mm";
        if self.mirrored {
            draft.take(pointer, least, &both, "the smaller; of the stage that is mirrored");
            let gap_mm = self.options.gap_width_mm;
            let why = if gap_mm.is_some() {
                "chosen at import: a single-helical stage has no gap"
            } else {
                "a single-helical stage has no gap"
            };
            draft.assume(gap_pointer, gap_mm.unwrap_or(DEFAULT_GAP_MM), why);
            return Some(least);
        }
        let gap = [0, 1].map(|member| self.read(draft, gap_pointer, &self.of_member(member, "PfeilNutB", "mm"), 1.0));
        let gaps: Vec<Reading> = gap.into_iter().flatten().filter(|reading| reading.value > 0.0).collect();
        let gap_mm = gaps.iter().map(|reading| reading.value).fold(0.0, f64::max);
        match gaps.is_empty() {
            false => draft.take(gap_pointer, gap_mm, &gaps, "the wider groove"),
            true => draft.assume(gap_pointer, 0.0, "no groove in the file"),
        }
        let (width_mm, why) = match self.options.face_width {
            FaceWidth::Half => (least, "the smaller; of one half, as chosen at import (face_width_is)"),
            FaceWidth::Total => (
                clean((least - gap_mm) / 2.0),
                "half of the smaller width less the groove: whether the file's width is of both halves is not certain (face_width_is)",
            ),
        };
        if width_mm <= 0.0 {
            let detail = format!("the groove of {gap_mm} mm leaves nothing of the width of {least} mm");
            draft.refuse(pointer, "conflict", detail);
            return None;
        }
        draft.take(pointer, width_mm, &both, why);
        if self.options.face_width == FaceWidth::Total {
            draft.warn("face-width-assumed", pointer, why);
        }
        Some(width_mm)
    }

    fn center_distance(&self, draft: &mut Draft, basic: &Basic) {
        let pointer = "/design/center_distance_mm";
        let shifts = basic.profile_shift[0] + basic.profile_shift[1];
        let play_free_mm = basic.play_free_mm(shifts);
        let Some(reading) =
            self.read(draft, pointer, &Key::of_pair("ZP[0]", "a", "mm"), 1.0).filter(|reading| reading.value > 0.0)
        else {
            draft.assume(pointer, Value::Null, "no centre distance in the file: that of play-free mesh");
            return;
        };
        if play_free_mm.is_some_and(|play_free_mm| (reading.value - play_free_mm).abs() <= SAME_DISTANCE_MM) {
            draft.set(pointer, Value::Null);
            let why = "that of play-free mesh within 0.5 µm, from which the service derives it";
            draft.note_taken(pointer, Value::Null, std::slice::from_ref(&reading), why);
        } else {
            draft.take(pointer, reading.value, std::slice::from_ref(&reading), "");
        }
        // Tip alteration of unchanged tip clearance: (a − a_d)/m_n − Σx.
        let reference_mm = 0.5 * (basic.reference_mm(0) + basic.reference_mm(1));
        let expected = (reading.value - reference_mm) / basic.module_mm - shifts;
        if let Some(tip) = self.tip(draft, basic, 0) {
            let k = Reading { value: tip.1, ..tip.0 };
            draft.check("tip alteration coefficient of unchanged tip clearance, pinion", &k, expected, "");
        }
    }
}
