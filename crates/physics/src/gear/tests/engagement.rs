//! Pairs that run although a textbook limit is passed, and centre distances that do not belong to their profile shifts.

use crate::gear::fixtures::{close, gear, pair, source_pair, spec, undercut_pair, worked_pair};
use crate::gear::{
    AssemblyField, GearField, GearSpec, Infeasibility, InfeasibilityReason, MarginKind, MemberId, Pair, PairSpec,
    SpecField, Warning, WarningReason,
};
use herringbone_oracle::Tolerance::Absolute;
use herringbone_oracle::check;
use proptest::prelude::*;

fn warnings(spec: &PairSpec) -> Vec<Warning> {
    match Pair::new(spec) {
        Ok((_, warnings)) => warnings,
        Err(reasons) => panic!("{reasons:#?}"),
    }
}

fn refused(spec: &PairSpec) -> Vec<Infeasibility> {
    match Pair::new(spec) {
        Ok((_, warnings)) => panic!("not refused; warnings {warnings:#?}"),
        Err(reasons) => reasons,
    }
}

/// Least length of the lines of contact over a mesh period, by going through it.
fn shortest_m(p: &Pair) -> f64 {
    (0..2000).map(|i| p.contact_length_m(p.position_m(f64::from(i) / 2000.0))).fold(f64::INFINITY, f64::min)
}

fn stub(addendum: f64, teeth: u32) -> GearSpec {
    GearSpec { addendum, ..gear(teeth, 0.0) }
}

fn about_ratio(warning: &Warning) -> bool {
    matches!(warning.reason, WarningReason::TransverseContactRatioBelowOne { .. })
}

/// Helical pairs whose transverse contact ratio is below 1 run as long as lines of contact exist at every phase.
#[test]
fn overlap_makes_up_for_a_short_path() {
    for (helix_deg, width_mm, pinion, gear) in [
        (45.0, 20.0, gear(6, 0.0), gear(12, 0.0)),
        (45.0, 12.0, gear(6, 0.0), gear(12, 0.0)),
        (45.0, 45.0, gear(7, 0.0), gear(11, 0.0)),
        (25.0, 40.0, stub(0.45, 20), stub(0.45, 60)),
        (15.0, 25.0, stub(0.5, 17), stub(0.5, 44)),
        (30.0, 90.0, stub(0.3, 30), stub(0.3, 30)),
    ] {
        let spec = spec(4.0, 20.0, helix_deg, width_mm, pinion, gear);
        let found = warnings(&spec);
        let p = pair(&spec);
        assert!(p.transverse_contact_ratio < 1.0, "{spec:?}");
        let warning = found.iter().find(|warning| about_ratio(warning)).unwrap_or_else(|| panic!("{found:?}"));
        let WarningReason::TransverseContactRatioBelowOne { transverse, overlap, shortest_over_mean, .. } =
            warning.reason
        else {
            unreachable!("{warning:?}")
        };
        assert_eq!((transverse, overlap), (p.transverse_contact_ratio, p.overlap_ratio));
        let shortest = shortest_m(&p);
        assert!(shortest > 0.0);
        close(shortest_over_mean, shortest / p.mean_contact_length_m(), 2e-3);
        close(shortest, p.contact_length_range_m()[0], 2e-3 * p.mean_contact_length_m());
        assert_eq!(p.single_contact_m(), None);
    }
}

/// Without enough overlap lines of contact are missing at some phases: refused with the sum and its limit.
#[test]
fn a_short_path_without_overlap_is_refused() {
    for (helix_deg, width_mm) in [(0.0, 40.0), (5.0, 5.0), (25.0, 5.0)] {
        let spec = spec(4.0, 20.0, helix_deg, width_mm, stub(0.45, 20), stub(0.45, 60));
        let reasons = refused(&spec);
        assert_eq!(reasons.len(), 1, "{reasons:?}");
        assert_eq!(reasons[0].field, SpecField::Member(MemberId::Pinion, GearField::Addendum));
        let InfeasibilityReason::ContactRatioBelowOne { transverse, overlap, .. } = reasons[0].reason else {
            panic!("{reasons:?}")
        };
        let total = transverse + overlap;
        assert!(total > 0.7 && total < 1.0, "{reasons:?}");
    }
    // Ordinary ratios carry no such warning.
    assert!(!warnings(&worked_pair()).iter().any(about_ratio));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    /// Around the limit: accepted exactly where lines of contact exist at every phase.
    #[test]
    fn lines_of_contact_decide(addendum in 0.35..0.6_f64, helix in 0.0..45.0_f64, width in 1.0..30.0_f64, teeth in 20_u32..40) {
        let spec = spec(4.0, 20.0, helix, width, stub(addendum, teeth), stub(addendum, 60));
        match Pair::new(&spec) {
            Ok((p, found)) => {
                prop_assert!(shortest_m(&p) > 0.0);
                prop_assert_eq!(p.transverse_contact_ratio < 1.0, found.iter().any(about_ratio));
            }
            Err(reasons) => {
                prop_assert!(!reasons.is_empty());
                for found in reasons {
                    let InfeasibilityReason::ContactRatioBelowOne { transverse, overlap, .. } = found.reason else {
                        return Err(TestCaseError::fail(format!("{found:?}")));
                    };
                    prop_assert!(transverse <= 0.0 || transverse + overlap <= 1.0, "{:?}", found);
                }
            }
        }
    }
}

/// The rack of old American 14.5° gears.
fn rack_145(teeth: u32) -> GearSpec {
    GearSpec { dedendum: 1.157, fillet_radius: 0.2, ..gear(teeth, 0.0) }
}

/// Least distance of the gear's tip corner from the pinion's flank on its whole way through the space, by brute force
/// in the plane: the corner's way in the pinion's coordinates against the flank as it is cut. Negative: the corner
/// enters the tooth.
fn tip_clearance_m(p: &Pair) -> f64 {
    let a = p.center_distance_m;
    let (pinion, gear) = (&p.pinion, &p.gear);
    let ratio = f64::from(pinion.teeth) / f64::from(gear.teeth);
    // The tooth of the pinion and the corner in the position in which pinion roll and gear roll add up to T1T2 at the
    // pitch point.
    let [pinion_rad, gear_rad] = p.tooth_angles_rad(p.pitch_point_m());
    let flank: Vec<[f64; 2]> = {
        let n = 4000;
        (0..=n)
            .map(|i| {
                let r =
                    pinion.root_radius_m + (pinion.tip_radius_m - pinion.root_radius_m) * f64::from(i) / f64::from(n);
                // The flank that leads in the sense of rotation, which is clockwise.
                let angle = pinion_rad - pinion.half_angle_rad(r);
                [r * angle.cos(), r * angle.sin()]
            })
            .collect()
    };
    let corner_angle = gear_rad - gear.half_angle_rad(gear.tip_radius_m);
    let mut least = f64::INFINITY;
    for i in -3000..=3000 {
        // The pinion's turn, clockwise positive; the gear turns the other way.
        let turn = 0.9 * f64::from(i) / 3000.0;
        let gear_angle = corner_angle + turn * ratio;
        let (x, y) = (gear.tip_radius_m * gear_angle.cos(), a + gear.tip_radius_m * gear_angle.sin());
        let (r, angle) = (x.hypot(y), y.atan2(x) + turn);
        if r > pinion.tip_radius_m || r < pinion.root_radius_m {
            continue;
        }
        let at = [r * angle.cos(), r * angle.sin()];
        let distance = flank
            .windows(2)
            .map(|ends| {
                let [ax, ay] = ends[0];
                let (dx, dy) = (ends[1][0] - ax, ends[1][1] - ay);
                let t = (((at[0] - ax) * dx + (at[1] - ay) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
                (at[0] - ax - t * dx).hypot(at[1] - ay - t * dy)
            })
            .fold(f64::INFINITY, f64::min);
        // Outside the tooth the corner stands before the leading flank.
        let outside = (angle - pinion_rad + pinion.half_angle_rad(r)) <= 0.0;
        least = least.min(if outside { distance } else { -distance });
    }
    least
}

/// The gear's tip passes the pinion's base tangent point, where the cutter has left nothing in its way: solved, with a
/// warning of undercut.
#[test]
fn a_tip_beyond_the_base_tangent_point_runs_where_the_cutter_was() {
    let inch = |teeth: u32, mate: u32| spec(25.4 / 12.0, 14.5, 0.0, 20.0, rack_145(teeth), rack_145(mate));
    let usual =
        |teeth: u32, mate: u32, helix_deg: f64| spec(5.0, 20.0, helix_deg, 40.0, gear(teeth, 0.0), gear(mate, 0.0));
    for spec in [
        inch(20, 63),
        inch(18, 63),
        inch(25, 100),
        inch(22, 40),
        usual(12, 60, 0.0),
        usual(12, 12, 0.0),
        usual(13, 90, 0.0),
        usual(14, 80, 8.0),
        usual(9, 60, 25.0),
    ] {
        let p = pair(&spec);
        assert!(p.line_of_action_m < p.gear.tip_roll_m(), "the tip stays short of T1: {spec:?}");
        assert!(p.path_start_m >= p.pinion.root_form_roll_m(), "the path starts before the flank");
        let found = warnings(&spec);
        assert!(found.iter().any(|w| matches!(w.reason, WarningReason::Undercut { .. })), "{found:?}");
        assert!(!found.iter().any(|w| matches!(w.reason, WarningReason::FilletInterference { .. })), "{found:?}");
        let clearance = tip_clearance_m(&p);
        assert!(clearance > 0.0, "{clearance} m left: {spec:?}");
        for margin in p.margins() {
            assert!(
                margin.value.is_finite() && (margin.kind != MarginKind::ActiveProfileRadius || margin.value > 0.0),
                "{margin:?}"
            );
        }
    }
    let p = pair(&inch(20, 63));
    let least_um = tip_clearance_m(&p) * 1e6;
    close(least_um, 3.8, 0.05);
}

/// A tip that does cut into what is there is refused with the addendum that does not; the brute-force way of the corner
/// agrees.
#[test]
fn a_tip_that_cuts_into_the_tooth_is_refused_with_its_limit() {
    let with = |teeth: u32, mate: u32, addendum: f64| {
        let pinion = GearSpec { fillet_radius: 0.4, ..gear(teeth, 0.0) };
        spec(5.0, 20.0, 0.0, 40.0, pinion, GearSpec { addendum, ..gear(mate, 0.0) })
    };
    for (teeth, mate) in [(14, 60), (16, 30), (18, 120)] {
        let reasons = refused(&with(teeth, mate, 1.24));
        let refusal = reasons.iter().find_map(|found| match found.reason {
            InfeasibilityReason::TipInterference { addendum, limit, .. } => Some((found.field, addendum, limit)),
            _ => None,
        });
        let (field, addendum, limit) = refusal.unwrap_or_else(|| panic!("{reasons:?}"));
        assert_eq!((field, addendum), (SpecField::Member(MemberId::Gear, GearField::Addendum), 1.24));
        assert!(limit > 0.9 && limit < 1.24, "{reasons:?}");
        assert!(Pair::new(&with(teeth, mate, limit + 1e-3)).is_err());
        let (p, found) = Pair::new(&with(teeth, mate, limit - 1e-3)).unwrap_or_else(|reasons| panic!("{reasons:?}"));
        assert!(found.iter().any(|w| matches!(w.reason, WarningReason::FilletInterference { .. })), "{found:?}");
        assert!(tip_clearance_m(&p) < 0.0);
    }
}

/// The source's pair: the gear's tip meets the pinion's base tangent point where `r_a2² = r_b2² + (T1T2)²`, at an
/// addendum of 1.2697 (a total contact ratio of 3.48 by the tips). The rack that cuts a deeper pinion for it has taken
/// that flank away.
#[test]
fn base_tangent_limit_of_the_source_pair() {
    let p = pair(&source_pair(1.0));
    let m = p.spec.normal_module_m;
    let tip_radius_m = p.line_of_action_m.hypot(p.gear.base_radius_m);
    let limit = (tip_radius_m - p.gear.reference_radius_m) / m;
    let topic = "Geometry: limits of feasible designs";
    check(topic, "source pair, addendum at which the gear's tip passes T1", limit, 1.26970, Absolute(5e-6));
    let roll = |r: f64, rb: f64| (r * r - rb * rb).sqrt();
    let e = roll(p.pinion.reference_radius_m + m * limit, p.pinion.base_radius_m);
    let unclipped = e / p.base_pitch_m + p.overlap_ratio;
    check(topic, "source pair, total contact ratio by the tips at that addendum", unclipped, 3.48, Absolute(5e-3));
    let taller = pair(&source_pair(1.30));
    assert!(taller.total_contact_ratio() < unclipped);
    let found = warnings(&source_pair(1.30));
    assert!(found.iter().any(|w| matches!(w.reason, WarningReason::Undercut { .. })), "{found:?}");
    assert!(tip_clearance_m(&taller) > 0.0);
}

/// z 19/63, m_n 16, shifts of 1.309 in all: 680 mm fit.
fn large(center_distance_mm: f64, shifts: [f64; 2]) -> PairSpec {
    let side = |teeth, x| GearSpec { tip_alteration: -0.058_625, ..gear(teeth, x) };
    let free = spec(16.0, 20.0, 7.0, 280.0, side(19, shifts[0]), side(63, shifts[1]));
    PairSpec { center_distance_m: Some(center_distance_mm * 1e-3), ..free }
}

/// A centre distance far from that of the profile shifts is refused where it is stated, with the distance that fits and
/// the shifts that fit it; what follows from it is not blamed on the teeth.
#[test]
fn a_centre_distance_that_does_not_fit_is_named() {
    let shifts = [0.52, 0.789];
    for (center_distance_mm, shifts, fitting_mm, sum) in [
        (861.0, shifts, Some(680.0007), Some(20.3552)),
        (2000.0, shifts, Some(680.0007), Some(202.0304)),
        (720.0, shifts, Some(680.0007), None),
        (690.0, shifts, Some(680.0007), None),
        (676.0, shifts, Some(680.0007), None),
        (640.0, shifts, Some(680.0007), None),
        (600.0, shifts, Some(680.0007), None),
        (680.0, [0.0, 0.0], Some(660.9264), None),
        (640.0, [0.0, 0.0], Some(660.9264), None),
        (672.0, [-0.3, -0.4], None, None),
    ] {
        let reasons = refused(&large(center_distance_mm, shifts));
        assert_eq!(reasons.len(), 1, "{center_distance_mm}: {reasons:#?}");
        assert_eq!(reasons[0].field, SpecField::CenterDistance);
        let fit = match &reasons[0].reason {
            InfeasibilityReason::CenterDistanceTooSmall { fit, .. } if center_distance_mm == 600.0 => fit,
            InfeasibilityReason::CenterDistanceDoesNotFit { fit, consequences, .. } => {
                assert!(!consequences.is_empty() && center_distance_mm != 600.0, "{reasons:?}");
                fit
            }
            other => panic!("{center_distance_mm}: {other:?}"),
        };
        close(fit.center_distance_m * 1e3, center_distance_mm, 1e-9);
        let fits_m = fit.fitting_center_distance_m.unwrap_or_else(|| panic!("{fit:?}"));
        if let Some(fitting_mm) = fitting_mm {
            close(fits_m * 1e3, fitting_mm, 5e-5);
        }
        close(fit.shift_sum, shifts[0] + shifts[1], 1e-15);
        if let Some(sum) = sum {
            close(fit.fitting_shift_sum.unwrap_or(f64::NAN), sum, 5e-5);
        }
    }
}

/// The sum that a refusal or warning names is right: with it the given distance leaves no backlash.
#[test]
fn the_named_shifts_fit_the_given_distance() {
    for center_distance_mm in [670.0, 676.0, 684.0, 690.0] {
        let fit = match Pair::new(&large(center_distance_mm, [0.52, 0.789])) {
            Ok((_, warnings)) => warnings.into_iter().find_map(|warning| match warning.reason {
                WarningReason::NegativeBacklash { fit, .. } | WarningReason::LargeBacklash { fit, .. } => Some(fit),
                _ => None,
            }),
            Err(reasons) => reasons.into_iter().find_map(|found| match found.reason {
                InfeasibilityReason::CenterDistanceDoesNotFit { fit, .. } => Some(fit),
                _ => None,
            }),
        };
        let sum = fit.and_then(|fit| fit.fitting_shift_sum).unwrap_or_else(|| panic!("{center_distance_mm}: {fit:?}"));
        let fitted = large(center_distance_mm, [0.52, sum - 0.52]);
        let p = pair(&PairSpec { center_distance_m: None, ..fitted });
        close(p.center_distance_m * 1e3, center_distance_mm, 1e-6);
    }
}

/// Involute gears run at any centre distance near that of their shifts: a moderate one is a working distance with its
/// backlash.
#[test]
fn a_moderate_centre_distance_runs() {
    let shifts = [0.52, 0.789];
    let is_negative = |warning: &Warning| matches!(warning.reason, WarningReason::NegativeBacklash { .. });
    let is_large = |warning: &Warning| matches!(warning.reason, WarningReason::LargeBacklash { .. });
    for (center_distance_mm, negative, large_backlash) in
        [(679.0, true, false), (680.0, false, false), (680.5, false, false), (682.0, false, true), (686.0, false, true)]
    {
        let found: Vec<Warning> = warnings(&large(center_distance_mm, shifts));
        assert_eq!(found.len(), usize::from(negative || large_backlash), "{center_distance_mm}: {found:#?}");
        assert_eq!(found.iter().any(is_negative), negative, "{center_distance_mm}: {found:#?}");
        assert_eq!(found.iter().any(is_large), large_backlash, "{center_distance_mm}: {found:#?}");
        for warning in &found {
            assert_eq!(warning.field, SpecField::CenterDistance);
            let (WarningReason::NegativeBacklash { fit, .. } | WarningReason::LargeBacklash { fit, .. }) =
                warning.reason
            else {
                panic!("{warning:?}")
            };
            close(fit.fitting_center_distance_m.unwrap_or(f64::NAN) * 1e3, 680.0007, 5e-5);
        }
    }
}

/// Faults of the teeth stay theirs, whatever the centre distance; an error of the centre distance is reported as one.
#[test]
fn blame_stays_where_it_belongs() {
    let low = |center_distance_m| PairSpec {
        center_distance_m,
        ..spec(4.0, 20.0, 0.0, 40.0, stub(0.45, 20), stub(0.45, 60))
    };
    for center_distance_m in [None, Some(0.16), Some(0.1602)] {
        let reasons = refused(&low(center_distance_m));
        let field = SpecField::Member(MemberId::Pinion, GearField::Addendum);
        assert_eq!(reasons[0].field, field, "{reasons:?}");
    }
    let mut pulled = PairSpec { center_distance_m: Some(0.201), ..worked_pair() };
    pulled.assembly.center_distance_error_m = -5e-3;
    assert_eq!(refused(&pulled)[0].field, SpecField::Assembly(AssemblyField::CenterDistanceError));
}

/// Ordinary pairs are what their formulas (ISO 21771) give, to the last bit.
#[test]
fn ordinary_pairs_keep_their_bits() {
    let mut working = worked_pair();
    working.center_distance_m = Some(0.2012);
    working.assembly.center_distance_error_m = 2e-5;
    for spec in
        [worked_pair(), source_pair(1.0), source_pair(1.123), undercut_pair(), working, large(680.0, [0.52, 0.789])]
    {
        let p = pair(&spec);
        let inv = |t: f64| t - t.atan();
        let beta = spec.helix_angle_rad;
        let alpha_n = spec.normal_pressure_angle_rad;
        let alpha_t = (alpha_n.tan() / beta.cos()).atan();
        let base_sum = p.pinion.base_radius_m + p.gear.base_radius_m;
        let shifts = p.pinion.profile_shift + p.gear.profile_shift;
        let zero_play = inv(alpha_t.tan()) + 2.0 * alpha_n.tan() * shifts / f64::from(p.pinion.teeth + p.gear.teeth);
        if let Some(a) = spec.center_distance_m {
            assert_eq!(p.center_distance_m.to_bits(), (a + spec.assembly.center_distance_error_m).to_bits());
        }
        let alpha_wt = (base_sum / p.center_distance_m).acos();
        assert_eq!(p.working_pressure_angle_rad.to_bits(), alpha_wt.to_bits());
        let length = base_sum * alpha_wt.tan();
        let start = (length - p.gear.tip_roll_m()).max(p.pinion.root_form_roll_m());
        let end = p.pinion.tip_roll_m().min(length - p.gear.root_form_roll_m());
        assert_eq!(
            [p.line_of_action_m, p.path_start_m, p.path_end_m].map(f64::to_bits),
            [length, start, end].map(f64::to_bits)
        );
        assert_eq!(p.transverse_contact_ratio.to_bits(), ((end - start) / p.base_pitch_m).to_bits());
        let play = 2.0 * base_sum * (inv(alpha_wt.tan()) - zero_play);
        assert_eq!(p.geometric_backlash_m.to_bits(), play.to_bits());
        // The corner gap of a tip that stays short of the mate's base tangent point.
        let (a, r, overrun) = (p.center_distance_m, p.gear.tip_radius_m, 0.03 * p.base_pitch_m);
        if p.path_start_m == length - p.gear.tip_roll_m() {
            let begin = (p.gear.base_radius_m / r).clamp(-1.0, 1.0).acos() - alpha_wt;
            let turn = (overrun - 0.0) / p.gear.base_radius_m;
            let gamma = begin + turn;
            let phi = |gamma: f64| (r * gamma.sin()).atan2(a - r * gamma.cos());
            let flank = ((a - r).powi(2) + 4.0 * a * r * (0.5 * gamma).sin().powi(2)).sqrt();
            let base = p.pinion.base_radius_m;
            let ratio = f64::from(p.gear.teeth) / f64::from(p.pinion.teeth);
            let at_start = (length - p.gear.tip_roll_m()).hypot(base);
            let roll = ((at_start - base) * (at_start + base)).max(0.0).sqrt();
            let ahead = p.pinion.base_half_angle_rad - inv(roll / base) - p.pinion.half_angle_rad(flank);
            let gap = base * (ratio * turn - (phi(gamma) - phi(begin)) + ahead);
            close(p.mesh_in_corner_gap_m(overrun).unwrap_or(f64::NAN), gap, 1e-16);
        }
    }
}
