//! The coast flanks under load: the mirrored pair run backwards against the pair with its members exchanged, in which
//! the gear is the driver in real time, and against the drive flanks.

use super::{pair, spec};
use crate::compliance::{Compliance, Settings};
use crate::contact::{LoadedContact, harmonics, solve_coast_halves, solve_pair_of_halves};
use crate::gear::{FlankModification, GearSpec, Pair, PairSpec, ReliefShape, TipRelief};
use crate::watch::Watch;
use herringbone_oracle::check_worst;
use std::f64::consts::TAU;

const TOPIC: &str = "Contact: coast flanks";

fn settings() -> Settings {
    Settings { positions: Some(48), ..Settings::default() }
}

fn relieved(um: f64) -> FlankModification {
    FlankModification {
        tip_relief: TipRelief { amount_m: um * 1e-6, length_m: 4e-3, shape: ReliefShape::Linear },
        helix_slope_m: 0.5 * um * 1e-6,
        ..FlankModification::NONE
    }
}

/// Members as unlike as they can be, so that no symmetry hides a wrong direction.
fn unlike() -> PairSpec {
    let mut base = spec([18, 47], 18.0, 30e-3);
    base.pinion.coast_flanks = Some([relieved(9.0), relieved(4.0)]);
    base.gear.coast_flanks = Some([relieved(2.0), relieved(0.0)]);
    base.pinion.flanks = [relieved(30.0); 2];
    base
}

fn coast(pair: &Pair, torque_nm: f64, stagger: f64) -> LoadedContact {
    let compliance = Compliance::analytic(pair, &settings(), Watch::none()).expect("not canceled");
    solve_coast_halves(pair, torque_nm, stagger, &compliance, &settings(), Watch::none()).unwrap()
}

fn drive(pair: &Pair, torque_nm: f64, stagger: f64) -> LoadedContact {
    let compliance = Compliance::analytic(pair, &settings(), Watch::none()).expect("not canceled");
    solve_pair_of_halves(pair, torque_nm, stagger, &compliance, &settings(), Watch::none()).unwrap()
}

/// Phase of harmonic `h` of equally spaced values, in periods.
fn angle(values: &[f64], h: f64) -> f64 {
    let n = values.len() as f64;
    let (mut re, mut im) = (0.0, 0.0);
    for (i, v) in values.iter().enumerate() {
        let (sin, cos) = (TAU * h * i as f64 / n).sin_cos();
        re += v * cos;
        im += v * sin;
    }
    im.atan2(re) / TAU
}

#[test]
fn coasting_is_the_exchanged_pair_driving() {
    let base = unlike();
    let real = pair(&base);
    let exchanged = pair(&PairSpec {
        pinion: GearSpec { flanks: base.gear.coast_flanks.unwrap(), ..base.gear },
        gear: GearSpec { flanks: base.pinion.coast_flanks.unwrap(), ..base.pinion },
        ..base
    });
    let torque = 300.0;
    let stagger = 0.3;
    let got = coast(&real, torque, stagger);
    let ratio = exchanged.pinion.base_radius_m / real.pinion.base_radius_m;
    let expected = drive(&exchanged, torque * ratio, stagger);
    for ((got, expected), side) in got.halves.iter().zip(&expected.halves).zip(["left", "right"]) {
        let of = |what: &str| format!("{what}, {side} half against the exchanged pair");
        let [a, b] = [got, expected].map(|half| harmonics(&half.transmission_error_m));
        check_worst(
            TOPIC,
            &of("mean transmission error"),
            [got.transmission_error.mean / expected.transmission_error.mean - 1.0],
            2e-3,
        );
        check_worst(TOPIC, &of("mean stiffness"), [got.stiffness.mean / expected.stiffness.mean - 1.0], 2e-3);
        let scale = b[0];
        check_worst(TOPIC, &of("harmonics of the error"), a.iter().zip(&b).take(3).map(|(a, b)| (a - b) / scale), 0.03);
        // The course in time, whatever its start: 2 φ1 - φ2 turns its sign with the direction of time.
        let course = |values: &[f64]| 2.0 * angle(values, 1.0) - angle(values, 2.0);
        let difference = course(&got.transmission_error_m) - course(&expected.transmission_error_m);
        check_worst(TOPIC, &of("direction of time"), [(difference + 0.5).rem_euclid(1.0) - 0.5], 0.03);
        let reversed = course(&got.transmission_error_m) + course(&expected.transmission_error_m);
        assert!(((reversed + 0.5).rem_euclid(1.0) - 0.5).abs() > 0.06, "the pair cannot tell the direction: {side}");
        let share = got.load_share_at_mesh_in - expected.load_share_at_mesh_in;
        check_worst(TOPIC, &of("share at mesh-in"), [share], 0.01);
        let range = (0..2).map(|k| got.load_begins_and_ends[k] - expected.load_begins_and_ends[k]);
        check_worst(TOPIC, &of("begin and end of load"), range, 0.03);
    }
    // Left and right lie apart by the stagger, in the same sense.
    let lag = |contact: &LoadedContact| {
        let [left, right] = &contact.halves;
        angle(&right.transmission_error_m, 1.0) - angle(&left.transmission_error_m, 1.0)
    };
    let difference = lag(&got) - lag(&expected);
    check_worst(TOPIC, "stagger in time", [(difference + 0.5).rem_euclid(1.0) - 0.5], 0.03);
    assert_eq!(got.halves[0].phase[0], 0.0);
    assert!((got.halves[1].phase[0] - stagger).abs() < 1e-12);
}

/// Absolute phase: at every phase the coast contact is that of the mirrored pair at its coast phase.
#[test]
fn every_phase_is_that_of_the_mirrored_pair() {
    let real = pair(&unlike());
    let mirrored = real.coast();
    let compliance = Compliance::analytic(&real, &settings(), Watch::none()).expect("not canceled");
    let got = solve_coast_halves(&real, 300.0, 0.0, &compliance, &settings(), Watch::none()).unwrap();
    let force = 150.0 / real.pinion.base_radius_m;
    for (half, side) in got.halves.iter().zip(crate::gear::Half::BOTH) {
        let mut contact = crate::contact::HalfContact::new(&mirrored, side, &compliance, &settings(), Watch::none());
        let errors = half.phase.iter().zip(&half.transmission_error_m).step_by(5).map(|(phase, error)| {
            let state = contact.at(real.coast_phase(*phase), force).unwrap();
            error / state.approach_m - 1.0
        });
        check_worst(TOPIC, &format!("phase by phase, {side:?} half"), errors.collect::<Vec<_>>(), 1e-6);
    }
    // The axial shift is the real pinion's: it closes the left half's drive flanks, so it opens its coast flanks.
    let tan = real.base_helix_angle_rad.tan();
    let [left, right] = &got.halves;
    for ((l, r), shift) in left.transmission_error_m.iter().zip(&right.transmission_error_m).zip(&got.axial_shift_m) {
        assert!((shift * 2.0 * tan - (r - l)).abs() < 1e-15);
    }
}

/// Without `coast` the flanks are those of the drive side; spur halves share by deflection on this side too.
#[test]
fn alike_flanks_are_alike_on_both_sides() {
    for helix in [0.0, 24.0] {
        let base = PairSpec {
            pinion: GearSpec { flanks: [relieved(8.0); 2], ..spec([25, 25], helix, 20e-3).pinion },
            ..spec([25, 25], helix, 20e-3)
        };
        let base = PairSpec { gear: base.pinion, ..base };
        let real = pair(&base);
        for stagger in [0.0, 0.4] {
            let (coast, drive) = (coast(&real, 200.0, stagger), drive(&real, 200.0, stagger));
            // Of equal gears the exchanged pair is the pair itself.
            for ((c, d), side) in coast.halves.iter().zip(&drive.halves).zip(["left", "right"]) {
                let means = [
                    c.transmission_error.mean / d.transmission_error.mean - 1.0,
                    c.stiffness.mean / d.stiffness.mean - 1.0,
                ];
                let quantity = format!("equal gears on either side, helix {helix}°, stagger {stagger}, {side} half");
                check_worst(TOPIC, &quantity, means, 2e-3);
            }
            assert_eq!(coast.equal_halves, drive.equal_halves);
        }
    }
}
