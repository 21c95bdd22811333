//! The three reference cases: event-exact solutions in 113-bit arithmetic (tests/data/dynamics_reference.json).

use std::collections::BTreeMap;

use serde::Deserialize;

use crate::dynamics::equations::{U, YG, YP};
use crate::dynamics::integrate::{Integrator, Motion};
use crate::dynamics::model::DynamicModel;
use crate::dynamics::segment::{Observer, Segment};
use crate::dynamics::*;
use crate::watch::Watch;
use herringbone_oracle::check_worst;

#[derive(Deserialize)]
pub(crate) struct ReferenceSolutions {
    common: CommonParameters,
    pub cases: BTreeMap<String, ReferenceCase>,
}

#[derive(Deserialize)]
struct CommonParameters {
    mean_stiffness_n_per_m: f64,
    phases_rad: Vec<f64>,
    impact_force_n: f64,
    impact_duration_mesh_periods: f64,
    pinion_inertia_kg_m2: f64,
    gear_inertia_kg_m2: f64,
    pinion_mass_kg: f64,
    gear_mass_kg: f64,
    lateral_n_per_m: f64,
    pinion_axial_coupling_n_per_m: f64,
    gear_axial_n_per_m: f64,
    gear_axial_coupling_n_per_m: f64,
    support_damping_ratio: f64,
    pinion_radius_m: f64,
    gear_radius_m: f64,
    helix_angle_deg: f64,
    equivalent_mass_kg: f64,
}

#[derive(Deserialize)]
#[allow(dead_code)]
pub(crate) struct ReferenceCase {
    pinion_torque_per_half_nm: f64,
    half_backlash_m: f64,
    mesh_damping_ratio: f64,
    amplitudes: Vec<f64>,
    pub initial_state: Vec<f64>,
    pub states: BTreeMap<u64, Vec<f64>>,
    pub rms_first_20: f64,
    pub rms_200_to_300: Option<f64>,
    pub fraction_contact: f64,
    pub s_min_um: f64,
    pub s_max_um: f64,
    pub switches: u64,
}

pub(crate) fn reference() -> ReferenceSolutions {
    serde_json::from_str(include_str!("../../../../../tests/data/dynamics_reference.json")).unwrap()
}

/// The parameters of a reference case.
pub(crate) fn parameters(name: &str) -> Parameters {
    let r = reference();
    let (m, c) = (&r.common, &r.cases[name]);
    let (rp, rg) = (m.pinion_radius_m, m.gear_radius_m);
    let me = equivalent_mass_kg(rp, m.pinion_inertia_kg_m2, rg, m.gear_inertia_kg_m2);
    assert!((me / m.equivalent_mass_kg - 1.0).abs() < 1e-14);
    let z = m.support_damping_ratio;
    let half = HalfParameters {
        pinion_mass_kg: m.pinion_mass_kg,
        pinion_inertia_kg_m2: m.pinion_inertia_kg_m2,
        gear_mass_kg: m.gear_mass_kg,
        gear_inertia_kg_m2: m.gear_inertia_kg_m2,
        pinion_torque_nm: c.pinion_torque_per_half_nm,
        pinion_lateral: Spring::with_damping_ratio(m.lateral_n_per_m, z, m.pinion_mass_kg),
        gear_lateral: Spring::with_damping_ratio(m.lateral_n_per_m, z, m.gear_mass_kg),
        pinion_axial: Spring::default(),
        gear_axial: Spring::with_damping_ratio(m.gear_axial_n_per_m, z, m.gear_mass_kg),
        contact_force: None,
        mesh_stiffness: Stiffness::Fourier {
            mean_n_per_m: m.mean_stiffness_n_per_m,
            harmonics: c
                .amplitudes
                .iter()
                .zip(&m.phases_rad)
                .map(|(&amplitude, &phase_rad)| Harmonic { amplitude, phase_rad })
                .collect(),
        },
        mesh_damping_n_s_per_m: mesh_damping_n_s_per_m(c.mesh_damping_ratio, m.mean_stiffness_n_per_m, me),
        impact: Some(ImpactExcitation::HalfSine {
            force_n: m.impact_force_n,
            duration_mesh_periods: m.impact_duration_mesh_periods,
            start_mesh_periods: 0.0,
        }),
        displacement_excitation: Vec::new(),
        phase_shift_mesh_periods: 0.0,
    };
    Parameters {
        mesh_frequency_hz: 2000.0 / 60.0 * 17.0,
        pinion_radius_m: rp,
        gear_radius_m: rg,
        helix_angle_rad: m.helix_angle_deg.to_radians(),
        half_backlash_m: c.half_backlash_m,
        damping_in_gap: true,
        impact_acts_on: ImpactActsOn::Torsion,
        halves: [half.clone(), half],
        couplings: Couplings {
            pinion_axial: Spring::with_damping_ratio(m.pinion_axial_coupling_n_per_m, z, m.pinion_mass_kg),
            gear_axial: Spring::with_damping_ratio(m.gear_axial_coupling_n_per_m, z, m.gear_mass_kg),
            ..Couplings::default()
        },
        train: None,
    }
}

/// Mean square of x'' of the left half by Gauss-Legendre quadrature on every segment.
#[derive(Default)]
struct MeanSquare {
    integral: f64,
    length: f64,
}

impl<const D: usize> Observer<D> for MeanSquare {
    fn segment(&mut self, g: &Segment<'_, D>) {
        // 5-point Gauss rule on 8 pieces.
        let nodes = [0.0, 0.538_469_310_105_683, -0.538_469_310_105_683, 0.906_179_845_938_664, -0.906_179_845_938_664];
        let weights =
            [128.0 / 225.0, 0.478_628_670_499_366, 0.478_628_670_499_366, 0.236_926_885_056_189, 0.236_926_885_056_189];
        let a: Vec<f64> = (0..=g.degree - 2)
            .map(|n| {
                let r = &g.rows[n + 2];
                ((n + 1) * (n + 2)) as f64 * (r[YP] - r[YG] + r[U])
            })
            .collect();
        let w2 = g.model.omega_ref * g.model.omega_ref;
        for piece in 0..8 {
            for (node, weight) in nodes.iter().zip(&weights) {
                let t = g.h * (f64::from(piece) + 0.5 + 0.5 * node) / 8.0;
                let value = w2 * a.iter().rev().fold(0.0, |s, c| s * t + c);
                self.integral += weight * g.h / 16.0 * value * value;
            }
        }
        self.length += g.h;
    }
}

/// Largest relative errors of the states at 1, 5 and 20 periods and of the RMS over the first 20 (relative to the
/// largest displacement or velocity of its kind).
fn errors<const D: usize>(name: &str, integrator: Integrator, tolerance: f64) -> (BTreeMap<u64, f64>, f64, StepCounts) {
    let p = parameters(name);
    let case = &reference().cases[name];
    let model = DynamicModel::<D>::new(&p).unwrap();
    let start = model.state_from(case.initial_state.as_slice().try_into().unwrap());
    let mut motion = Motion::new(&model, start, integrator, tolerance, u64::MAX);
    let mut square = MeanSquare::default();
    let mut out = BTreeMap::new();
    for period in 1..=20 {
        motion.advance_period(&mut square, &Watch::none(), 0.0).unwrap();
        if let Some(expected) = case.states.get(&period) {
            let x = model.physical_displacements(&motion.state.x);
            let v = model.physical_displacements(&motion.state.v);
            let mut worst = 0.0f64;
            for c in 0..12 {
                // Relative to the largest of the same kind: lengths, angles of pinion, of gear.
                let like = |at: usize| {
                    (0..12).filter(|k| kind(*k) == kind(c)).map(|k| expected[at + k].abs()).fold(0.0, f64::max)
                };
                worst = worst.max((x[c] - expected[c]).abs() / like(0));
                worst = worst.max((v[c] * model.omega_ref - expected[12 + c]).abs() / like(12));
            }
            out.insert(period, worst);
        }
    }
    let rms = (square.integral / square.length).sqrt();
    (out, (rms / case.rms_first_20 - 1.0).abs(), motion.counts)
}

fn kind(c: usize) -> usize {
    match c % 6 {
        2 => 1,
        5 => 2,
        _ => 0,
    }
}

#[test]
fn taylor_meets_the_reference() {
    for (name, states, rms) in [("A", 1e-9, 1e-9), ("B", 1e-7, 1e-9), ("C", 1e-9, 1e-9)] {
        let (e6, r6, n) = errors::<6>(name, Integrator::Taylor, 1e-14);
        let (e12, r12, _) = errors::<12>(name, Integrator::Taylor, 1e-14);
        println!("{name}: 6: {e6:?} rms {r6:.1e}; 12: {e12:?} rms {r12:.1e}; {n:?}");
        let topic = format!("Dynamics: reference case {name}");
        let of = |what: &str, coordinates: u32| format!("{what}, Taylor series, {coordinates} coordinates");
        for (e, r, coordinates) in [(e6, r6, 6), (e12, r12, 12)] {
            check_worst(&topic, &of("states after 1, 5 and 20 periods", coordinates), e.into_values(), states);
            check_worst(&topic, &of("RMS of x_left'' over 20 periods", coordinates), [r], rms);
        }
    }
}

#[test]
fn runge_kutta_meets_the_reference() {
    for (name, limit) in [("A", 1e-6), ("B", 1e-2), ("C", 1e-4)] {
        let (e, r, n) = errors::<12>(name, Integrator::RungeKutta, 1e-9);
        println!("{name}: {e:?} rms {r:.1e}; {n:?}");
        let topic = format!("Dynamics: reference case {name}");
        check_worst(&topic, "states after 1, 5 and 20 periods, Runge–Kutta", e.into_values(), limit);
        check_worst(&topic, "RMS of x_left'' over 20 periods, Runge–Kutta", [r], limit);
    }
}
