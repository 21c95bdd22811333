//! Data of a true-to-scale drawing of a pair: tooth outlines, circles, path of contact, lines of contact.

use super::document::Hand;
use herringbone_physics::gear::Half;
use serde::Serialize;

/// The pair to scale, in millimetres: the transverse section in the middle of the left half, and the plane of action.
///
/// Everything is given at mesh phase 0 (a pair of the left half stands at its first contact) with how it moves: a client
/// turns and shifts, and computes no geometry. One mesh period turns the pinion by `turn_rad` and shifts lines and points
/// of contact by one base pitch.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct Drawing {
    /// How far the pair stays from what is warned of or refused.
    pub margins: Vec<MarginResult>,
    pub section: DrawnSection,
    pub plane_of_action: PlaneOfAction,
    /// Both shafts; absent without `design.shafts`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shafts: Option<DrawnShafts>,
}

/// Both shafts in the plane of their axes: along the axis (0 in the middle of the gap, the left half below 0), and across (0 on the
/// pinion's axis, the gear's axis at the centre distance).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DrawnShafts {
    pub center_distance_mm: f64,
    pub pinion: DrawnShaft,
    pub gear: DrawnShaft,
}

/// One shaft.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DrawnShaft {
    /// Place of the axis across.
    pub axis_mm: f64,
    pub segments: Vec<DrawnSegment>,
    /// Ends of the left and the right half of this member along the axis.
    pub faces_mm: [[f64; 2]; 2],
    pub tip_radius_mm: f64,
    pub root_radius_mm: f64,
    pub bearings: Vec<DrawnBearing>,
    /// Where the torque enters (pinion) or leaves (gear).
    pub coupling_mm: f64,
    /// Whether the coupling holds the shaft axially.
    pub coupling_holds_axially: bool,
    /// Whether a machine inertia hangs on the coupling.
    pub has_machine: bool,
    /// Further rigid bodies.
    pub bodies_mm: Vec<f64>,
    /// Nothing holds the shaft along its axis.
    pub floats_axially: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DrawnSegment {
    /// Ends along the axis.
    pub axial_mm: [f64; 2],
    pub radius_mm: f64,
    pub bore_radius_mm: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DrawnBearing {
    pub axial_mm: f64,
    /// Radius of the shaft there.
    pub radius_mm: f64,
    pub holds_radially: bool,
    pub holds_axially: bool,
    pub holds_tilting: bool,
}

/// The transverse section: origin at the pitch point, second axis along the line of centres towards the gear. The pinion turns
/// clockwise and drives.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Section))]
pub struct DrawnSection {
    /// The end of the pinion's axis, `left` or `right`, from which the section is seen: from there the pinion turns clockwise.
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    pub seen_from: Half,
    pub pinion: DrawnGear,
    pub gear: DrawnGear,
    /// Points of the line of action, in its order: T1, A, B, C, D, E, T2 (ISO 21771). B and D only where one pair alone
    /// touches in between.
    pub points: Vec<PathPoint>,
    /// Transverse base pitch: distance of the points of contact of neighbouring tooth pairs.
    pub base_pitch_mm: f64,
    /// Where pairs touch in this section at phase 0: roll coordinates along the line of action, those included that come
    /// into contact within the mesh period.
    pub contacts_roll_mm: Vec<f64>,
    /// Play of the drawn (nominal) teeth along the base tangent; below zero their back flanks overlap.
    pub play_mm: f64,
}

/// One gear in the section.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DrawnGear {
    pub teeth: u32,
    /// The axis.
    pub center_mm: [f64; 2],
    /// One tooth with half a space on either side: points (x, y) in coordinates of the gear, the tooth along x. Copies turned by
    /// whole angular pitches make the gear.
    pub tooth_mm: Vec<[f64; 2]>,
    /// Angle of a tooth's centreline about the axis at phase 0, counter-clockwise from the first axis.
    pub angle_rad: f64,
    /// Turn in one mesh period, counter-clockwise positive; its size is the angular pitch.
    pub turn_rad: f64,
    pub bore_radius_mm: f64,
    pub root_radius_mm: f64,
    /// Where fillet and involute meet.
    pub root_form_radius_mm: f64,
    pub base_radius_mm: f64,
    pub reference_radius_mm: f64,
    pub working_pitch_radius_mm: f64,
    pub tip_radius_mm: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct PathPoint {
    pub name: String,
    /// Distance from T1 along the line of action.
    pub roll_mm: f64,
    /// Place in the section.
    pub at_mm: [f64; 2],
}

/// The plane of action of both halves: along the axis (0 in the middle of the gap, the left half below 0), and along the
/// line of action (roll, from T1; contact moves towards larger values).
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct PlaneOfAction {
    /// Start A and end E of the path of contact.
    pub path_roll_mm: [f64; 2],
    /// Axial place of the transverse section.
    pub section_axial_mm: f64,
    pub base_helix_angle_deg: f64,
    pub left: DrawnHalf,
    pub right: DrawnHalf,
}

/// One half in the plane of action.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DrawnHalf {
    /// Hand of the pinion's half: `left` or `right`.
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    pub pinion_hand: Hand,
    /// Ends along the axis, in ascending order.
    pub axial_mm: [f64; 2],
    /// Lines of contact at phase 0 over the whole face width, to be cut at the ends of the path; those included that come in
    /// within the mesh period.
    pub lines: Vec<DrawnLine>,
    /// Sum of the lengths of the lines (cut to the path): least and greatest over the mesh period.
    pub contact_length_mm: [f64; 2],
}

/// A line of contact: two ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct DrawnLine {
    pub axial_mm: [f64; 2],
    pub roll_mm: [f64; 2],
}

/// A quantity of one gear that must stay above its limit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema), schema(as = Margin))]
pub struct MarginResult {
    /// `tip-thickness` (normal section), `tip-clearance` (to the mate's root), `profile-shift` (coefficient; the rack undercuts
    /// below the limit), `active-profile` (diameter where contact ends; the involute starts at the limit, the root form diameter).
    pub code: String,
    /// `pinion` or `gear`.
    pub member: String,
    pub value: f64,
    pub limit: f64,
    /// `m_n` (multiples of the normal module), `mm` or `1`.
    pub unit: String,
}
