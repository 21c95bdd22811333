//! Designs that cannot run, each with its reason and limit; and no design fails otherwise.

use crate::gear::feasibility::FILLET_CUT_LIMIT;
use crate::gear::fixtures::{gear, source_pair, spec, undercut_pair, worked_pair};
use crate::gear::{
    FlankModification, GearField, GearSpec, Half, Infeasibility, InfeasibilityReason as Reason, MemberId, Pair,
    PairSpec, ReliefShape, SpecField, TipRelief, WarningReason,
};
use herringbone_oracle::Tolerance::Absolute;
use herringbone_oracle::check;
use proptest::prelude::*;

fn reasons(spec: &PairSpec) -> Vec<Infeasibility> {
    Pair::new(spec).err().unwrap_or_default()
}

fn warnings(spec: &PairSpec) -> Vec<WarningReason> {
    Pair::new(spec).map(|(_, warnings)| warnings.into_iter().map(|w| w.reason).collect()).unwrap_or_default()
}

#[test]
fn reports_every_reason_at_once() {
    let mut wild = worked_pair();
    wild.gear.addendum = 1.9;
    wild.pinion.addendum = 1.9;
    wild.pinion.bore_radius_m = 0.05;
    wild.pinion.fillet_radius = 0.9;
    let found = reasons(&wild);
    let has = |of: fn(&Reason) -> bool| found.iter().any(|found| of(&found.reason));
    assert!(has(|reason| matches!(reason, Reason::TipInterference { .. })), "{found:?}");
    assert!(has(|reason| matches!(reason, Reason::PointedTip { .. })), "{found:?}");
    assert!(has(|reason| matches!(reason, Reason::BoreTooLarge { .. })), "{found:?}");
    assert!(has(|reason| matches!(reason, Reason::NoTipClearance { .. })), "{found:?}");
    assert!(has(|reason| matches!(reason, Reason::FilletRadiusTooLarge { .. })), "{found:?}");
}

#[test]
fn stated_values_out_of_range() {
    let mut wrong = worked_pair();
    wrong.gap_width_m = -1e-3;
    wrong.face_width_m = f64::NAN;
    wrong.pinion.teeth = 3;
    let fields: Vec<SpecField> = reasons(&wrong).into_iter().map(|r| r.field).collect();
    for field in [SpecField::GapWidth, SpecField::FaceWidth, SpecField::Member(MemberId::Pinion, GearField::Teeth)] {
        assert!(fields.contains(&field), "{field:?} is not in {fields:?}");
    }
}

#[test]
fn center_distance_below_the_base_circles() {
    let found = reasons(&PairSpec { center_distance_m: Some(0.18), ..worked_pair() });
    let limit_m = found.iter().find_map(|found| match found.reason {
        Reason::CenterDistanceTooSmall { base_radius_sum_m, .. } => Some(base_radius_sum_m),
        _ => None,
    });
    let limit_mm = limit_m.unwrap_or_else(|| panic!("{found:?}")) * 1e3;
    let topic = "Geometry: limits of feasible designs";
    check(topic, "least centre distance of the worked example, mm", limit_mm, 186.63513, Absolute(2e-5));
}

#[test]
fn warns_about_undercut_thin_tips_rims_and_jamming_teeth() {
    let has = |spec: &PairSpec, of: fn(&WarningReason) -> bool| warnings(spec).iter().any(of);
    assert!(has(&undercut_pair(), |reason| matches!(reason, WarningReason::Undercut { .. })));
    let mut thin = worked_pair();
    thin.pinion.bore_radius_m = 0.040;
    assert!(has(&thin, |reason| matches!(reason, WarningReason::ThinRim { .. })));
    let tight = PairSpec { center_distance_m: Some(0.2009), ..worked_pair() };
    assert!(has(&tight, |reason| matches!(reason, WarningReason::NegativeBacklash { .. })));
    let pointed = GearSpec { addendum: 1.0, ..gear(14, 0.75) };
    let pointed = spec(5.0, 20.0, 5.0, 40.0, pointed, gear(67, 0.0));
    assert!(has(&pointed, |reason| matches!(reason, WarningReason::ThinTip { .. })));
    assert_eq!(warnings(&worked_pair()), []);
}

/// A tip that reaches below the form circle meets the fillet: the cut grows with the addendum until it is refused.
#[test]
fn fillet_interference_grows_with_the_addendum() {
    let with = |addendum| {
        let side = |teeth| GearSpec { addendum, ..gear(teeth, 0.0) };
        PairSpec { pinion: side(17), gear: side(44), ..source_pair(1.0) }
    };
    assert_eq!(warnings(&with(1.10)), []);
    assert!(matches!(warnings(&with(1.14))[..], [WarningReason::FilletInterference { .. }]));
    let depth = |addendum: f64| {
        let found = reasons(&with(addendum));
        let cut = found.iter().find_map(|found| match found.reason {
            Reason::FilletInterference { cut, .. } => Some(cut),
            _ => None,
        });
        cut.unwrap_or_else(|| panic!("{addendum}: {found:?}"))
    };
    assert!(depth(1.18) < depth(1.20) && depth(1.20) < depth(1.22));
}

fn any_gear() -> impl Strategy<Value = GearSpec> {
    (5_u32..300, -1.5..2.0_f64, 0.3..1.8_f64, 0.5..2.2_f64, 0.0..0.6_f64, -0.3..0.1_f64, 0.0..0.1_f64).prop_map(
        |(teeth, profile_shift, addendum, dedendum, fillet_radius, tip_alteration, bore_radius_m)| GearSpec {
            profile_shift,
            addendum,
            dedendum,
            fillet_radius,
            tip_alteration,
            bore_radius_m,
            flanks: [FlankModification {
                tip_relief: TipRelief { amount_m: 1e-5, length_m: 3e-3, shape: ReliefShape::Linear },
                ..FlankModification::NONE
            }; 2],
            ..GearSpec::plain(teeth)
        },
    )
}

fn any_spec() -> impl Strategy<Value = PairSpec> {
    (
        any_gear(),
        any_gear(),
        0.2..20.0_f64,
        10.0..30.0_f64,
        0.0..45.0_f64,
        1.0..200.0_f64,
        prop::option::of(-0.05..0.05_f64),
    )
        .prop_map(|(pinion, gear, module_mm, alpha, beta, width, stretch)| {
            let mut s = spec(module_mm, alpha, beta, width, pinion, gear);
            let sum = f64::from(pinion.teeth + gear.teeth);
            let reference = 0.5 * sum * s.normal_module_m / s.helix_angle_rad.cos();
            s.center_distance_m = stretch.map(|e| reference * (1.0 + e));
            s
        })
}

/// Near-standard gears, so that most designs are feasible.
fn plausible_spec() -> impl Strategy<Value = PairSpec> {
    (12_u32..120, 12_u32..200, 0.0..40.0_f64, -0.1..0.5_f64, -0.3..0.3_f64, 0.8..1.1_f64).prop_map(
        |(z1, z2, beta, x1, x2, addendum)| {
            let with = |z, x| GearSpec { addendum, dedendum: addendum + 0.25, fillet_radius: 0.25, ..gear(z, x) };
            spec(4.0, 20.0, beta, 40.0, with(z1, x1), with(z2, x2))
        },
    )
}

/// True for a feasible design; its numbers, or those of the refusal, are finite.
fn check_finite(spec: &PairSpec) -> Result<bool, TestCaseError> {
    match Pair::new(spec) {
        Err(reasons) => {
            prop_assert!(!reasons.is_empty());
            for reason in reasons {
                let shown = format!("{reason:?}");
                prop_assert!(!shown.contains("NaN") && !shown.contains("inf"), "{shown}");
            }
            Ok(false)
        }
        Ok((p, _)) => check_pair(&p).map(|()| true),
    }
}

fn check_pair(p: &Pair) -> Result<(), TestCaseError> {
    prop_assert!(p.transverse_contact_ratio > 0.0 && p.overlap_ratio >= 0.0);
    prop_assert!(p.transverse_contact_ratio >= 1.0 || p.total_contact_ratio() > 1.0);
    prop_assert!(p.path_start_m >= 0.0 && p.path_end_m <= p.line_of_action_m);
    for member in [&p.pinion, &p.gear] {
        let span = member.tip_radius_m - member.root_radius_m;
        let join = member.root_form_radius_m;
        let step = member.half_angle_rad(join * (1.0 - 1e-12)) - member.half_angle_rad(join);
        prop_assert!(step.abs() < 1e-6, "step of {step} rad at the join");
        for i in 0..=40 {
            let half = member.half_angle_rad(member.root_radius_m + span * f64::from(i) / 40.0);
            prop_assert!(half.is_finite() && half > 0.0, "half angle {half}");
        }
    }
    for i in 0..=20 {
        let overrun = 0.02 * f64::from(i) * p.base_pitch_m;
        for gap in [p.mesh_in_corner_gap_m(overrun), p.mesh_out_corner_gap_m(overrun)].into_iter().flatten() {
            // A tip may cut so far into the generated profile before the pair is refused.
            let allowed_m = FILLET_CUT_LIMIT * p.spec.normal_module_m;
            prop_assert!(gap.is_finite() && gap > -allowed_m, "gap {gap}");
        }
        let x = p.path_start_m + p.base_pitch_m * 0.1 * f64::from(i);
        prop_assert!(p.initial_gap_m(Half::Left, x, 0.0).is_finite());
        prop_assert!(p.contact_length_m(x).is_finite());
    }
    Ok(())
}

proptest! {
    // Infeasible designs do not count as plausible cases; that they do not prevail is asserted by the limit of their
    // number.
    #![proptest_config(ProptestConfig { cases: 2000, max_global_rejects: 4000, ..ProptestConfig::default() })]

    #[test]
    fn wild_designs_are_solved_or_refused(spec in any_spec()) {
        check_finite(&spec)?;
    }

    #[test]
    fn plausible_designs_are_solved(spec in plausible_spec()) {
        prop_assume!(check_finite(&spec)?);
    }
}
