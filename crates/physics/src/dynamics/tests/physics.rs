//! Statics, natural frequencies, energy, symmetry and scaling.

use super::reference::{parameters, reference};
use crate::dynamics::*;
use crate::watch::Watch;
use herringbone_oracle::Tolerance::{Absolute, Relative};
use herringbone_oracle::{check, check_worst};

const NATURAL: &str = "Dynamics: natural frequencies";
const BALANCES: &str = "Dynamics: balances and symmetries";

/// Twelve-DOF double-helical pair with couplings between the halves; eigenvalues from an independent program, Hz.
#[test]
fn natural_frequencies_with_couplings() {
    let half = |_| HalfParameters {
        pinion_mass_kg: 8.0,
        pinion_inertia_kg_m2: 0.0125,
        gear_mass_kg: 55.0,
        gear_inertia_kg_m2: 0.55,
        pinion_torque_nm: 100.0,
        pinion_lateral: Spring { stiffness: 6e8, damping: 0.0 },
        gear_lateral: Spring { stiffness: 9e8, damping: 0.0 },
        pinion_axial: Spring::default(),
        gear_axial: Spring { stiffness: 3e8, damping: 0.0 },
        contact_force: None,
        mesh_stiffness: Stiffness::Constant { mean_n_per_m: 8e8 },
        mesh_damping_n_s_per_m: 0.0,
        impact: None,
        displacement_excitation: Vec::new(),
        phase_shift_mesh_periods: 0.0,
    };
    let spring = |stiffness| Spring { stiffness, damping: 0.0 };
    let mut p = Parameters {
        mesh_frequency_hz: 500.0,
        pinion_radius_m: 0.052,
        gear_radius_m: 0.1346,
        helix_angle_rad: 22f64.to_radians(),
        half_backlash_m: 1e-6,
        damping_in_gap: true,
        impact_acts_on: ImpactActsOn::Torsion,
        halves: [half(0), half(1)],
        couplings: Couplings {
            pinion_axial: spring(3e9),
            gear_axial: spring(6e9),
            pinion_lateral: spring(2e9),
            gear_lateral: spring(4e9),
            pinion_torsion: spring(5e6),
            gear_torsion: spring(5e7),
        },
        train: None,
    };
    let f = NaturalModes::new(&p).unwrap().frequencies_hz;
    let expected = [0.0, 329.20, 539.79, 615.84, 1088.4, 2052.3, 2265.1, 2353.9, 2749.1, 3976.7, 4422.4, 5035.8];
    for (i, (f, e)) in f.iter().zip(expected).enumerate() {
        let tolerance = if e < 1.0 { Absolute(1e-4) } else { Relative(1e-4) };
        check(NATURAL, &format!("halves coupled, mode {}, Hz", i + 1), *f, e, tolerance);
    }
    // Solver coordinates have the same frequencies: a free vibration of the twelve-coordinate model keeps its shape and
    // has the frequency of its mode.
    let modes = NaturalModes::new(&p).unwrap();
    let mut errors = Vec::new();
    p.halves.iter_mut().for_each(|h| h.pinion_torque_nm = 0.0);
    p.half_backlash_m = 0.0;
    for (f, shape) in modes.frequencies_hz.iter().zip(&modes.shapes).skip(1) {
        let scale = 1e-6;
        p.mesh_frequency_hz = f / 4.0;
        let model = DynamicModel::<12>::new(&p).unwrap();
        let mut start = [0.0; 24];
        start[..12].copy_from_slice(&shape.map(|c| c * scale));
        let mut motion = Motion::new(&model, model.state_from(&start), Integrator::Taylor, 1e-13, u64::MAX);
        motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
        // Four vibrations later the state is that of the start.
        let end = model.physical_displacements(&motion.state.x);
        let largest = shape.iter().fold(0.0f64, |m, c| m.max(c.abs())) * scale;
        errors.extend((0..12).map(|c| (end[c] - start[c]) / largest));
    }
    check_worst(
        NATURAL,
        "free vibration in each mode after four of its periods, of the largest displacement",
        errors,
        1e-7,
    );
}

/// Rigid couplings and bearings, spur: one torsional mode, √(2 k_m/m_eq)/2π = 2247.4585 Hz.
#[test]
fn the_torsional_mode_alone() {
    let mut p = parameters("A");
    p.helix_angle_rad = 0.0;
    let (rp, rg) = (0.052, 0.1346);
    (p.pinion_radius_m, p.gear_radius_m) = (rp, rg);
    for h in &mut p.halves {
        (h.pinion_inertia_kg_m2, h.gear_inertia_kg_m2) = (0.0125, 0.55);
        h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 8e8 };
        (h.pinion_lateral.stiffness, h.gear_lateral.stiffness) = (1e17, 1e17);
    }
    let f = NaturalModes::new(&p).unwrap().frequencies_hz;
    let nearest = f.into_iter().min_by(|a, b| (a - 2247.4585).abs().total_cmp(&(b - 2247.4585).abs())).unwrap();
    check(NATURAL, "spur, held fast but for the rotation, Hz", nearest, 2247.4585, Absolute(1e-3));
}

#[test]
fn static_deflection_is_the_reference_start() {
    for name in ["A", "B", "C"] {
        let p = parameters(name);
        let q = NaturalModes::new(&p).unwrap().static_deflection(&p);
        let expected = &reference().cases[name].initial_state;
        let errors = (0..12).map(|c| (q[c] - expected[c]) / expected[2]);
        check_worst(BALANCES, &format!("static deflection of case {name}, of the pinion's rotation"), errors, 1e-11);
    }
}

/// Constant stiffness, no impact, damped: the static deflection is an equilibrium.
#[test]
fn nothing_moves_without_excitation() {
    let mut p = parameters("C");
    for h in &mut p.halves {
        h.impact = None;
        h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 9e8 };
    }
    p.half_backlash_m = 0.0;
    let q = NaturalModes::new(&p).unwrap().static_deflection(&p);
    let mut start = [0.0; 24];
    start[..12].copy_from_slice(&q);
    let model = DynamicModel::<12>::new(&p).unwrap();
    let mut motion = Motion::new(&model, model.state_from(&start), Integrator::Taylor, 1e-12, u64::MAX);
    for _ in 0..50 {
        motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
    }
    let end = model.physical_displacements(&motion.state.x);
    let errors = (0..12).map(|c| (end[c] - q[c]) / q[2]);
    check_worst(BALANCES, "rest without excitation, 50 periods, of the pinion's rotation", errors, 1e-12);
}

/// Kinetic and potential energy of the twelve displacements, less the work of the torques, J.
pub(crate) fn energy(p: &Parameters, x: &[f64; 12], v: &[f64; 12], k_mesh: f64) -> f64 {
    let mut e = 0.0;
    let (sin, cos) = p.helix_angle_rad.sin_cos();
    for (j, h) in p.halves.iter().enumerate() {
        let (x, v) = (&x[6 * j..6 * j + 6], &v[6 * j..6 * j + 6]);
        let masses = [
            h.pinion_mass_kg,
            h.pinion_mass_kg,
            h.pinion_inertia_kg_m2,
            h.gear_mass_kg,
            h.gear_mass_kg,
            h.gear_inertia_kg_m2,
        ];
        e += (0..6).map(|c| 0.5 * masses[c] * v[c] * v[c]).sum::<f64>();
        e += 0.5 * h.pinion_lateral.stiffness * x[0] * x[0]
            + 0.5 * h.gear_lateral.stiffness * x[3] * x[3]
            + 0.5 * h.gear_axial.stiffness * x[4] * x[4];
        e -= h.pinion_torque_nm * x[2] - h.pinion_torque_nm * p.gear_radius_m / p.pinion_radius_m * x[5];
        let sin = if j == 0 { sin } else { -sin };
        let s = cos * (x[0] - x[3] + p.pinion_radius_m * x[2] - p.gear_radius_m * x[5]) + sin * (x[1] - x[4]);
        let f = (s.abs() - p.half_backlash_m).max(0.0);
        e += 0.5 * k_mesh * f * f;
    }
    e + 0.5 * p.couplings.pinion_axial.stiffness * (x[1] - x[7]).powi(2)
        + 0.5 * p.couplings.gear_axial.stiffness * (x[4] - x[10]).powi(2)
}

/// Undamped with constant stiffness and contact on both flanks: the energy is constant to a limit that a missed event
/// would exceed by far.
#[test]
fn energy_is_kept() {
    let mut p = parameters("C");
    p.half_backlash_m = 2e-6;
    for h in &mut p.halves {
        h.impact = None;
        h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 9e8 };
        h.mesh_damping_n_s_per_m = 0.0;
        for s in [&mut h.pinion_lateral, &mut h.gear_lateral, &mut h.gear_axial] {
            s.damping = 0.0;
        }
    }
    p.couplings.pinion_axial.damping = 0.0;
    p.couplings.gear_axial.damping = 0.0;
    let model = DynamicModel::<12>::new(&p).unwrap();
    let mut start = [0.0; 24];
    start[..12].copy_from_slice(&reference().cases["C"].initial_state[..12]);
    start[14] = 0.6;
    start[20] = 0.3;
    let mut motion = Motion::new(&model, model.state_from(&start), Integrator::Taylor, 1e-14, u64::MAX);
    let of = |m: &Motion<'_, 12>| {
        let v = model.physical_displacements(&m.state.v).map(|v| v * model.omega_ref);
        energy(&p, &model.physical_displacements(&m.state.x), &v, 9e8)
    };
    let first = of(&motion);
    let mut errors = Vec::new();
    for _ in 0..100 {
        motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
        let now = of(&motion);
        errors.push(now / first - 1.0);
    }
    check_worst(BALANCES, "energy over 100 undamped periods with contact on both flanks", errors, 1e-10);
    assert!(motion.contact_changed);
}

/// Torque, backlash, impact and start multiplied by a factor: the motion is multiplied by it.
#[test]
fn motion_scales_with_the_load() {
    let p = parameters("C");
    let mut q = p.clone();
    let factor = 3.0;
    q.half_backlash_m *= factor;
    for h in &mut q.halves {
        h.pinion_torque_nm *= factor;
        if let Some(ImpactExcitation::HalfSine { force_n, .. }) = &mut h.impact {
            *force_n *= factor;
        }
    }
    let run = |p: &Parameters, scale: f64| {
        let model = DynamicModel::<6>::new(p).unwrap();
        let start: [f64; 24] = reference().cases["C"].initial_state.as_slice().try_into().unwrap();
        let mut motion =
            Motion::new(&model, model.state_from(&start.map(|c| c * scale)), Integrator::Taylor, 1e-13, u64::MAX);
        for _ in 0..20 {
            motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
        }
        motion.state.x
    };
    let (a, b) = (run(&p, 1.0), run(&q, factor));
    let errors = (0..6).map(|c| (a[c] * factor - b[c]) / b[U]);
    check_worst(BALANCES, "threefold load, impact, backlash and start: threefold motion", errors, 1e-10);
}

/// The halves exchanged and the helix angle reversed: the same motion with the halves exchanged.
#[test]
fn exchanging_the_halves_exchanges_the_motion() {
    let mut p = parameters("C");
    p.halves[1].phase_shift_mesh_periods = 0.3;
    p.halves[0].gear_axial.stiffness *= 1.2;
    let mut q = p.clone();
    q.halves.swap(0, 1);
    q.helix_angle_rad = -q.helix_angle_rad;
    let start: [f64; 24] = reference().cases["C"].initial_state.as_slice().try_into().unwrap();
    let swapped: [f64; 24] = std::array::from_fn(|i| start[i / 12 * 12 + (i + 6) % 12]);
    let run = |p: &Parameters, start: &[f64; 24]| {
        let model = DynamicModel::<12>::new(p).unwrap();
        let mut motion = Motion::new(&model, model.state_from(start), Integrator::Taylor, 1e-13, u64::MAX);
        for _ in 0..10 {
            motion.advance_period(&mut Unobserved, &Watch::none(), 0.0).unwrap();
        }
        model.physical_displacements(&motion.state.x)
    };
    let (a, b) = (run(&p, &start), run(&q, &swapped));
    let errors = (0..12).map(|c| (a[c] - b[(c + 6) % 12]) / a[2]);
    check_worst(BALANCES, "halves exchanged and helix turned over: motion exchanged", errors, 1e-10);
}
