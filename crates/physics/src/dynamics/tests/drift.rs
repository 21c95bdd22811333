//! Long runs: energy of undamped pairs over ten thousand mesh periods, a steady motion over a million.

use super::reference::{parameters, reference};
use crate::dynamics::*;
use crate::watch::Watch;
use herringbone_oracle::check_worst;

const LONG: &str = "Dynamics: long runs";

/// Case C without damping, impact and fluctuation of the stiffness.
fn undamped(half_backlash_m: f64, torque_nm: f64) -> Parameters {
    let mut p = parameters("C");
    p.half_backlash_m = half_backlash_m;
    for h in &mut p.halves {
        h.pinion_torque_nm = torque_nm;
        h.impact = None;
        h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 9e8 };
        h.mesh_damping_n_s_per_m = 0.0;
        for s in [&mut h.pinion_lateral, &mut h.gear_lateral, &mut h.gear_axial] {
            s.damping = 0.0;
        }
    }
    p.couplings.pinion_axial.damping = 0.0;
    p.couplings.gear_axial.damping = 0.0;
    p
}

/// Energy in solver coordinates, without the rigid rotation: kinetic, springs, mesh, less the work of the torques. J.
fn energy<const D: usize>(model: &DynamicModel<D>, p: &Parameters, state: &MotionState<D>) -> f64 {
    let x = model.physical_displacements(&state.x);
    let v = model.physical_displacements(&state.v).map(|v| v * model.omega_ref);
    super::physics::energy(p, &x, &v, 9e8)
}

/// Worst relative change of the energy over ten thousand mesh periods, and whether the contact changed.
fn drift<const D: usize>(p: &Parameters, speeds: [f64; 2], tolerance: f64) -> (f64, bool) {
    let model = DynamicModel::<D>::new(p).unwrap();
    let mut start = [0.0; 24];
    start[..12].copy_from_slice(&NaturalModes::new(p).unwrap().static_deflection(p));
    (start[14], start[20]) = (speeds[0], speeds[1]);
    let mut motion = Motion::new(&model, model.state_from(&start), Integrator::Taylor, tolerance, u64::MAX);
    let first = energy(&model, p, &motion.state);
    // The work of the torque shifts the zero of the energy; the scale is the kinetic energy at the start.
    let swing = 0.5 * p.halves[0].pinion_inertia_kg_m2 * (speeds[0].powi(2) + speeds[1].powi(2));
    let mut worst = 0.0f64;
    for _ in 0..10_000 {
        motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
        worst = worst.max(((energy(&model, p, &motion.state) - first) / swing).abs());
    }
    (worst, motion.contact_changed)
}

/// Undamped pairs that vibrate freely, at the tolerance of a default accuracy of 1e-6 and at a fine one.
#[test]
fn energy_stays_over_ten_thousand_periods() {
    // Tolerances of `Integrate` at an accuracy of 1e-6, and 1e-12.
    for (name, tolerance, limit) in [("default tolerance", 5e-8, 1e-4), ("tolerance 1e-12", 1e-12, 1e-7)] {
        let of = |what: &str| format!("energy over 10 000 undamped periods, {what}, {name}");
        let (kept, changed) = drift::<12>(&undamped(0.0, 0.0), [0.2, 0.1], tolerance);
        assert!(!changed);
        check_worst(LONG, &of("no load, no backlash"), [kept], limit);
        let (kept, changed) = drift::<12>(&undamped(2e-5, 400.0), [0.002, 0.001], tolerance);
        assert!(!changed);
        check_worst(LONG, &of("loaded, contact kept"), [kept], limit);
        let (kept, changed) = drift::<12>(&undamped(2e-6, 20.0), [0.6, 0.3], tolerance);
        assert!(changed);
        check_worst(LONG, &of("contact opening and closing on both flanks"), [kept], limit);
    }
}

/// A million mesh periods of a steady motion end without drift, in cases A and C.
#[test]
#[ignore = "takes a minute"]
fn a_million_periods() {
    for (name, repeats) in [("A", 1u64), ("C", 2)] {
        let p = parameters(name);
        let model = DynamicModel::<6>::new(&p).unwrap();
        let start = model.state_from(reference().cases[name].initial_state.as_slice().try_into().unwrap());
        let mut motion = Motion::new(&model, start, Integrator::Taylor, 1e-12, u64::MAX);
        let mut follow = |periods: u64| {
            for _ in 0..periods {
                motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
            }
            motion.state
        };
        let early = follow(1000 * repeats);
        let late = follow(1_000_000 - 1000 * repeats);
        let size = early.x.iter().fold(0.0f64, |m, c| m.max(c.abs()));
        let errors = (0..6).filter(|c| *c != W).map(|c| (late.x[c] - early.x[c]) / size);
        check_worst(LONG, &format!("case {name} after 1 000 000 periods, of the largest displacement"), errors, 1e-9);
    }
}
