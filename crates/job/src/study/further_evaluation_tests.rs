//! Optimisations and tolerance studies: ratios to the input, time limits, searches on a robust measure, halves on their
//! own, deviations in company, further samples, neighbours of the best design.

use super::evaluation_tests::{Rows, given, job, optimised, outcome, refused, search, studied, study};
use super::{SolveContext, Stage, StageStore, solve};
use crate::arbitrary;
use crate::result::{EvaluationPhase, SweepPoint};
use proptest::prelude::*;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::sync::Mutex;

/// The pointers of what is wrong with a document after a change.
fn wrong(mut document: Value, change: impl FnOnce(&mut Value)) -> Vec<String> {
    change(&mut document);
    refused(&document).into_iter().map(|(pointer, _)| pointer).collect()
}

#[test]
fn an_objective_relative_to_the_input_is_a_ratio() {
    let mut document = search();
    document["objectives"][0] = json!({"measure": "/response/rms/mesh_circumferential_acceleration_m_s2",
        "over": "worst", "relative_to": "input"});
    let result = optimised(&document);
    let objective = &result.objectives[0];
    assert_eq!((objective.input, objective.relative_to.as_deref()), (Some(1.0), Some("input")));
    let ratios = objective.per_point.iter().map(|point| point.best.unwrap() / point.input.unwrap());
    let worst = ratios.fold(0.0, f64::max);
    assert!((objective.best.unwrap() / worst - 1.0).abs() < 1e-12 && worst < 1.0, "{objective:?}");
    assert!((objective.gain_percent.unwrap() - 100.0 * (1.0 - worst)).abs() < 1e-9);
    // A measure that is 0 for the input has no ratio.
    document["objectives"][0]["measure"] = json!("/mesh/transmission_error_pp_um");
    document["model"]["mesh_stiffness"] = json!({"source": "given", "mean_n_per_um": 900.0});
    let error = solve(&job(&document), &SolveContext::none()).expect_err("no ratio").to_string();
    assert!(error.contains("/objectives/0/relative_to"), "{error}");
    let found = wrong(search(), |value| {
        value["objectives"][0]["relative_to"] = json!("input");
        value["objectives"][0]["goal"] = json!("target");
        value["objectives"][0]["target"] = json!(1.0);
    });
    assert!(found.contains(&"/objectives/0/relative_to".to_owned()), "{found:?}");
}

#[test]
fn a_search_ends_when_its_time_is_up() {
    let mut document = search();
    document["budget"] = json!({"evaluations": 600, "seconds": 12});
    document["tolerances"] = json!([{"pointer": "/design/supports/damping_ratio", "tolerance": 0.001}]);
    document["robust"] = json!({"samples": 8, "candidates": 2, "confirm_samples": 8});
    // A quarter of a second for each row.
    let rows = Rows::default();
    let clock_ms = || 250.0 * rows.saved.lock().unwrap().len() as f64;
    let context = SolveContext { points: &rows, clock_ms: &clock_ms, ..SolveContext::none() };
    let result = solve(&job(&document), &context).unwrap().result.optimise.unwrap();
    assert_eq!(result.numerics.stopped_by, "time");
    assert!(result.numerics.evaluations < 150 && result.best.is_some(), "{}", result.numerics.evaluations);
    let best = &result.points[result.best.unwrap().position as usize];
    assert!(best.values[0] % 10.0 == 0.0 && best.values[3].fract() == 0.0, "{best:?}");
    // What was interrupted after the search goes on from there, however much time it has.
    let stored = rows.saved.into_inner().unwrap().into_iter().take(result.points.len() - 2);
    let before = stored.map(|(position, row)| (position, serde_json::from_str(&row).unwrap())).collect();
    let resumed = Rows { before, ..Rows::default() };
    let context = SolveContext { points: &resumed, ..SolveContext::none() };
    let again = solve(&job(&document), &context).unwrap().result.optimise.unwrap();
    assert_eq!(again.points, result.points);
    assert_eq!(again.numerics, result.numerics);
    assert_eq!(wrong(search(), |value| value["budget"] = json!({"seconds": 0.5})), ["/budget/seconds"]);
}

#[test]
fn a_search_on_the_robust_measure_goes_on_from_the_winner() {
    let mut document = search();
    document["tolerances"] = json!([{"pointer": "/operation/pinion_torque_nm", "tolerance": 10.0}]);
    document.as_object_mut().unwrap().remove("operating_points");
    document["robust"] =
        json!({"samples": 8, "candidates": 3, "confirm_samples": 64, "search": true, "search_designs": 60});
    let parsed = crate::parse_value(&document).unwrap();
    let result = optimised(&document);
    assert!(result.points.len() as u64 <= parsed.evaluations(), "{} {}", result.points.len(), parsed.evaluations());
    let robust = result.robust.unwrap();
    let found = robust.search.unwrap();
    assert!(found.designs > 20 && found.designs <= 60 && found.after < found.before, "{found:?}");
    let row = &result.points[result.best.unwrap().position as usize];
    assert!(row.violation == Some(0.0) && row.values[3].fract() == 0.0, "{row:?}");
    assert!(robust.best.unwrap().p90 < robust.input.unwrap().p90 && robust.nominal_best.is_some());
    let found = wrong(document, |value| value["robust"]["search"] = json!(false));
    assert_eq!(found, ["/robust/search_designs"]);
}

#[test]
fn halves_deviate_for_themselves() {
    let mut document = study("from_sample");
    document["samples"] = json!(16);
    document["design"]["pinion"]["helix_slope_um"] = json!(2.0);
    document["tolerances"] = json!([
        {"pointer": "/design/pinion/helix_slope_um", "halves": "independent", "tolerance": 6.0},
        {"pointer": "/design/gear/profile_shift", "distribution": "uniform", "plus": 0.01, "halves": "together"},
    ]);
    document["correlations"] = json!([{"pointers": ["/design/pinion/helix_slope_um"], "correlation": 0.5}]);
    let parsed = crate::parse_value(&document).unwrap_or_else(|error| panic!("{error:?}"));
    let pointers: Vec<&str> = parsed.tolerances.iter().map(|one| one.pointer.as_str()).collect();
    let halves = ["/design/pinion/left/helix_slope_um", "/design/pinion/right/helix_slope_um"];
    assert_eq!(pointers, [halves[0], "/design/gear/profile_shift", halves[1]]);
    assert_eq!(parsed.correlations[0].pointers, halves);
    assert_eq!(crate::parse_value(&serde_json::to_value(&parsed).unwrap()).unwrap(), parsed);
    let result = studied(&document);
    let of = |input: usize| result.points.iter().map(|row| row.values[input]).collect::<Vec<_>>();
    assert!(result.points[0].values == [2.0, 0.0, 2.0] && of(0) != of(2), "{:?}", result.points[0].values);
    for (index, tolerance) in [
        json!({"pointer": "/design/face_width_mm", "halves": "independent", "tolerance": 1.0}),
        json!({"pointer": "/design/pinion/left/helix_slope_um", "halves": "independent", "tolerance": 1.0}),
        json!({"pointer": "/design/pinion/profile_shift", "halves": "independent", "tolerance": 0.1}),
    ]
    .into_iter()
    .enumerate()
    {
        let found = wrong(study("none"), |value| value["tolerances"][1] = tolerance);
        assert_eq!(found, ["/tolerances/1/pointer"], "{index}");
    }
}

fn correlation(points: &[SweepPoint]) -> f64 {
    let column = |input: usize| points.iter().map(|row| row.values[input]).collect::<Vec<_>>();
    let centred = |values: Vec<f64>| {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.into_iter().map(|value| value - mean).collect::<Vec<_>>()
    };
    let (a, b) = (centred(column(0)), centred(column(1)));
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt()
}

#[test]
fn inputs_deviate_in_company() {
    let pair = ["/design/face_width_mm", "/design/gear/profile_shift"];
    for expected in [0.8, -0.6] {
        let mut document = study("from_sample");
        document["samples"] = json!(256);
        document["tolerances"][1] = json!({"pointer": pair[1], "tolerance": 0.01, "cut": false});
        document["correlations"] = json!([{"pointers": pair, "correlation": expected}]);
        let result = studied(&document);
        let found = correlation(&result.points[1..]);
        assert!((found - expected).abs() < 0.05, "{found} {expected}");
        assert!(result.sensitivity[0].halved_p90.is_none());
    }
    let refused = |correlations: Value| wrong(study("none"), |value| value["correlations"] = correlations);
    let one = |pointers: Value, correlation: f64| json!([{"pointers": pointers, "correlation": correlation}]);
    assert_eq!(refused(one(json!([pair[0]]), 0.5)), ["/correlations/0/pointers"]);
    assert_eq!(refused(one(json!([pair[0], "/design/helix_angle_deg"]), 0.5)), ["/correlations/0/pointers/1"]);
    assert_eq!(refused(one(json!([pair[0], pair[0]]), 0.5)), ["/correlations/0/pointers/1"]);
    assert_eq!(refused(one(json!(pair), 1.5)), ["/correlations/0/correlation"]);
    let three = wrong(study("none"), |value| {
        value["tolerances"].as_array_mut().unwrap().push(json!({"pointer": "/design/gap_width_mm", "tolerance": 1}));
        value["correlations"] = json!([{"pointers": [pair[0], pair[1], "/design/gap_width_mm"], "correlation": -0.6}]);
    });
    assert_eq!(three, ["/correlations/0/correlation"]);
    let jansen = wrong(study("jansen"), |value| value["correlations"] = one(json!(pair), 0.5));
    assert_eq!(jansen, ["/sensitivity"]);
}

#[derive(Default)]
struct Stages(Mutex<HashMap<String, Vec<u8>>>);

impl StageStore for Stages {
    fn load(&self, key: &str) -> Option<Vec<u8>> {
        self.0.lock().unwrap().get(key).cloned()
    }

    fn save(&self, key: &str, _stage: Stage, bytes: &[u8]) {
        self.0.lock().unwrap().insert(key.to_owned(), bytes.to_vec());
    }
}

#[test]
fn a_larger_sample_goes_on_from_a_smaller_one() {
    let of = |samples: u32, stages: &dyn StageStore| {
        let mut document = study("from_sample");
        document["samples"] = json!(samples);
        let context = SolveContext { stages, ..SolveContext::none() };
        solve(&job(&document), &context).unwrap().result.tolerance.unwrap()
    };
    let stages = Stages::default();
    assert_eq!(of(64, &stages).points_reused, 0);
    let larger = of(128, &stages);
    assert_eq!(larger.points_reused, 64);
    let alone = of(128, &Stages::default());
    assert_eq!((&larger.points, &larger.measures), (&alone.points, &alone.measures));
    assert_eq!(of(32, &stages).points_reused, 32);
    assert_eq!(of(256, &stages).points_reused, 128);
}

/// Damping and supports at a given speed.
fn of_supports() -> Value {
    let mut document = search();
    let variables = document["variables"].as_array_mut().unwrap();
    variables.remove(3);
    variables.remove(0);
    document["budget"] = json!({"evaluations": 150});
    document
}

#[test]
fn the_best_design_is_compared_with_its_neighbours() {
    let result = optimised(&of_supports());
    let speeds: Vec<f64> = result.neighbours.iter().map(|one| one.speed_percent).collect();
    assert_eq!(speeds, [-5.0, -2.0, 2.0, 5.0]);
    assert!(result.neighbours.iter().all(|one| one.objective.is_some()));
    let best = result.objectives[0].best.unwrap();
    for flat in &result.flatness {
        let [low, high] = flat.range_within_2_percent;
        let own = result.best.as_ref().unwrap().values[&flat.pointer];
        for (end, rise) in [low, high].into_iter().zip(flat.rise_at_ends_percent) {
            // Along one variable alone, and near: the rise is small, and none is missing but that of the best itself.
            assert_eq!(rise.is_none(), end == own, "{flat:?}");
            assert!(rise.is_none_or(|rise| (-0.1..50.0).contains(&rise)), "{flat:?}");
        }
    }
    let row = result.points.iter().rfind(|row| row.phase == Some(EvaluationPhase::Flatness)).expect("confirmed");
    assert!(row.objectives.as_ref().unwrap()[0] > 0.999 * best);
    assert_eq!(result.points.iter().filter(|row| row.phase == Some(EvaluationPhase::Speed)).count(), 4);
}

#[test]
fn f910_permuting_the_variables_permutes_the_answer() {
    // By simplices and by CMA-ES.
    for method in ["auto", "cma_es"] {
        let mut document = of_supports();
        document["method"] = json!(method);
        document["budget"] = json!({"evaluations": 900});
        let one = optimised(&document);
        document["variables"].as_array_mut().unwrap().reverse();
        let other = optimised(&document);
        let [a, b] = [&one, &other].map(|result| result.objectives[0].best.unwrap());
        println!("{a} {b}: {:?} {:?}", one.best.unwrap().values, other.best.unwrap().values);
        assert!((a / b - 1.0).abs() < 0.01, "{a} {b}");
    }
}

#[test]
fn pairs_that_cannot_be_are_the_worse_the_farther_they_are_from_one_that_can() {
    let mut document = search();
    document["variables"] = json!([{"pointer": "/design/pinion/addendum", "from": 0.8, "to": 2.0}]);
    document["objectives"] = json!([{"measure": "/geometry/total_contact_ratio", "goal": "maximise"}]);
    document.as_object_mut().unwrap().remove("constraints");
    let result = optimised(&document);
    let mut refused: Vec<(f64, f64)> = result
        .points
        .iter()
        .filter(|row| row.error.is_some())
        .map(|row| (row.values[0], row.violation.unwrap()))
        .collect();
    refused.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(refused.len() > 3 && refused.windows(2).all(|pair| pair[1].1 >= pair[0].1), "{refused:?}");
    let [first, last] = [refused[0], refused[refused.len() - 1]];
    assert!(first.1 > 2.0 && last.1 > first.1 + 0.05, "{refused:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// Any document of which a quantity of the geometry is asked ends in a result or a typed error.
    #[test]
    fn f910_any_search_ends(value in arbitrary::documents(), is_tolerance in any::<bool>()) {
        let mut document = given(|_| {});
        document["design"] = value["design"].clone();
        document["operation"] = value["operation"].clone();
        let measure = json!({"measure": "/geometry/total_contact_ratio"});
        if is_tolerance {
            document["kind"] = json!("tolerance");
            document["tolerances"] = json!([{"pointer": "/design/pinion/profile_shift", "tolerance": 0.1}]);
            document["measures"] = json!([measure]);
            document["samples"] = json!(16);
        } else {
            document["kind"] = json!("optimise");
            document["variables"] = json!([{"pointer": "/design/pinion/profile_shift", "from": -0.3, "to": 0.8}]);
            document["objectives"] = json!([measure]);
            document["budget"] = json!({"evaluations": 30});
        }
        let Ok(job) = crate::parse_value(&document).and_then(super::CheckedJob::new) else { return Ok(()) };
        let result = solve(&job, &SolveContext::none()).expect("solved").result;
        prop_assert!(result.optimise.is_some() != result.tolerance.is_some());
    }
}

#[test]
fn an_optimisation_says_what_it_evaluates_at_most() {
    let document = search();
    let result = outcome(&document).result.optimise.unwrap();
    assert!(result.points.len() as u64 <= crate::parse_value(&document).unwrap().evaluations());
}
