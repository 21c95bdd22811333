//! Time per mesh period of the methods, alone and in lanes, and time per operating point, on the reference cases.
//!
//! `cargo bench -p herringbone-physics --bench dynamics`

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use herringbone_physics::dynamics::{Integrator, NaturalModes, Parameters, advance, advance_many};
use herringbone_physics::response::{Analysis, SolutionMethod, solve, solve_many};
use herringbone_physics::watch::Watch;

#[path = "dynamics_cases.rs"]
mod cases;

const PERIODS: u64 = 100;
const POINTS: usize = 32;
/// Local errors of a step: that of an integration with an accuracy of 1e-6, and a fine one.
const TOLERANCES: [(f64, &str); 2] = [(5e-8, ""), (1e-12, ", tolerance 1e-12")];

/// Static deflection at rest, both halves mirrored to the last bit.
fn start(p: &Parameters) -> [f64; 24] {
    let mut start = [0.0; 24];
    if let Ok(modes) = NaturalModes::new(p) {
        start[..12].copy_from_slice(&modes.static_deflection(p));
    }
    for c in 0..6 {
        start[6 + c] = if c == 1 || c == 4 { -start[c] } else { start[c] };
    }
    start
}

/// The case at `points` equally spaced speeds from 0.5 to 1.5 of its own.
fn speeds(p: &Parameters, points: usize) -> Vec<Parameters> {
    let at = |i| Parameters { mesh_frequency_hz: p.mesh_frequency_hz * (0.5 + i as f64 / points as f64), ..p.clone() };
    (0..points).map(at).collect()
}

/// Trajectories without statistics. One mesh period of one point takes 1/100 (alone) or 1/3200 (in lanes) of the time.
fn trajectories(c: &mut Criterion) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool of one thread");
    for name in ["A", "B", "C"] {
        let p = cases::case(name);
        let from = start(&p);
        let mut staggered = p.clone();
        staggered.halves[1].phase_shift_mesh_periods = 0.5;
        for (what, p) in [("6 coordinates", &p), ("12 coordinates", &staggered)] {
            let points = vec![p.clone(); POINTS];
            let starts = vec![from; POINTS];
            for (tolerance, label) in TOLERANCES {
                c.bench_function(&format!("{name}, {what}: 100 mesh periods alone{label}"), |b| {
                    b.iter(|| advance(black_box(p), &from, PERIODS, Integrator::Taylor, tolerance, &Watch::none()));
                });
                let id = format!("{name}, {what}: 100 mesh periods of 32 points in lanes, one thread{label}");
                c.bench_function(&id, |b| {
                    b.iter(|| {
                        pool.install(|| advance_many(black_box(&points), &starts, PERIODS, tolerance, &Watch::none()))
                    });
                });
            }
        }
    }
}

/// Responses of one operating point.
fn points(c: &mut Criterion) {
    for name in ["A", "C"] {
        let p = cases::case(name);
        let auto = Analysis { energy_balance: false, ..Analysis::default() };
        c.bench_function(&format!("{name}: steady state of one point"), |b| {
            b.iter(|| solve(black_box(&p), &auto, &Watch::none()).map(|r| r.summary.error_estimate));
        });
        let recorded = SolutionMethod::Integrate { mesh_periods: PERIODS, record_mesh_periods: PERIODS };
        let recorded = Analysis { method: recorded, ..auto.clone() };
        c.bench_function(&format!("{name}: 100 mesh periods recorded, with their error"), |b| {
            b.iter(|| solve(black_box(&p), &recorded, &Watch::none()).map(|r| r.summary.error_estimate));
        });
    }
}

/// Responses of 1000 operating points, on all threads of the pool.
fn sweeps(c: &mut Criterion) {
    let mut group = c.benchmark_group("1000 speeds");
    group.sample_size(10);
    let auto = Analysis { energy_balance: false, ..Analysis::default() };
    let linear = speeds(&cases::case("A"), 1000);
    group.bench_function("A: steady states", |b| b.iter(|| solve_many(black_box(&linear), &auto, &Watch::none())));
    let method = SolutionMethod::Integrate { mesh_periods: 300, record_mesh_periods: 100 };
    let integrate = Analysis { method, ..auto };
    let separating = speeds(&cases::case("C"), 1000);
    group.bench_function("C: 300 mesh periods each, 100 recorded", |b| {
        b.iter(|| solve_many(black_box(&separating), &integrate, &Watch::none()));
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    targets = trajectories, points, sweeps
}
criterion_main!(benches);
