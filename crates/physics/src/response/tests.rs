//! Responses against the reference cases, against each other and at random parameters.

use std::cell::Cell;

use proptest::prelude::*;
use proptest::test_runner::TestRunner;

use super::*;
use crate::dynamics::tests::reference::{parameters, reference};
use crate::dynamics::{DynamicsError, Harmonic, ImpactExcitation, Integrator, Parameters, Spring, Stiffness};
use crate::watch::{Canceled, Watch};
use herringbone_oracle::Tolerance::{Absolute, Relative};
use herringbone_oracle::{check, check_worst};

fn integrate(name: &str, mesh_periods: u64, record: u64, accuracy: f64, integrator: Integrator) -> Response {
    let case = &reference().cases[name];
    let analysis = Analysis {
        method: SolutionMethod::Integrate { mesh_periods, record_mesh_periods: record },
        integrator,
        accuracy,
        initial_state: Some(case.initial_state.as_slice().try_into().unwrap()),
        ..Analysis::default()
    };
    solve(&parameters(name), &analysis, &Watch::none()).unwrap()
}

fn auto(p: &Parameters, accuracy: f64) -> Response {
    solve(p, &Analysis { accuracy, ..Analysis::default() }, &Watch::none()).unwrap()
}

fn mesh_rms(r: &Response) -> f64 {
    r.summary.rms.mesh_circumferential_acceleration_m_s2.left
}

/// The estimate is not below the error, nor more than a hundred times above (above the rounding of the reference).
fn honest(name: &str, what: &str, r: &Response, accuracy: f64) {
    let expected = reference().cases[name].rms_200_to_300.unwrap();
    let error = (mesh_rms(r) / expected - 1.0).abs();
    let estimate = r.summary.error_estimate;
    println!("{what} {accuracy:.0e}: error {error:.1e} estimate {estimate:.1e} steps {}", r.summary.counts.steps);
    let topic = format!("Response: reference case {name}, RMS of x_left''");
    check(&topic, &format!("{what}, accuracy {accuracy:.0e}, m/s²"), mesh_rms(r), expected, Relative(accuracy));
    assert!(error <= estimate, "{what} {accuracy}: {error} {estimate}");
    assert!(estimate <= 100.0 * error.max(3e-14), "{what} {accuracy}: {error} {estimate}");
}

#[test]
fn integrated_cases_meet_the_reference() {
    for (name, regime) in [("A", Regime::Period1), ("C", Regime::PeriodN)] {
        for accuracy in [1e-4, 1e-6, 1e-8, 1e-10] {
            let r = integrate(name, 300, 100, accuracy, Integrator::Taylor);
            honest(name, "periods 200 to 300 integrated", &r, accuracy);
            assert_eq!((r.summary.regime, r.summary.degrees_of_freedom), (regime, 6));
        }
        let r = integrate(name, 300, 100, 1e-6, Integrator::RungeKutta);
        honest(name, "the same by Runge–Kutta", &r, 1e-6);
        assert_eq!(r.summary.regime, regime);
    }
}

#[test]
fn the_steady_state_needs_no_transient() {
    for (name, n, contact) in [("A", 1, ContactState::Continuous), ("C", 2, ContactState::SingleSided)] {
        for accuracy in [1e-6, 1e-9] {
            let r = auto(&parameters(name), accuracy);
            honest(name, "periodic motion solved for", &r, accuracy);
            assert_eq!(r.summary.period_mesh_periods, Some(n));
            assert_eq!((r.summary.contact, r.summary.method), (contact, AppliedMethod::Periodic));
        }
    }
    // From an independent solution: slowest multiplier 0.891 with both halves free to move on their own.
    let r = auto(&parameters("A"), 1e-6);
    let modulus = r.summary.floquet_modulus.unwrap();
    check("Response: regime", "slowest multiplier of case A", modulus, 0.891, Absolute(5e-4));
}

/// Over the whole run, transient included: fraction of time in contact and extremes of s.
#[test]
fn contact_and_extremes_meet_the_reference() {
    for name in ["A", "B", "C"] {
        let case = &reference().cases[name];
        let analysis = Analysis {
            method: SolutionMethod::Integrate { mesh_periods: 300, record_mesh_periods: 300 },
            accuracy: 1e-9,
            initial_state: Some(case.initial_state.as_slice().try_into().unwrap()),
            channels: vec![ChannelId::parse("s_left").unwrap()],
            samples_per_mesh_period: 0,
            ..Analysis::default()
        };
        let r = solve(&parameters(name), &analysis, &Watch::none()).unwrap();
        let s = &r.summary.statistics["s_left"];
        // Case B is chaotic: only its statistics can be compared. The reference's extremes are those of the ends of its
        // (long) steps, so the true ones lie outside.
        let close = if name == "B" { 0.05 } else { 5e-3 };
        let topic = "Response: contact and extremes over 300 periods";
        let of = |what: &str| format!("case {name}, {what}");
        check(
            topic,
            &of("share of time in contact"),
            r.summary.contact_share.left,
            case.fraction_contact,
            Absolute(close),
        );
        check(topic, &of("least s, µm"), s.min * 1e6, case.s_min_um, Relative(close));
        check(topic, &of("greatest s, µm"), s.max * 1e6, case.s_max_um, Relative(close));
        assert!(name == "B" || (s.min * 1e6 < case.s_min_um && s.max * 1e6 > case.s_max_um), "{name} {s:?}");
    }
}

/// Independent solutions: RMS on the attractor of all twelve coordinates 120.85 ± 0.15 (20000 periods), exponent 0.37.
#[test]
fn chaos_is_recognised() {
    let r = integrate("B", 300, 100, 1e-9, Integrator::Taylor);
    assert_eq!(r.summary.regime, Regime::Chaotic);
    assert_eq!(r.summary.degrees_of_freedom, 6);
    let r = auto(&parameters("B"), 1e-6);
    assert_eq!((r.summary.regime, r.summary.contact), (Regime::Chaotic, ContactState::SingleSided));
    assert_eq!(r.summary.degrees_of_freedom, 12);
    let exponent = r.summary.lyapunov_per_mesh_period.unwrap();
    check("Response: regime", "Lyapunov exponent of case B, per mesh period", exponent, 0.37, Absolute(0.08));
    assert!(r.summary.error_estimate < 0.02, "{:?}", r.summary);
    let threefold = Relative(3.0 * r.summary.error_estimate);
    check("Response: reference case B, RMS of x_left''", "on the attractor, m/s²", mesh_rms(&r), 120.85, threefold);
    let periodic = Analysis { method: SolutionMethod::Periodic, ..Analysis::default() };
    let refused = solve(&parameters("B"), &periodic, &Watch::none());
    assert!(matches!(refused, Err(DynamicsError::NotPeriodic { .. })), "{refused:?}");
}

/// A negligible difference of the halves makes twelve coordinates of six, with the same values.
#[test]
fn six_and_twelve_coordinates_agree() {
    for name in ["A", "C"] {
        let p = parameters(name);
        let mut q = p.clone();
        q.halves[1].gear_mass_kg *= 1.0 + 1e-13;
        let (six, twelve) = (auto(&p, 1e-9), auto(&q, 1e-9));
        assert_eq!((six.summary.degrees_of_freedom, twelve.summary.degrees_of_freedom), (6, 12));
        let topic = "Response: six against twelve coordinates";
        check_worst(topic, &format!("RMS of x_left'', case {name}"), [mesh_rms(&six) / mesh_rms(&twelve) - 1.0], 1e-9);
        let axial = |r: &Response| r.summary.rms.pinion_axial_acceleration_m_s2;
        let error = axial(&six).right / axial(&twelve).right - 1.0;
        check_worst(topic, &format!("RMS of the pinion's axial acceleration, case {name}"), [error], 1e-9);
        let error = six.summary.floquet_modulus.unwrap() - twelve.summary.floquet_modulus.unwrap();
        check_worst(topic, &format!("slowest multiplier, case {name}"), [error], 1e-6);
    }
}

#[test]
fn series_are_the_motion() {
    let mut p = parameters("A");
    p.halves[1].phase_shift_mesh_periods = 0.25;
    let names = [
        "x_left",
        "a_x_left",
        "a_y_p_left",
        "a_y_g_left",
        "theta_p_right",
        "v_theta_p_right",
        "f_n_left",
        "f_y_left",
        "s_right",
    ];
    let analysis = Analysis {
        channels: names.iter().map(|n| ChannelId::parse(n).unwrap()).collect(),
        samples_per_mesh_period: 2048,
        accuracy: 1e-9,
        ..Analysis::default()
    };
    let r = solve(&p, &analysis, &Watch::none()).unwrap();
    assert_eq!(r.channels.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), names);
    let channel = |name: &str| r.channels.iter().find(|c| c.name == name).unwrap();
    for c in &r.channels {
        assert_eq!(c.values.len(), 2048);
        let s = &r.summary.statistics[&c.name];
        let mean = c.values.iter().sum::<f64>() / 2048.0;
        let rms = (c.values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 2048.0).sqrt();
        assert!((rms / s.rms - 1.0).abs() < 1e-4 && (mean - s.mean).abs() < 1e-3 * s.rms, "{} {rms} {s:?}", c.name);
        let (low, high) = c.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        assert!(s.min <= low + 1e-9 * s.rms && s.max >= high - 1e-9 * s.rms, "{} {s:?}", c.name);
        // Accelerations have kinks at the edges of the pulses, which samples miss.
        let missed = if c.name.starts_with("a_") { 0.05 } else { 1e-4 };
        assert!(low - s.min < missed * s.rms && s.max - high < missed * s.rms, "{} {s:?} {low} {high}", c.name);
    }
    // Velocity is the slope of the rotation; the gear has the mesh force.
    let (theta, speed) = (channel("theta_p_right"), channel("v_theta_p_right"));
    for i in 1..2047 {
        let slope = (theta.values[i + 1] - theta.values[i - 1]) / (2.0 * theta.dt_s);
        assert!((slope - speed.values[i]).abs() < 1e-4 * r.summary.statistics["v_theta_p_right"].rms);
    }
    let cos = p.helix_angle_rad.cos();
    assert!(
        (channel("f_y_left").values[7] - cos * channel("f_n_left").values[7]).abs()
            < 1e-9 * channel("f_n_left").values[7]
    );
    // The mean mesh force is that of the torque less the mean impact.
    let static_n = p.halves[0].pinion_torque_nm / p.pinion_radius_m;
    let mean_impact = p.halves[0].impact.as_ref().unwrap().mean_n();
    let mean = r.summary.statistics["f_y_left"].mean;
    let topic = "Response: balances and equivalences";
    check(topic, "mean mesh force of case A: torque less mean impact, N", mean, static_n - mean_impact, Relative(1e-9));
    assert_eq!(r.summary.degrees_of_freedom, 12);
    let spectrum = Spectrum::of(channel("a_x_left"), p.mesh_frequency_hz);
    let power: f64 = spectrum.amplitude.iter().map(|a| a * a / 2.0).sum();
    let error = power.sqrt() / r.summary.statistics["a_x_left"].rms - 1.0;
    check_worst(topic, "power of the spectrum against the RMS", [error], 1e-4);
}

/// The same waveform as Fourier series and as samples.
#[test]
fn sampled_stiffness_is_met() {
    let p = parameters("A");
    let mut q = p.clone();
    for h in &mut q.halves {
        let values_n_per_m = (0..512).map(|i| h.mesh_stiffness.at(f64::from(i) / 512.0)).collect();
        h.mesh_stiffness = Stiffness::Samples { values_n_per_m };
    }
    let (a, b) = (auto(&p, 1e-6), auto(&q, 1e-6));
    let topic = "Response: balances and equivalences";
    let error = mesh_rms(&b) / mesh_rms(&a) - 1.0;
    check_worst(topic, "stiffness as 512 samples against its Fourier series, RMS", [error], 1e-4);
    // Both integrators use the samples alike.
    let rk = Analysis {
        method: SolutionMethod::Integrate { mesh_periods: 250, record_mesh_periods: 20 },
        integrator: Integrator::RungeKutta,
        ..Analysis::default()
    };
    let c = solve(&q, &rk, &Watch::none()).unwrap();
    let error = mesh_rms(&c) / mesh_rms(&b) - 1.0;
    check_worst(topic, "sampled stiffness, Runge–Kutta against the Taylor series, RMS", [error], 1e-6);
}

#[test]
fn no_excitation_no_motion() {
    let mut p = parameters("A");
    for h in &mut p.halves {
        h.impact = None;
        h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 9e8 };
    }
    for method in [SolutionMethod::Auto, SolutionMethod::Integrate { mesh_periods: 50, record_mesh_periods: 40 }] {
        let r = solve(&p, &Analysis { method, ..Analysis::default() }, &Watch::none()).unwrap();
        let topic = "Response: balances and equivalences";
        check_worst(
            topic,
            &format!("no excitation, RMS of x_left'' by {}, m/s²", format!("{:?}", r.summary.method).to_lowercase()),
            [mesh_rms(&r)],
            1e-6,
        );
        assert_eq!((r.summary.regime, r.summary.contact), (Regime::Period1, ContactState::Continuous));
        assert!((r.summary.dynamic_factor.unwrap() - 1.0).abs() < 1e-9);
    }
}

#[test]
fn an_unbalanced_pair_has_no_steady_state() {
    let mut p = parameters("A");
    p.halves[0].impact = None;
    let refused = solve(&p, &Analysis::default(), &Watch::none());
    assert!(matches!(refused, Err(DynamicsError::Unbalanced { .. })), "{refused:?}");
    p.balance_axially();
    let r = auto(&p, 1e-6);
    assert_eq!(r.summary.regime, Regime::Period1);
    assert!(
        r.summary.rms.mesh_circumferential_acceleration_m_s2.left
            < r.summary.rms.mesh_circumferential_acceleration_m_s2.right
    );
}

#[test]
fn light_load_rattles_between_both_flanks() {
    let mut p = parameters("C");
    p.half_backlash_m = 1e-6;
    p.halves.iter_mut().for_each(|h| h.pinion_torque_nm = 0.0);
    let r = auto(&p, 1e-6);
    assert_eq!(r.summary.contact, ContactState::DoubleSided);
    assert_eq!(r.summary.dynamic_factor, None);
    assert!(r.summary.min_displacement_m < -1e-6);
}

#[test]
fn a_canceled_response_stops() {
    let calls = std::sync::atomic::AtomicU64::new(0);
    let canceled = || calls.fetch_add(1, std::sync::atomic::Ordering::Relaxed) > 20;
    let watch = Watch::new(&|_| {}, &canceled);
    let r = solve(&parameters("B"), &Analysis::default(), &watch);
    assert_eq!(r, Err(DynamicsError::Canceled(Canceled)));
}

/// From 10^low to 10^high.
fn log(low: f64, high: f64) -> impl Strategy<Value = f64> {
    (low..high).prop_map(|e| 10f64.powf(e))
}

prop_compose! {
    fn random_parameters()(
        stiffness in prop::array::uniform6(log(3.0, 13.0)),
        (mp, mg, ip, ig) in (log(-1.0, 3.0), log(0.0, 4.0), log(-5.0, 2.0), log(-4.0, 4.0)),
        (rp, rg) in (log(-2.0, 0.0), log(-2.0, 0.5)),
        (zeta, zeta_m) in (0.0f64..2.0, 0.0f64..2.0),
        torque in prop_oneof![Just(0.0), log(0.0, 5.0), log(0.0, 5.0).prop_map(|t| -t)],
        backlash in prop_oneof![Just(0.0), log(-8.0, -3.0)],
        (rpm, teeth) in (log(0.0, 5.0), 10.0f64..100.0),
        beta in 0.0f64..0.8,
        amplitudes in prop::collection::vec((0.0f64..0.5, -3.0f64..3.0), 0..6),
        (force, duration, start) in (log(0.0, 5.0), 0.01f64..1.5, 0.0f64..1.0),
        shift in prop_oneof![Just(0.0), 0.0f64..1.0],
        (gap, torsion, sampled) in (any::<bool>(), any::<bool>(), any::<bool>()),
    ) -> Parameters {
        let mut p = parameters("A");
        p.mesh_frequency_hz = rpm / 60.0 * teeth;
        (p.pinion_radius_m, p.gear_radius_m, p.helix_angle_rad) = (rp, rg, beta);
        (p.half_backlash_m, p.damping_in_gap) = (backlash, gap);
        let me = crate::dynamics::equivalent_mass_kg(rp, ip, rg, ig);
        for (j, h) in p.halves.iter_mut().enumerate() {
            (h.pinion_mass_kg, h.gear_mass_kg, h.pinion_inertia_kg_m2, h.gear_inertia_kg_m2) = (mp, mg, ip, ig);
            h.pinion_torque_nm = torque;
            h.pinion_lateral = Spring::with_damping_ratio(stiffness[0], zeta, mp);
            h.gear_lateral = Spring::with_damping_ratio(stiffness[1], zeta, mg);
            h.gear_axial = Spring::with_damping_ratio(stiffness[2], zeta, mg);
            h.mesh_damping_n_s_per_m = crate::dynamics::mesh_damping_n_s_per_m(zeta_m, stiffness[3], me);
            h.mesh_stiffness = Stiffness::Fourier {
                mean_n_per_m: stiffness[3],
                harmonics: amplitudes.iter().map(|&(amplitude, phase_rad)| Harmonic { amplitude, phase_rad }).collect(),
            };
            if sampled {
                let values_n_per_m = (0..24).map(|i| h.mesh_stiffness.at(f64::from(i) / 24.0).max(0.0)).collect();
                h.mesh_stiffness = Stiffness::Samples { values_n_per_m };
            }
            h.impact = Some(ImpactExcitation::HalfSine { force_n: force, duration_mesh_periods: duration, start_mesh_periods: start });
            h.phase_shift_mesh_periods = shift * j as f64;
        }
        p.couplings.pinion_axial = Spring::with_damping_ratio(stiffness[4], zeta, mp);
        p.couplings.gear_axial = Spring::with_damping_ratio(stiffness[5], zeta, mg);
        if torsion {
            p.couplings.pinion_torsion = Spring::with_damping_ratio(1e6, zeta, ip);
        }
        p
    }
}

/// Whether the pair has a response; if so, its numbers must be finite.
fn is_solved(p: &Parameters, method: SolutionMethod, integrator: Integrator) -> Result<bool, TestCaseError> {
    let analysis = Analysis { method, integrator, max_steps: 20_000, accuracy: 1e-4, ..Analysis::default() };
    let Ok(r) = solve(p, &analysis, &Watch::none()) else { return Ok(false) };
    let s = &r.summary;
    for value in s.rms.channels.values().chain(&s.dynamic_factor).chain([&s.min_displacement_m]) {
        prop_assert!(value.is_finite(), "{s:?}");
    }
    prop_assert!(!s.error_estimate.is_nan());
    prop_assert!(r.final_state.iter().all(|c| c.is_finite()));
    Ok(true)
}

/// Every random pair ends in finite numbers or in an error, and some of them in numbers.
#[test]
fn random_parameters_end() {
    const CASES: u32 = 40;
    /// Smallest number of responses by all methods together; 23 in a typical run, less than this in one of some 1e5.
    const MIN_SOLVED: u32 = 2;
    let integrate = SolutionMethod::Integrate { mesh_periods: 30, record_mesh_periods: 10 };
    let methods = [
        (SolutionMethod::Auto, Integrator::Taylor),
        (integrate, Integrator::Taylor),
        (integrate, Integrator::RungeKutta),
    ];
    let solved = [const { Cell::new(0) }; 3];
    let config = ProptestConfig { cases: CASES, source_file: Some(file!()), ..ProptestConfig::default() };
    let mut runner = TestRunner::new(config);
    let ended = runner.run(&random_parameters(), |p| {
        for ((method, integrator), solved) in methods.into_iter().zip(&solved) {
            solved.set(solved.get() + u32::from(is_solved(&p, method, integrator)?));
        }
        Ok(())
    });
    if let Err(error) = ended {
        panic!("{error}\n{runner}");
    }
    for ((method, integrator), solved) in methods.into_iter().zip(&solved) {
        println!("{method:?} by {integrator:?}: {} of {CASES} pairs have a response", solved.get());
    }
    assert!(solved.iter().map(Cell::get).sum::<u32>() >= MIN_SOLVED, "{solved:?}");
}
