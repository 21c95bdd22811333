//! The loaded contact of one half of the source paper's example pair, part by part, on one core.
//!
//! `RAYON_NUM_THREADS=1 cargo bench -p herringbone-physics --bench contact`; what came out stands in
//! docs/BENCHMARKS.md.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use herringbone_physics::compliance::{Compliance, Settings};
use herringbone_physics::contact::{
    ContactShafts, HalfContact, HalfCycle, Hand, MeshFrame, sense_of_rotation, solve_half, solve_on_shafts,
    solve_pair_of_halves,
};
use herringbone_physics::fe::{FlankFlexibility, Resolution};
use herringbone_physics::gear::{FlankModification, GearSpec, Half, Pair, PairSpec};
use herringbone_physics::shafts::{Bearing, Coupling, Shaft, ShaftMaterial, ShaftSegment, ShaftTrain};
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

/// A shaft of one diameter between two bearings with the gear bodies in the middle.
fn shaft(diameter_m: f64, body_m: f64, axial_n_per_m: f64) -> Shaft {
    let segment = |length_m, diameter_m| ShaftSegment { length_m, diameter_m, bore_m: 0.0 };
    Shaft {
        segments: vec![segment(0.13, diameter_m), segment(0.18, body_m), segment(0.13, diameter_m)],
        gear_position_m: 0.22,
        bearings: vec![Bearing { axial_n_per_m, ..Bearing::radial(0.05, 1e9) }, Bearing::radial(0.39, 1e9)],
        coupling: Coupling { position_m: 0.0, axial_n_per_m: 0.0, torsional: None },
        half_body: None,
        bodies: Vec::new(),
        material: ShaftMaterial { youngs_modulus_pa: 206e9, poissons_ratio: 0.3, density_kg_m3: 7850.0 },
    }
}

/// Both halves, unequal by a helix slope so that both are solved, on rigid bodies and on elastic shafts: 32 positions.
fn on_shafts(criterion: &mut Criterion) {
    let mut pair = example();
    pair.spec.pinion.flanks[0] = FlankModification { helix_slope_m: 3e-6, ..FlankModification::NONE };
    pair.spec.gap_width_m = 0.03;
    let settings = Settings { positions: Some(32), ..Settings::default() };
    let compliance = compliance(&pair, &settings);
    let train = ShaftTrain { pinion: shaft(0.08, 0.097, 0.0), gear: shaft(0.12, 0.275, 4e8) };
    let frame = || MeshFrame::new(&pair, sense_of_rotation(Hand::Left, pair.spec.rotation), Hand::Left, false);
    let shafts = ContactShafts::new(&train, frame(), &compliance).expect("supported shafts");
    let torque_nm = 2.0 * TORQUE_NM;
    let mut group = criterion.benchmark_group("both halves");
    group.bench_function("on rigid bodies", |b| {
        b.iter(|| solve_pair_of_halves(black_box(&pair), torque_nm, 0.0, &compliance, &settings, Watch::none()));
    });
    group.bench_function("on shafts", |b| {
        let with = (&compliance, &settings);
        b.iter(|| solve_on_shafts(black_box(&pair), &shafts, (torque_nm, 0.0, 0.0), false, with, Watch::none()));
    });
    group.bench_function("flexibility of the shafts", |b| {
        b.iter(|| ContactShafts::new(black_box(&train), frame(), &compliance));
    });
    group.finish();
}

/// Everything on this thread, as the figures are meant.
fn on_one_thread(criterion: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().expect("the first pool");
    analytic(criterion);
    on_shafts(criterion);
    finite_elements(criterion);
}

criterion_group!(benches, on_one_thread);
criterion_main!(benches);
