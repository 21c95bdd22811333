//! Whole stages on the source paper's example pair, as a job runs them.
//!
//! `cargo bench -p herringbone-job --bench chain`; what came out stands in docs/BENCHMARKS.md.

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use herringbone_job::parse_value;
use herringbone_job::study::{self, CheckedJob, SolveContext};
use serde_json::{Value, json};
use std::hint::black_box;

fn example(change: impl FnOnce(&mut Value)) -> CheckedJob {
    let mut value: Value =
        serde_json::from_str(include_str!("../../../examples/table1.json")).expect("the example is JSON");
    value["analysis"]["channels"] = json!([]);
    change(&mut value);
    parse_value(&value).and_then(CheckedJob::new).expect("a valid document")
}

fn solve(job: &CheckedJob) -> study::Outcome {
    let context = SolveContext::none();
    study::solve(job, &context).expect("the example solves")
}

fn documents(criterion: &mut Criterion) {
    let bytes = include_bytes!("../../../examples/table1.json");
    criterion.bench_function("document: parse", |b| b.iter(|| herringbone_job::parse(black_box(bytes))));
    let document = example(|_| {}).into_document();
    criterion.bench_function("document: geometry and warnings", |b| {
        b.iter(|| CheckedJob::new(black_box(&document).clone()).map(|job| job.report()));
    });
}

fn stages(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("job");
    group.sample_size(20);
    let mesh = |change: fn(&mut Value)| {
        example(|value| {
            value["kind"] = json!("mesh");
            change(&mut value["model"]["mesh_stiffness"]);
        })
    };
    let meshes = [
        ("positions by accuracy (default)", mesh(|_| {})),
        ("64 positions", mesh(|stiffness| stiffness["positions"] = json!(64))),
        ("256 positions", mesh(|stiffness| stiffness["positions"] = json!(256))),
    ];
    for (name, document) in meshes {
        group.bench_function(BenchmarkId::new("mesh, cold", name), |b| b.iter(|| solve(black_box(&document))));
    }
    let closed_form = example(|value| value["model"]["mesh_stiffness"] = json!({"source": "iso6336"}));
    group.bench_function("response, ISO 6336 stiffness", |b| b.iter(|| solve(black_box(&closed_form))));
    let whole = example(|_| {});
    group.bench_function("response, loaded contact, cold", |b| b.iter(|| solve(black_box(&whole))));
    let contact = example(|value| value["model"]["mesh_force"] = json!("contact"));
    group.bench_function("response, contact in the equations, cold", |b| b.iter(|| solve(black_box(&contact))));
    group.sample_size(10);
    for force in ["stiffness", "contact"] {
        let speeds = example(|value| {
            value["kind"] = json!("sweep");
            value["model"]["mesh_force"] = json!(force);
            value["axes"] =
                json!([{"pointer": "/operation/pinion_speed_rpm", "from": 500, "to": 12_000, "points": 1000}]);
        });
        group.bench_function(BenchmarkId::new("1000 speeds", force), |b| b.iter(|| solve(black_box(&speeds))));
    }
    group.finish();
}

criterion_group!(benches, documents, stages);
criterion_main!(benches);
