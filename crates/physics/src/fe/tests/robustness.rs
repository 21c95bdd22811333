//! Every feasible tooth can be meshed.

use crate::fe::section::SectionMesh;
use crate::fe::sizes::Sizes;
use crate::fe::surface::InvoluteFlank;
use crate::fe::{FeError, FlankFlexibility, FlankFlexibilityInput, Resolution};
use crate::gear::{GearSpec, MemberId, Pair, fixtures};
use crate::watch::Watch;

#[test]
fn every_feasible_form_is_meshed() {
    let (mut feasible, mut undercut, mut failed) = (0, 0, Vec::new());
    for teeth in [5, 7, 10, 14, 20, 40, 150, 1000] {
        for shift in [-0.5, 0.0, 0.4, 0.8] {
            for beta in [0.0, 20.0, 45.0] {
                for alpha in [14.5, 20.0, 27.0] {
                    for (addendum, dedendum, fillet) in [
                        (1.0, 1.25, 0.38),
                        (1.0, 1.25, 0.0),
                        (0.8, 1.0, 0.3),
                        (1.4, 1.65, 0.2),
                        (1.0, 1.4, 0.45),
                        (0.3, 0.5, 0.05),
                    ] {
                        let own =
                            GearSpec { addendum, dedendum, fillet_radius: fillet, ..fixtures::gear(teeth, shift) };
                        let mate = GearSpec { addendum, dedendum, fillet_radius: fillet, ..fixtures::gear(60, 0.0) };
                        let Ok((pair, _)) = Pair::new(&fixtures::spec(4.0, alpha, beta, 40.0, own, mate)) else {
                            continue;
                        };
                        feasible += 1;
                        undercut += usize::from(pair.pinion.is_undercut());
                        let member = &pair.pinion;
                        let root = member.root_radius_m;
                        let involute = InvoluteFlank::new(member).unwrap();
                        for resolution in [Resolution::Coarse, Resolution::Fine] {
                            for hold in [root - 0.5e-3 * 4.0, 0.3 * root] {
                                let profile: Vec<f64> =
                                    (0..=10).map(|i| involute.length_m * f64::from(i) / 10.0).collect();
                                let sizes = Sizes::new(resolution).section;
                                if let Err(error) = SectionMesh::new(member, &involute, 4e-3, hold, &profile, &sizes) {
                                    failed.push((teeth, shift, beta, alpha, addendum, fillet, resolution, error));
                                }
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(feasible > 200 && undercut > 20, "{feasible} feasible, {undercut} undercut");
    assert!(failed.is_empty(), "{} of {feasible}: {:?}", failed.len(), &failed[..failed.len().min(5)]);
}

#[test]
fn extreme_gears_are_solved() {
    // Teeth, helix angle, width over module, depth of the rim over module.
    for (teeth, beta, width, rim) in [(9, 30.0, 4.0, 3.0), (300, 0.0, 2.0, 1.0), (120, 45.0, 16.0, 0.5)] {
        let spec = fixtures::spec(2.0, 20.0, beta, 2.0 * width, fixtures::gear(teeth, 0.4), fixtures::gear(60, 0.0));
        let (pair, _) = Pair::new(&spec).unwrap();
        let hold = pair.pinion.root_radius_m - rim * 2e-3;
        let flank = FlankFlexibility::new(
            &FlankFlexibilityInput::new(&pair, MemberId::Pinion, hold, 1, Resolution::Coarse),
            Watch::none(),
        )
        .unwrap();
        let n = flank.nodes();
        let bulk = flank.bulk(0).unwrap();
        assert!(bulk.iter().all(|v| v.is_finite()));
        assert!((0..n).all(|a| flank.total(0, a, a).unwrap() > 0.0));
        // A load moves its own place more than the next tooth.
        let next = flank.bulk(1).unwrap();
        assert!((0..n).all(|a| flank.total(0, a, a).unwrap() > next[a * n + a]));
    }
}

#[test]
fn a_body_without_rim_is_refused() {
    let gear = fixtures::gear(20, 0.0);
    let (pair, _) = Pair::new(&fixtures::spec(3.0, 20.0, 20.0, 24.0, gear, gear)).unwrap();
    for hold in [0.0, -1.0, f64::NAN, pair.pinion.root_radius_m, 1.0] {
        let input = FlankFlexibilityInput::new(&pair, MemberId::Pinion, hold, 0, Resolution::Coarse);
        assert!(matches!(FlankFlexibility::new(&input, Watch::none()), Err(FeError::NoRim { .. })), "{hold}");
    }
}
