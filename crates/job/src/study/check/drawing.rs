//! The drawing of a document's pair.

use crate::document::{GearInput, Hand, JobDocument, ResolvedShafts, RotationInput, ShaftInput};
use crate::drawing::{
    Drawing, DrawnBearing, DrawnGear, DrawnHalf, DrawnLine, DrawnSection, DrawnSegment, DrawnShaft, DrawnShafts,
    MarginResult, PathPoint, PlaneOfAction,
};
use crate::study::CheckedJob;
use herringbone_physics::gear::{self, Half, MarginKind, Member, Pair};
use std::f64::consts::TAU;

const MM: f64 = 1e3;

impl Drawing {
    /// The drawing of a job's pair.
    pub fn of(job: &CheckedJob) -> Drawing {
        let (document, pair) = (job.document(), &job.prepared().pair);
        Drawing {
            margins: pair.margins().into_iter().map(margin).collect(),
            section: section(pair, document),
            plane_of_action: plane_of_action(pair, document),
            shafts: document.design.resolved_shafts().map(|resolved| shafts(&resolved, pair, document)),
        }
    }
}

fn margin(margin: gear::Margin) -> MarginResult {
    let (code, unit, factor) = match margin.kind {
        MarginKind::TipThickness => ("tip-thickness", "m_n", 1.0),
        MarginKind::TipClearance => ("tip-clearance", "m_n", 1.0),
        MarginKind::ProfileShift => ("profile-shift", "1", 1.0),
        // As a diameter.
        MarginKind::ActiveProfileRadius => ("active-profile", "mm", 2.0 * MM),
    };
    MarginResult {
        code: code.to_owned(),
        member: margin.member.as_str().to_owned(),
        value: factor * margin.value,
        limit: factor * margin.limit,
        unit: unit.to_owned(),
    }
}

fn section(pair: &Pair, document: &JobDocument) -> DrawnSection {
    // Roll coordinate of the lines of contact in the middle of the left half.
    let b = pair.spec.face_width_m;
    let x_m = pair.position_m(0.0) + 0.5 * b * pair.base_helix_angle_rad.tan();
    let [pinion_pitch_m, gear_pitch_m] = pair.pitch_radii_m();
    let [pinion_rad, gear_rad] = pair.tooth_angles_rad(x_m);
    let drawn = |member: &Member, center_m: [f64; 2], pitch_m: f64, angle_rad: f64, sense: f64| DrawnGear {
        teeth: member.teeth,
        center_mm: center_m.map(|c| c * MM),
        tooth_mm: member.outline_m().into_iter().map(|point| point.map(|c| c * MM)).collect(),
        angle_rad,
        turn_rad: sense * TAU / f64::from(member.teeth),
        bore_radius_mm: member.bore_radius_m * MM,
        root_radius_mm: member.root_radius_m * MM,
        root_form_radius_mm: member.root_form_radius_m * MM,
        base_radius_mm: member.base_radius_m * MM,
        reference_radius_mm: member.reference_radius_m * MM,
        working_pitch_radius_mm: pitch_m * MM,
        tip_radius_mm: member.tip_radius_m * MM,
    };
    let p = pair.base_pitch_m;
    let first = ((pair.path_start_m - x_m) / p).ceil() as i32 - 1;
    let last = ((pair.path_end_m - x_m) / p).floor() as i32;
    DrawnSection {
        seen_from: seen_from(document),
        pinion: drawn(&pair.pinion, [0.0, -pinion_pitch_m], pinion_pitch_m, pinion_rad, -1.0),
        gear: drawn(&pair.gear, [0.0, gear_pitch_m], gear_pitch_m, gear_rad, 1.0),
        points: points(pair),
        base_pitch_mm: p * MM,
        contacts_roll_mm: (first..=last).map(|k| (x_m + f64::from(k) * p) * MM).collect(),
        play_mm: pair.geometric_backlash_m * MM,
    }
}

/// The end of the axis from which the pinion is seen to turn clockwise. On a right half of right hand the outer ends
/// are ahead counter-clockwise, seen from the right; with the apex leading the inner ends are ahead in the sense of
/// rotation.
fn seen_from(document: &JobDocument) -> Half {
    let right_half_is_right_hand = document.design.pinion.left_half_hand == Hand::Left;
    let apex_leads = document.operation.rotation == RotationInput::ApexLeading;
    if right_half_is_right_hand == apex_leads { Half::Right } else { Half::Left }
}

fn points(pair: &Pair) -> Vec<PathPoint> {
    let mut points = vec![
        ("T1", 0.0),
        ("A", pair.path_start_m),
        ("C", pair.pitch_point_m()),
        ("E", pair.path_end_m),
        ("T2", pair.line_of_action_m),
    ];
    if let Some([b, d]) = pair.single_contact_m() {
        points.extend([("B", b), ("D", d)]);
    }
    points.sort_by(|a, b| a.1.total_cmp(&b.1));
    let place = |x_m: f64| pair.action_point_m(x_m).map(|c| c * MM);
    points
        .into_iter()
        .map(|(name, x_m)| PathPoint { name: name.to_owned(), roll_mm: x_m * MM, at_mm: place(x_m) })
        .collect()
}

fn plane_of_action(pair: &Pair, document: &JobDocument) -> PlaneOfAction {
    let (b, inner_m) = (pair.spec.face_width_m, 0.5 * pair.spec.gap_width_m);
    let hand = document.design.pinion.left_half_hand;
    let stagger = document.design.half_stagger.rem_euclid(1.0);
    PlaneOfAction {
        path_roll_mm: [pair.path_start_m * MM, pair.path_end_m * MM],
        section_axial_mm: -(inner_m + 0.5 * b) * MM,
        base_helix_angle_deg: pair.base_helix_angle_rad.to_degrees(),
        left: half(pair, Half::Left, hand, 0.0),
        right: half(pair, Half::Right, hand.opposite(), stagger),
    }
}

fn half(pair: &Pair, half: Half, pinion_hand: Hand, phase: f64) -> DrawnHalf {
    let side = if half == Half::Left { -1.0 } else { 1.0 };
    let (inner_m, b) = (0.5 * pair.spec.gap_width_m, pair.spec.face_width_m);
    let mut axial_mm = [inner_m, inner_m + b].map(|z| side * z * MM);
    axial_mm.sort_by(f64::total_cmp);
    // From the mesh-out end to the station from the inner end is the same law as back.
    let axial = |entry_m: f64| side * (inner_m + pair.entry_m(entry_m)) * MM;
    let lines = pair.whole_lines(pair.position_m(phase), pair.base_pitch_m);
    DrawnHalf {
        pinion_hand,
        axial_mm,
        lines: lines
            .into_iter()
            .map(|line| DrawnLine { axial_mm: line.entry_m.map(axial), roll_mm: line.x_m.map(|x| x * MM) })
            .collect(),
        contact_length_mm: pair.contact_length_range_m().map(|l| l * MM),
    }
}

fn shafts(resolved: &ResolvedShafts, pair: &Pair, document: &JobDocument) -> DrawnShafts {
    let design = &document.design;
    let drawn = |given: &ShaftInput, gear: &GearInput, member: &Member, axis_mm: f64| {
        let z = |position_mm: f64| position_mm - given.gear_position_mm;
        let width_mm = gear.face_width_mm.unwrap_or(design.face_width_mm);
        // A half that is wider or narrower than the design's is centred on that.
        let middle_mm = 0.5 * (design.gap_width_mm + design.face_width_mm);
        let half = |side: f64| [side * middle_mm - 0.5 * width_mm, side * middle_mm + 0.5 * width_mm];
        DrawnShaft {
            axis_mm,
            segments: given
                .places_mm()
                .map(|(ends, segment)| DrawnSegment {
                    axial_mm: ends.map(z),
                    radius_mm: 0.5 * segment.diameter_mm,
                    bore_radius_mm: 0.5 * segment.bore_mm,
                })
                .collect(),
            faces_mm: [half(-1.0), half(1.0)],
            tip_radius_mm: member.tip_radius_m * MM,
            root_radius_mm: member.root_radius_m * MM,
            bearings: given
                .bearings
                .iter()
                .map(|bearing| DrawnBearing {
                    axial_mm: z(bearing.position_mm),
                    radius_mm: 0.5 * given.diameter_at_mm(bearing.position_mm).unwrap_or_default(),
                    holds_radially: bearing.holds_radially().contains(&true),
                    holds_axially: bearing.axial_n_per_um > 0.0,
                    holds_tilting: bearing.tilting_nm_per_rad > 0.0,
                })
                .collect(),
            coupling_mm: z(given.coupling.position_mm),
            coupling_holds_axially: given.coupling.axial_n_per_um > 0.0,
            has_machine: given.coupling.inertia_kg_m2.is_some(),
            bodies_mm: given.inertias.iter().map(|inertia| z(inertia.position_mm)).collect(),
            floats_axially: !given.is_held_axially(),
        }
    };
    let center_distance_mm = pair.center_distance_m * MM;
    DrawnShafts {
        center_distance_mm,
        pinion: drawn(&resolved.pinion, &design.pinion, &pair.pinion, 0.0),
        gear: drawn(&resolved.gear, &design.gear, &pair.gear, center_distance_mm),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse_value;
    use serde_json::{Value, json};

    fn drawn(change: impl Fn(&mut Value)) -> Drawing {
        let mut value: Value = serde_json::from_str(include_str!("../../../../../examples/table1.json")).unwrap();
        change(&mut value);
        Drawing::of(&CheckedJob::new(parse_value(&value).unwrap()).unwrap())
    }

    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() < 1e-9, "{value} is not {expected}");
    }

    #[test]
    fn points_of_the_line_of_action_stand_in_their_order() {
        let section = drawn(|_| {}).section;
        let names: Vec<_> = section.points.iter().map(|point| point.name.as_str()).collect();
        assert_eq!(names, ["T1", "A", "B", "C", "D", "E", "T2"]);
        let distance = |a: &PathPoint, b: &PathPoint| (a.at_mm[0] - b.at_mm[0]).hypot(a.at_mm[1] - b.at_mm[1]);
        for ends in section.points.windows(2) {
            near(distance(&ends[0], &ends[1]), ends[1].roll_mm - ends[0].roll_mm);
        }
        near(section.points[3].at_mm[0].hypot(section.points[3].at_mm[1]), 0.0);
    }

    #[test]
    fn both_halves_stand_round_the_gap_with_mirrored_lines() {
        let plane = drawn(|_| {}).plane_of_action;
        assert_eq!([plane.left.axial_mm, plane.right.axial_mm], [[-90.0, -15.0], [15.0, 90.0]]);
        for (left, right) in plane.left.lines.iter().zip(&plane.right.lines) {
            assert_eq!(left.axial_mm, right.axial_mm.map(|z| -z));
            assert_eq!(left.roll_mm, right.roll_mm);
        }
        // Apex leading: at the inner ends contact is ahead on its way from A to E.
        let line = plane.left.lines[0];
        let inner = usize::from(line.axial_mm[1] > line.axial_mm[0]);
        assert!(line.roll_mm[inner] > line.roll_mm[1 - inner], "{line:?}");
    }

    #[test]
    fn rotation_turns_the_lines_and_stagger_advances_the_right_half() {
        let trailing = drawn(|value| value["operation"]["rotation"] = json!("apex_trailing")).plane_of_action;
        let line = trailing.right.lines[0];
        let outer = usize::from(line.axial_mm[1] > line.axial_mm[0]);
        assert!(line.roll_mm[outer] > line.roll_mm[1 - outer], "{line:?}");
        let drawing = drawn(|value| value["design"]["half_stagger"] = json!(0.25));
        let pitch = drawing.section.base_pitch_mm;
        let plane = drawing.plane_of_action;
        let shift = (plane.right.lines[0].roll_mm[0] - plane.left.lines[0].roll_mm[0]) / pitch;
        near((shift - 0.25).rem_euclid(1.0).min((0.25 - shift).rem_euclid(1.0)), 0.0);
    }

    #[test]
    fn contact_in_the_section_is_where_lines_cross_it() {
        let drawing = drawn(|_| {});
        let (section, plane) = (&drawing.section, &drawing.plane_of_action);
        let at = plane.section_axial_mm;
        let crossings: Vec<f64> = plane
            .left
            .lines
            .iter()
            .map(|line| {
                let part = (at - line.axial_mm[0]) / (line.axial_mm[1] - line.axial_mm[0]);
                line.roll_mm[0] + part * (line.roll_mm[1] - line.roll_mm[0])
            })
            .collect();
        for contact in &section.contacts_roll_mm {
            assert!(crossings.iter().any(|crossing| (crossing - contact).abs() < 1e-9), "{contact} of {crossings:?}");
        }
        near(section.pinion.turn_rad * -17.0, TAU);
    }

    #[test]
    fn the_pinion_turns_clockwise_seen_from_the_end_that_hands_and_rotation_say() {
        assert_eq!(drawn(|_| {}).section.seen_from, Half::Right);
        assert_eq!(
            drawn(|value| value["operation"]["rotation"] = json!("apex_trailing")).section.seen_from,
            Half::Left
        );
        assert_eq!(
            drawn(|value| value["design"]["pinion"]["left_half_hand"] = json!("right")).section.seen_from,
            Half::Left
        );
    }

    #[test]
    fn shafts_stand_round_the_middle_of_the_gap() {
        assert_eq!(drawn(|_| {}).shafts, None);
        let shafts = drawn(|value| {
            value["design"]["shafts"] =
                json!({"arrangement": {"bearing_span_mm": 340.0, "pinion_shaft_diameter_mm": 80.0}});
        });
        let shafts = shafts.shafts.unwrap();
        let (pinion, gear) = (&shafts.pinion, &shafts.gear);
        assert_eq!((pinion.faces_mm, gear.faces_mm), ([[-90.0, -15.0], [15.0, 90.0]], [[-90.0, -15.0], [15.0, 90.0]]));
        for shaft in [pinion, gear] {
            near(shaft.bearings[0].axial_mm, -170.0);
            near(shaft.bearings[1].axial_mm, 170.0);
            assert!(shaft.segments.windows(2).all(|pair| pair[0].axial_mm[1] == pair[1].axial_mm[0]));
            near(shaft.segments[1].axial_mm[0], -90.0);
            // The body is the root circle, which the pair calculates itself, to four digits.
            assert!((shaft.segments[1].radius_mm / shaft.root_radius_mm - 1.0).abs() < 5e-4);
        }
        near(pinion.bearings[0].radius_mm, 40.0);
        assert!(pinion.coupling_mm < -170.0 && gear.coupling_mm > 170.0);
        assert!(pinion.floats_axially && gear.bearings[0].holds_axially && !gear.floats_axially);
        near(gear.axis_mm, shafts.center_distance_mm);
    }
}
