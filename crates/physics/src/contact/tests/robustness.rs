//! Wild inputs: every feasible pair under every load gives finite, non-negative forces.

use proptest::prelude::*;

use crate::compliance::{BodyHold, Compliance, Settings};
use crate::contact::{solve_half, solve_pair_of_halves};
use crate::fe::{FlankFlexibility, Resolution};
use crate::gear::{Half, Pair, ReliefShape, TipRelief};
use crate::watch::Watch;

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    #[test]
    fn any_feasible_pair_converges(
        teeth in (8u32..120, 12u32..300),
        helix_deg in prop_oneof![Just(0.0), 0.0..45.0f64],
        width_modules in 2.0..30.0f64,
        torque_exponent in -3.0..6.0f64,
        errors in (0.0..300e-6f64, -200e-6..200e-6f64, 0.0..200e-6f64),
        shift in 0.0..0.6f64,
        bore_hold in any::<bool>(),
        corner_contact in any::<bool>(),
    ) {
        let mut spec = super::spec([teeth.0, teeth.1], helix_deg, width_modules * 4e-3);
        spec.pinion.profile_shift = shift;
        spec.pinion.flanks[0].tip_relief =
            TipRelief { amount_m: errors.0, length_m: 3e-3, shape: ReliefShape::Linear };
        spec.assembly.in_plane_misalignment_m = errors.1;
        spec.gear.flanks[1].helix_slope_m = errors.2;
        // Infeasible designs are no cases: all 16 are solved.
        let Ok((pair, _)) = Pair::new(&spec) else { return Err(TestCaseError::reject("infeasible")) };
        let settings = Settings {
            positions: Some(6),
            accuracy: 1e-3,
            slices: Some(12),
            body: if bore_hold { BodyHold::Bore } else { BodyHold::Rim },
            corner_contact,
        };
        let torque = 10f64.powf(torque_exponent);
        let both = solve_pair_of_halves(&pair, torque, 0.3, &Compliance::analytic(&pair, &settings, Watch::none()).expect("not canceled"), &settings, Watch::none());
        let both = both.map_err(|e| TestCaseError::fail(format!("{e}")))?;
        for half in &both.halves {
            for i in 0..6 {
                prop_assert!(half.transmission_error_m[i].is_finite() && half.transmission_error_m[i] > 0.0);
                prop_assert!(half.stiffness_n_per_m[i].is_finite() && half.stiffness_n_per_m[i] > 0.0);
            }
            prop_assert!(half.load_share.iter().all(|&s| (0.0..=1.0 + 1e-9).contains(&s)));
            prop_assert!(half.load_share_at_mesh_in.is_finite());
        }
    }
}

/// Steps of the stiffness between neighbouring positions, over its mean: halving the distance of the positions has to
/// make them smaller, down to the share of a single slice that comes into contact.
#[test]
fn steps_of_the_stiffness_shrink_with_the_distance_of_the_positions() {
    const SLICE: f64 = 2e-3;
    let mut relieved = super::spec([24, 61], 18.0, 40e-3);
    relieved.pinion.flanks[0].tip_relief = TipRelief { amount_m: 20e-6, length_m: 4e-3, shape: ReliefShape::Parabolic };
    let mut misaligned = super::spec([17, 44], 33.0, 60e-3);
    misaligned.assembly.in_plane_misalignment_m = 30e-6;
    for spec in [super::spec([29, 67], 30.0, 45e-3), super::spec([30, 31], 8.0, 30e-3), relieved, misaligned] {
        let pair = super::pair(&spec);
        for corner_contact in [true, false] {
            let settings = Settings { corner_contact, ..Settings::default() };
            let compliance = Compliance::analytic(&pair, &settings, Watch::none()).expect("not canceled");
            let largest = |positions: usize| {
                let settings = Settings { positions: Some(positions), ..settings };
                let cycle = solve_half(&pair, Half::Left, 6e3, &compliance, &settings, Watch::none()).unwrap();
                let k = &cycle.stiffness_n_per_m;
                let step = |i: usize| (k[(i + 1) % positions] - k[i]).abs() / cycle.stiffness.mean;
                (0..positions).map(step).fold(0.0, f64::max)
            };
            let [coarse, fine] = [64, 128].map(largest);
            assert!(fine < 0.75 * coarse + SLICE, "{coarse} {fine}, corner contact {corner_contact}, {spec:?}");
        }
    }
}

/// A torque at which one half alone carries (the other is held open), a gap beyond all deflection, tooth numbers and
/// helix angles at their ends: what has broken before, or nearly.
#[test]
fn extremes_converge() {
    for (teeth, helix_deg, width_modules, torque_nm, gap_m) in [
        ([8u32, 300u32], 45.0, 12.0, 1e3, 0.0),
        ([12, 12], 0.0, 10.0, 1e-3, 1e-3),
        ([20, 300], 0.0, 3.0, 1e6, 1e-4),
        ([38, 38], 33.0, 29.0, 1e5, 0.0),
        ([60, 90], 0.5, 30.0, 1e-3, 2e-4),
    ] {
        let mut spec = super::spec(teeth, helix_deg, width_modules * 4e-3);
        spec.pinion.profile_shift = if teeth[0] < 17 { 0.5 } else { 0.0 };
        spec.pinion.flanks[1].lead_crowning_m = gap_m;
        spec.assembly.apex_offset_m = gap_m;
        spec.assembly.in_plane_misalignment_m = 5.0 * gap_m;
        let pair = super::pair(&spec);
        let settings = Settings { positions: Some(12), ..Settings::default() };
        let compliance = Compliance::analytic(&pair, &settings, Watch::none()).expect("not canceled");
        let both = solve_pair_of_halves(&pair, torque_nm, 0.0, &compliance, &settings, Watch::none())
            .unwrap_or_else(|error| panic!("{teeth:?}, {helix_deg} deg, {torque_nm} N m: {error}"));
        for half in &both.halves {
            assert!(half.stiffness_n_per_m.iter().all(|k| k.is_finite() && *k > 0.0));
        }
    }
}

/// Finite elements of two small gears under loads far apart and a face that touches on a small part only.
#[test]
fn finite_elements_converge_under_any_load() {
    let mut spec = super::spec([14, 19], 20.0, 12e-3);
    spec.pinion.profile_shift = 0.2;
    let plain = super::pair(&spec);
    let settings = Settings { positions: Some(8), ..Settings::default() };
    let [pinion, gear] = Compliance::finite_element_inputs(&plain, &settings, Resolution::Coarse)
        .map(|input| FlankFlexibility::new(&input, Watch::none()).unwrap());
    for misalignment_m in [0.0, 20e-6, 1e-3] {
        spec.assembly.in_plane_misalignment_m = misalignment_m;
        let pair = super::pair(&spec);
        let compliance =
            Compliance::finite_elements(&pair, &settings, [&pinion, &gear], Watch::none()).expect("not canceled");
        for torque_nm in [1e-3, 1.0, 1e3, 1e6] {
            let both = solve_pair_of_halves(&pair, torque_nm, 0.0, &compliance, &settings, Watch::none())
                .unwrap_or_else(|error| panic!("{misalignment_m} m, {torque_nm} N m: {error}"));
            for half in &both.halves {
                assert!(half.stiffness_n_per_m.iter().all(|k| k.is_finite() && *k > 0.0));
                assert!(half.load_share.iter().all(|s| (0.0..=1.0 + 1e-9).contains(s)));
            }
        }
    }
}
