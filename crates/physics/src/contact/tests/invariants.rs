//! Properties that hold for any numbers.

use std::f64::consts::PI;

use super::{pair, spec};
use crate::compliance::Stencil;
use crate::compliance::{BodyHold, Compliance, Settings};
use crate::contact::distribution::{Prescribed, distribute};
use crate::contact::lines::{CornerGaps, PairRange, collect, reference_roll_m};
use crate::contact::system::{ContactSystem, LocalApproach, SystemWorkspace};
use crate::contact::{HalfContact, solve_half, solve_pair_of_halves};
use crate::gear::{Half, ReliefShape, TipRelief};
use crate::watch::{Meter, Watch};
use herringbone_oracle::Tolerance::Relative;
use herringbone_oracle::{check, check_worst};

const TOPIC: &str = "Contact: balances of the loaded analysis";

fn quick() -> Settings {
    Settings { positions: Some(16), slices: Some(20), ..Settings::default() }
}

#[test]
fn forces_balance_and_never_pull() {
    let pair = pair(&spec([29, 67], 30.0, 45e-3));
    let (mut balance, mut least) = (Vec::new(), f64::INFINITY);
    for body in [BodyHold::Rim, BodyHold::Bore] {
        let settings = Settings { body, ..quick() };
        let compliance = Compliance::analytic(&pair, &settings, Watch::none()).expect("not canceled");
        let mut contact = HalfContact::new(&pair, Half::Left, &compliance, &settings, Watch::none());
        for force in [0.1, 4e3, 4e6] {
            for i in 0..16 {
                let state = contact.at(f64::from(i) / 16.0, force).unwrap();
                let sum: f64 = state.forces_n.iter().sum();
                balance.push(sum * pair.base_helix_angle_rad.cos() / force - 1.0);
                least = state.forces_n.iter().fold(least, |least, &f| least.min(f));
                assert!(state.approach_m > 0.0 && state.stiffness_n_per_m > 0.0);
            }
        }
    }
    check_worst(TOPIC, "sum of the normal forces × cos β_b over the force of the torque", balance, 1e-9);
    check_worst(TOPIC, "pull: least normal force below zero, N", [least.min(0.0)], 0.0);
}

#[test]
fn equal_halves_are_solved_once_and_share_equally() {
    let pair = pair(&spec([29, 67], 30.0, 45e-3));
    let both = solve_pair_of_halves(
        &pair,
        500.0,
        0.0,
        &Compliance::analytic(&pair, &quick(), Watch::none()).expect("not canceled"),
        &quick(),
        Watch::none(),
    )
    .unwrap();
    assert!(both.equal_halves);
    assert_eq!(both.halves[0], both.halves[1]);
    assert!(both.axial_shift_m.iter().all(|&u| u == 0.0));
    let tan = pair.base_helix_angle_rad.tan();
    let axial = 250.0 / pair.pinion.base_radius_m * tan;
    check(TOPIC, "axial force of a half at 500 N m, N", both.axial_force_n[0], axial, Relative(1e-12));
}

#[test]
fn a_stagger_moves_the_right_half_along_its_own_curve() {
    let pair = pair(&spec([29, 67], 30.0, 45e-3));
    let both = solve_pair_of_halves(
        &pair,
        500.0,
        0.25,
        &Compliance::analytic(&pair, &quick(), Watch::none()).expect("not canceled"),
        &quick(),
        Watch::none(),
    )
    .unwrap();
    let [left, right] = &both.halves;
    let mut errors = Vec::new();
    for i in 0..16 {
        let (r, l) = (right.transmission_error_m[i], left.transmission_error_m[(i + 4) % 16]);
        errors.push(r / l - 1.0);
    }
    check_worst(TOPIC, "staggered half against the same half a quarter of a period later", errors, 1e-6);
}

#[test]
fn spur_halves_without_axial_coupling_deflect_equally() {
    let mut spec = spec([29, 67], 0.0, 30e-3);
    spec.pinion.flanks[1].lead_crowning_m = 10e-6;
    let pair = pair(&spec);
    let both = solve_pair_of_halves(
        &pair,
        200.0,
        0.0,
        &Compliance::analytic(&pair, &quick(), Watch::none()).expect("not canceled"),
        &quick(),
        Watch::none(),
    )
    .unwrap();
    let [left, right] = &both.halves;
    let total = 200.0 / pair.pinion.base_radius_m;
    let (mut deflections, mut forces) = (Vec::new(), Vec::new());
    for i in 0..16 {
        deflections.push(left.transmission_error_m[i] / right.transmission_error_m[i] - 1.0);
        forces.push((left.force_bt_n[i] + right.force_bt_n[i]) / total - 1.0);
        assert!(left.force_bt_n[i] > right.force_bt_n[i]);
    }
    check_worst(TOPIC, "unequal spur halves: deflection of one over the other", deflections, 1e-8);
    check_worst(TOPIC, "unequal spur halves: forces of both over the force of the torque", forces, 1e-9);
}

#[test]
fn shares_of_all_pairs_make_one() {
    let pair = pair(&spec([29, 67], 30.0, 45e-3));
    let cycle = solve_half(
        &pair,
        Half::Left,
        4e3,
        &Compliance::analytic(&pair, &quick(), Watch::none()).expect("not canceled"),
        &quick(),
        Watch::none(),
    )
    .unwrap();
    let sums = (0..16).map(|i| {
        let sum: f64 = cycle.load_share.iter().skip(i).step_by(16).sum();
        sum - 1.0
    });
    check_worst(TOPIC, "shares of all pairs at a position against 1", sums, 1e-9);
    assert!(cycle.loaded_contact_ratio >= pair.total_contact_ratio() - 0.05);
    assert!(cycle.load_share_at_mesh_in > 0.0 && cycle.load_share_at_mesh_in < 0.2);
    assert!(cycle.entry.deflection_before_entry_m(0.0) > 0.0);
}

#[test]
fn integer_overlap_gives_a_nearly_constant_stiffness() {
    // b tanβ_b = 2 p_bt: the length of the contact lines does not vary.
    let helix = 25f64;
    let width = 2.0 * PI * 4e-3 / helix.to_radians().sin();
    let constant = pair(&spec([40, 60], helix, width));
    let other = pair(&spec([40, 60], helix, 0.8 * width));
    let spread = |pair| {
        let settings = Settings { corner_contact: false, positions: Some(16), slices: Some(48), ..Settings::default() };
        let cycle = solve_half(
            pair,
            Half::Left,
            1e4,
            &Compliance::analytic(pair, &settings, Watch::none()).expect("not canceled"),
            &settings,
            Watch::none(),
        )
        .unwrap();
        (cycle.stiffness.max - cycle.stiffness.min) / cycle.stiffness.mean
    };
    let (flat, wavy) = (spread(&constant), spread(&other));
    check_worst(TOPIC, "whole overlap ratio: swing of the stiffness over its mean", [flat], 0.025);
    assert!(wavy > 4.0 * flat, "{flat} {wavy}");
}

#[test]
fn a_canceled_analysis_stops() {
    let pair = pair(&spec([29, 67], 30.0, 45e-3));
    let watch = Watch::new(&|_| {}, &|| true);
    assert!(
        solve_half(
            &pair,
            Half::Left,
            1e3,
            &Compliance::analytic(&pair, &quick(), Watch::none()).expect("not canceled"),
            &quick(),
            watch
        )
        .is_err()
    );
}

/// Gu, Velex, Sainsot and Bruyère (2015), uniform stiffness per length of contact line:
/// k/k_m = 1 + 2 Σ sinc(n ε_α) sinc(n ε_β) cos[π n (2τ - ε_α - ε_β)].
#[test]
fn contact_lines_follow_the_uniform_series() {
    let sinc = |x: f64| if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
    for (teeth, helix, width) in [([29, 67], 30.0, 45e-3), ([40, 60], 12.0, 60e-3), ([17, 44], 24.43, 75e-3)] {
        let pair = pair(&spec(teeth, helix, width));
        let (ea, eb) = (pair.transverse_contact_ratio, pair.overlap_ratio);
        let reach = PairRange { lowest_pair: i32::MIN, corner_gap_m: 0.0, least_part_m: 0.0 };
        let (mut points, mut errors) = (Vec::new(), Vec::new());
        for i in 0..16 {
            let phase = (f64::from(i) + 0.5) / 16.0;
            collect(&pair, &CornerGaps::default(), Half::Left, (phase, 24), &reach, |_, _| 0.0, &mut points);
            let length: f64 = points.iter().map(|p| p.width_m).sum::<f64>() / (ea * width);
            let series: f64 = 1.0
                + 2.0
                    * (1..4000)
                        .map(f64::from)
                        .map(|n| sinc(n * ea) * sinc(n * eb) * (PI * n * (2.0 * phase - ea - eb)).cos())
                        .sum::<f64>();
            errors.push(length - series);
        }
        let quantity =
            format!("length of the contact lines over its mean, z {}/{}, helix {helix}°", teeth[0], teeth[1]);
        check_worst("Contact: uniform series of Gu, Velex and others", &quantity, errors, 1e-4);
    }
}

/// A foundation of constant stiffness per width instead of tooth, body and Hertzian contact: the force is the integral
/// of what the approach exceeds the gap by, c ∫ (δ - g)₊ dy over all lines. Unmodified flanks make that c δ times the
/// length of the lines, whose course is the series above; relief on both tips unloads the ends of the path.
#[test]
fn a_constant_foundation_gives_the_length_of_the_lines_and_relief_unloads_it() {
    struct Foundation(Vec<f64>);
    impl LocalApproach for Foundation {
        fn approach(&self, i: usize, force: f64) -> (f64, f64) {
            (force / self.0[i], 1.0 / self.0[i])
        }
    }
    const STIFFNESS: f64 = 15e9;
    let mut spec = spec([29, 67], 30.0, 45e-3);
    let (mut lengths, mut forces) = (Vec::new(), Vec::new());
    for relief_m in [0.0, 15e-6] {
        let relief = TipRelief { amount_m: relief_m, length_m: 6e-3, shape: ReliefShape::Parabolic };
        spec.pinion.flanks[0].tip_relief = relief;
        spec.gear.flanks[0].tip_relief = relief;
        let pair = pair(&spec);
        let cos = pair.base_helix_angle_rad.cos();
        let reach = PairRange { lowest_pair: i32::MIN, corner_gap_m: 0.0, least_part_m: 0.0 };
        let mut points = Vec::new();
        for i in 0..16 {
            let phase = (f64::from(i) + 0.5) / 16.0;
            collect(&pair, &CornerGaps::default(), Half::Left, (phase, 90), &reach, |_, _| 0.0, &mut points);
            let gaps: Vec<f64> = points.iter().map(|p| p.gap_m * cos).collect();
            let local = Foundation(points.iter().map(|p| STIFFNESS * p.width_m).collect());
            let stencils = vec![Stencil { first: 0, weights: [0.25; 4] }; points.len()];
            let lines: Vec<_> = std::iter::once(0..points.len()).collect();
            let system = ContactSystem {
                gaps: &gaps,
                stencils: &stencils,
                stations: 4,
                bulk: &[0.0; 16],
                lines: &lines,
                coupling: &[],
                local: &local,
                modes: &[],
            };
            let total = 4e3;
            let found = {
                let mut meter = Meter::new(Watch::none());
                distribute(&system, Prescribed::Force(total), &[], &mut SystemWorkspace::default(), &mut meter).unwrap()
            };
            if relief_m == 0.0 {
                let length: f64 = pair.contact_lines(reference_roll_m(&pair, phase)).iter().map(|l| l.width_m()).sum();
                lengths.push(found.stiffness / (STIFFNESS * length) - 1.0);
                lengths.push(found.approach * STIFFNESS * length / total - 1.0);
            } else {
                // The integral on a grid of its own, from the lines and the modification.
                const STEPS: usize = 4000;
                let sum: f64 = pair
                    .contact_lines(reference_roll_m(&pair, phase))
                    .iter()
                    .map(|line| {
                        let step = line.width_m() / STEPS as f64;
                        let exceeds = |k: usize| {
                            let part = (k as f64 + 0.5) / STEPS as f64;
                            let at = |[a, b]: [f64; 2]| a + (b - a) * part;
                            let gap = pair.initial_gap_m(Half::Left, at(line.x_m), pair.entry_m(at(line.entry_m)));
                            (found.approach - gap * cos).max(0.0)
                        };
                        (0..STEPS).map(exceeds).sum::<f64>() * step
                    })
                    .sum();
                forces.push(STIFFNESS * sum / total - 1.0);
                assert!(found.forces.contains(&0.0), "the tips are free");
            }
        }
    }
    let topic = "Contact: uniform series of Gu, Velex and others";
    check_worst(
        topic,
        "stiffness and approach of a constant foundation against the length of the lines",
        lengths,
        1e-9,
    );
    check_worst(TOPIC, "constant foundation under tip relief: force at the approach found", forces, 2e-3);
}
