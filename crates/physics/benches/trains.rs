//! Time of a response with a reduced train of 40 modes against the twelve degrees of freedom of the same pair, with the
//! same tabulated contact force.
//!
//! `cargo bench -p herringbone-physics --bench trains`

use std::hint::black_box;
use std::sync::Arc;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use herringbone_physics::dynamics::{ContactForce, FlankForce, LinearOutput, ModalTrain, Parameters, Spring};
use herringbone_physics::response::{Analysis, solve};
use herringbone_physics::watch::Watch;

#[path = "dynamics_cases.rs"]
mod cases;
#[path = "train_cases.rs"]
mod train_cases;

/// A contact force as a contact analysis leaves it: 96 knots, nine levels, a first contact that varies over the phase,
/// F = k(φ) e²/(e + c).
fn contact_force() -> ContactForce {
    const KNOTS: usize = 96;
    let knots: Vec<f64> = (0..KNOTS).map(|i| i as f64 / KNOTS as f64).collect();
    let level_m: Vec<f64> = [0.0, 0.1, 0.3, 0.6, 1.0, 1.5, 2.4, 3.8, 6.0].map(|level| level * 12e-6).to_vec();
    let tau = std::f64::consts::TAU;
    let stiffness = |phase: f64| {
        let (a, b) = ((tau * phase).cos(), (2.0 * tau * phase + 0.7).cos());
        let slopes = (-tau * (tau * phase).sin(), -2.0 * tau * (2.0 * tau * phase + 0.7).sin());
        (1.1e9 * (1.0 + 0.1 * a + 0.04 * b), 1.1e9 * (0.1 * slopes.0 + 0.04 * slopes.1))
    };
    let free_m = |phase: f64| [0.4e-6 * (1.0 - (tau * phase).cos()), 0.4e-6 * tau * (tau * phase).sin()];
    let softening_m = 2e-6;
    let node = |phase: f64, e: f64| {
        let (k, slope) = stiffness(phase);
        let shape = e * e / (e + softening_m);
        let rise = e * (e + 2.0 * softening_m) / (e + softening_m).powi(2);
        [k * shape, k * rise, slope * shape, slope * rise]
    };
    let flank = FlankForce {
        free_m: knots.iter().map(|phase| free_m(*phase)).collect(),
        nodes: level_m.iter().map(|e| knots.iter().map(|phase| node(*phase, *e)).collect()).collect(),
        level_m,
    };
    ContactForce::new(knots, [&flank, &flank]).expect("a contact force")
}

fn with_contact(stagger: f64) -> Parameters {
    let mut p = cases::case("A");
    let force = Arc::new(contact_force());
    for h in &mut p.halves {
        h.impact = None;
        h.contact_force = Some(force.clone());
    }
    p.halves[1].phase_shift_mesh_periods = stagger;
    // Not mirror-symmetric: twelve coordinates.
    p.halves[1].gear_mass_kg *= 1.0 + 1e-15;
    p
}

fn with_train(p: &Parameters, further: usize, gyroscopic: f64) -> Parameters {
    Parameters { train: Some(Arc::new(train_cases::train_of(p, further, gyroscopic))), ..p.clone() }
}

fn responses(c: &mut Criterion) {
    let analysis = Analysis::default();
    let mut measure = |what: &str, p: Parameters| {
        c.bench_function(what, |b| b.iter(|| solve(black_box(&p), &analysis, &Watch::none())));
    };
    for (label, stagger) in [("", 0.0), (", staggered", 0.3)] {
        let p = with_contact(stagger);
        measure(&format!("contact force, 12 degrees of freedom{label}"), p.clone());
        measure(&format!("contact force, train of 12 modes{label}"), with_train(&p, 0, 0.0));
        measure(&format!("contact force, train of 40 modes{label}"), with_train(&p, 28, 0.0));
        measure(&format!("contact force, train of 40 modes, gyroscopic{label}"), with_train(&p, 28, 0.02));
        measure(&format!("contact force, train of 96 modes, gyroscopic{label}"), with_train(&p, 84, 0.02));
    }
    for name in ["A", "C"] {
        let mut p = cases::case(name);
        p.halves[1].gear_mass_kg *= 1.0 + 1e-15;
        measure(&format!("case {name}, 12 degrees of freedom"), p.clone());
        measure(&format!("case {name}, train of 40 modes, gyroscopic"), with_train(&p, 28, 0.02));
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    targets = responses
}
criterion_main!(benches);
