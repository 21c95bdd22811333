//! Harmonic balance of pairs and trains: against the shooting method, and its proof of stability against Floquet
//! multipliers.

use std::sync::Arc;

use super::contact_force::case as contact_case;
use super::reference::parameters;
use super::train::train_cases::train_of;
use crate::dynamics::*;
use crate::response::{Analysis, AppliedMethod, Regime, solve};
use crate::watch::Watch;
use herringbone_oracle::check_worst;

const TOPIC: &str = "Dynamics: harmonic balance";

fn with_further_modes(p: &Parameters, gyroscopic: f64) -> Parameters {
    Parameters { train: Some(Arc::new(train_of(p, 28, gyroscopic))), ..p.clone() }
}

/// Trains whose steady motion keeps contact: mesh stiffness with impact (on the torsion, on all motions), with a
/// displacement excitation, and a tabulated contact force.
fn cases() -> Vec<(&'static str, Parameters)> {
    let mut linear = parameters("A");
    linear.halves[1].phase_shift_mesh_periods = 0.3;
    let mut on_all = linear.clone();
    on_all.impact_acts_on = ImpactActsOn::All;
    let mut excited = linear.clone();
    let harmonics = [(0.4e-6, 0.4), (0.1e-6, 2.0)];
    let harmonics = harmonics.map(|(amplitude, phase_rad)| Harmonic { amplitude, phase_rad });
    excited.halves.iter_mut().for_each(|h| h.displacement_excitation = harmonics.to_vec());
    let (mut contact, _) = contact_case(400.0, 0.6e-6);
    contact.halves[1].phase_shift_mesh_periods = 0.3;
    vec![
        ("mesh stiffness, impact on the torsion", with_further_modes(&linear, 0.02)),
        ("mesh stiffness, impact on all motions", with_further_modes(&on_all, 0.02)),
        ("displacement excitation", with_further_modes(&excited, 0.0)),
        ("contact force", with_further_modes(&contact, 0.02)),
    ]
}

/// A motion that starts from its own end is found by integration and Newton's method on the period map.
#[test]
fn the_orbit_is_that_of_the_shooting_method() {
    for (name, q) in cases() {
        let analysis = Analysis { accuracy: 1e-8, ..Analysis::default() };
        let series = solve(&q, &analysis, &Watch::none()).unwrap();
        let model = DynamicModel::<52>::new(&q).unwrap();
        let balance = HarmonicBalance::new(&model, [9e8; 2]).expect("a train whose modes decay");
        let orbit = balance.solve(&model.static_state_of_train([9e8; 2]), 1e-9).expect("in contact");
        let start = model.modal_state(&orbit.start);
        let size = start.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        // Rigid-body modes drift as they like.
        let train = q.train.as_ref().expect("a train");
        let differences = start.iter().zip(&series.final_modal_state).map(|(a, b)| (a - b) / size).enumerate();
        let errors = differences.filter(|(c, _)| !train.is_rigid_body_mode(c % train.len())).map(|(_, error)| error);
        check_worst(TOPIC, &format!("{name}: start by the series against the record's end"), errors, 1e-6);
        let initial_modal_state = Some(series.final_modal_state.iter().map(|v| 0.999 * v).collect());
        let shooting = solve(&q, &Analysis { initial_modal_state, ..analysis }, &Watch::none()).unwrap();
        for response in [&series, &shooting] {
            let summary = &response.summary;
            assert_eq!((summary.regime, summary.method), (Regime::Period1, AppliedMethod::Periodic), "{name}");
            assert!(summary.error_estimate < 1e-8, "{name}: {}", summary.error_estimate);
        }
        let channels = &shooting.summary.rms.channels;
        let errors = channels.iter().map(|(channel, rms)| series.summary.rms.channels[channel] / rms - 1.0);
        check_worst(TOPIC, &format!("{name}: RMS values against the shooting method"), errors, 1e-8);
        let modulus = |summary: &crate::response::Summary| summary.floquet_modulus.expect("found as an orbit");
        let error = modulus(&series.summary) / modulus(&shooting.summary) - 1.0;
        check_worst(TOPIC, &format!("{name}: largest Floquet multiplier"), [error], 1e-6);
    }
}

/// Pairs whose steady motion keeps contact: mirror-symmetric, staggered (the pinion floats along its axis), with
/// unequal halves that torsional springs couple, without backlash, under a torque the other way.
fn pairs() -> Vec<(&'static str, Parameters)> {
    let linear = parameters("A");
    let changed = |change: &dyn Fn(&mut Parameters)| {
        let mut p = linear.clone();
        change(&mut p);
        p
    };
    let stagger = |p: &mut Parameters| p.halves[1].phase_shift_mesh_periods = 0.3;
    let harmonics = [(0.4e-6, 0.4), (0.1e-6, 2.0)];
    let harmonics = harmonics.map(|(amplitude, phase_rad)| Harmonic { amplitude, phase_rad });
    let unequal = |p: &mut Parameters| {
        stagger(p);
        p.couplings.pinion_torsion = Spring { stiffness: 2e6, damping: 20.0 };
        p.couplings.gear_torsion = Spring { stiffness: 8e6, damping: 80.0 };
        p.couplings.pinion_lateral = Spring { stiffness: 1e8, damping: 900.0 };
        p.halves[1].gear_mass_kg *= 1.2;
        p.halves[0].pinion_axial = Spring { stiffness: 1e8, damping: 500.0 };
    };
    let (symmetric_contact, _) = contact_case(400.0, 0.6e-6);
    let mut contact = symmetric_contact.clone();
    stagger(&mut contact);
    vec![
        ("mirror-symmetric", linear.clone()),
        ("staggered", changed(&stagger)),
        ("unequal halves coupled in torsion", changed(&unequal)),
        ("impact on all motions", changed(&|p| p.impact_acts_on = ImpactActsOn::All)),
        (
            "displacement excitation",
            changed(&|p| {
                p.halves.iter_mut().for_each(|h| h.displacement_excitation = harmonics.to_vec());
            }),
        ),
        ("without backlash", changed(&|p| p.half_backlash_m = 0.0)),
        ("torque the other way", changed(&|p| p.halves.iter_mut().for_each(|h| h.pinion_torque_nm *= -1.0))),
        ("contact force, mirror-symmetric", symmetric_contact),
        ("contact force, staggered", contact),
    ]
}

#[test]
fn the_orbit_of_a_pair_is_that_of_the_shooting_method() {
    for (name, q) in pairs() {
        let analysis = Analysis { accuracy: 1e-8, ..Analysis::default() };
        let by_series = match number_of_coordinates(&q, q.is_symmetric()) {
            6 => has_orbit::<6>(&q),
            _ => has_orbit::<12>(&q),
        };
        assert!(by_series, "{name}: found by the series");
        let series = solve(&q, &analysis, &Watch::none()).unwrap();
        // The search always computes multipliers, the series only where it cannot prove stability.
        let alone = Analysis { multipliers: false, ..analysis.clone() };
        let proven = solve(&q, &alone, &Watch::none()).unwrap().summary.floquet_modulus.is_none();
        assert!(proven, "{name}: found by the search, or not proven stable");
        let initial_state = Some(series.final_state.map(|v| 0.999 * v));
        let shooting = solve(&q, &Analysis { initial_state, ..analysis }, &Watch::none()).unwrap();
        for response in [&series, &shooting] {
            let summary = &response.summary;
            assert_eq!((summary.regime, summary.method), (Regime::Period1, AppliedMethod::Periodic), "{name}");
            assert!(summary.error_estimate < 1e-8, "{name}: {}", summary.error_estimate);
        }
        let rms = |response: &crate::response::Response| {
            let rms = &response.summary.rms;
            let [mesh, axial] = [rms.mesh_circumferential_acceleration_m_s2, rms.pinion_axial_acceleration_m_s2];
            [mesh.left, mesh.right, axial.left, axial.right]
        };
        let errors = rms(&series).into_iter().zip(rms(&shooting)).map(|(a, b)| a / b - 1.0);
        check_worst(TOPIC, &format!("pair, {name}: RMS values against the shooting method"), errors, 1e-8);
        let multipliers = |response: &crate::response::Response| {
            let found = response.summary.floquet_multipliers.clone().expect("found as an orbit");
            found.iter().map(|m| m.modulus).collect::<Vec<f64>>()
        };
        let (a, b) = (multipliers(&series), multipliers(&shooting));
        assert_eq!(a.len(), b.len(), "{name}");
        check_worst(
            TOPIC,
            &format!("pair, {name}: moduli of the Floquet multipliers"),
            a.iter().zip(&b).map(|(a, b)| a - b),
            1e-5,
        );
    }
}

/// Whether the steady motion of a pair is found by the series.
fn has_orbit<const D: usize>(p: &Parameters) -> bool {
    let model = DynamicModel::<D>::new(p).unwrap();
    let mean = [0, 1].map(|j| p.halves[j].mesh_stiffness.mean_n_per_m());
    let mut at_rest = [0.0; 24];
    at_rest[..12].copy_from_slice(&NaturalModes::new(p).unwrap().static_deflection(p));
    let mut start = model.state_from(&at_rest);
    model.close_contact(&mut start);
    HarmonicBalance::new(&model, mean).is_some_and(|balance| balance.solve(&start, 1e-9).is_some())
}

/// Stiffness variations from none to parametric resonance: what is proven stable has all multipliers within the unit
/// circle, and the proof succeeds for moderate variations.
#[test]
fn what_is_proven_stable_is_stable() {
    let (mut proven, mut unstable) = (0, 0);
    for damping in [0.3, 1.0] {
        for frequency in [0.9, 1.7, 2.1] {
            for variation in [0.0, 0.02, 0.1, 0.3, 0.6] {
                let mut p = parameters("A");
                p.half_backlash_m = 0.0;
                for h in &mut p.halves {
                    let mean_n_per_m = h.mesh_stiffness.mean_n_per_m();
                    let harmonics = vec![Harmonic { amplitude: variation, phase_rad: 0.0 }];
                    h.mesh_stiffness = Stiffness::Fourier { mean_n_per_m, harmonics };
                    h.mesh_damping_n_s_per_m *= damping;
                }
                let mut q = with_further_modes(&p, 0.02);
                let train = q.train.clone().expect("set above");
                // Of the mode that moves the mesh most.
                let lead = (0..train.len()).max_by(|a, b| train.mesh[0][*a].abs().total_cmp(&train.mesh[0][*b].abs()));
                let omega = train.eigenvalues_rad2_s2[lead.expect("has modes")].sqrt();
                q.mesh_frequency_hz = frequency * omega / std::f64::consts::TAU;
                let model = DynamicModel::<52>::new(&q).unwrap();
                let balance = HarmonicBalance::new(&model, [9e8; 2]).expect("a train whose modes decay");
                let Some(orbit) = balance.solve(&model.static_state_of_train([9e8; 2]), 1e-7) else { continue };
                let limits = IntegrationLimits { tolerance: 1e-9, max_steps: 1_000_000, watch: &Watch::none() };
                let shooting = Shooting::new(&model, [9e8; 2], limits).unwrap();
                let map = shooting.period_map(&model, orbit.start, 1).unwrap();
                let modulus = shooting.multipliers(&map.monodromy)[0].norm();
                let surely = balance.is_surely_stable(&orbit);
                assert!(!surely || modulus < 1.0, "{frequency} {variation}: {modulus}");
                proven += usize::from(surely);
                unstable += usize::from(modulus > 1.0);
            }
        }
    }
    println!("{proven} proven stable, {unstable} unstable");
    assert!(proven >= 6 && unstable >= 2, "{proven} {unstable}");
}
