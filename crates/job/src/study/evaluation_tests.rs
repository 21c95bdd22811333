//! Optimisations and tolerance studies: against closed forms, against themselves, and what is refused.

use super::{CheckedJob, Outcome};
use super::{LineEnd, PointStore, SolveContext, SolveError, StoredPoints, document_at, solve};
use crate::DocumentError;
use crate::result::{OptimiseResult, SweepPoint, ToleranceResult};
use herringbone_search::normal_quantile;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::Mutex;

/// The example pair with a given stiffness: a response takes a fraction of a millisecond.
pub(super) fn given(change: impl FnOnce(&mut Value)) -> Value {
    let mut value: Value = serde_json::from_str(include_str!("../../../../examples/given_stiffness.json")).unwrap();
    value["model"] = json!({
        "mesh_stiffness": {"source": "given", "mean_n_per_um": 900.0, "harmonics": [{"amplitude": 0.1}]},
        "impact": {"source": "none"},
    });
    value["analysis"] = json!({"accuracy": 1e-3});
    change(&mut value);
    value
}

pub(super) fn job(value: &Value) -> CheckedJob {
    CheckedJob::new(crate::parse_value(value).unwrap_or_else(|error| panic!("{error:?}"))).expect("can be solved")
}

pub(super) fn outcome(value: &Value) -> Outcome {
    solve(&job(value), &SolveContext::none()).expect("solved")
}

pub(super) fn optimised(value: &Value) -> OptimiseResult {
    outcome(value).result.optimise.expect("an optimisation")
}

pub(super) fn studied(value: &Value) -> ToleranceResult {
    outcome(value).result.tolerance.expect("a study")
}

/// The one value of the best design.
fn best(result: &OptimiseResult) -> f64 {
    *result.best.as_ref().expect("feasible").values.values().next().expect("a variable")
}

fn of_one_variable(pointer: &str, [from, to]: [f64; 2], objective: Value) -> Value {
    given(|value| {
        value["kind"] = json!("optimise");
        value["variables"] = json!([{"pointer": pointer, "from": from, "to": to}]);
        value["objectives"] = json!([objective]);
        value["budget"] = json!({"accuracy": 1e-10});
    })
}

#[test]
fn f93_face_width_and_helix_angle_for_an_overlap_ratio_of_one() {
    let whole = json!({"measure": "/geometry/overlap_ratio", "goal": "target", "target": 1.0});
    let document = of_one_variable("/design/face_width_mm", [10.0, 200.0], whole.clone());
    let outcome = outcome(&document);
    let geometry = outcome.result.geometry.clone().expect("geometry");
    let exact_mm = geometry.transverse_base_pitch_mm / geometry.base_helix_angle_deg.to_radians().tan();
    let result = outcome.result.optimise.expect("an optimisation");
    println!("face width {} mm, exact {exact_mm} mm, {} evaluations", best(&result), result.numerics.evaluations);
    assert!((best(&result) - exact_mm).abs() < 1e-6 * exact_mm);
    assert_eq!((result.verdict.as_str(), result.numerics.method.as_str()), ("improved", "nelder_mead"));
    // ε_β = b sin β / (π m_n), ISO 21771.
    let document = of_one_variable("/design/helix_angle_deg", [5.0, 40.0], whole);
    let (width_mm, module_mm) = (
        document["design"]["face_width_mm"].as_f64().unwrap(),
        document["design"]["normal_module_mm"].as_f64().unwrap(),
    );
    let exact_deg = (std::f64::consts::PI * module_mm / width_mm).asin().to_degrees();
    let result = optimised(&document);
    assert!((best(&result) - exact_deg).abs() < 1e-6 * exact_deg, "{} {exact_deg}", best(&result));
}

#[test]
fn f93_largest_profile_shift_with_a_tip_thickness() {
    let mut document = of_one_variable(
        "/design/pinion/profile_shift",
        [0.0, 0.8],
        json!({"measure": "/geometry/pinion/tip_diameter_mm", "goal": "maximise"}),
    );
    document["constraints"] = json!([{"margin": "tip-thickness", "at_least": 0.5}]);
    let result = optimised(&document);
    // The root of the tip thickness by bisection.
    let thickness = |shift: f64| {
        let mut document = document.clone();
        document["kind"] = json!("response");
        for name in ["variables", "objectives", "constraints", "budget"] {
            document.as_object_mut().unwrap().remove(name);
        }
        document["design"]["pinion"]["profile_shift"] = json!(shift);
        let drawing = crate::drawing::Drawing::of(&job(&document));
        let of_tip = drawing.margins.iter().filter(|margin| margin.code == "tip-thickness");
        of_tip.map(|margin| margin.value).fold(f64::INFINITY, f64::min)
    };
    let (mut low, mut high) = (0.0, 0.8);
    assert!(thickness(low) > 0.5 && thickness(high) < 0.5);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if thickness(middle) > 0.5 { low = middle } else { high = middle }
    }
    println!("profile shift {}, exact {low}", best(&result));
    assert!((best(&result) - low).abs() < 1e-6, "{} {low}", best(&result));
    assert_eq!(result.active[0].constraint.as_deref(), Some("tip-thickness"));
    assert!(result.constraints[0].met && result.constraints[0].slack.unwrap() < 1e-5);
}

/// A search over speed, damping and supports at two operating points: four variables, so CMA-ES.
pub(super) fn search() -> Value {
    given(|value| {
        value["kind"] = json!("optimise");
        value["operating_points"] = json!([{"pinion_torque_nm": 400.0}, {"pinion_torque_nm": 800.0, "share": 2.0}]);
        value["design"]["supports"] = json!({"pinion_lateral_n_per_um": 600.0, "gear_lateral_n_per_um": 600.0});
        value["variables"] = json!([
            {"pointer": "/operation/pinion_speed_rpm", "from": 1500.0, "to": 4000.0, "step": 10.0},
            {"pointer": "/model/mesh_damping_ratio", "from": 0.02, "to": 0.1},
            {"pointer": "/design/supports/pinion_lateral_n_per_um", "also": ["/design/supports/gear_lateral_n_per_um"],
                "also_factors": [2.0], "from": 200.0, "to": 900.0},
            {"pointer": "/design/pinion/teeth", "from": 16, "to": 19},
        ]);
        value["objectives"] =
            json!([{"measure": "/response/rms/mesh_circumferential_acceleration_m_s2", "over": "weighted"}]);
        value["constraints"] = json!([{"measure": "/geometry/total_contact_ratio", "at_least": 2.6}]);
        value["budget"] = json!({"evaluations": 90});
    })
}

/// Rows as they are stored; stops the solve after so many.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) before: BTreeMap<usize, SweepPoint>,
    pub(super) saved: Mutex<BTreeMap<usize, String>>,
    pub(super) most: usize,
}

impl PointStore for Rows {
    fn load(&self) -> StoredPoints {
        StoredPoints { rows: self.before.clone().into_iter().collect(), ends: BTreeMap::new() }
    }

    fn save(&self, position: usize, row: &SweepPoint, _end: Option<&LineEnd>) {
        let text = serde_json::to_string(row).expect("JSON");
        assert!(self.saved.lock().unwrap().insert(position, text).is_none(), "{position} twice");
    }
}

/// Solves with rows of before, on so many threads; the rows saved, and the result unless it was stopped.
fn solve_with(value: &Value, rows: &Rows, threads: usize) -> Option<String> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let canceled = || rows.most > 0 && rows.saved.lock().unwrap().len() >= rows.most;
    let context = SolveContext { points: rows, canceled: &canceled, ..SolveContext::none() };
    match pool.install(|| solve(&job(value), &context)) {
        Ok(mut outcome) => {
            outcome.result.numerics.reused.clear();
            Some(serde_json::to_string(&outcome.result).expect("JSON"))
        }
        Err(SolveError::Canceled(_)) => None,
        Err(error) => panic!("{error}"),
    }
}

#[test]
fn f92_the_same_rows_for_any_threads_and_after_any_interruption() {
    for value in [search(), study("jansen")] {
        let whole = Rows::default();
        let expected = solve_with(&value, &whole, 2).expect("solved");
        let all = whole.saved.into_inner().unwrap();
        assert!(all.len() > 80);
        for threads in [1, 7] {
            let rows = Rows::default();
            assert!(solve_with(&value, &rows, threads).expect("solved") == expected, "{threads} threads");
            assert!(rows.saved.into_inner().unwrap() == all);
        }
        for most in [7, 61] {
            let stopped = Rows { most, ..Rows::default() };
            assert!(solve_with(&value, &stopped, 2).is_none());
            let stored = stopped.saved.into_inner().unwrap();
            assert!(stored.iter().all(|(position, row)| all[position] == *row));
            let before = stored.iter().map(|(position, row)| (*position, serde_json::from_str(row).unwrap())).collect();
            let resumed = Rows { before, ..Rows::default() };
            assert!(solve_with(&value, &resumed, 3).expect("solved") == expected, "after {most} rows");
            let solved = resumed.saved.into_inner().unwrap();
            assert!(solved.len() + stored.len() == all.len());
        }
    }
}

#[test]
fn a_search_says_what_it_found() {
    let document = search();
    let result = optimised(&document);
    let objective = &result.objectives[0];
    assert_eq!(result.verdict, "improved");
    assert!(
        objective.best.unwrap() < objective.input.unwrap() && objective.gain_percent.unwrap() > 10.0,
        "{objective:?}"
    );
    assert_eq!((objective.unit.as_str(), objective.over.as_str(), objective.per_point.len()), ("m/s2", "weighted", 2));
    assert_eq!([objective.per_point[0].pinion_torque_nm, objective.per_point[1].pinion_torque_nm], [400.0, 800.0]);
    // The weighted mean of the points is the objective.
    let points: Vec<f64> = objective.per_point.iter().map(|point| point.best.unwrap()).collect();
    assert!(((points[0] + 2.0 * points[1]) / 3.0 / objective.best.unwrap() - 1.0).abs() < 1e-12);
    let best = result.best.as_ref().unwrap();
    let row = &result.points[best.position as usize];
    assert_eq!(
        row.values,
        document["variables"]
            .as_array()
            .unwrap()
            .iter()
            .map(|v| best.values[v["pointer"].as_str().unwrap()])
            .collect::<Vec<_>>()
    );
    assert!(row.values[0] % 10.0 == 0.0 && row.values[3].fract() == 0.0 && row.violation == Some(0.0), "{row:?}");
    assert!(
        result.numerics.evaluations <= 91 + 2 * 4
            && result.history.evaluations.len() == result.numerics.generations as usize
    );
    assert!(result.history.best.iter().flatten().collect::<Vec<_>>().windows(2).all(|pair| pair[1] <= pair[0]));
    // The document of the row is that of its first operating point.
    let parsed = crate::parse_value(&document).unwrap();
    let single = document_at(&parsed, &row.values).expect("fits");
    assert_eq!((single.operation.pinion_torque_nm, single.design.pinion.teeth), (400.0, row.values[3] as u32));
    assert_eq!(single.design.supports.gear_lateral_n_per_um, Some(2.0 * row.values[2]));
    let alone = solve(&CheckedJob::new(single).unwrap(), &SolveContext::none()).unwrap().result;
    let rms = alone.response.unwrap().rms.mesh_circumferential_acceleration_m_s2;
    assert_eq!(rms.left.max(rms.right), row.measures.as_ref().unwrap()[0]);
}

#[test]
fn a_design_that_nothing_can_help_is_said_to_be_infeasible() {
    let mut document = search();
    document["constraints"] = json!([{"measure": "/geometry/total_contact_ratio", "at_least": 9.0}]);
    let result = optimised(&document);
    assert_eq!((result.verdict.as_str(), &result.best), ("no feasible design", &None));
    assert!(!result.input.feasible && result.input.violation > 0.0);
    assert_eq!(result.numerics.infeasible as usize, result.points.len() - 1);
}

#[test]
fn two_objectives_have_a_front() {
    let mut document = search();
    document["objectives"] = json!([
        {"measure": "/geometry/total_contact_ratio", "goal": "maximise"},
        {"measure": "/geometry/mesh_frequency_hz"},
    ]);
    document["variables"] = json!([
        {"pointer": "/design/pinion/teeth", "from": 12, "to": 24},
        {"pointer": "/design/pinion/profile_shift", "from": -0.2, "to": 0.6},
    ]);
    document["constraints"] = json!([{"margin": "tip-thickness", "at_least": 0.2}]);
    document["budget"] = json!({"evaluations": 700});
    let result = optimised(&document);
    let front = &result.front;
    assert!(front.len() > 3 && front.iter().filter(|design| design.knee).count() == 1, "{front:?}");
    let volumes = &result.history.hypervolume;
    assert!(volumes.len() == result.history.evaluations.len() && *volumes.last().unwrap() > 0.0, "{volumes:?}");
    assert!(volumes.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12));
    for pair in front.windows(2) {
        assert!(pair[1].objectives[0] < pair[0].objectives[0] && pair[1].objectives[1] < pair[0].objectives[1]);
    }
}

/// A tolerance study of a linear measure.
pub(super) fn study(sensitivity: &str) -> Value {
    given(|value| {
        value["kind"] = json!("tolerance");
        value["tolerances"] = json!([
            {"pointer": "/design/face_width_mm", "tolerance": 3.0, "cut": false},
            {"pointer": "/design/gear/profile_shift", "distribution": "uniform", "plus": 0.01},
        ]);
        value["measures"] = json!([{"measure": "/geometry/overlap_ratio"}]);
        value["limits"] = json!([{"measure": "/geometry/overlap_ratio", "at_least": 1.6}]);
        value["samples"] = json!(128);
        value["sensitivity"] = json!(sensitivity);
    })
}

#[test]
fn f98_percentiles_of_a_linear_measure() {
    for sampling in ["sobol", "random"] {
        let mut document = study("from_sample");
        document["samples"] = json!(1024);
        document["sampling"] = json!(sampling);
        let outcome = outcome(&document);
        let geometry = outcome.result.geometry.clone().expect("geometry");
        let result = outcome.result.tolerance.expect("a study");
        let per_mm = geometry.base_helix_angle_deg.to_radians().tan() / geometry.transverse_base_pitch_mm;
        let measure = &result.measures[0];
        assert_eq!(measure.nominal, Some(geometry.overlap_ratio));
        for (name, part) in [("p5", 0.05), ("p50", 0.5), ("p90", 0.9), ("p95", 0.95)] {
            let exact = geometry.overlap_ratio + per_mm * normal_quantile(part);
            let found = &measure.percentiles[name];
            let [low, high] = [found.low, found.high].map(|end| end.expect("large enough"));
            println!("{sampling} {name}: {} in {low} to {high}, exact {exact}", found.value);
            assert!(low <= exact && exact <= high && high - low < 0.4 * per_mm, "{name}");
        }
        let [first, second] = [0, 1].map(|input| &result.sensitivity[input]);
        assert!(first.rank_correlation.unwrap() > 0.99 && first.first_order.unwrap() > 0.95, "{first:?}");
        assert!(second.rank_correlation.unwrap().abs() < 1.5 * second.rank_noise.unwrap(), "{second:?}");
        assert!(second.first_order.unwrap() < 2.0 * second.first_order_noise.unwrap() + 0.02, "{second:?}");
        // Half the tolerance: the percentile of half the deviation.
        let halved = geometry.overlap_ratio + 0.5 * per_mm * normal_quantile(0.9);
        assert!((first.halved_p90.unwrap() - halved).abs() < 0.1 * per_mm, "{first:?}, {halved}");
        assert!(first.halved_effective_samples.unwrap() > 500.0);
        let histogram = measure.histogram.as_ref().unwrap();
        assert_eq!(histogram.counts.iter().sum::<u32>(), 1024);
        let beyond = measure.beyond_limit.as_ref().unwrap();
        assert!(beyond.low <= beyond.share && beyond.share <= beyond.high);
    }
    let total = &studied(&study("jansen")).sensitivity[0];
    assert!((total.total.unwrap() - 1.0).abs() < 0.05 && total.rank_correlation.is_some(), "{total:?}");
    let screened = studied(&study("morris"));
    assert_eq!(screened.points.len(), 1 + 12 * 3);
    assert!(screened.sensitivity[0].effect.unwrap() > 0.0 && screened.sensitivity[1].effect == Some(0.0));
}

/// z 17, m_n 6 mm, β 24.43°, half faces of 75 mm: d = 112.03 mm.
#[test]
fn a_class_of_iso_1328_stands_for_a_tolerance() {
    let mut document = study("none");
    document["tolerances"] = json!([
        {"pointer": "/design/pinion/helix_slope_um", "iso1328_class": 5},
        {"pointer": "/design/pinion/left/helix_slope_um", "iso1328_class": 7},
    ]);
    document["design"]["pinion"]["left"] = json!({"helix_slope_um": 1.0});
    let read = crate::parse_value(&document).unwrap();
    let tolerances: Vec<_> = read.tolerances.iter().map(|tolerance| tolerance.tolerance).collect();
    assert_eq!(tolerances, [Some(7.56), Some(15.12)]);
    assert_eq!(crate::parse_value(&serde_json::to_value(&read).unwrap()).unwrap(), read);
    document["tolerances"][0]["pointer"] = json!("/design/face_width_mm");
    assert!(refused(&document).iter().any(|(pointer, _)| pointer == "/tolerances/0/iso1328_class"));
}

#[test]
fn f98_rows_are_those_of_the_documents_one_by_one() {
    let mut document = study("none");
    document["tolerances"] = json!([
        {"pointer": "/operation/pinion_torque_nm", "tolerance": 50.0},
        {"pointer": "/design/supports/damping_ratio", "distribution": "triangular", "plus": 0.01, "minus": 0.02},
    ]);
    document["measures"] =
        json!([{"measure": "/response/rms/mesh_circumferential_acceleration_m_s2", "halves": "left"}]);
    document.as_object_mut().unwrap().remove("limits");
    document["samples"] = json!(16);
    let result = studied(&document);
    let parsed = crate::parse_value(&document).unwrap();
    assert_eq!(result.points.len(), 17);
    for row in &result.points {
        let single = document_at(&parsed, &row.values).expect("fits");
        let alone = solve(&CheckedJob::new(single).unwrap(), &SolveContext::none()).unwrap().result;
        let left = alone.response.unwrap().rms.mesh_circumferential_acceleration_m_s2.left;
        assert_eq!(row.measures.as_deref(), Some([left].as_slice()));
    }
}

#[test]
fn robust_candidates_are_compared_over_the_tolerances() {
    let mut document = search();
    document["tolerances"] = json!([{"pointer": "/operation/pinion_torque_nm", "tolerance": 10.0}]);
    document.as_object_mut().unwrap().remove("operating_points");
    document["robust"] = json!({"samples": 8, "candidates": 3, "confirm_samples": 64});
    let result = optimised(&document);
    let robust = result.robust.expect("robust");
    assert_eq!((robust.measure.as_str(), robust.sample, robust.candidates.len()), ("p90", 64, 3));
    assert!(robust.candidates.windows(2).all(|pair| pair[0].robust <= pair[1].robust));
    assert_eq!(robust.candidates[0].position, result.best.unwrap().position);
    let (input, best) = (robust.input.unwrap(), robust.best.unwrap());
    assert!(best.p50 <= best.p90 && best.p90 < input.p90 && robust.gain_percent.unwrap() > 0.0);
    assert!(best.p90_interval.unwrap()[0] <= best.p90);
}

pub(super) fn refused(value: &Value) -> Vec<(String, String)> {
    let found = match crate::parse_value(value).and_then(CheckedJob::new) {
        Err(DocumentError::Invalid(found)) => found,
        other => panic!("expected violations, got {:?}", other.map(|_| ())),
    };
    found.into_iter().map(|violation| (violation.pointer, violation.detail)).collect()
}

#[test]
fn what_is_wrong_with_a_search_is_said_at_once() {
    let mut document = search();
    document["variables"][0]["to"] = json!(1000.0);
    document["variables"][1]["pointers"] = json!([]);
    document["objectives"][0]["goal"] = json!("target");
    document["constraints"][0]["margin"] = json!("tip-thickness");
    document["relative_to"] = json!("input");
    document["samples"] = json!(64);
    let pointers: Vec<String> = refused(&document).into_iter().map(|(pointer, _)| pointer).collect();
    for expected in [
        "/variables/0/to",
        "/variables/1/pointers",
        "/objectives/0/target",
        "/constraints/0/margin",
        "/relative_to",
        "/samples",
    ] {
        assert!(pointers.contains(&expected.to_owned()), "{expected}: {pointers:?}");
    }
    let mut document = search();
    document["variables"][0]["pointer"] = json!("/operation/pinion_torque_nm");
    document["variables"][1]["pointer"] = json!("/design/pinion/teeths");
    document["variables"][2]["also"] = json!(["/design/pinion/teeth"]);
    document["objectives"][0]["measure"] = json!("/response/rms");
    document["constraints"][0] = json!({"measure": "/geometry/overlap_ratio", "is": "continuous"});
    let found = refused(&document);
    let pointers: Vec<&str> = found.iter().map(|(pointer, _)| pointer.as_str()).collect();
    for expected in [
        "/variables/0/pointer",
        "/variables/1/pointer",
        "/variables/3/pointer",
        "/objectives/0/measure",
        "/constraints/0/measure",
    ] {
        assert!(pointers.contains(&expected), "{expected}: {found:?}");
    }
    let mut document = search();
    document["variables"][3]["to"] = json!(5000);
    document["variables"][1]["to"] = json!(50.0);
    let found = refused(&document);
    assert!(
        found.iter().any(|(pointer, detail)| pointer == "/variables/1/to" && detail.contains("permitted")),
        "{found:?}"
    );
    assert!(found.iter().any(|(pointer, _)| pointer == "/variables/3/to"), "{found:?}");
    let mut document = study("jansen");
    document["samples"] = json!(100);
    document["tolerances"][0]["plus"] = json!(1.0);
    document["tolerances"][1]["pointer"] = json!("/design/pinion/teeth");
    document["limits"][0]["measure"] = json!("/geometry/total_contact_ratio");
    let found = refused(&document);
    for expected in ["/samples", "/tolerances/0/plus", "/limits/0/measure"] {
        assert!(found.iter().any(|(pointer, _)| pointer == expected), "{expected}: {found:?}");
    }
    let mut document = study("none");
    document["tolerances"][1]["pointer"] = json!("/design/pinion/teeth");
    assert!(refused(&document).iter().any(|(pointer, _)| pointer == "/tolerances/1/pointer"));
}
