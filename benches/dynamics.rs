//! Time per mesh period of the Taylor method and time per operating point, on the reference cases.
//!
//! `cargo bench --no-default-features --bench dynamics`

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use herringbone::dynamics::{
    Couplings, HalfParameters, Harmonic, Impact, Parameters, Spring, Stiffness, equivalent_mass_kg,
    mesh_damping_n_s_per_m,
};
use herringbone::response::{Analysis, Method, solve};
use herringbone::watch::Watch;

/// Reference cases A (linear, contact kept) and C (period 2, contact lost and closed) of tests/data/dynamics_reference.json.
fn parameters(torque_per_half_nm: f64, half_backlash_m: f64, damping_ratio: f64, amplitude: f64) -> Parameters {
    let (rp, rg) = (0.056_015_195_318_438_44, 0.144_980_505_530_064_2);
    let (mp, ip, mg, ig) = (6.0, 0.0325, 38.0, 1.85);
    let me = equivalent_mass_kg(rp, ip, rg, ig);
    let harmonics = [(1.0, 0.3), (0.05 / 0.12, 1.1), (0.25, 2.0), (0.125, 0.7)];
    let half = HalfParameters {
        pinion_mass_kg: mp,
        pinion_inertia_kg_m2: ip,
        gear_mass_kg: mg,
        gear_inertia_kg_m2: ig,
        pinion_torque_nm: torque_per_half_nm,
        pinion_lateral: Spring::with_damping_ratio(6e8, 0.03, mp),
        gear_lateral: Spring::with_damping_ratio(6e8, 0.03, mg),
        pinion_axial: Spring::default(),
        gear_axial: Spring::with_damping_ratio(2e8, 0.03, mg),
        mesh_stiffness: Stiffness::Fourier {
            mean_n_per_m: 9e8,
            harmonics: harmonics.map(|(a, phase_rad)| Harmonic { amplitude: a * amplitude, phase_rad }).to_vec(),
        },
        mesh_damping_n_s_per_m: mesh_damping_n_s_per_m(damping_ratio, 9e8, me),
        impact: Some(Impact::HalfSine { force_n: 3000.0, duration_mesh_periods: 0.08, start_mesh_periods: 0.0 }),
        phase_shift_mesh_periods: 0.0,
    };
    Parameters {
        mesh_frequency_hz: 2000.0 / 60.0 * 17.0,
        pinion_radius_m: rp,
        gear_radius_m: rg,
        helix_angle_rad: 24.43f64.to_radians(),
        half_backlash_m,
        damping_in_gap: true,
        halves: [half.clone(), half],
        couplings: Couplings {
            pinion_axial: Spring::with_damping_ratio(3e8, 0.03, mp),
            gear_axial: Spring::with_damping_ratio(3e8, 0.03, mg),
            ..Couplings::default()
        },
    }
}

fn bench(c: &mut Criterion) {
    let a = parameters(400.0, 1e-6, 0.1, 0.12);
    let mut staggered = a.clone();
    staggered.halves[1].phase_shift_mesh_periods = 0.5;
    let period_2 = parameters(40.0, 2e-5, 0.03, 0.24);
    for (name, p) in [("A", &a), ("A, 12 coordinates", &staggered), ("C", &period_2)] {
        // The difference of the two divided by 1000 is the cost of one mesh period; of the last two, with statistics.
        for (what, mesh_periods, record) in
            [("1 period", 1, 1), ("1001 periods", 1001, 1), ("1001 recorded", 1001, 1001)]
        {
            let method = Method::Integrate { mesh_periods, record_mesh_periods: record };
            let analysis = Analysis { method, ..Analysis::default() };
            c.bench_function(&format!("{name}: {what}"), |b| {
                b.iter(|| solve(black_box(p), &analysis, &Watch::none()).map(|r| r.summary.error_estimate))
            });
        }
        let analysis = Analysis::default();
        c.bench_function(&format!("{name}: auto"), |b| {
            b.iter(|| solve(black_box(p), &analysis, &Watch::none()).map(|r| r.summary.error_estimate))
        });
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).warm_up_time(std::time::Duration::from_millis(300)).measurement_time(std::time::Duration::from_secs(2));
    targets = bench
}
criterion_main!(benches);
