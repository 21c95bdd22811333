//! The loaded contact of one half of the source paper's example pair, part by part, on one core.
//!
//! `RAYON_NUM_THREADS=1 cargo bench -p herringbone-physics --bench contact`; what came out stands in
//! docs/BENCHMARKS.md.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use herringbone_physics::compliance::{Compliance, Settings};
use herringbone_physics::contact::{HalfContact, HalfCycle, solve_half};
use herringbone_physics::fe::{FlankFlexibility, Resolution};
use herringbone_physics::gear::{GearSpec, Half, Pair, PairSpec};
use herringbone_physics::watch::Watch;

/// Half of the example's pinion torque.
const TORQUE_NM: f64 = 400.0;

/// The teeth of examples/table1.json.
fn example() -> Pair {
    let helix_angle_rad = 24.43_f64.to_radians();
    let member = |teeth, bore_radius_m| GearSpec { bore_radius_m, ..GearSpec::plain(teeth) };
    // 20° in the transverse section.
    let normal_pressure_angle_rad = (20_f64.to_radians().tan() * helix_angle_rad.cos()).atan();
    let angles = [normal_pressure_angle_rad, helix_angle_rad];
    let spec = PairSpec::plain(6e-3, angles, 75e-3, [member(17, 25e-3), member(44, 60e-3)]);
    Pair::new(&spec).expect("the example is feasible").0
}

fn solve(pair: &Pair, compliance: &Compliance, settings: &Settings) -> HalfCycle {
    let force_n = TORQUE_NM / pair.pinion.base_radius_m;
    solve_half(pair, Half::Left, force_n, compliance, settings, Watch::none()).expect("the example solves")
}

fn elements(pair: &Pair, settings: &Settings, resolution: Resolution) -> [FlankFlexibility; 2] {
    Compliance::finite_element_inputs(pair, settings, resolution)
        .map(|input| FlankFlexibility::new(&input, Watch::none()).expect("the example has a mesh"))
}

fn compliance(pair: &Pair, settings: &Settings) -> Compliance {
    Compliance::analytic(pair, settings, Watch::none()).expect("not canceled")
}

fn analytic(criterion: &mut Criterion) {
    let pair = example();
    let adaptive = Settings::default();
    let equal = Settings { positions: Some(64), ..adaptive };
    let mut group = criterion.benchmark_group("analytic");
    group.bench_function("cold, 64 positions", |b| {
        b.iter(|| solve(&pair, &compliance(black_box(&pair), &equal), &equal));
    });
    group.bench_function("cold, positions by accuracy", |b| {
        b.iter(|| solve(&pair, &compliance(black_box(&pair), &adaptive), &adaptive));
    });
    group.bench_function("compliance alone", |b| b.iter(|| compliance(black_box(&pair), &adaptive)));
    let compliance = compliance(&pair, &adaptive);
    group.bench_function("contact alone, 64 positions", |b| b.iter(|| solve(black_box(&pair), &compliance, &equal)));
    group.bench_function("contact alone, positions by accuracy", |b| {
        b.iter(|| solve(black_box(&pair), &compliance, &adaptive));
    });
    let force_n = TORQUE_NM / pair.pinion.base_radius_m;
    group.bench_function("one position alone", |b| {
        b.iter(|| {
            let mut contact = HalfContact::new(black_box(&pair), Half::Left, &compliance, &adaptive, Watch::none());
            contact.at(0.3, force_n).expect("the example solves")
        });
    });
    group.finish();
}

fn finite_elements(criterion: &mut Criterion) {
    let pair = example();
    let settings = Settings::default();
    let mut group = criterion.benchmark_group("fe");
    group.sample_size(10);
    let flanks = elements(&pair, &settings, Resolution::Medium);
    group.bench_function("medium, from stored flanks, positions by accuracy", |b| {
        b.iter(|| {
            let compliance = Compliance::finite_elements(black_box(&pair), &settings, flanks.each_ref(), Watch::none())
                .expect("not canceled");
            solve(&pair, &compliance, &settings)
        });
    });
    group.bench_function("coarse, elements of both gears", |b| {
        b.iter(|| elements(black_box(&pair), &settings, Resolution::Coarse));
    });
    group.finish();
}

/// Everything on this thread, as the figures are meant.
fn on_one_thread(criterion: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().expect("the first pool");
    analytic(criterion);
    finite_elements(criterion);
}

criterion_group!(benches, on_one_thread);
criterion_main!(benches);
