//! The macro-geometry: teeth, angles, module, widths, gap.

use super::center;
use super::pair::{MEMBERS, Pair, listed, spread};
use super::tools::tool_of;
use super::view::{difference, dot};
use crate::draft::{Draft, Reading};
use crate::unit::{Quantity, clean};

/// Gap where none is known, mm.
pub(crate) const DEFAULT_GAP_MM: f64 = 30.0;

/// Basic data that further rules need.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Basic {
    pub module_mm: f64,
    pub pressure_angle_deg: f64,
    /// Size of the helix angle.
    pub helix_angle_deg: f64,
    /// Helix angle of the pinion's left half, positive for a right hand.
    pub left_helix_deg: f64,
    pub teeth: [f64; 2],
    pub profile_shift: [f64; 2],
    pub face_width_mm: f64,
}

impl Basic {
    pub(crate) fn reference_mm(&self, member: usize) -> f64 {
        self.teeth[member] * self.module_mm / self.helix_angle_deg.to_radians().cos()
    }

    fn transverse_pressure_angle_rad(&self) -> f64 {
        (self.pressure_angle_deg.to_radians().tan() / self.helix_angle_deg.to_radians().cos()).atan()
    }

    pub(super) fn base_mm(&self, member: usize) -> f64 {
        self.reference_mm(member) * self.transverse_pressure_angle_rad().cos()
    }

    pub(super) fn cos_base_helix(&self) -> f64 {
        (1.0 - (self.helix_angle_deg.to_radians().sin() * self.pressure_angle_deg.to_radians().cos()).powi(2)).sqrt()
    }

    /// Working transverse pressure angle of play-free mesh for a sum of profile shifts (ISO 21771, 6.2); `None` where
    /// there is none.
    fn working_angle_rad(&self, shifts: f64) -> Option<f64> {
        let alpha_t = self.transverse_pressure_angle_rad();
        let value = involute(alpha_t)
            + 2.0 * self.pressure_angle_deg.to_radians().tan() * shifts / (self.teeth[0] + self.teeth[1]);
        if !(value.is_finite() && value > 0.0) {
            return None;
        }
        // inv is convex and increasing: from above the root, the iteration falls to it.
        let mut tangent = (3.0 * value).cbrt() + value;
        for _ in 0..100 {
            let step = (tangent - tangent.atan() - value) * (1.0 + tangent * tangent) / (tangent * tangent);
            tangent -= step;
            if step.abs() <= 1e-15 * tangent {
                break;
            }
        }
        Some(tangent.atan())
    }

    /// Centre distance of play-free mesh.
    pub(crate) fn play_free_mm(&self, shifts: f64) -> Option<f64> {
        let reference_mm = 0.5 * (self.reference_mm(0) + self.reference_mm(1));
        Some(reference_mm * self.transverse_pressure_angle_rad().cos() / self.working_angle_rad(shifts)?.cos())
    }

    /// Working transverse pressure angle at a centre distance.
    pub(super) fn working_angle_at(&self, center_mm: f64) -> Option<f64> {
        let cosine = 0.5 * (self.base_mm(0) + self.base_mm(1)) / center_mm;
        (cosine > 0.0 && cosine < 1.0).then(|| cosine.acos())
    }

    /// Sum of the profile shifts for which a centre distance is that of play-free mesh.
    pub(super) fn shifts_at(&self, center_mm: f64) -> Option<f64> {
        let difference = involute(self.working_angle_at(center_mm)?) - involute(self.transverse_pressure_angle_rad());
        let shifts = difference * (self.teeth[0] + self.teeth[1]) / (2.0 * self.pressure_angle_deg.to_radians().tan());
        shifts.is_finite().then_some(shifts)
    }
}

fn involute(angle_rad: f64) -> f64 {
    angle_rad.tan() - angle_rad
}

/// Writes the macro-geometry; `None` where it is not complete, with the reasons in the draft.
pub(super) fn write(pair: &Pair, draft: &mut Draft, gap_width_mm: Option<f64>) -> Option<Basic> {
    for (member, name) in MEMBERS.into_iter().enumerate() {
        let readings = pair.numbers(&pair.gears(member), "number_of_teeth", Quantity::Number);
        let teeth = pair.halves[0].teeth[member];
        let pointer = format!("/design/{name}/teeth");
        draft.set(&pointer, teeth);
        draft.note_taken(&pointer, teeth.into(), &readings, "");
    }
    draft.set("/design/pressure_angle_plane", "normal");
    let helix = helix(pair, draft);
    let pressure_angle_deg = pressure_angle(pair, draft);
    let module_mm = module(pair, draft, helix.map(|(size, _)| size));
    let width_mm = widths(pair, draft, gap_width_mm);
    let ((helix_angle_deg, left_helix_deg), pressure_angle_deg, module_mm, face_width_mm) =
        (helix?, pressure_angle_deg?, module_mm?, width_mm?);
    let mut basic = Basic {
        module_mm,
        pressure_angle_deg,
        helix_angle_deg,
        left_helix_deg,
        teeth: [pair.teeth(0), pair.teeth(1)],
        profile_shift: [0.0; 2],
        face_width_mm,
    };
    let possible = module_mm > 0.0 && helix_angle_deg < 85.0 && (0.0..60.0).contains(&pressure_angle_deg);
    if !possible {
        draft.refuse(
            "/design",
            "out-of-range",
            format!("has module {module_mm} mm, helix angle {helix_angle_deg}°, pressure angle {pressure_angle_deg}°: no gear"),
        );
        return None;
    }
    center::write(pair, draft, &mut basic);
    Some(basic)
}

/// Size of the helix angle, and that of the pinion's left half with its sign.
fn helix(pair: &Pair, draft: &mut Draft) -> Option<(f64, f64)> {
    let pointer = "/design/helix_angle_deg";
    let id = "helix_angle_reference_diameter";
    let gears = pair.all_gears();
    let readings = pair.numbers(&gears, id, Quantity::Angle);
    let pinions = pair.numbers(&pair.gears(0), id, Quantity::Angle);
    let wheels = pair.numbers(&pair.gears(1), id, Quantity::Angle);
    let (left, why) = match (pinions.first(), wheels.first()) {
        (Some(pinion), _) => (pinion.value, "size; a positive angle in the file is right-hand"),
        (None, Some(wheel)) => (-wheel.value, "size; the pinion's is missing, its mate has the opposite hand"),
        (None, None) => {
            draft.refuse(pointer, "missing", pair.missing(&gears, id));
            return None;
        }
    };
    for (pinion, wheel) in pinions.iter().zip(&wheels) {
        if pinion.value * wheel.value > 0.0 {
            let detail = format!(
                "both gears of a stage have the same hand ({}); mating external gears have opposite ones",
                listed(&[pinion.clone(), wheel.clone()])
            );
            draft.refuse(pointer, "conflict", detail);
            return None;
        }
    }
    let size = left.abs();
    if readings.iter().any(|reading| (reading.value.abs() - size).abs() > 1e-3) {
        draft.refuse(pointer, "conflict", format!("the helix angles differ in size: {}", listed(&readings)));
        return None;
    }
    draft.take(pointer, size, &readings, why);
    let hands = if left > 0.0 { ["right", "left"] } else { ["left", "right"] };
    for (name, hand) in MEMBERS.into_iter().zip(hands) {
        let pointer = format!("/design/{name}/left_half_hand");
        let from = readings.first().map(Reading::from).unwrap_or_default();
        let why = match name {
            "pinion" => "sign of the helix angle of the left half, the one with the smaller coordinate on its shaft",
            _ => "opposite of the pinion's",
        };
        draft.take_word(&pointer, hand, &from, left.into(), why);
    }
    Some((size, left))
}

fn pressure_angle(pair: &Pair, draft: &mut Draft) -> Option<f64> {
    let pointer = "/design/pressure_angle_deg";
    let mut readings = Vec::new();
    for gear in pair.all_gears() {
        let flanks = pair.numbers(&pair.flanks(gear), "normal_pressure_angle", Quantity::Angle);
        if spread(&flanks) > 1e-6 {
            let detail = format!("the flanks of a gear differ, its teeth are asymmetric: {}", listed(&flanks));
            draft.refuse(pointer, "asymmetric", detail);
            return None;
        }
        readings.extend(flanks);
    }
    if readings.is_empty() {
        let tools = pair.all_gears().into_iter().filter_map(|gear| tool_of(pair, gear));
        readings = tools.filter_map(|tool| pair.view.number(tool, "normal_pressure_angle", Quantity::Angle)).collect();
    }
    let Some(first) = readings.first() else {
        draft.assume(pointer, 20.0, "no pressure angle in the file, on flanks or tools");
        return Some(20.0);
    };
    if spread(&readings) > 1e-6 {
        draft.refuse(pointer, "conflict", format!("the pressure angles differ: {}", listed(&readings)));
        return None;
    }
    let value = first.value;
    draft.take(pointer, value, &readings, "");
    Some(value)
}

fn module(pair: &Pair, draft: &mut Draft, helix_deg: Option<f64>) -> Option<f64> {
    let pointer = "/design/normal_module_mm";
    let gears = pair.all_gears();
    let mut readings = pair.numbers(&gears, "normal_module", Quantity::Length);
    let mut factor = 1.0;
    let mut why = "";
    if readings.is_empty()
        && let Some(helix_deg) = helix_deg
    {
        readings = pair.numbers(&gears, "transverse_module", Quantity::Length);
        factor = helix_deg.to_radians().cos();
        why = "transverse module · cos β";
    }
    let Some(first) = readings.first() else {
        draft.refuse(pointer, "missing", pair.missing(&gears, "normal_module"));
        return None;
    };
    let value = if factor == 1.0 { first.value } else { clean(first.value * factor) };
    if spread(&readings) > 1e-6 * first.value.abs() {
        draft.refuse(pointer, "conflict", format!("the modules differ: {}", listed(&readings)));
        return None;
    }
    draft.take(pointer, value, &readings, why);
    Some(value)
}

/// Face width and gap.
fn widths(pair: &Pair, draft: &mut Draft, gap_width_mm: Option<f64>) -> Option<f64> {
    let pointer = "/design/face_width_mm";
    let gears = pair.all_gears();
    let readings = pair.numbers(&gears, "face_width", Quantity::Length);
    let common = pair.numbers(&pair.stages(), "common_face_width", Quantity::Length);
    let Some(least) = readings.iter().chain(&common).min_by(|a, b| a.value.total_cmp(&b.value)).cloned() else {
        draft.refuse(pointer, "missing", pair.missing(&gears, "face_width"));
        return None;
    };
    let mut width_mm = least.value;
    let mut why = match (spread(&readings) > 1e-9, least.attribute) {
        (_, "common_face_width") => "common width of the stage",
        (true, _) => "the smallest",
        (false, _) => "",
    };
    for member in [0, 1] {
        let halves = pair.numbers(&pair.gears(member), "face_width", Quantity::Length);
        if spread(&halves) > 1e-3 * width_mm {
            let detail = format!("the halves differ in width, the smaller counts: {}", listed(&halves));
            draft.warn("widths-differ", pointer, detail);
        }
    }
    if let Some(overlap_mm) = overlap_mm(pair) {
        if overlap_mm <= 0.0 {
            draft.refuse(pointer, "no-overlap", "the faces of pinion and gear do not meet, by their support vectors");
            return None;
        }
        if overlap_mm < width_mm - 1e-3 {
            width_mm = clean(overlap_mm);
            why = "what the faces of pinion and gear have in common, by their support vectors";
            let detail = format!("is {width_mm} mm: the faces of pinion and gear are shifted against each other");
            draft.warn("faces-shifted", pointer, detail);
        }
    }
    draft.take(pointer, width_mm, &readings, why);
    for (member, name) in MEMBERS.into_iter().enumerate() {
        let own = pair.numbers(&pair.gears(member), "face_width", Quantity::Length);
        if let Some(least) = own.iter().min_by(|a, b| a.value.total_cmp(&b.value))
            && least.value > width_mm * (1.0 + 1e-9)
        {
            let why = "wider than the common width; the common part, centred, bears";
            draft.take(&format!("/design/{name}/face_width_mm"), least.value, std::slice::from_ref(least), why);
        }
    }
    gap(pair, draft, width_mm, gap_width_mm);
    Some(width_mm)
}

/// Width that the faces of both members have in common, the smaller of the halves, by the vectors to their middles.
fn overlap_mm(pair: &Pair) -> Option<f64> {
    let view = pair.view;
    let of_half = |pinion, wheel| {
        let references = [pinion, wheel].map(|gear| view.reference(gear, "reference_component_for_position"));
        if references[0] != references[1] {
            return None;
        }
        let places = [view.vector(pinion, "support_vector")?, view.vector(wheel, "support_vector")?];
        let widths = [pinion, wheel].map(|gear| view.number(gear, "face_width", Quantity::Length));
        let [Some(one), Some(other)] = widths else { return None };
        let axis = view.direction(pinion, "u_axis_vector")?;
        let apart_mm = dot(difference(places[1], places[0]), axis).abs();
        Some((0.5 * (one.value + other.value) - apart_mm).min(one.value.min(other.value)))
    };
    pair.halves.iter().filter_map(|half| of_half(half.pinion, half.wheel)).min_by(f64::total_cmp)
}

fn gap(pair: &Pair, draft: &mut Draft, width_mm: f64, gap_width_mm: Option<f64>) {
    let pointer = "/design/gap_width_mm";
    if pair.mirrored {
        let why = match gap_width_mm {
            Some(_) => "chosen at import: a single-helical stage has no gap",
            None => "a single-helical stage has no gap",
        };
        draft.assume(pointer, gap_width_mm.unwrap_or(DEFAULT_GAP_MM), why);
        return;
    }
    let mut distances = Vec::new();
    for member in [0, 1] {
        let faces: Vec<_> = pair.faces(member).into_iter().flatten().collect();
        for note in faces.iter().filter_map(|face| face.note.as_ref()) {
            draft.warn("position-differs", pointer, note.clone());
        }
        if let [one, other] = faces.as_slice() {
            let distance_mm = (other.middle_mm - one.middle_mm).abs();
            let readings: Vec<_> = one.readings.iter().chain(&other.readings).cloned().collect();
            distances.push((distance_mm, readings));
        }
    }
    let Some((distance_mm, readings)) = distances.iter().min_by(|a, b| a.0.total_cmp(&b.0)).cloned() else {
        draft.assume(pointer, DEFAULT_GAP_MM, "the places of the halves on their shafts are not in the file");
        draft.warn("gap-assumed", pointer, format!("is not in the file: {DEFAULT_GAP_MM} mm assumed"));
        return;
    };
    if let [one, other] = distances.as_slice()
        && (one.0 - other.0).abs() > 0.1
    {
        let detail = format!(
            "the middles of the halves are {} mm apart on the pinion and {} mm on the gear; the smaller distance counts",
            one.0, other.0
        );
        draft.warn("gaps-differ", pointer, detail);
    }
    let gap_mm = clean(distance_mm - width_mm);
    if gap_mm < -1e-9 {
        draft.refuse(pointer, "overlap", format!("the faces of the halves overlap: the gap is {gap_mm} mm"));
        return;
    }
    let why = "distance of the middles of the halves less the face width";
    draft.take(pointer, gap_mm.max(0.0), &readings, why);
}
