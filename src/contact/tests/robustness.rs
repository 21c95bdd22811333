//! Wild inputs: every feasible pair under every load gives finite, non-negative forces.

use proptest::prelude::*;

use crate::contact::{BodyHold, Compliance, Settings, solve_pair_of_halves};
use crate::gear::{Pair, ReliefShape, TipRelief};
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
        let Ok((pair, _)) = Pair::new(&spec) else { return Ok(()) };
        let settings = Settings {
            positions: Some(6),
            accuracy: 1e-3,
            slices: Some(12),
            body: if bore_hold { BodyHold::Bore } else { BodyHold::Rim },
            corner_contact,
        };
        let torque = 10f64.powf(torque_exponent);
        let both = solve_pair_of_halves(&pair, torque, 0.3, &Compliance::analytic(&pair, &settings), &settings, Watch::none());
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
