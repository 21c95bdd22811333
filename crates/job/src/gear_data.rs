//! The gear data of a pair in the terms of ISO 21771-1, calculated from its document.

use crate::document::{GearInput, Hand, JobDocument};
use crate::result::ResultFields;
use crate::study::{bounds, prepare};
use crate::{DocumentError, parse};
use herringbone_physics::gear::{Half, Member, Pair};
use serde::Serialize;
use std::f64::consts::PI;

const MM: f64 = 1e3;

/// Gear data of the pair of a job, ISO 21771-1 (symbols in brackets): of one helix half where widths and forces are
/// meant; of a sweep those of its base document.
#[derive(Debug, Clone, PartialEq, Serialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "geometry#diameters-angles-and-pitches")]
pub struct GearData {
    /// Normal module (m_n).
    #[scalar(label = "normal module", symbol = "m_n")]
    pub normal_module_mm: f64,
    /// Transverse module (m_t).
    #[scalar(label = "transverse module", symbol = "m_t")]
    pub transverse_module_mm: f64,
    /// Normal pressure angle (α_n).
    #[scalar(label = "normal pressure angle", symbol = "α_n")]
    pub normal_pressure_angle_deg: f64,
    /// Transverse pressure angle (α_t).
    #[scalar(label = "transverse pressure angle", symbol = "α_t")]
    pub transverse_pressure_angle_deg: f64,
    /// Working transverse pressure angle (α_wt).
    #[scalar(label = "working transverse pressure angle", symbol = "α_wt")]
    pub working_pressure_angle_deg: f64,
    /// Helix angle at the reference cylinder (β).
    #[scalar(label = "helix angle", symbol = "β")]
    pub helix_angle_deg: f64,
    /// Base helix angle (β_b).
    #[scalar(label = "base helix angle", symbol = "β_b")]
    pub base_helix_angle_deg: f64,
    /// Gear ratio z2/z1 (u).
    #[scalar(label = "gear ratio", symbol = "u")]
    pub gear_ratio: f64,
    /// Working centre distance, its error included (a_w).
    #[scalar(label = "centre distance, working", symbol = "a")]
    pub center_distance_mm: f64,
    /// Face width of a half that both gears have in common (b).
    #[scalar(label = "face width of a half", symbol = "b")]
    pub face_width_mm: f64,
    /// Gap between the common face widths of the halves.
    #[scalar(label = "gap between the halves")]
    pub gap_width_mm: f64,
    /// Transverse base pitch (p_bt).
    #[scalar(label = "transverse base pitch", symbol = "p_bt")]
    pub transverse_base_pitch_mm: f64,
    /// Axial pitch (p_x); null for spur gears.
    #[scalar(label = "axial pitch", symbol = "p_x")]
    pub axial_pitch_mm: Option<f64>,
    /// Length of the path of contact (g_α).
    #[scalar(label = "length of the path of contact", symbol = "g_α", theory = "geometry#contact-ratios")]
    pub path_of_contact_mm: f64,
    /// Transverse contact ratio (ε_α).
    #[scalar(label = "transverse contact ratio", symbol = "ε_α", theory = "geometry#contact-ratios")]
    pub transverse_contact_ratio: f64,
    /// Overlap ratio (ε_β).
    #[scalar(label = "overlap ratio", symbol = "ε_β", theory = "geometry#contact-ratios")]
    pub overlap_ratio: f64,
    /// Total contact ratio (ε_γ).
    #[scalar(label = "total contact ratio", symbol = "ε_γ", theory = "geometry#contact-ratios")]
    pub total_contact_ratio: f64,
    /// Backlash of the equations of motion along the mesh displacement s, both sides together.
    #[scalar(label = "backlash along s, total", symbol = "j", theory = "geometry#backlash")]
    pub backlash_um: f64,
    /// Velocity at the working pitch circles (v_w).
    #[scalar(label = "pitch line velocity", symbol = "v_w", theory = "geometry#speed-torque-and-mesh-frequency")]
    pub pitch_line_velocity_m_s: f64,
    pub pinion: MemberData,
    pub gear: MemberData,
    /// Points of the path of contact in its order: A, B, D, E; B and D only where one tooth pair alone is in contact
    /// between them.
    pub path_points: Vec<PathPosition>,
    /// Lines of contact of the loaded flanks, in each half at the instant at which a tooth pair enters the mesh.
    pub contact_lines: Vec<HalfContactLine>,
}

/// Gear data of one gear (both halves, but for the face width).
#[derive(Debug, Clone, PartialEq, Serialize, ResultFields)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
#[scalar(theory = "geometry#diameters-angles-and-pitches")]
pub struct MemberData {
    /// Number of teeth (z).
    #[scalar(label = "number of teeth", symbol = "z")]
    pub teeth: u32,
    /// Hand of the left half: `left` or `right`.
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    #[scalar(label = "hand of the left half")]
    pub left_half_hand: Hand,
    /// Profile shift coefficient (x).
    #[scalar(label = "profile shift coefficient", symbol = "x")]
    pub profile_shift: f64,
    /// Reference diameter (d).
    #[scalar(label = "reference diameter", symbol = "d")]
    pub reference_diameter_mm: f64,
    /// Base diameter (d_b).
    #[scalar(label = "base diameter", symbol = "d_b")]
    pub base_diameter_mm: f64,
    /// Working pitch diameter (d_w).
    #[scalar(label = "working pitch diameter", symbol = "d_w")]
    pub working_pitch_diameter_mm: f64,
    /// Tip diameter (d_a).
    #[scalar(label = "tip diameter", symbol = "d_a")]
    pub tip_diameter_mm: f64,
    /// Root diameter (d_f).
    #[scalar(label = "root diameter", symbol = "d_f")]
    pub root_diameter_mm: f64,
    /// Root form diameter (d_Ff).
    #[scalar(label = "root form diameter", symbol = "d_Ff", theory = "geometry#tooth-form")]
    pub root_form_diameter_mm: f64,
    /// Tooth thickness at the tip in the normal section (s_an).
    #[scalar(label = "normal tooth thickness at the tip", symbol = "s_an", theory = "geometry#tooth-form")]
    pub tip_thickness_normal_mm: f64,
    /// Addendum of the basic rack, normal modules (h*_aP).
    #[scalar(label = "addendum of the rack, modules", symbol = "h*_aP")]
    pub addendum: f64,
    /// Dedendum of the basic rack, normal modules (h*_fP).
    #[scalar(label = "dedendum of the rack, modules", symbol = "h*_fP")]
    pub dedendum: f64,
    /// Root fillet radius of the basic rack, normal modules (ρ*_fP).
    #[scalar(label = "root fillet radius of the rack, modules", symbol = "ρ*_fP")]
    pub fillet_radius: f64,
    /// Face width of one half of this gear (b).
    #[scalar(label = "face width of a half of its own", symbol = "b")]
    pub face_width_mm: f64,
    #[scalar(label = "bore diameter", symbol = "d_i", theory = "geometry#mass-and-moment-of-inertia")]
    pub bore_diameter_mm: f64,
    /// Speed (n).
    #[scalar(label = "speed", symbol = "n", theory = "geometry#speed-torque-and-mesh-frequency")]
    pub speed_rpm: f64,
    /// Torque on both halves together (T).
    #[scalar(label = "torque, both halves", symbol = "T", theory = "geometry#speed-torque-and-mesh-frequency")]
    pub torque_nm: f64,
    #[scalar(label = "mass", symbol = "m", theory = "geometry#mass-and-moment-of-inertia")]
    pub mass_kg: f64,
    #[scalar(label = "moment of inertia", symbol = "J", theory = "geometry#mass-and-moment-of-inertia")]
    pub inertia_kg_m2: f64,
}

/// A point of the path of contact.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct PathPosition {
    pub name: String,
    /// Distance from the base tangent point T1 of the pinion along the line of action.
    pub roll_mm: f64,
    /// Distance from A in transverse base pitches.
    pub base_pitches: f64,
}

/// A line of contact in the plane of action: two ends.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema))]
pub struct HalfContactLine {
    /// `left` or `right`.
    #[cfg_attr(feature = "schema", schema(value_type = String))]
    pub half: Half,
    /// Positions along the axis: 0 in the middle of the gap, the left half below 0.
    pub axial_mm: [f64; 2],
    /// Roll lengths of the pinion's flank.
    pub roll_mm: [f64; 2],
}

impl GearData {
    /// The gear data of a document's pair.
    ///
    /// # Errors
    /// [`DocumentError::Invalid`] with every reason why the pair cannot exist.
    pub fn of(document: &JobDocument) -> Result<GearData, DocumentError> {
        let prepared = prepare::prepare(document)?;
        let pair = &prepared.pair;
        let [pinion, gear] = [&document.design.pinion, &document.design.gear];
        let ratio = f64::from(pair.gear.teeth) / f64::from(pair.pinion.teeth);
        let pitch_radii_m = pair.pitch_radii_m();
        let beta = pair.spec.helix_angle_rad;
        let (speed_rpm, torque_nm) = (document.operation.pinion_speed_rpm, document.operation.pinion_torque_nm);
        let member = |member: &Member, given: &GearInput, index: usize| MemberData {
            teeth: member.teeth,
            left_half_hand: given.left_half_hand,
            profile_shift: member.profile_shift,
            reference_diameter_mm: member.reference_radius_m * 2.0 * MM,
            base_diameter_mm: member.base_radius_m * 2.0 * MM,
            working_pitch_diameter_mm: pitch_radii_m[index] * 2.0 * MM,
            tip_diameter_mm: member.tip_radius_m * 2.0 * MM,
            root_diameter_mm: member.root_radius_m * 2.0 * MM,
            root_form_diameter_mm: member.root_form_radius_m * 2.0 * MM,
            tip_thickness_normal_mm: member.normal_thickness_m(member.tip_radius_m) * MM,
            addendum: given.addendum,
            dedendum: given.dedendum,
            fillet_radius: given.fillet_radius,
            face_width_mm: member.face_width_m * MM,
            bore_diameter_mm: member.bore_radius_m * 2.0 * MM,
            speed_rpm: if index == 0 { speed_rpm } else { speed_rpm / ratio },
            torque_nm: if index == 0 { torque_nm } else { torque_nm * ratio },
            mass_kg: prepared.mass_kg[index],
            inertia_kg_m2: prepared.inertia_kg_m2[index],
        };
        Ok(GearData {
            normal_module_mm: pair.spec.normal_module_m * MM,
            transverse_module_mm: pair.transverse_module_m * MM,
            normal_pressure_angle_deg: pair.spec.normal_pressure_angle_rad.to_degrees(),
            transverse_pressure_angle_deg: pair.transverse_pressure_angle_rad.to_degrees(),
            working_pressure_angle_deg: pair.working_pressure_angle_rad.to_degrees(),
            helix_angle_deg: document.design.helix_angle_deg,
            base_helix_angle_deg: pair.base_helix_angle_rad.to_degrees(),
            gear_ratio: ratio,
            center_distance_mm: pair.center_distance_m * MM,
            face_width_mm: pair.spec.face_width_m * MM,
            gap_width_mm: pair.spec.gap_width_m * MM,
            transverse_base_pitch_mm: pair.base_pitch_m * MM,
            axial_pitch_mm: (beta > 0.0).then(|| PI * pair.spec.normal_module_m / beta.sin() * MM),
            path_of_contact_mm: (pair.path_end_m - pair.path_start_m) * MM,
            transverse_contact_ratio: pair.transverse_contact_ratio,
            overlap_ratio: pair.overlap_ratio,
            total_contact_ratio: pair.total_contact_ratio(),
            backlash_um: bounds::backlash_um(document),
            pitch_line_velocity_m_s: pitch_radii_m[0] * prepared.pinion_speed_rad_s,
            pinion: member(&pair.pinion, pinion, 0),
            gear: member(&pair.gear, gear, 1),
            path_points: path_points(pair),
            contact_lines: contact_lines(pair, torque_nm < 0.0),
        })
    }

    /// The gear data of a document as the store keeps it.
    ///
    /// # Errors
    /// [`DocumentError`] where this version refuses the document.
    pub fn of_stored(document: &str) -> Result<GearData, DocumentError> {
        GearData::of(&parse(document.as_bytes())?)
    }
}

fn path_points(pair: &Pair) -> Vec<PathPosition> {
    let mut points = vec![("A", pair.path_start_m)];
    if let Some([b, d]) = pair.single_contact_m() {
        points.extend([("B", b), ("D", d)]);
    }
    points.push(("E", pair.path_end_m));
    points
        .into_iter()
        .map(|(name, x_m)| PathPosition {
            name: name.to_owned(),
            roll_mm: x_m * MM,
            base_pitches: (x_m - pair.path_start_m) / pair.base_pitch_m,
        })
        .collect()
}

/// Lines of contact of both halves when a pair enters. On the coast flanks (`Pair::coast`) contact runs backwards
/// along the path of the mirrored pair: a pair enters where one of the mirrored pair leaves.
fn contact_lines(pair: &Pair, is_coast: bool) -> Vec<HalfContactLine> {
    let inner_m = 0.5 * pair.spec.gap_width_m;
    let (loaded, position_m) =
        if is_coast { (pair.coast(), pair.path_end_m) } else { (pair.clone(), pair.position_m(0.0)) };
    let lines = loaded.contact_lines(position_m);
    let of_half = |half: Half, side: f64| {
        let axial_mm = |entry_m: f64| side * (inner_m + loaded.entry_m(entry_m)) * MM;
        lines
            .iter()
            .map(|line| HalfContactLine {
                half,
                axial_mm: line.entry_m.map(axial_mm),
                roll_mm: line.x_m.map(|x_m| x_m * MM),
            })
            .collect::<Vec<_>>()
    };
    [of_half(Half::Left, -1.0), of_half(Half::Right, 1.0)].concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parse_value;
    use serde_json::{Value, json};

    fn data(change: impl Fn(&mut Value)) -> GearData {
        let mut value: Value = serde_json::from_str(include_str!("../../../examples/table1.json")).unwrap();
        change(&mut value);
        GearData::of(&parse_value(&value).unwrap()).unwrap()
    }

    fn near(value: f64, expected: f64) {
        assert!((value - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{value} is not {expected}");
    }

    /// The formulas of ISO 21771-1 from the inputs, independent of the pair's own derivation.
    #[test]
    fn derived_data_follow_the_standard() {
        let found = data(|_| {});
        let beta = found.helix_angle_deg.to_radians();
        near(found.gear_ratio, 44.0 / 17.0);
        near(found.transverse_module_mm, 6.0 / beta.cos());
        near(found.axial_pitch_mm.unwrap(), PI * 6.0 / beta.sin());
        near(found.pinion.reference_diameter_mm, 17.0 * found.transverse_module_mm);
        near(found.pinion.working_pitch_diameter_mm, 2.0 * found.center_distance_mm * 17.0 / 61.0);
        near(found.gear.working_pitch_diameter_mm, 2.0 * found.center_distance_mm * 44.0 / 61.0);
        near(found.gear.speed_rpm, found.pinion.speed_rpm * 17.0 / 44.0);
        near(found.gear.torque_nm, found.pinion.torque_nm * 44.0 / 17.0);
        let pitch_line_m_s = PI * found.pinion.working_pitch_diameter_mm * 1e-3 * found.pinion.speed_rpm / 60.0;
        near(found.pitch_line_velocity_m_s, pitch_line_m_s);
        near(found.total_contact_ratio, found.transverse_contact_ratio + found.overlap_ratio);
        near(found.transverse_contact_ratio, found.path_of_contact_mm / found.transverse_base_pitch_mm);
    }

    #[test]
    fn spur_gears_have_no_axial_pitch() {
        let found = data(|value| value["design"]["helix_angle_deg"] = json!(0.0));
        assert_eq!(found.axial_pitch_mm, None);
        near(found.transverse_module_mm, found.normal_module_mm);
    }

    #[test]
    fn path_points_are_those_of_single_contact() {
        let found = data(|_| {});
        let [a, b, d, e] = found.path_points.try_into().unwrap();
        assert_eq!([&a.name, &b.name, &d.name, &e.name], ["A", "B", "D", "E"]);
        near(a.base_pitches, 0.0);
        near(b.base_pitches, found.transverse_contact_ratio - 1.0);
        near(d.base_pitches, 1.0);
        near(e.base_pitches, found.transverse_contact_ratio);
    }

    /// Ends of the lines lie in the zone of contact, on lines inclined by the base helix angle, one base pitch apart;
    /// one line has just begun at a corner of the zone: on drive flanks at A, on coast flanks at E.
    #[test]
    fn contact_lines_lie_in_the_zone_of_contact() {
        for (torque_nm, rotation) in
            [(800.0, "apex_leading"), (800.0, "apex_trailing"), (-800.0, "apex_leading"), (-800.0, "apex_trailing")]
        {
            let found = data(|value| {
                value["operation"]["pinion_torque_nm"] = json!(torque_nm);
                value["operation"]["rotation"] = json!(rotation);
            });
            let (start, end) = (found.path_points[0].roll_mm, found.path_points.last().unwrap().roll_mm);
            let (inner, outer) = (0.5 * found.gap_width_mm, 0.5 * found.gap_width_mm + found.face_width_mm);
            let slope = found.base_helix_angle_deg.to_radians().tan();
            // Intersection of the line through an end with the inner end of the faces, in base pitches from a line that
            // begins.
            let inner_is_first = (rotation == "apex_leading") == (torque_nm > 0.0);
            let sense = if inner_is_first { -1.0 } else { 1.0 };
            let corner_roll = if torque_nm > 0.0 { start } else { end };
            let entry_face = if rotation == "apex_leading" { inner } else { outer };
            let mut of_half = [0, 0];
            for line in &found.contact_lines {
                of_half[usize::from(line.half == Half::Right)] += 1;
                for (axial, roll) in line.axial_mm.into_iter().zip(line.roll_mm) {
                    assert_eq!(axial < 0.0, line.half == Half::Left, "{line:?}");
                    assert!(roll >= start - 1e-9 && roll <= end + 1e-9, "{line:?}");
                    assert!(axial.abs() >= inner - 1e-9 && axial.abs() <= outer + 1e-9, "{line:?}");
                    let from_corner = roll - corner_roll - sense * slope * (axial.abs() - entry_face);
                    let pitches = from_corner / found.transverse_base_pitch_mm;
                    assert!((pitches - pitches.round()).abs() < 1e-9, "{torque_nm} {rotation} {pitches} {line:?}");
                }
            }
            assert!(of_half[0] >= 2 && of_half[0] == of_half[1], "{of_half:?}");
        }
    }

    #[test]
    fn stored_documents_of_earlier_versions_have_gear_data() {
        let given = include_str!("../../../examples/table1.json");
        assert_eq!(GearData::of_stored(given).unwrap(), data(|_| {}));
        assert!(matches!(GearData::of_stored("{"), Err(DocumentError::Malformed { .. })));
    }
}
