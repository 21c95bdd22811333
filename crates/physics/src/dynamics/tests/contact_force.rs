//! Tabulated contact force: its polynomials, motions by independent methods, lanes, perturbations.

use std::f64::consts::TAU;
use std::sync::Arc;

use super::reference::{parameters, reference};
use crate::dynamics::*;
use crate::watch::Watch;
use herringbone_oracle::check_worst;

const TOPIC: &str = "Dynamics: contact force";

/// F = k(φ) e²/(e + c), k = mean (1 + a cos 2πφ): stiffness from 0 to k with the displacement; first contact at free
/// cos(2πφ).
fn law(mean: f64, a: f64, c: f64, free: f64, highest_m: f64) -> FlankForce {
    let level_m: Vec<f64> = (0..=12).map(|i| highest_m * (f64::from(i) / 12.0).powf(1.5)).collect();
    let wave = |phase: f64| (1.0 + a * (TAU * phase).cos(), -a * TAU * (TAU * phase).sin());
    let nodes = level_m
        .iter()
        .map(|&e| {
            let (f, slope) = if e == 0.0 {
                (0.0, if c == 0.0 { 1.0 } else { 0.0 })
            } else {
                (e * e / (e + c), e * (e + 2.0 * c) / (e + c).powi(2))
            };
            knots()
                .iter()
                .map(|&phase| {
                    let (k, k_phase) = wave(phase);
                    [mean * k * f, mean * k * slope, mean * k_phase * f, mean * k_phase * slope]
                })
                .collect()
        })
        .collect();
    let free_m = knots().iter().map(|p| [free * (TAU * p).cos(), -free * TAU * (TAU * p).sin()]).collect();
    FlankForce { level_m, free_m, nodes }
}

fn knots() -> Vec<f64> {
    (0..24).map(|i| (f64::from(i) + 0.2 * (1.3 * f64::from(i)).sin() + 0.3) / 24.0).collect()
}

fn force(free: f64) -> Arc<ContactForce> {
    let driving = law(9e8, 0.2, 1e-6, free, 40e-6);
    let back = law(8e8, 0.15, 0.5e-6, free, 40e-6);
    Arc::new(ContactForce::new(knots(), [&driving, &back]).unwrap())
}

/// Case A of the references with a contact force in place of its stiffness, without its impact.
pub(super) fn case(load_nm: f64, free: f64) -> (Parameters, [f64; 24]) {
    let mut p = parameters("A");
    let contact = force(free);
    for h in &mut p.halves {
        h.contact_force = Some(contact.clone());
        h.impact = None;
        h.pinion_torque_nm = load_nm;
    }
    let mut start: [f64; 24] = reference().cases["A"].initial_state.as_slice().try_into().unwrap();
    start[12..].fill(0.0);
    (p, start)
}

#[test]
fn force_and_slopes_are_continuous_over_levels_and_knots() {
    let contact = force(0.3e-6);
    let level_m = law(9e8, 0.2, 1e-6, 0.0, 40e-6).level_m;
    let mut errors = Vec::new();
    for step in 0..97 {
        let phase = f64::from(step) / 97.0;
        let free = contact.free_m(1, phase);
        for &level in &level_m[1..] {
            let at = |e: f64| contact.force(free + e, 0.0, phase, phase);
            let (below, above) = (at(level * (1.0 - 1e-9)), at(level * (1.0 + 1e-9)));
            errors.push((above.0 - below.0) / below.0 - 2e-9 * below.1 * level / below.0);
            errors.push((above.1 - below.1) / below.1);
        }
    }
    for knot in knots() {
        for e in [1e-6, 7e-6, 60e-6] {
            let at = |phase: f64| contact.force(contact.free_m(1, phase) + e, 0.0, phase, phase);
            let (before, after) = (at(knot - 1e-10), at(knot + 1e-10));
            errors.push((after.0 - before.0) / before.0);
        }
    }
    check_worst(TOPIC, "jumps of force and stiffness at levels and knots", errors, 1e-7);
}

#[test]
fn the_displacement_under_a_load_carries_it() {
    let contact = force(0.3e-6);
    let errors = [-9000.0, -50.0, 0.1, 300.0, 5e3, 8e4].into_iter().flat_map(|load: f64| {
        let contact = &contact;
        (0..11).map(move |i| {
            let phase = f64::from(i) / 11.0;
            let s = contact.displacement_under(load, 2e-6, phase);
            contact.force(s, 2e-6, phase, phase).0 / load - 1.0
        })
    });
    check_worst(TOPIC, "force at the displacement under a load", errors, 1e-11);
}

/// The Taylor method locates every level and knot; the Runge–Kutta method does not locate levels.
#[test]
fn motions_with_contact_on_both_flanks_agree_with_another_method() {
    let mut errors = Vec::new();
    for (load_nm, free) in [(400.0, 0.0), (60.0, 0.3e-6), (8.0, 0.1e-6)] {
        let (mut p, start) = case(load_nm, free);
        p.half_backlash_m = 2e-6;
        let taylor = advance(&p, &start, 6, Integrator::Taylor, 1e-12, &Watch::none()).unwrap();
        let other = advance(&p, &start, 6, Integrator::RungeKutta, 1e-11, &Watch::none()).unwrap();
        let size = taylor.state[..6].iter().fold(0.0f64, |m, v| m.max(v.abs()));
        errors.extend((0..6).map(|c| (taylor.state[c] - other.state[c]) / size));
    }
    check_worst(TOPIC, "displacements after six mesh periods against Runge and Kutta", errors, 2e-6);
}

#[test]
fn lanes_change_nothing_under_contact_forces_and_beside_stiffnesses() {
    let (mut points, mut starts) = (Vec::new(), Vec::new());
    for i in 0..13 {
        let (mut p, start) = case([400.0, 60.0, 8.0][i % 3], [0.0, 0.2e-6][i % 2]);
        p.mesh_frequency_hz *= 0.4 + 0.1 * i as f64;
        if i % 4 == 1 {
            p.halves[1].phase_shift_mesh_periods = 0.3;
        }
        if i % 4 == 2 {
            p.damping_in_gap = false;
        }
        if i % 5 == 4 {
            p.halves.iter_mut().for_each(|h| h.contact_force = None);
        }
        points.push(p);
        starts.push(start);
    }
    let many = advance_many(&points, &starts, 5, 5e-8, &Watch::none()).unwrap();
    for ((p, s), reached) in points.iter().zip(&starts).zip(many) {
        let alone = advance(p, s, 5, Integrator::Taylor, 5e-8, &Watch::none()).unwrap();
        assert_eq!(alone.state.map(f64::to_bits), reached.unwrap().state.map(f64::to_bits));
    }
}

/// The monodromy matrix against differences of motions, across levels and loss of contact, with and without the damper
/// in the gap.
#[test]
fn perturbations_are_differences_of_motions() {
    let mut errors = Vec::new();
    for (load_nm, in_gap) in [(400.0, true), (30.0, true), (30.0, false)] {
        let (mut p, start) = case(load_nm, 0.2e-6);
        p.damping_in_gap = in_gap;
        let model = DynamicModel::<6>::new(&p).unwrap();
        let from = model.state_from(&start);
        let go = |state: MotionState<6>| {
            let mut motion = Motion::new(&model, state, Integrator::Taylor, 1e-13, 1_000_000);
            motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
            motion.state
        };
        let mut variation = Variation::new(&model, Variation::unit_perturbations(&model), 1e-12);
        let mut motion = Motion::new(&model, from, Integrator::Taylor, 1e-13, 1_000_000);
        motion.advance_period(&mut variation, &Watch::none(), 0.0).unwrap();
        for (c, column) in variation.columns.iter().take(5).enumerate() {
            let displaced = |by: f64| {
                let mut state = from;
                state.x[c] += by;
                state.contact[0] = model.contact_of(0, model.s(0, &state.x), 0.0);
                go(state)
            };
            let step = 2e-10;
            let (up, down) = (displaced(step), displaced(-step));
            let size = column.0.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            let worst = (0..5)
                .map(|r| ((up.x[r] - down.x[r]) / (2.0 * step) - column.0[r]) / size)
                .fold(0.0f64, |m, e| m.max(e.abs()));
            errors.push(worst);
        }
    }
    check_worst(TOPIC, "perturbations over a mesh period against differences", errors, 5e-4);
}

#[test]
fn invalid_tables_are_refused() {
    let good = law(9e8, 0.2, 1e-6, 0.0, 40e-6);
    let refused = |change: &dyn Fn(&mut FlankForce)| {
        let mut bad = good.clone();
        change(&mut bad);
        assert!(
            ContactForce::new(knots(), [&bad, &good]).is_err() && ContactForce::new(knots(), [&good, &bad]).is_err()
        );
    };
    refused(&|f| f.nodes[3][2][1] = f64::NAN);
    refused(&|f| f.nodes[3][2][0] = 1e9);
    refused(&|f| f.level_m.swap(2, 3));
    refused(&|f| f.level_m[0] = 1e-7);
    refused(&|f| f.free_m.truncate(2));
    assert!(ContactForce::new(vec![0.1, 0.5], [&good, &good]).is_err());
    let (mut p, start) = case(400.0, 0.0);
    p.halves[1].contact_force = None;
    assert!(advance(&p, &start, 1, Integrator::Taylor, 1e-9, &Watch::none()).is_err());
}

/// A first contact that moves over the phase is a displacement excitation: the driving flank comes later by what the
/// back flank comes earlier. Without mesh damping, which acts on the rate of s in one and of s − e in the other.
#[test]
fn a_displacement_excitation_is_a_first_contact_that_moves() {
    let free = 1.5e-6;
    let flank = |side: f64, free: f64| law(if side > 0.0 { 9e8 } else { 8e8 }, 0.2, 1e-6, side * free, 40e-6);
    let table = |free: f64| Arc::new(ContactForce::new(knots(), [&flank(1.0, free), &flank(-1.0, free)]).unwrap());
    for (load_nm, integrator) in
        [(400.0, Integrator::Taylor), (4.0, Integrator::Taylor), (400.0, Integrator::RungeKutta)]
    {
        let (mut moving, start) = case(load_nm, 0.0);
        moving.halves.iter_mut().for_each(|h| h.mesh_damping_n_s_per_m = 0.0);
        let mut displaced = moving.clone();
        let excitation = vec![Harmonic { amplitude: free, phase_rad: 0.0 }];
        for j in 0..2 {
            moving.halves[j].contact_force = Some(table(free));
            displaced.halves[j].contact_force = Some(table(0.0));
            displaced.halves[j].displacement_excitation = excitation.clone();
        }
        let end = |p: &Parameters| advance(p, &start, 3, integrator, 1e-11, &Watch::none()).unwrap().state;
        let mut still = displaced.clone();
        still.halves.iter_mut().for_each(|h| h.displacement_excitation.clear());
        let (moving, displaced, still) = (end(&moving), end(&displaced), end(&still));
        let size = moving[..12].iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let difference = |a: &[f64; 24]| (0..12).fold(0.0f64, |m, c| m.max((a[c] - moving[c]).abs())) / size;
        assert!(difference(&still) > 1e-2, "the excitation matters: {}", difference(&still));
        // The cubics between 24 knots hold the cosine to 4e-5 of it.
        let quantity = format!("displacement excitation as a moving first contact, {load_nm} N m, {integrator:?}");
        check_worst(TOPIC, &quantity, [difference(&displaced)], 5e-4);
    }
}
