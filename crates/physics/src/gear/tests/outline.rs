//! The drawing: outlines on the true flanks, teeth that touch where they should and overlap nowhere.

use crate::gear::fixtures::{close, gear, pair, source_pair, spec, undercut_pair, worked_pair};
use crate::gear::{Margin, MarginKind, Member, MemberId, Pair, PairSpec};

fn pairs() -> Vec<Pair> {
    let shifted = spec(4.0, 20.0, 28.0, 30.0, gear(13, 0.4), gear(120, -0.2));
    let apart = PairSpec { center_distance_m: Some(0.2035), ..source_pair(1.0) };
    let spur = spec(6.0, 20.0, 0.0, 50.0, gear(17, 0.0), gear(44, 0.0));
    [source_pair(1.0), worked_pair(), undercut_pair(), shifted, apart, spur].iter().map(pair).collect()
}

fn turned([x, y]: [f64; 2], angle_rad: f64, [cx, cy]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = angle_rad.sin_cos();
    [cx + x * cos - y * sin, cy + x * sin + y * cos]
}

fn centers(pair: &Pair) -> [[f64; 2]; 2] {
    let [pinion, gear] = pair.pitch_radii_m();
    [[0.0, -pinion], [0.0, gear]]
}

/// Signed angle from the nearest flank of any tooth at the point's radius, as an arc: positive inside a tooth.
fn depth_m(member: &Member, tooth_rad: f64, center: [f64; 2], point: [f64; 2]) -> f64 {
    let (x, y) = (point[0] - center[0], point[1] - center[1]);
    let r = x.hypot(y);
    if r > member.tip_radius_m {
        return member.tip_radius_m - r;
    }
    let pitch = std::f64::consts::TAU / f64::from(member.teeth);
    let off = (y.atan2(x) - tooth_rad + 0.5 * pitch).rem_euclid(pitch) - 0.5 * pitch;
    (member.half_angle_rad(r) - off.abs()) * r
}

#[test]
fn outlines_run_over_one_pitch_and_lie_on_the_tooth_form() {
    for pair in pairs() {
        for member in [&pair.pinion, &pair.gear] {
            let outline = member.outline_m();
            let half_pitch = std::f64::consts::PI / f64::from(member.teeth);
            let angles: Vec<_> = outline.iter().map(|[x, y]| y.atan2(*x)).collect();
            close(angles[0], -half_pitch, 1e-12);
            close(angles[angles.len() - 1], half_pitch, 1e-12);
            for ([x, y], angle) in outline.iter().zip(&angles) {
                let r = x.hypot(*y);
                let (low, high) = (member.root_radius_m, member.tip_radius_m);
                assert!(r >= low * (1.0 - 1e-12) && r <= high * (1.0 + 1e-12), "{r}");
                let is_flank = r > low * (1.0 + 1e-9) && r < high * (1.0 - 1e-9);
                if is_flank {
                    close(angle.abs() * r, member.half_angle_rad(r) * r, 1e-9 * high);
                }
                // The involute by its own property: its tangent length is the arc unrolled from the base circle.
                if is_flank && r > member.root_form_radius_m {
                    let roll = member.roll_length_m(r);
                    let unrolled = member.base_half_angle_rad - angle.abs() + (roll / member.base_radius_m).atan();
                    close(unrolled * member.base_radius_m, roll, 1e-9 * high);
                }
            }
        }
    }
}

#[test]
fn the_drawn_tooth_has_its_thickness_at_the_reference_circle() {
    let p = pair(&spec(6.0, 20.0, 24.43, 55.0, gear(17, 0.2), gear(44, 0.0)));
    let r = p.pinion.reference_radius_m;
    let outline = p.pinion.outline_m();
    let crossing = outline.windows(2).find_map(|ends| {
        let [a, b] = [ends[0][0].hypot(ends[0][1]), ends[1][0].hypot(ends[1][1])];
        let angle = |[x, y]: [f64; 2]| y.atan2(x);
        (a < r && b >= r).then(|| angle(ends[0]) + (r - a) / (b - a) * (angle(ends[1]) - angle(ends[0])))
    });
    let thickness = -2.0 * r * crossing.unwrap() * 24.43_f64.to_radians().cos();
    let expected = 6e-3 * (std::f64::consts::FRAC_PI_2 + 2.0 * 0.2 * 20.0_f64.to_radians().tan());
    // The polyline's chord between two points of the involute.
    close(thickness, expected, 1e-3 * expected);
}

#[test]
fn flanks_touch_at_the_point_of_contact_along_the_whole_path() {
    for pair in pairs() {
        let [pinion_center, gear_center] = centers(&pair);
        for i in 0..=40 {
            let x = pair.path_start_m + (pair.path_end_m - pair.path_start_m) * f64::from(i) / 40.0;
            let point = pair.action_point_m(x);
            let [pinion_rad, gear_rad] = pair.tooth_angles_rad(x);
            let scale = pair.center_distance_m;
            close(depth_m(&pair.pinion, pinion_rad, pinion_center, point), 0.0, 1e-9 * scale);
            close(depth_m(&pair.gear, gear_rad, gear_center, point), 0.0, 1e-9 * scale);
        }
    }
}

#[test]
fn no_point_of_one_gears_outline_lies_inside_the_other() {
    for pair in pairs() {
        let [pinion_center, gear_center] = centers(&pair);
        let pitch = |member: &Member| std::f64::consts::TAU / f64::from(member.teeth);
        for i in 0..20 {
            let x = pair.path_start_m + pair.base_pitch_m * f64::from(i) / 20.0;
            let [pinion_rad, gear_rad] = pair.tooth_angles_rad(x);
            // Negative backlash would show on the back flanks; these pairs have none.
            assert!(pair.geometric_backlash_m >= -1e-12);
            for k in -4..=4 {
                for point in pair.pinion.outline_m() {
                    let at = turned(point, pinion_rad + f64::from(k) * pitch(&pair.pinion), pinion_center);
                    let depth = depth_m(&pair.gear, gear_rad, gear_center, at);
                    assert!(depth < 1e-9 * pair.center_distance_m, "{depth} at {i}");
                }
                for point in pair.gear.outline_m() {
                    let at = turned(point, gear_rad + f64::from(k) * pitch(&pair.gear), gear_center);
                    let depth = depth_m(&pair.pinion, pinion_rad, pinion_center, at);
                    assert!(depth < 1e-9 * pair.center_distance_m, "{depth} at {i}");
                }
            }
        }
    }
}

#[test]
fn centre_distance_is_the_sum_of_the_pitch_radii_and_the_pitch_point_is_the_origin() {
    for pair in pairs() {
        let [pinion, gear] = pair.pitch_radii_m();
        close(pinion + gear, pair.center_distance_m, 1e-12);
        assert_eq!(pair.action_point_m(pair.pitch_point_m()), [0.0, 0.0]);
        let [x, y] = pair.action_point_m(0.0);
        close(x.hypot(y + pinion), pair.pinion.base_radius_m, 1e-12);
    }
}

#[test]
fn single_contact_is_between_b_and_d_where_there_is_any() {
    let p = pair(&worked_pair());
    let [b, d] = p.single_contact_m().unwrap();
    assert!(p.path_start_m < b && b < d && d < p.path_end_m);
    close(d - b, (2.0 - p.transverse_contact_ratio) * p.base_pitch_m, 1e-12);
}

#[test]
fn whole_lines_cut_to_the_path_are_the_lines_of_contact_at_every_phase() {
    for pair in pairs() {
        let whole = pair.whole_lines(pair.position_m(0.0), pair.base_pitch_m);
        let tan = pair.base_helix_angle_rad.tan();
        for i in 0..50 {
            let travel = pair.base_pitch_m * f64::from(i) / 50.0;
            let mut drawn = 0.0;
            for line in &whole {
                let [from, to] = line.x_m.map(|x| (x + travel).clamp(pair.path_start_m, pair.path_end_m));
                let inside = line.x_m[0] + travel >= pair.path_start_m && line.x_m[0] + travel <= pair.path_end_m;
                drawn += if tan > 0.0 { (to - from) / tan } else { f64::from(u8::from(inside)) * line.width_m() };
            }
            let expected: f64 =
                pair.contact_lines(pair.position_m(0.0) + travel).iter().map(|line| line.width_m()).sum();
            close(drawn, expected, 1e-9 * pair.spec.face_width_m);
        }
    }
}

#[test]
fn margins_are_of_both_members_and_hold_for_a_sound_pair() {
    let p = pair(&worked_pair());
    let margins = p.margins();
    assert_eq!(margins.len(), 8);
    let of = |kind, member| *margins.iter().find(|m| m.kind == kind && m.member == member).unwrap();
    let thickness = of(MarginKind::TipThickness, MemberId::Pinion);
    assert!(thickness.value > thickness.limit, "{thickness:?}");
    close(of(MarginKind::TipClearance, MemberId::Gear).value, 0.25, 1e-9);
    let active = of(MarginKind::ActiveProfileRadius, MemberId::Gear);
    assert!(active.value > active.limit, "{active:?}");
    let undercut = pair(&undercut_pair()).margins();
    let of_shift = |m: &&Margin| m.kind == MarginKind::ProfileShift && m.member == MemberId::Pinion;
    assert!(undercut.iter().find(of_shift).is_some_and(|m| m.value < m.limit));
}
