//! The coast flanks: the mirrored pair against the drawing, against rigid displacements and against itself.

use crate::gear::fixtures::{close, gear, pair, source_pair, spec, worked_pair};
use crate::gear::{
    Assembly, EndRelief, FlankModification, GearField, GearSpec, Half, MemberId, Pair, PairSpec, Rotation, SpecField,
};

fn pairs() -> Vec<Pair> {
    let shifted = spec(4.0, 20.0, 28.0, 30.0, gear(13, 0.4), gear(120, -0.2));
    let apart = PairSpec { center_distance_m: Some(0.2035), ..source_pair(1.0) };
    let trailing = PairSpec { rotation: Rotation::ApexTrailing, ..worked_pair() };
    let spur = spec(6.0, 20.0, 0.0, 50.0, gear(17, 0.0), gear(44, 0.0));
    [source_pair(1.0), worked_pair(), shifted, apart, trailing, spur].iter().map(pair).collect()
}

/// Signed distance of `angle` from the nearest multiple of `period`.
fn off(angle: f64, period: f64) -> f64 {
    (angle + 0.5 * period).rem_euclid(period) - 0.5 * period
}

/// The drawing has the tooth's two flanks from its outline alone. Where the coast pair's line of action is drawn,
/// mirrored on the line of centres, the other flank of the same tooth of the same pinion passes through its point of
/// contact.
#[test]
fn the_other_flank_of_the_drawn_tooth_stands_where_the_coast_phase_says() {
    for pair in pairs() {
        let coast = pair.coast();
        let (b, tan) = (pair.spec.face_width_m, pair.base_helix_angle_rad.tan());
        let pitch = std::f64::consts::TAU / f64::from(pair.pinion.teeth);
        let center_y = -pair.pitch_radii_m()[0];
        for i in 0..7 {
            let phase = f64::from(i) / 7.0;
            let coast_phase = pair.coast_phase(phase);
            for y in [0.0, 0.3 * b, b] {
                let x = pair.position_m(phase) + pair.entry_m(y) * tan;
                let [tooth_rad, _] = pair.tooth_angles_rad(x);
                // Some pair of the coast flanks that touches in the same section.
                let first = coast.position_m(coast_phase) + coast.entry_m(y) * tan;
                let pitches = ((coast.path_start_m - first) / coast.base_pitch_m).ceil();
                let roll = first + pitches * coast.base_pitch_m;
                let [px, py] = coast.action_point_m(roll);
                let (px, py) = (-px, py - center_y);
                let half_angle = pair.pinion.half_angle_rad(px.hypot(py));
                let flank_rad = py.atan2(px) - tooth_rad;
                // The drive flank is ahead: clockwise. The coast flank is on the side of growing angle.
                close(off(flank_rad - half_angle, pitch), 0.0, 1e-9);
                assert!(off(flank_rad + half_angle, pitch).abs() > 1e-3, "the same flank");
            }
        }
    }
}

#[test]
fn the_mirror_of_the_mirror_is_the_pair_and_its_phase() {
    let modified = |um: f64| FlankModification { lead_crowning_m: um * 1e-6, ..FlankModification::NONE };
    let member = GearSpec { flanks: [modified(1.0), modified(2.0)], ..gear(17, 0.0) };
    let other = GearSpec { coast_flanks: Some([modified(5.0), modified(6.0)]), ..gear(44, 0.0) };
    let assembly = Assembly {
        center_distance_error_m: 30e-6,
        in_plane_misalignment_m: 11e-6,
        out_of_plane_misalignment_m: -7e-6,
        apex_offset_m: 5e-6,
    };
    let p = pair(&PairSpec { assembly, ..spec(6.0, 20.0, 24.0, 55.0, member, other) });
    let coast = p.coast();
    assert_eq!(coast.spec.pinion.flanks, p.spec.pinion.flanks);
    assert_eq!(coast.spec.gear.flanks, [modified(5.0), modified(6.0)]);
    assert_eq!(coast.spec.rotation, Rotation::ApexTrailing);
    assert_eq!(coast.spec.assembly.apex_offset_m, -5e-6);
    assert_eq!(coast.spec.assembly.center_distance_error_m, 30e-6);
    let back = coast.coast();
    let close_assembly = |a: &Assembly, b: &Assembly| {
        close(a.in_plane_misalignment_m, b.in_plane_misalignment_m, 1e-18);
        close(a.out_of_plane_misalignment_m, b.out_of_plane_misalignment_m, 1e-18);
    };
    close_assembly(&back.spec.assembly, &p.spec.assembly);
    assert_eq!(Pair { spec: PairSpec { assembly, ..back.spec }, ..back }, p);
    for i in 0..50 {
        let phase = f64::from(i) / 50.0;
        let coast_phase = p.coast_phase(phase);
        assert!((0.0..1.0).contains(&coast_phase), "{coast_phase}");
        close(off(coast.coast_phase(coast_phase) - phase, 1.0), 0.0, 1e-12);
        close(off(p.coast_phase(phase + 0.25) - coast_phase + 0.25, 1.0), 0.0, 1e-12);
    }
}

/// A rigid tilt of the pinion's axis opens the flanks by what it moves away along their lines of action.
#[test]
fn misalignment_opens_both_flanks_as_the_rigid_tilt_does() {
    let base = worked_pair();
    for (f, e) in [(20e-6, 0.0), (-20e-6, 0.0), (0.0, 20e-6), (0.0, -20e-6), (15e-6, 9e-6)] {
        let assembly = Assembly { in_plane_misalignment_m: f, out_of_plane_misalignment_m: e, ..Assembly::NONE };
        let drive = pair(&PairSpec { assembly, ..base });
        let coast = drive.coast();
        let (sin, cos) = drive.working_pressure_angle_rad.sin_cos();
        // In the section as drawn, the gear above: along the drive flanks' line of action, across it (towards the
        // gear), and along the coast flanks', at the left half's outer end against its inner end.
        let along = [cos, sin];
        let across = [-sin, cos];
        let moved = [-f * along[0] - e * across[0], -f * along[1] - e * across[1]];
        let opens = |direction: [f64; 2]| -(moved[0] * direction[0] + moved[1] * direction[1]);
        let b = base.face_width_m;
        for (pair, direction) in [(&drive, along), (&coast, [-cos, sin])] {
            let rise = |half| pair.initial_gap_m(half, 0.02, b) - pair.initial_gap_m(half, 0.02, 0.0);
            close(rise(Half::Left), opens(direction), 1e-9 + 1e-3 * f.hypot(e));
            // One straight axis through both halves.
            close(rise(Half::Right), -opens(direction), 1e-9 + 1e-3 * f.hypot(e));
        }
    }
    let offset = Assembly { apex_offset_m: 10e-6, ..Assembly::NONE };
    let drive = pair(&PairSpec { assembly: offset, ..base });
    let gap = |pair: &Pair, half| pair.initial_gap_m(half, 0.02, 0.01);
    assert!(gap(&drive, Half::Left) > 0.0 && gap(&drive, Half::Right) == 0.0);
    assert_eq!(gap(&drive.coast(), Half::Right), gap(&drive, Half::Left));
    assert_eq!(gap(&drive.coast(), Half::Left), 0.0);
}

/// A wider gear has its modifications over its own face: the common part, in the middle, has the middle of them.
#[test]
fn modifications_of_a_wider_member_run_over_its_own_face() {
    let crowned = FlankModification {
        lead_crowning_m: 10e-6,
        helix_slope_m: 6e-6,
        end_relief: EndRelief { amount_m: 20e-6, length_m: 5e-3 },
        ..FlankModification::NONE
    };
    let wide = GearSpec { face_width_m: Some(75e-3), flanks: [crowned; 2], ..gear(44, 0.0) };
    let p = pair(&spec(6.0, 20.0, 24.43, 55.0, gear(17, 0.0), wide));
    let at = |y: f64| p.initial_gap_m(Half::Left, p.pitch_point_m(), y);
    let expected = |y: f64| 10e-6 * (2.0 * y / 75e-3 - 1.0).powi(2) + 6e-6 * y / 75e-3;
    for y in [0.0, 20e-3, 55e-3] {
        // End relief of 5 mm stands outside the common part, 10 mm from the ends.
        close(at(y), expected(y + 10e-3), 1e-15);
    }
    // Own width as the common one: nothing changes, not by a bit.
    let equal = GearSpec { face_width_m: Some(55e-3), ..wide };
    let own = pair(&spec(6.0, 20.0, 24.43, 55.0, gear(17, 0.0), equal));
    let plain = pair(&spec(6.0, 20.0, 24.43, 55.0, gear(17, 0.0), GearSpec { face_width_m: None, ..wide }));
    for y in [0.0, 3e-3, 55e-3] {
        let gaps = [&own, &plain].map(|pair| pair.initial_gap_m(Half::Left, 0.03, y).to_bits());
        assert_eq!(gaps[0], gaps[1]);
    }
    assert_eq!(own.gear.inertia_kg_m2().to_bits(), plain.gear.inertia_kg_m2().to_bits());
    let ratio = p.gear.mass_kg() / plain.gear.mass_kg();
    close(ratio, 75.0 / 55.0, 1e-12);
}

#[test]
fn widths_that_do_not_fit_are_refused_with_their_field() {
    for (width_m, fits) in [(54e-3, false), (55e-3, true), (85e-3, true), (85.1e-3, false), (f64::NAN, false)] {
        // The gap of the fixtures is 30 mm.
        let wide = GearSpec { face_width_m: Some(width_m), ..gear(44, 0.0) };
        let found = Pair::new(&spec(6.0, 20.0, 24.43, 55.0, gear(17, 0.0), wide));
        match found {
            Ok(_) => assert!(fits, "{width_m}"),
            Err(reasons) => {
                assert!(!fits, "{width_m} {reasons:?}");
                let field = SpecField::Member(MemberId::Gear, GearField::FaceWidth);
                assert!(reasons.iter().all(|reason| reason.field == field), "{reasons:?}");
            }
        }
    }
}
