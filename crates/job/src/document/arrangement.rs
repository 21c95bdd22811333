//! Shafts from a few numbers: usual arrangements, from which both shafts are derived.

use super::design::{DesignInput, GearInput, MaterialInput};
use super::shafts::{
    BearingInput, CouplingInput, Faces, ROUNDING, RigidBodyInput, ShaftInput, ShaftSegmentInput, shaft_and_faces,
    unit_of,
};
use crate::reader::ObjectPlace;
use herringbone_macros::{Input, Words};
use serde::Serialize;
use std::f64::consts::PI;

/// Radial stiffness of a bearing over the shaft's diameter, where it is not given, N/µm per mm.
const RADIAL_PER_DIAMETER: f64 = 10.0;
/// Axial stiffness of the bearing that locates the gear, over its radial one.
const AXIAL_OVER_RADIAL: f64 = 1.0 / 3.0;
/// Damping of the bearings of an arrangement over their stiffness, N·s/m per N/µm: 1e-5 s, in the middle of the
/// (0.25 … 2.5)·1e-5 s that are usual for rolling bearings.
const DAMPING_PER_STIFFNESS: f64 = 10.0;
/// Diameter of the pinion's shaft between bearings over the root circle.
const JOURNAL_OVER_ROOT: f64 = 0.8;
/// Largest diameter of the gear's shaft over its root circle.
const GEAR_JOURNAL_OVER_ROOT: f64 = 0.6;
/// From the outer bearing to the coupling, over the diameter.
const COUPLING_OVERHANG: f64 = 1.5;
/// From the middle of a bearing to the end of the shaft, over the diameter.
const SEAT: f64 = 0.25;
/// From the face to the bearing beside an overhung pinion, over the diameter.
const OVERHANG: f64 = 0.5;

/// A usual arrangement of both shafts. Fields that are null are derived from the size of the pair.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
pub struct ArrangementInput {
    /// Pinion between its bearings (straddle) or beside both of them (overhung); the gear stands between its bearings.
    #[input(default = Mounting::Straddle)]
    pub r#type: Mounting,
    /// End of the pinion's shaft where the torque enters; the bearings of an overhung pinion are on that side.
    #[input(default = ShaftEnd::Left)]
    pub input: ShaftEnd,
    /// End of the gear's shaft where the torque leaves; the other end than the input's when null.
    #[input(derived = "opposite of the input")]
    pub output: Option<ShaftEnd>,
    /// Distance between the bearings of the pinion and, where both stand between them, of the gear; by face width, gap
    /// and shaft diameter when null.
    #[input(unit = "mm", min = 1.0, max = 20_000.0)]
    pub bearing_span_mm: Option<f64>,
    /// Diameter of the pinion's shaft; 0.8 of the root circle (overhung: the root circle) when null.
    #[input(unit = "mm", min = 0.5, max = 10_000.0)]
    pub pinion_shaft_diameter_mm: Option<f64>,
    /// Diameter of the gear's shaft; the pinion's times the cube root of the gear ratio, at most 0.6 of the root circle, when null.
    #[input(unit = "mm", min = 0.5, max = 10_000.0)]
    pub gear_shaft_diameter_mm: Option<f64>,
    /// From the face of an overhung pinion to the bearing beside it; half of the shaft's diameter when null.
    #[input(unit = "mm", min = 0.0, max = 10_000.0, when = "type = overhung")]
    pub overhang_mm: Option<f64>,
    /// From the last bearing to the coupling, on both shafts; 1.5 times the diameter of each when null.
    #[input(unit = "mm", min = 0.0, max = 20_000.0)]
    pub coupling_overhang_mm: Option<f64>,
    /// Radial stiffness of each bearing of the pinion; 10 N/um per mm of shaft diameter when null.
    #[input(unit = "N/um", min = 1e-3, max = 1e7)]
    pub pinion_bearing_radial_n_per_um: Option<f64>,
    /// Radial stiffness of each bearing of the gear; 10 N/um per mm of shaft diameter when null.
    #[input(unit = "N/um", min = 1e-3, max = 1e7)]
    pub gear_bearing_radial_n_per_um: Option<f64>,
    /// Axial stiffness of the bearing that locates the gear, opposite of the output; a third of the radial one when null.
    /// The pinion floats.
    #[input(unit = "N/um", min = 1e-3, max = 1e7)]
    pub gear_bearing_axial_n_per_um: Option<f64>,
    /// Damping of each bearing, radially and where it holds axially; 10 N s/m for each N/um of its stiffness when null.
    #[input(unit = "N s/m", min = 0.0, max = 1e12)]
    pub bearing_damping_ns_per_m: Option<f64>,
}

/// Mounting of the pinion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum Mounting {
    /// Between its bearings.
    #[words(label = "straddle: pinion between its bearings")]
    Straddle,
    /// Beside both of its bearings.
    #[words(label = "overhung: pinion beside both bearings")]
    Overhung,
}

/// An end of a shaft.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Words)]
pub enum ShaftEnd {
    Left,
    Right,
}

impl ShaftEnd {
    fn opposite(self) -> Self {
        match self {
            ShaftEnd::Left => ShaftEnd::Right,
            ShaftEnd::Right => ShaftEnd::Left,
        }
    }

    /// -1 for the left end, 1 for the right one.
    fn side(self) -> f64 {
        match self {
            ShaftEnd::Left => -1.0,
            ShaftEnd::Right => 1.0,
        }
    }
}

/// The shafts that a document describes, and what was not given of them.
#[derive(Debug, Clone, PartialEq)]
pub struct ResolvedShafts {
    pub pinion: ShaftInput,
    pub gear: ShaftInput,
    /// Values of the arrangement's fields that are null.
    pub derived: Vec<DerivedShaftValue>,
    /// Radial stiffnesses of bearings that were assumed after the size of the shaft.
    pub assumed_bearings: Vec<DerivedShaftValue>,
}

/// The value of a field that is null.
#[derive(Debug, Clone, PartialEq)]
pub struct DerivedShaftValue {
    /// JSON pointer to the field of the document.
    pub pointer: String,
    pub value: f64,
    /// Unit of the field, as in its name.
    pub unit: &'static str,
    pub basis: &'static str,
}

/// Circles and widths of a member by its basic rack: no pair is needed.
struct Body {
    faces: Faces,
    /// Half width of this member.
    face_width_mm: f64,
    reference_diameter_mm: f64,
    root_diameter_mm: f64,
    density_kg_m3: f64,
}

impl Body {
    fn of(design: &DesignInput, gear: &GearInput) -> Self {
        let module_mm = design.normal_module_mm;
        let reference_diameter_mm = f64::from(gear.teeth) * module_mm / design.helix_angle_deg.to_radians().cos();
        let width_mm = gear.face_width_mm.unwrap_or(design.face_width_mm);
        // A half that is wider or narrower than the design's is centred on that.
        let excess_mm = 0.5 * (width_mm - design.face_width_mm);
        let middle = 0.5 * design.gap_width_mm;
        let root_mm = reference_diameter_mm - 2.0 * module_mm * (gear.dedendum - gear.profile_shift);
        let tip_mm =
            reference_diameter_mm + 2.0 * module_mm * (gear.addendum + gear.profile_shift + gear.tip_alteration);
        let material: &MaterialInput = gear.material.as_ref().unwrap_or(&design.material);
        Self {
            faces: Faces {
                inner_mm: (middle - excess_mm).max(0.0),
                outer_mm: middle + design.face_width_mm + excess_mm,
                tip_diameter_mm: tip_mm,
            },
            face_width_mm: width_mm,
            reference_diameter_mm,
            // A gear whose root circle vanishes is refused elsewhere.
            root_diameter_mm: rounded(root_mm.max(0.2 * reference_diameter_mm)),
            density_kg_m3: material.density_kg_m3,
        }
    }

    /// The body between the halves: a groove one module deep below the root circle, not below the shaft.
    fn groove_diameter_mm(&self, shaft_diameter_mm: f64, module_mm: f64) -> f64 {
        rounded((self.root_diameter_mm - module_mm).max(shaft_diameter_mm.min(self.root_diameter_mm)))
    }

    /// The teeth of a half as a ring between root and reference circle.
    fn teeth(&self) -> Option<RigidBodyInput> {
        let [outer_m, inner_m, width_m] =
            [self.reference_diameter_mm, self.root_diameter_mm, self.face_width_mm].map(|mm| 1e-3 * mm);
        let mass_kg = self.density_kg_m3 * PI / 4.0 * (outer_m * outer_m - inner_m * inner_m) * width_m;
        let squares = outer_m * outer_m + inner_m * inner_m;
        (mass_kg > 0.0).then(|| RigidBodyInput {
            mass_kg: rounded(mass_kg),
            polar_inertia_kg_m2: rounded(mass_kg * squares / 8.0),
            diametral_inertia_kg_m2: rounded(mass_kg * (squares / 16.0 + width_m * width_m / 12.0)),
        })
    }
}

/// A derived value with four significant digits, as people give one.
fn rounded(value: f64) -> f64 {
    // The text of a number is read without an error of its last digits.
    format!("{value:.3e}").parse().unwrap_or(value)
}

/// A sum of lengths without the errors of its last digits: to a picometre.
fn cleaned(length_mm: f64) -> f64 {
    (length_mm * 1e9).round() / 1e9
}

/// What a derived shaft needs: places from the middle of the gap, positive to the right.
struct Plan {
    diameter_mm: f64,
    bearings_mm: [f64; 2],
    coupling_mm: f64,
    /// Radial and axial stiffness of each bearing.
    stiffness_n_per_um: [[f64; 2]; 2],
    damping_ns_per_m: Option<f64>,
}

impl Plan {
    fn shaft(&self, body: &Body, module_mm: f64) -> ShaftInput {
        let Self { diameter_mm, bearings_mm, coupling_mm, .. } = *self;
        let Faces { inner_mm, outer_mm, .. } = body.faces;
        let seat_mm = rounded(SEAT * diameter_mm);
        let least = |places: [f64; 4]| places.into_iter().fold(f64::INFINITY, f64::min);
        let left_mm = least([-outer_mm, coupling_mm, bearings_mm[0] - seat_mm, bearings_mm[1] - seat_mm]);
        let right_mm = -least([-outer_mm, -coupling_mm, -bearings_mm[0] - seat_mm, -bearings_mm[1] - seat_mm]);
        let groove_mm = body.groove_diameter_mm(diameter_mm, module_mm);
        let pieces = [
            (left_mm, -outer_mm, diameter_mm),
            (-outer_mm, -inner_mm, body.root_diameter_mm),
            (-inner_mm, inner_mm, groove_mm),
            (inner_mm, outer_mm, body.root_diameter_mm),
            (outer_mm, right_mm, diameter_mm),
        ];
        // Pieces shorter than a segment can be are left out; the next one begins where the last one ends.
        let mut segments: Vec<ShaftSegmentInput> = Vec::new();
        let mut start_mm = left_mm;
        for (_, end_mm, diameter_mm) in pieces {
            if end_mm - start_mm >= 0.1 {
                segments.push(ShaftSegmentInput { length_mm: cleaned(end_mm - start_mm), diameter_mm, bore_mm: 0.0 });
                start_mm = end_mm;
            }
        }
        let length_mm: f64 = segments.iter().map(|segment| segment.length_mm).sum();
        let position = |z_mm: f64| cleaned(z_mm - left_mm).clamp(0.0, length_mm);
        let bearing = |index: usize| {
            let [radial, axial] = self.stiffness_n_per_um[index];
            let damping = |stiffness: f64| match stiffness > 0.0 {
                true => self.damping_ns_per_m.unwrap_or_else(|| rounded(DAMPING_PER_STIFFNESS * stiffness)),
                false => 0.0,
            };
            BearingInput {
                radial_n_per_um: Some(radial),
                axial_n_per_um: axial,
                radial_damping_ns_per_m: damping(radial),
                axial_damping_ns_per_m: damping(axial),
                ..BearingInput::at(position(bearings_mm[index]))
            }
        };
        ShaftInput {
            gear_position_mm: position(0.0),
            segments,
            bearings: vec![bearing(0), bearing(1)],
            coupling: CouplingInput {
                position_mm: position(coupling_mm),
                axial_n_per_um: 0.0,
                axial_friction_n: 0.0,
                torsional_nm_per_rad: None,
                torsional_damping_nms_per_rad: 0.0,
                inertia_kg_m2: None,
            },
            half_body: body.teeth(),
            inertias: Vec::new(),
        }
    }
}

/// Both shafts of an arrangement, and the values of its fields that are null.
fn derive(
    arrangement: &ArrangementInput,
    design: &DesignInput,
    is_derived: [bool; 2],
) -> ([ShaftInput; 2], Vec<DerivedShaftValue>) {
    let [pinion, gear] = [&design.pinion, &design.gear].map(|gear| Body::of(design, gear));
    let mut derived = Vec::new();
    let mut take = |name: &str, given: Option<f64>, value: f64, basis: &'static str, is_used: bool| {
        let value = rounded(value);
        if is_used {
            let pointer = format!("/design/shafts/arrangement/{name}");
            derived.push(DerivedShaftValue { pointer, value, unit: unit_of(name), basis });
        }
        given.unwrap_or(value)
    };
    let [of_pinion, of_gear] = is_derived;
    let is_overhung = arrangement.r#type == Mounting::Overhung;
    let (part, basis) = match is_overhung {
        true => (1.0, "the root circle"),
        false => (JOURNAL_OVER_ROOT, "0.8 × root ø"),
    };
    let pinion_mm = take(
        "pinion_shaft_diameter_mm",
        arrangement.pinion_shaft_diameter_mm,
        part * pinion.root_diameter_mm,
        basis,
        of_pinion,
    );
    let ratio = f64::from(design.gear.teeth) / f64::from(design.pinion.teeth);
    let gear_mm = take(
        "gear_shaft_diameter_mm",
        arrangement.gear_shaft_diameter_mm,
        (pinion_mm * ratio.cbrt()).min(GEAR_JOURNAL_OVER_ROOT * gear.root_diameter_mm),
        "the pinion's × ratio^⅓, at most 0.6 × root ø",
        of_gear,
    );
    let outer_mm = pinion.faces.outer_mm.max(gear.faces.outer_mm);
    let straddle_mm = 2.0 * (outer_mm + pinion_mm.max(if is_overhung { gear_mm } else { 0.0 }));
    let overhang_mm = take(
        "overhang_mm",
        arrangement.overhang_mm,
        OVERHANG * pinion_mm,
        "half of the shaft's ø",
        of_pinion && is_overhung,
    );
    let (span_mm, basis) = match is_overhung {
        true => (
            2.0 * (pinion.faces.outer_mm + overhang_mm),
            "twice the distance from the bearing to the middle of the gap",
        ),
        false => (straddle_mm, "faces and gap and a shaft ø on either side"),
    };
    let uses_span = of_pinion || (of_gear && !is_overhung);
    let span_mm = take("bearing_span_mm", arrangement.bearing_span_mm, span_mm, basis, uses_span);
    let gear_span_mm = if is_overhung { straddle_mm } else { span_mm };
    let basis = "10 N/µm per mm of shaft ø";
    let pinion_radial = take(
        "pinion_bearing_radial_n_per_um",
        arrangement.pinion_bearing_radial_n_per_um,
        RADIAL_PER_DIAMETER * pinion_mm,
        basis,
        of_pinion,
    );
    let gear_radial = take(
        "gear_bearing_radial_n_per_um",
        arrangement.gear_bearing_radial_n_per_um,
        RADIAL_PER_DIAMETER * gear_mm,
        basis,
        of_gear,
    );
    let gear_axial = take(
        "gear_bearing_axial_n_per_um",
        arrangement.gear_bearing_axial_n_per_um,
        AXIAL_OVER_RADIAL * gear_radial,
        "a third of the radial stiffness",
        of_gear,
    );
    let overhang =
        |diameter_mm: f64| arrangement.coupling_overhang_mm.unwrap_or_else(|| rounded(COUPLING_OVERHANG * diameter_mm));
    let (input, output) = (arrangement.input, arrangement.output.unwrap_or(arrangement.input.opposite()));
    let pinion_bearings = match is_overhung {
        true => {
            let near_mm = pinion.faces.outer_mm + overhang_mm;
            let mut ends = [near_mm, near_mm + span_mm].map(|distance| input.side() * distance);
            ends.sort_by(f64::total_cmp);
            ends
        }
        false => [-0.5 * span_mm, 0.5 * span_mm],
    };
    let beyond = |bearings: [f64; 2], end: ShaftEnd, diameter_mm: f64| match end {
        ShaftEnd::Left => bearings[0] - overhang(diameter_mm),
        ShaftEnd::Right => bearings[1] + overhang(diameter_mm),
    };
    let gear_bearings = [-0.5 * gear_span_mm, 0.5 * gear_span_mm];
    // The bearing away from the coupling locates the gear.
    let locating = usize::from(output == ShaftEnd::Left);
    let of_pinion = Plan {
        diameter_mm: pinion_mm,
        bearings_mm: pinion_bearings,
        coupling_mm: beyond(pinion_bearings, input, pinion_mm),
        stiffness_n_per_um: [[pinion_radial, 0.0]; 2],
        damping_ns_per_m: arrangement.bearing_damping_ns_per_m,
    };
    let of_gear = Plan {
        diameter_mm: gear_mm,
        bearings_mm: gear_bearings,
        coupling_mm: beyond(gear_bearings, output, gear_mm),
        stiffness_n_per_um: [0, 1].map(|index| [gear_radial, if index == locating { gear_axial } else { 0.0 }]),
        damping_ns_per_m: arrangement.bearing_damping_ns_per_m,
    };
    let module_mm = design.normal_module_mm;
    ([of_pinion.shaft(&pinion, module_mm), of_gear.shaft(&gear, module_mm)], derived)
}

impl DesignInput {
    /// Both shafts: as given, else from the arrangement, every bearing with its radial stiffness; `None` without
    /// `shafts`.
    pub fn resolved_shafts(&self) -> Option<ResolvedShafts> {
        let shafts = self.shafts.as_ref()?;
        let is_derived = [shafts.pinion.is_none(), shafts.gear.is_none()];
        let (from_arrangement, derived) = match &shafts.arrangement {
            Some(arrangement) => {
                let (shafts, derived) = derive(arrangement, self, is_derived);
                (shafts.map(Some), derived)
            }
            None => ([None, None], Vec::new()),
        };
        let [pinion, gear] = from_arrangement;
        let mut resolved = ResolvedShafts {
            pinion: shafts.pinion.clone().or(pinion)?,
            gear: shafts.gear.clone().or(gear)?,
            derived,
            assumed_bearings: Vec::new(),
        };
        for (name, shaft) in [("pinion", &mut resolved.pinion), ("gear", &mut resolved.gear)] {
            assume_stiffness(shaft, &format!("/design/shafts/{name}"), &mut resolved.assumed_bearings);
        }
        let is_assumed = |value: &&DerivedShaftValue| {
            let field = value.pointer.rsplit('/').next().unwrap_or_default();
            let Some(arrangement) = &shafts.arrangement else { return false };
            match field {
                "pinion_bearing_radial_n_per_um" => arrangement.pinion_bearing_radial_n_per_um.is_none(),
                "gear_bearing_radial_n_per_um" => arrangement.gear_bearing_radial_n_per_um.is_none(),
                "gear_bearing_axial_n_per_um" => arrangement.gear_bearing_axial_n_per_um.is_none(),
                _ => false,
            }
        };
        let of_arrangement: Vec<_> = resolved.derived.iter().filter(is_assumed).cloned().collect();
        resolved.assumed_bearings.extend(of_arrangement);
        Some(resolved)
    }
}

/// Gives each bearing without a radial stiffness that of its size.
fn assume_stiffness(shaft: &mut ShaftInput, pointer: &str, assumed: &mut Vec<DerivedShaftValue>) {
    for index in 0..shaft.bearings.len() {
        let bearing = &shaft.bearings[index];
        if !bearing.speed_table.is_empty() || bearing.given_radial_n_per_um().iter().all(Option::is_some) {
            continue;
        }
        let value = rounded(RADIAL_PER_DIAMETER * shaft.diameter_at_mm(bearing.position_mm).unwrap_or_default());
        shaft.bearings[index].radial_n_per_um = Some(value);
        let pointer = format!("{pointer}/bearings/{index}/radial_n_per_um");
        assumed.push(DerivedShaftValue { pointer, value, unit: "N/um", basis: "10 N/µm per mm of shaft ø" });
    }
}

/// The rules between the shafts and the rest of the design; `place`: of the design.
pub(super) fn design_and_shafts(design: &DesignInput, place: &ObjectPlace) {
    let Some(shafts) = &design.shafts else { return };
    // What the places of the faces follow from.
    let sizes = ["normal_module_mm", "helix_angle_deg", "face_width_mm", "gap_width_mm", "pinion", "gear"];
    if sizes.into_iter().any(|name| place.is_refused(name)) {
        return;
    }
    for (name, shaft, gear) in [("pinion", &shafts.pinion, &design.pinion), ("gear", &shafts.gear, &design.gear)] {
        let name = format!("shafts/{name}");
        if let Some(shaft) = shaft.as_ref().filter(|_| !place.is_refused(&name)) {
            shaft_and_faces(shaft, &Body::of(design, gear).faces, &name, place);
        }
    }
    if place.is_refused("shafts") {
        return;
    }
    if let Some(arrangement) = &shafts.arrangement {
        span_reaches(arrangement, design, place);
    }
    let Some(resolved) = design.resolved_shafts() else { return };
    // Where both are given; an arrangement locates the gear.
    if !resolved.pinion.is_held_axially() && !resolved.gear.is_held_axially() {
        let detail = "holds the gear nowhere along its axis, and the pinion floats too: both would wander off together; \
                      give one bearing of the gear, or its coupling, axial_n_per_um above 0 (a floating pinion is usual)";
        place.conflict("shafts/gear/bearings", detail);
    }
}

/// The bearings of an arrangement stand beside the faces.
fn span_reaches(arrangement: &ArrangementInput, design: &DesignInput, place: &ObjectPlace) {
    let Some(span_mm) = arrangement.bearing_span_mm.filter(|_| arrangement.r#type == Mounting::Straddle) else {
        return;
    };
    let outer_mm = [&design.pinion, &design.gear].map(|gear| Body::of(design, gear).faces.outer_mm);
    let least_mm = 2.0 * outer_mm[0].max(outer_mm[1]);
    if span_mm < least_mm * (1.0 - ROUNDING) {
        let detail = format!(
            "is {span_mm} mm; both halves with their gap are {least_mm} mm wide, so that the bearings would stand in the faces; permitted: {least_mm} mm and more"
        );
        place.outside("shafts/arrangement/bearing_span_mm", "mm", [least_mm, 20_000.0], detail);
    }
}
