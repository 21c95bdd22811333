//! What must hold whatever the numbers are.

use std::f64::consts::PI;

use super::{pair, spec};
use crate::contact::lines::{Reach, collect};
use crate::contact::{BodyHold, Compliance, HalfContact, Settings, solve_half, solve_pair_of_halves};
use crate::gear::Half;
use crate::watch::Watch;

fn quick() -> Settings {
    Settings { positions: 16, slices: Some(20), ..Settings::default() }
}

#[test]
fn forces_balance_and_never_pull() {
    let pair = pair(&spec([29, 67], 30.0, 45e-3));
    for body in [BodyHold::Rim, BodyHold::Bore] {
        let settings = Settings { body, ..quick() };
        let compliance = Compliance::new(&pair, &settings);
        let mut contact = HalfContact::new(&pair, Half::Left, &compliance, &settings);
        for force in [0.1, 4e3, 4e6] {
            for i in 0..16 {
                let state = contact.at(f64::from(i) / 16.0, force).unwrap();
                let sum: f64 = state.forces_n.iter().sum();
                assert!((sum * pair.base_helix_angle_rad.cos() / force - 1.0).abs() < 1e-9);
                assert!(state.forces_n.iter().all(|&f| f >= 0.0));
                assert!(state.approach_m > 0.0 && state.stiffness_n_per_m > 0.0);
            }
        }
    }
}

#[test]
fn equal_halves_are_solved_once_and_share_equally() {
    let pair = pair(&spec([29, 67], 30.0, 45e-3));
    let both = solve_pair_of_halves(&pair, 500.0, 0.0, &quick(), Watch::none()).unwrap();
    assert!(both.equal_halves);
    assert_eq!(both.halves[0], both.halves[1]);
    assert!(both.axial_shift_m.iter().all(|&u| u == 0.0));
    let tan = pair.base_helix_angle_rad.tan();
    let axial = 250.0 / pair.pinion.base_radius_m * tan;
    assert!((both.axial_force_n[0] / axial - 1.0).abs() < 1e-12);
}

#[test]
fn a_stagger_moves_the_right_half_along_its_own_curve() {
    let pair = pair(&spec([29, 67], 30.0, 45e-3));
    let both = solve_pair_of_halves(&pair, 500.0, 0.25, &quick(), Watch::none()).unwrap();
    let [left, right] = &both.halves;
    for i in 0..16 {
        let (r, l) = (right.transmission_error_m[i], left.transmission_error_m[(i + 4) % 16]);
        assert!((r / l - 1.0).abs() < 1e-8, "{i}: {r} {l}");
    }
}

#[test]
fn spur_halves_without_axial_coupling_deflect_equally() {
    let mut spec = spec([29, 67], 0.0, 30e-3);
    spec.pinion.flanks[1].lead_crowning_m = 10e-6;
    let pair = pair(&spec);
    let both = solve_pair_of_halves(&pair, 200.0, 0.0, &quick(), Watch::none()).unwrap();
    let [left, right] = &both.halves;
    let total = 200.0 / pair.pinion.base_radius_m;
    for i in 0..16 {
        assert!((left.transmission_error_m[i] / right.transmission_error_m[i] - 1.0).abs() < 1e-8);
        assert!(((left.force_bt_n[i] + right.force_bt_n[i]) / total - 1.0).abs() < 1e-9);
        assert!(left.force_bt_n[i] > right.force_bt_n[i]);
    }
}

#[test]
fn shares_of_all_pairs_make_one() {
    let pair = pair(&spec([29, 67], 30.0, 45e-3));
    let cycle = solve_half(&pair, Half::Left, 4e3, &quick(), Watch::none()).unwrap();
    for i in 0..16 {
        let sum: f64 = cycle.load_share.iter().skip(i).step_by(16).sum();
        assert!((sum - 1.0).abs() < 1e-9);
    }
    assert!(cycle.loaded_contact_ratio >= pair.total_contact_ratio() - 0.05);
    assert!(cycle.load_share_at_mesh_in > 0.0 && cycle.load_share_at_mesh_in < 0.2);
    assert!(cycle.entry.deflection_before_entry_m(0.0) > 0.0);
}

#[test]
fn integer_overlap_gives_a_nearly_constant_stiffness() {
    // b tanβ_b = 2 p_bt: the length of the contact lines does not vary.
    let helix = 25f64;
    let width = 2.0 * std::f64::consts::PI * 4e-3 / helix.to_radians().sin();
    let constant = pair(&spec([40, 60], helix, width));
    let other = pair(&spec([40, 60], helix, 0.8 * width));
    let spread = |pair| {
        let settings = Settings { corner_contact: false, positions: 16, slices: Some(48), ..Settings::default() };
        let cycle = solve_half(pair, Half::Left, 1e4, &settings, Watch::none()).unwrap();
        (cycle.stiffness.max - cycle.stiffness.min) / cycle.stiffness.mean
    };
    let (flat, wavy) = (spread(&constant), spread(&other));
    assert!(flat < 0.02 && wavy > 4.0 * flat, "{flat} {wavy}");
}

#[test]
fn a_canceled_analysis_stops() {
    let pair = pair(&spec([29, 67], 30.0, 45e-3));
    let watch = Watch::new(&|_| {}, &|| true);
    assert!(solve_half(&pair, Half::Left, 1e3, &quick(), watch).is_err());
}

/// Gu, Velex, Sainsot and Bruyère (2015), uniform stiffness per length of contact line:
/// k/k_m = 1 + 2 Σ sinc(n ε_α) sinc(n ε_β) cos[π n (2τ - ε_α - ε_β)].
#[test]
fn contact_lines_follow_the_uniform_series() {
    let sinc = |x: f64| if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
    for (teeth, helix, width) in [([29, 67], 30.0, 45e-3), ([40, 60], 12.0, 60e-3), ([17, 44], 24.43, 75e-3)] {
        let pair = pair(&spec(teeth, helix, width));
        let (ea, eb) = (pair.transverse_contact_ratio, pair.overlap_ratio);
        let reach = Reach { lowest_pair: i32::MIN, corner_gap_m: 0.0 };
        let mut points = Vec::new();
        for i in 0..16 {
            let phase = (f64::from(i) + 0.5) / 16.0;
            collect(&pair, Half::Left, phase, 24, &reach, &mut points);
            let length: f64 = points.iter().map(|p| p.width_m).sum::<f64>() / (ea * width);
            let series: f64 = 1.0
                + 2.0
                    * (1..4000)
                        .map(f64::from)
                        .map(|n| sinc(n * ea) * sinc(n * eb) * (PI * n * (2.0 * phase - ea - eb)).cos())
                        .sum::<f64>();
            assert!((length - series).abs() < 1e-4, "{phase}: {length} {series}");
        }
    }
}
