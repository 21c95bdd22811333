//! Tests of responses against the reference cases and against each other.

use super::*;
use crate::dynamics::Integrator;
use crate::dynamics::tests::reference::{parameters, reference};
use crate::watch::Watch;

fn integrate(name: &str, mesh_periods: u64, record: u64, accuracy: f64) -> Response {
    let case = &reference().cases[name];
    let analysis = Analysis {
        method: Method::Integrate { mesh_periods, record_mesh_periods: record },
        accuracy,
        initial_state: Some(case.initial_state.as_slice().try_into().unwrap()),
        ..Analysis::default()
    };
    solve(&parameters(name), &analysis, &Watch::none()).unwrap()
}

#[test]
fn integrated_cases_meet_the_reference() {
    for (name, regime) in [("A", Regime::Period1), ("C", Regime::PeriodN)] {
        for accuracy in [1e-4, 1e-6, 1e-9, 1e-12] {
            let r = integrate(name, 300, 100, accuracy);
            let rms = r.summary.rms.mesh_circumferential_acceleration_m_s2.left;
            let error = (rms / reference().cases[name].rms_200_to_300.unwrap() - 1.0).abs();
            println!(
                "{name} {accuracy:e}: error {error:.1e} estimate {:.1e} {:?}",
                r.summary.error_estimate, r.summary.numerics
            );
            assert!(error < accuracy, "{name} {accuracy}: {error}");
            assert!(error <= r.summary.error_estimate, "{name} {accuracy}: {error} {}", r.summary.error_estimate);
            assert_eq!(r.summary.regime, regime);
        }
    }
}

#[test]
fn the_steady_state_needs_no_transient() {
    for (name, accuracy) in [("A", 1e-6), ("C", 1e-6), ("A", 1e-9), ("C", 1e-9)] {
        let analysis = Analysis { accuracy, ..Analysis::default() };
        let r = solve(&parameters(name), &analysis, &Watch::none()).unwrap();
        let rms = r.summary.rms.mesh_circumferential_acceleration_m_s2.left;
        let error = (rms / reference().cases[name].rms_200_to_300.unwrap() - 1.0).abs();
        println!("{name} {accuracy:e}: error {error:.1e} {:?}", r.summary);
    }
}

#[test]
fn chaos_is_recognised() {
    let r = integrate("B", 300, 100, 1e-9);
    println!("{:?}", r.summary);
    assert_eq!(r.summary.regime, Regime::Chaotic);
    let r = solve(&parameters("B"), &Analysis::default(), &Watch::none()).unwrap();
    println!("{:?}", r.summary);
    let _ = Integrator::Taylor;
}
