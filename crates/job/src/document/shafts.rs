//! Shafts and bearings: stepped shafts of pinion and gear, what carries them and what drives them.

use super::arrangement::ArrangementInput;
use crate::reader::ObjectPlace;
use crate::unit::Unit;
use herringbone_macros::Input;
use serde::Serialize;

/// Most segments, bearings, further bodies of a shaft, and speeds of a bearing's table.
const MAX_SEGMENTS: usize = 64;
const MAX_BEARINGS: usize = 16;
const MAX_INERTIAS: usize = 32;
const MAX_SPEEDS: usize = 64;

/// Bearings nearer to each other than this stand at one place, mm.
const SAME_PLACE_MM: f64 = 1e-3;
/// Part of a shaft's length by which a position may lie beyond its ends: rounding of sums of lengths.
pub(super) const ROUNDING: f64 = 1e-9;

/// Shafts and bearings of both members. They replace the supports.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(group = "shafts", rules = shafts_rules)]
pub struct ShaftsInput {
    /// A usual arrangement, from which the shafts that are not given are derived.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arrangement: Option<ArrangementInput>,
    /// Shaft of the pinion; from the arrangement when null.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pinion: Option<ShaftInput>,
    /// Shaft of the gear; from the arrangement when null.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gear: Option<ShaftInput>,
}

fn shafts_rules(shafts: &mut ShaftsInput, place: &ObjectPlace) {
    if shafts.arrangement.is_none() {
        for (name, shaft) in [("pinion", &shafts.pinion), ("gear", &shafts.gear)] {
            if shaft.is_none() && !(place.gives(name) && place.is_reading_object()) {
                place.missing(name, format!("is required: the {name}'s shaft, or an arrangement to derive it from"));
            }
        }
    }
}

/// One shaft, with the body of its member. Positions are measured from its own left end.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(rules = shaft_rules)]
pub struct ShaftInput {
    /// Middle of the gap (apex plane), from the left end of the shaft; the two shafts are aligned by it.
    #[input(unit = "mm", min = 0.0, max = 50_000.0)]
    pub gear_position_mm: f64,
    /// Pieces of one diameter, from the left end to the right end, the body of the member included.
    #[input(required, min_items = 1, max_items = MAX_SEGMENTS)]
    pub segments: Vec<ShaftSegmentInput>,
    /// Springs and dampers to the housing.
    #[input(required, min_items = 1, max_items = MAX_BEARINGS)]
    pub bearings: Vec<BearingInput>,
    /// Where the torque enters (pinion) or leaves (gear).
    #[input(required)]
    pub coupling: CouplingInput,
    /// Rigid body at mid-face of each half, in addition to the mass of the segments; none when null.
    pub half_body: Option<RigidBodyInput>,
    /// Further rigid bodies on the shaft.
    #[input(max_items = MAX_INERTIAS)]
    pub inertias: Vec<ShaftInertiaInput>,
}

/// A piece of a shaft of one diameter.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(rules = segment_rules)]
pub struct ShaftSegmentInput {
    /// Length.
    #[input(unit = "mm", min = 0.1, max = 20_000.0)]
    pub length_mm: f64,
    /// Outer diameter; over the face width that of the body, near the root circle.
    #[input(unit = "mm", min = 0.5, max = 10_000.0)]
    pub diameter_mm: f64,
    /// Inner diameter.
    #[input(unit = "mm", min = 0.0, max = 10_000.0, default = 0.0)]
    pub bore_mm: f64,
}

fn segment_rules(segment: &mut ShaftSegmentInput, place: &ObjectPlace) {
    let ShaftSegmentInput { diameter_mm, bore_mm, .. } = *segment;
    if bore_mm >= diameter_mm {
        let detail = format!("is {bore_mm} mm in a diameter of {diameter_mm} mm; permitted: 0 to less than that");
        place.outside("bore_mm", "mm", [0.0, diameter_mm], detail);
    }
}

/// A bearing: linear springs and dampers to the housing. None of them resists rotation about the shaft's axis.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(rules = bearing_rules)]
pub struct BearingInput {
    /// From the left end of the shaft.
    #[input(unit = "mm", min = 0.0, max = 50_000.0)]
    pub position_mm: f64,
    /// Radial stiffness in both directions; by the shaft's diameter there when null.
    #[input(unit = "N/um", min = 0.0, max = 1e7)]
    pub radial_n_per_um: Option<f64>,
    /// Along the line of centres where it differs.
    #[input(unit = "N/um", min = 0.0, max = 1e7, derived = "as radial")]
    pub radial_x_n_per_um: Option<f64>,
    /// Perpendicular to the line of centres where it differs.
    #[input(unit = "N/um", min = 0.0, max = 1e7, derived = "as radial")]
    pub radial_y_n_per_um: Option<f64>,
    /// Axial stiffness; 0 lets the shaft float.
    #[input(unit = "N/um", min = 0.0, max = 1e7, default = 0.0)]
    pub axial_n_per_um: f64,
    /// Stiffness against tilting about x and about y.
    #[input(unit = "N m/rad", min = 0.0, max = 1e13, default = 0.0)]
    pub tilting_nm_per_rad: f64,
    /// Radial damping.
    #[input(unit = "N s/m", min = 0.0, max = 1e12, default = 0.0)]
    pub radial_damping_ns_per_m: f64,
    /// Axial damping.
    #[input(unit = "N s/m", min = 0.0, max = 1e12, default = 0.0)]
    pub axial_damping_ns_per_m: f64,
    /// Damping of tilting.
    #[input(unit = "N m s/rad", min = 0.0, max = 1e10, default = 0.0)]
    pub tilting_damping_nms_per_rad: f64,
    /// Radial stiffness and damping over the speed of the shaft, cross terms included, in place of the constant ones;
    /// linear between the speeds, constant beyond them.
    #[input(max_items = MAX_SPEEDS)]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub speed_table: Vec<BearingAtSpeedInput>,
}

/// Radial stiffness and damping of a bearing at one speed: force of the shaft on the bearing along the first axis per
/// displacement or velocity of the shaft along the second. x: from the pinion's axis to the gear's; y: perpendicular, with
/// z along the shafts from left to right.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(rules = bearing_at_speed_rules)]
pub struct BearingAtSpeedInput {
    /// Speed of this shaft.
    #[input(unit = "r/min", min = 0.0, max = 200_000.0)]
    pub speed_rpm: f64,
    /// Stiffness along x.
    #[input(unit = "N/um", min = 0.0, max = 1e7)]
    pub stiffness_xx_n_per_um: f64,
    /// Force on the bearing along x by a displacement of the shaft along y.
    #[input(unit = "N/um", min = -1e7, max = 1e7, default = 0.0)]
    pub stiffness_xy_n_per_um: f64,
    /// Force on the bearing along y by a displacement of the shaft along x.
    #[input(unit = "N/um", min = -1e7, max = 1e7, default = 0.0)]
    pub stiffness_yx_n_per_um: f64,
    /// Stiffness along y.
    #[input(unit = "N/um", min = 0.0, max = 1e7)]
    pub stiffness_yy_n_per_um: f64,
    /// Damping along x.
    #[input(unit = "N s/m", min = 0.0, max = 1e12, default = 0.0)]
    pub damping_xx_ns_per_m: f64,
    /// Force on the bearing along x by a velocity of the shaft along y.
    #[input(unit = "N s/m", min = -1e12, max = 1e12, default = 0.0)]
    pub damping_xy_ns_per_m: f64,
    /// Force on the bearing along y by a velocity of the shaft along x.
    #[input(unit = "N s/m", min = -1e12, max = 1e12, default = 0.0)]
    pub damping_yx_ns_per_m: f64,
    /// Damping along y.
    #[input(unit = "N s/m", min = 0.0, max = 1e12, default = 0.0)]
    pub damping_yy_ns_per_m: f64,
}

fn bearing_at_speed_rules(row: &mut BearingAtSpeedInput, place: &ObjectPlace) {
    let [[xx, xy], [yx, yy]] = row.stiffness_n_per_um();
    if xx <= 0.0 || yy <= 0.0 {
        let name = if xx <= 0.0 { "stiffness_xx_n_per_um" } else { "stiffness_yy_n_per_um" };
        place.outside(
            name,
            "N/um",
            [0.0, f64::INFINITY],
            "is 0 N/µm; a bearing with a table carries in both directions: above 0 N/µm",
        );
    } else if xx * yy <= xy * yx {
        let detail = format!(
            "makes the stiffness singular or negative: xx yy = {} is not above xy yx = {} (N/µm)², so that no position of the shaft is stable",
            xx * yy,
            xy * yx
        );
        place.conflict("stiffness_xy_n_per_um", detail);
    }
    // What the damper takes is the symmetric part of its matrix.
    let [[xx, xy], [yx, yy]] = row.damping_ns_per_m();
    if xx * yy < 0.25 * (xy + yx) * (xy + yx) {
        let detail = format!(
            "lets the damper feed energy in: xx yy = {} is below (xy + yx)²/4 = {} (N·s/m)²",
            xx * yy,
            0.25 * (xy + yx) * (xy + yx)
        );
        place.conflict("damping_xy_ns_per_m", detail);
    }
}

impl BearingAtSpeedInput {
    /// Rows: force along x, y; columns: displacement along x, y.
    pub fn stiffness_n_per_um(&self) -> [[f64; 2]; 2] {
        [
            [self.stiffness_xx_n_per_um, self.stiffness_xy_n_per_um],
            [self.stiffness_yx_n_per_um, self.stiffness_yy_n_per_um],
        ]
    }

    /// Rows: force along x, y; columns: velocity along x, y.
    pub fn damping_ns_per_m(&self) -> [[f64; 2]; 2] {
        [[self.damping_xx_ns_per_m, self.damping_xy_ns_per_m], [self.damping_yx_ns_per_m, self.damping_yy_ns_per_m]]
    }
}

fn bearing_rules(bearing: &mut BearingInput, place: &ObjectPlace) {
    let constant = [
        ("radial_n_per_um", bearing.radial_n_per_um.is_some()),
        ("radial_x_n_per_um", bearing.radial_x_n_per_um.is_some()),
        ("radial_y_n_per_um", bearing.radial_y_n_per_um.is_some()),
        ("radial_damping_ns_per_m", bearing.radial_damping_ns_per_m > 0.0),
    ];
    if bearing.speed_table.is_empty() {
        if bearing.holds_nothing() {
            place.conflict(
                "radial_n_per_um",
                "is 0 N/µm, and so are the axial and the tilting stiffness: the bearing carries nothing; give one of them above 0",
            );
        }
        return;
    }
    for (name, is_given) in constant {
        if is_given {
            place.conflict(name, "is given together with speed_table, which replaces it; give one");
        }
    }
    for (index, rows) in bearing.speed_table.windows(2).enumerate() {
        if rows[1].speed_rpm <= rows[0].speed_rpm {
            let detail = format!(
                "is {} r/min after {} r/min; the speeds of the table have to ascend",
                rows[1].speed_rpm, rows[0].speed_rpm
            );
            let name = format!("speed_table/{}/speed_rpm", index + 1);
            place.outside(&name, "r/min", [rows[0].speed_rpm, f64::INFINITY], detail);
        }
    }
}

impl BearingInput {
    /// A bearing without stiffness at a place.
    pub(super) fn at(position_mm: f64) -> Self {
        Self {
            position_mm,
            radial_n_per_um: None,
            radial_x_n_per_um: None,
            radial_y_n_per_um: None,
            axial_n_per_um: 0.0,
            tilting_nm_per_rad: 0.0,
            radial_damping_ns_per_m: 0.0,
            axial_damping_ns_per_m: 0.0,
            tilting_damping_nms_per_rad: 0.0,
            speed_table: Vec::new(),
        }
    }

    /// Constant radial stiffness along x and y as far as it is given.
    pub(crate) fn given_radial_n_per_um(&self) -> [Option<f64>; 2] {
        [self.radial_x_n_per_um, self.radial_y_n_per_um].map(|own| own.or(self.radial_n_per_um))
    }

    /// Whether it holds the shaft along x and along y; a stiffness that is not given is taken after the size.
    pub(crate) fn holds_radially(&self) -> [bool; 2] {
        match self.speed_table.is_empty() {
            true => self.given_radial_n_per_um().map(|given| given != Some(0.0)),
            false => [true; 2],
        }
    }

    fn holds_nothing(&self) -> bool {
        self.holds_radially() == [false; 2] && self.axial_n_per_um == 0.0 && self.tilting_nm_per_rad == 0.0
    }
}

/// The coupling, and the machine beyond it.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(rules = coupling_rules)]
pub struct CouplingInput {
    /// From the left end of the shaft.
    #[input(unit = "mm", min = 0.0, max = 50_000.0)]
    pub position_mm: f64,
    /// Axial stiffness; 0 lets the shaft float.
    #[input(unit = "N/um", min = 0.0, max = 1e7, default = 0.0)]
    pub axial_n_per_um: f64,
    /// Friction against axial displacement, as of gear couplings under torque: what it can do to the balance of the
    /// halves is reported as two limits.
    #[input(unit = "N", min = 0.0, max = 1e8, default = 0.0)]
    pub axial_friction_n: f64,
    /// Torsional stiffness towards the machine; without one the end is free.
    #[input(unit = "N m/rad", min = 1e-3, max = 1e13)]
    pub torsional_nm_per_rad: Option<f64>,
    /// Torsional damping between shaft and machine.
    #[input(unit = "N m s/rad", min = 0.0, max = 1e10, default = 0.0)]
    pub torsional_damping_nms_per_rad: f64,
    /// Moment of inertia of the machine beyond the coupling, about the axis.
    #[input(unit = "kg m2", min = 1e-9, max = 1e9)]
    pub inertia_kg_m2: Option<f64>,
}

fn coupling_rules(coupling: &mut CouplingInput, place: &ObjectPlace) {
    match (coupling.torsional_nm_per_rad, coupling.inertia_kg_m2) {
        (Some(_), None) => place.missing(
            "inertia_kg_m2",
            "is required with torsional_nm_per_rad: a spring to nothing; give the machine's inertia (1e-9 to 1e9 kg·m²), or leave both out",
        ),
        (None, Some(_)) => place.missing(
            "torsional_nm_per_rad",
            "is required with inertia_kg_m2: what connects the machine to the shaft (0.001 to 1e13 N·m/rad); or leave both out",
        ),
        (None, None) if coupling.torsional_damping_nms_per_rad > 0.0 => place.conflict(
            "torsional_damping_nms_per_rad",
            "is above 0 N·m·s/rad without a machine beyond the coupling; give torsional_nm_per_rad and inertia_kg_m2 too",
        ),
        _ => {}
    }
}

/// A rigid body.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(rules = body_rules)]
pub struct RigidBodyInput {
    /// Mass.
    #[input(unit = "kg", min = 0.0, max = 1e6)]
    pub mass_kg: f64,
    /// Moment of inertia about the axis of the shaft.
    #[input(unit = "kg m2", min = 0.0, max = 1e9)]
    pub polar_inertia_kg_m2: f64,
    /// Moment of inertia about a diameter, through its centre of gravity.
    #[input(unit = "kg m2", min = 0.0, max = 1e9)]
    pub diametral_inertia_kg_m2: f64,
}

fn body_rules(body: &mut RigidBodyInput, place: &ObjectPlace) {
    inertias_exist(body.polar_inertia_kg_m2, body.diametral_inertia_kg_m2, place);
}

/// Of a body, no moment of inertia is larger than the sum of the two others.
fn inertias_exist(polar_kg_m2: f64, diametral_kg_m2: f64, place: &ObjectPlace) {
    if polar_kg_m2 > 2.0 * diametral_kg_m2 * (1.0 + 1e-6) {
        let least = 0.5 * polar_kg_m2;
        let detail = format!(
            "is {diametral_kg_m2} kg·m² with a polar one of {polar_kg_m2} kg·m²; no body has less than half of that: {least} kg·m² and more"
        );
        place.outside("diametral_inertia_kg_m2", "kg m2", [least, f64::INFINITY], detail);
    }
}

/// A rigid body on the shaft.
#[derive(Debug, Clone, PartialEq, Serialize, Input)]
#[input(rules = inertia_rules)]
pub struct ShaftInertiaInput {
    /// From the left end of the shaft.
    #[input(unit = "mm", min = 0.0, max = 50_000.0)]
    pub position_mm: f64,
    /// Mass.
    #[input(unit = "kg", min = 0.0, max = 1e6)]
    pub mass_kg: f64,
    /// Moment of inertia about the axis of the shaft.
    #[input(unit = "kg m2", min = 0.0, max = 1e9)]
    pub polar_inertia_kg_m2: f64,
    /// Moment of inertia about a diameter, through its centre of gravity.
    #[input(unit = "kg m2", min = 0.0, max = 1e9)]
    pub diametral_inertia_kg_m2: f64,
}

fn inertia_rules(inertia: &mut ShaftInertiaInput, place: &ObjectPlace) {
    inertias_exist(inertia.polar_inertia_kg_m2, inertia.diametral_inertia_kg_m2, place);
}

fn shaft_rules(shaft: &mut ShaftInput, place: &ObjectPlace) {
    if shaft.bearings.is_empty() && place.gives("bearings") {
        place.conflict(
            "bearings",
            "is without a bearing: nothing carries the shaft; it needs two, or one with tilting stiffness",
        );
    }
    if place.is_refused("bearings") {
        return;
    }
    stand_apart(shaft, place);
    carry(shaft, place);
    if place.is_refused("segments") {
        return;
    }
    let length_mm = shaft.length_mm();
    let inside = |name: &str, position_mm: f64, what: &str| {
        if !shaft.has(position_mm) {
            let detail = format!(
                "is {position_mm} mm: {what} beyond the right end; the shaft is {length_mm} mm long (sum of its segments), permitted: 0 to {length_mm} mm"
            );
            place.outside(name, "mm", [0.0, length_mm], detail);
        }
    };
    inside("gear_position_mm", shaft.gear_position_mm, "the gear is");
    for (index, bearing) in shaft.bearings.iter().enumerate() {
        inside(&format!("bearings/{index}/position_mm"), bearing.position_mm, "the bearing is");
    }
    inside("coupling/position_mm", shaft.coupling.position_mm, "the coupling is");
    for (index, inertia) in shaft.inertias.iter().enumerate() {
        inside(&format!("inertias/{index}/position_mm"), inertia.position_mm, "the body is");
    }
}

/// Every bearing has a place of its own.
fn stand_apart(shaft: &ShaftInput, place: &ObjectPlace) {
    for (index, bearing) in shaft.bearings.iter().enumerate() {
        let at = bearing.position_mm;
        let same = shaft.bearings[..index].iter().position(|other| (other.position_mm - at).abs() < SAME_PLACE_MM);
        if let Some(other) = same {
            let detail = format!(
                "is {at} mm, where bearing {other} stands; two bearings at one place are one: add their stiffnesses"
            );
            place.conflict(&format!("bearings/{index}/position_mm"), detail);
        }
    }
}

/// The bearings hold the shaft against displacement and tilting in both planes.
fn carry(shaft: &ShaftInput, place: &ObjectPlace) {
    let tilting = shaft.bearings.iter().filter(|bearing| bearing.tilting_nm_per_rad > 0.0).count();
    let directions = [("x", "along the line of centres"), ("y", "perpendicular to the line of centres")];
    for (axis, (name, words)) in directions.into_iter().enumerate() {
        let radial = shaft.bearings.iter().filter(|bearing| bearing.holds_radially()[axis]).count();
        let detail = match (radial, tilting) {
            (0, _) => format!(
                "hold nothing along {name} ({words}): each radial stiffness there is 0 N/µm; the shaft would fall out"
            ),
            (1, 0) => format!(
                "hold the shaft at one place along {name} ({words}): it would tilt about that bearing; give a second one, or tilting_nm_per_rad above 0"
            ),
            _ => continue,
        };
        place.conflict("bearings", detail);
        // One reason for both directions where they are alike.
        if shaft.bearings.iter().all(|bearing| bearing.holds_radially()[0] == bearing.holds_radially()[1]) {
            break;
        }
    }
}

impl ShaftInput {
    /// Sum of the segments' lengths.
    pub fn length_mm(&self) -> f64 {
        self.segments.iter().map(|segment| segment.length_mm).sum()
    }

    /// Whether a position lies between the ends.
    fn has(&self, position_mm: f64) -> bool {
        let length_mm = self.length_mm();
        (-ROUNDING * length_mm..=(1.0 + ROUNDING) * length_mm).contains(&position_mm)
    }

    /// The segments with the positions of their ends.
    pub(crate) fn places_mm(&self) -> impl Iterator<Item = ([f64; 2], &ShaftSegmentInput)> {
        self.segments.iter().scan(0.0, |start_mm, segment| {
            let end_mm = *start_mm + segment.length_mm;
            let ends = [*start_mm, end_mm];
            *start_mm = end_mm;
            Some((ends, segment))
        })
    }

    /// Smallest outer diameter at a position (at a step, that of the thinner segment).
    pub(crate) fn diameter_at_mm(&self, position_mm: f64) -> Option<f64> {
        let slack_mm = SAME_PLACE_MM;
        let touching =
            self.places_mm().filter(|([start, end], _)| (start - slack_mm..=end + slack_mm).contains(&position_mm));
        touching.map(|(_, segment)| segment.diameter_mm).min_by(f64::total_cmp)
    }

    /// Whether a bearing or the coupling holds the shaft axially.
    pub fn is_held_axially(&self) -> bool {
        self.coupling.axial_n_per_um > 0.0 || self.bearings.iter().any(|bearing| bearing.axial_n_per_um > 0.0)
    }

    /// Whether no bearing has damping.
    pub fn is_undamped(&self) -> bool {
        self.bearings.iter().all(|bearing| {
            bearing.radial_damping_ns_per_m == 0.0
                && bearing.axial_damping_ns_per_m == 0.0
                && bearing.tilting_damping_nms_per_rad == 0.0
                && bearing.speed_table.iter().all(|row| row.damping_ns_per_m() == [[0.0; 2]; 2])
        })
    }
}

/// The places of the halves of one member on its shaft: what the rules between shafts and design need.
pub(super) struct Faces {
    /// Ends of each half from the middle of the gap: inner, outer.
    pub inner_mm: f64,
    pub outer_mm: f64,
    /// Tip circle of the basic rack.
    pub tip_diameter_mm: f64,
}

/// The rules between a given shaft and the faces of its member; `name`: of the shaft in its object.
pub(super) fn shaft_and_faces(shaft: &ShaftInput, faces: &Faces, name: &str, place: &ObjectPlace) {
    let length_mm = shaft.length_mm();
    let at_mm = shaft.gear_position_mm;
    if shaft.segments.is_empty() || !shaft.has(at_mm) {
        return;
    }
    let Faces { inner_mm, outer_mm, tip_diameter_mm } = *faces;
    if !shaft.has(at_mm - outer_mm) || !shaft.has(at_mm + outer_mm) {
        let pointer = format!("{name}/gear_position_mm");
        let detail = format!(
            "is {at_mm} mm: the faces reach from {} to {} mm, beyond the shaft of {length_mm} mm (sum of its segments); {}",
            at_mm - outer_mm,
            at_mm + outer_mm,
            match 2.0 * outer_mm <= length_mm {
                true => format!("permitted: {outer_mm} to {} mm", length_mm - outer_mm),
                false => format!("both halves with their gap need {} mm", 2.0 * outer_mm),
            }
        );
        place.outside(&pointer, "mm", [outer_mm, length_mm - outer_mm], detail);
        return;
    }
    for (half, ends) in
        [("left", [at_mm - outer_mm, at_mm - inner_mm]), ("right", [at_mm + inner_mm, at_mm + outer_mm])]
    {
        for (index, bearing) in shaft.bearings.iter().enumerate() {
            let position_mm = bearing.position_mm;
            if position_mm > ends[0] + SAME_PLACE_MM && position_mm < ends[1] - SAME_PLACE_MM {
                let detail = format!(
                    "is {position_mm} mm, in the {half} half, whose face reaches from {} to {} mm; a bearing stands beside the faces or in the gap",
                    ends[0], ends[1]
                );
                place.conflict(&format!("{name}/bearings/{index}/position_mm"), detail);
            }
        }
    }
    for (index, ([start_mm, end_mm], segment)) in shaft.places_mm().enumerate() {
        let faces = [[at_mm - outer_mm, at_mm - inner_mm], [at_mm + inner_mm, at_mm + outer_mm]];
        let under_a_face =
            faces.iter().any(|[left, right]| start_mm < right - SAME_PLACE_MM && end_mm > left + SAME_PLACE_MM);
        // A rack that leaves no tip circle is refused with the pair.
        if under_a_face && tip_diameter_mm > 0.5 && segment.diameter_mm > tip_diameter_mm * (1.0 + ROUNDING) {
            let detail = format!(
                "is {} mm under the face; no teeth stand out of that: the tip circle is {tip_diameter_mm:.3} mm; permitted: up to it, usual: the root circle",
                segment.diameter_mm
            );
            place.outside(&format!("{name}/segments/{index}/diameter_mm"), "mm", [0.5, tip_diameter_mm], detail);
        }
    }
}

/// The unit of a field by its name.
pub(super) fn unit_of(name: &str) -> &'static str {
    Unit::of_name(name).unwrap_or(Unit::ONE).text
}
