//! Motions in lanes are bit-identical to the motions alone.

use super::reference::{parameters, reference};
use crate::dynamics::*;
use crate::watch::{Canceled, Watch};

fn start(name: &str) -> [f64; 24] {
    reference().cases[name].initial_state.as_slice().try_into().unwrap()
}

/// Points of different cases, speeds, excitations and symmetries, so that lanes have nothing in common.
fn points() -> (Vec<Parameters>, Vec<[f64; 24]>) {
    let mut all = Vec::new();
    for (i, name) in ["A", "B", "C"].into_iter().cycle().take(21).enumerate() {
        let mut p = parameters(name);
        p.mesh_frequency_hz *= 0.3 + 0.11 * i as f64;
        if i % 5 == 1 {
            p.halves[1].phase_shift_mesh_periods = 0.25;
        }
        if i % 5 == 2 {
            let values_n_per_m = (0..16).map(|k| 9e8 + 1e8 * (f64::from(k) * 1.7).sin()).collect();
            p.halves
                .iter_mut()
                .for_each(|h| h.mesh_stiffness = Stiffness::Samples { values_n_per_m: Vec::clone(&values_n_per_m) });
        }
        if i % 5 == 3 {
            p.halves.iter_mut().for_each(|h| h.impact = None);
            p.damping_in_gap = false;
        }
        if i % 5 == 4 {
            let harmonics = vec![Harmonic { amplitude: 900.0, phase_rad: 0.4 }];
            p.halves
                .iter_mut()
                .for_each(|h| h.impact = Some(ImpactExcitation::Harmonics { harmonics: harmonics.clone() }));
        }
        all.push((p, start(name)));
    }
    all.into_iter().unzip()
}

#[test]
fn lanes_change_nothing() {
    let (points, starts) = points();
    for tolerance in [1e-6, 5e-8, 1e-12] {
        let many = advance_many(&points, &starts, 7, tolerance, &Watch::none()).unwrap();
        for ((p, s), reached) in points.iter().zip(&starts).zip(many) {
            let alone = advance(p, s, 7, Integrator::Taylor, tolerance, &Watch::none()).unwrap();
            let reached = reached.unwrap();
            assert_eq!(alone.state.map(f64::to_bits), reached.state.map(f64::to_bits));
            assert_eq!(alone.counts.steps, reached.counts.steps);
        }
    }
}

#[test]
fn any_number_of_threads_gives_the_same() {
    let (points, starts) = points();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| advance_many(&points, &starts, 5, 5e-8, &Watch::none()).unwrap())
    };
    for (a, b) in run(1).into_iter().zip(run(3)) {
        assert_eq!(a.unwrap().state.map(f64::to_bits), b.unwrap().state.map(f64::to_bits));
    }
}

#[test]
fn a_bad_point_fails_alone_and_a_watch_stops_all() {
    let (mut points, starts) = points();
    points[3].mesh_frequency_hz = f64::NAN;
    let many = advance_many(&points, &starts, 2, 5e-8, &Watch::none()).unwrap();
    let failed: Vec<usize> = (0..many.len()).filter(|&i| many[i].is_err()).collect();
    assert_eq!(failed, [3]);
    let canceled = advance_many(&points, &starts, 1_000_000, 5e-8, &Watch::new(&|_| {}, &|| true));
    assert_eq!(canceled.unwrap_err(), Canceled);
}
