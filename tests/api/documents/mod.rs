//! Malformed job documents: each is refused with the status, code, pointer and range that are documented.

mod encodings;
mod sizes;

use crate::support::*;
use axum::http::Method;
use rstest::rstest;
use serde_json::{Value, json};

const JSON: (&str, &str) = ("content-type", "application/json");

/// A valid document with one member set (or, with null for a pointer to a member, removed).
fn with(pointer: &str, value: Value) -> String {
    let mut document = document();
    set(&mut document, pointer, value);
    document.to_string()
}

fn set(document: &mut Value, pointer: &str, value: Value) {
    let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
    let mut place = document;
    for step in parent.split('/').skip(1) {
        place = &mut place[step];
    }
    place[name] = value;
}

fn without(pointer: &str) -> String {
    let mut document = document();
    let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
    document.pointer_mut(parent).and_then(Value::as_object_mut).expect("an object").remove(name).expect("a member");
    document.to_string()
}

/// The valid document with raw text in the place of the module, which JSON values could not hold.
fn raw_module(text: &str) -> String {
    document().to_string().replace("\"normal_module_mm\":6.0", &format!("\"normal_module_mm\":{text}"))
}

#[rstest]
#[case::empty("".into())]
#[case::blank("   ".into())]
#[case::truncated({ let text = document().to_string(); text[..text.len() / 2].into() })]
#[case::nan(raw_module("NaN"))]
#[case::infinity(raw_module("Infinity"))]
#[case::negative_infinity(raw_module("-Infinity"))]
#[case::overflow(raw_module("1e400"))]
#[case::leading_plus(raw_module("+6"))]
#[case::hex(raw_module("0x6"))]
#[case::comment(format!("/* gear */ {}", document()))]
#[case::trailing_comma(document().to_string().replace("\"kind\":\"response\"", "\"kind\":\"response\",,"))]
#[case::single_quotes("{'kind': 'mesh'}".into())]
#[case::two_documents(format!("{0}{0}", document()))]
#[case::deep_nesting("[".repeat(100_000))]
#[case::deep_objects("{\"design\":".repeat(100_000))]
#[case::not_json("normal_module_mm: 6".into())]
#[tokio::test]
async fn not_json(#[case] body: String) {
    let app = app().await;
    let answer = app.send(Method::POST, "/api/v1/jobs", &[JSON], body).await;
    answer.assert_problem(400, "malformed-json");
    assert!(answer.violation("")["detail"].as_str().is_some_and(|detail| detail.contains("line")), "{answer:?}");
}

/// Body, pointer, code, and the permitted range where there is one.
#[rstest]
#[case::missing_module(without("/design/normal_module_mm"), "/design/normal_module_mm", "missing", None)]
#[case::missing_teeth(without("/design/pinion/teeth"), "/design/pinion/teeth", "missing", None)]
#[case::missing_design(without("/design"), "/design", "missing", None)]
#[case::missing_operation(without("/operation"), "/operation", "missing", None)]
#[case::null_required(with("/design/face_width_mm", json!(null)), "/design/face_width_mm", "missing", None)]
#[case::text_for_number(with("/design/normal_module_mm", json!("6")), "/design/normal_module_mm", "wrong-type", Some((0.1, 100.0, "mm")))]
#[case::boolean_for_number(with("/design/helix_angle_deg", json!(true)), "/design/helix_angle_deg", "wrong-type", Some((0.0, 50.0, "deg")))]
#[case::number_for_text(with("/name", json!(7)), "/name", "wrong-type", None)]
#[case::number_for_boolean(with("/model", json!({"damping_in_gap": 1})), "/model/damping_in_gap", "wrong-type", None)]
#[case::array_for_object(with("/design", json!([])), "/design", "wrong-type", None)]
#[case::text_for_object(with("/design/pinion", json!("17")), "/design/pinion", "wrong-type", None)]
#[case::object_for_array(with("/axes", json!({})), "/axes", "wrong-type", None)]
#[case::array_for_document("[]".into(), "", "wrong-type", None)]
#[case::null_document("null".into(), "", "wrong-type", None)]
#[case::number_document("17".into(), "", "wrong-type", None)]
#[case::huge(raw_module("1e308"), "/design/normal_module_mm", "out-of-range", Some((0.1, 100.0, "mm")))]
#[case::negative_module(with("/design/normal_module_mm", json!(-6.0)), "/design/normal_module_mm", "out-of-range", Some((0.1, 100.0, "mm")))]
#[case::zero_module(with("/design/normal_module_mm", json!(0)), "/design/normal_module_mm", "out-of-range", Some((0.1, 100.0, "mm")))]
#[case::tiny_module(with("/design/normal_module_mm", json!(5e-324)), "/design/normal_module_mm", "out-of-range", Some((0.1, 100.0, "mm")))]
#[case::zero_teeth(with("/design/pinion/teeth", json!(0)), "/design/pinion/teeth", "out-of-range", Some((5.0, 1000.0, "1")))]
#[case::negative_teeth(with("/design/pinion/teeth", json!(-17)), "/design/pinion/teeth", "out-of-range", Some((5.0, 1000.0, "1")))]
#[case::fractional_teeth(with("/design/pinion/teeth", json!(17.5)), "/design/pinion/teeth", "wrong-type", Some((5.0, 1000.0, "1")))]
#[case::many_teeth(with("/design/gear/teeth", json!(u64::MAX)), "/design/gear/teeth", "out-of-range", Some((5.0, 1000.0, "1")))]
#[case::steep_helix(with("/design/helix_angle_deg", json!(90)), "/design/helix_angle_deg", "out-of-range", Some((0.0, 50.0, "deg")))]
#[case::negative_width(with("/design/face_width_mm", json!(-75)), "/design/face_width_mm", "out-of-range", Some((0.5, 2000.0, "mm")))]
#[case::zero_speed(with("/operation/pinion_speed_rpm", json!(0)), "/operation/pinion_speed_rpm", "out-of-range", Some((0.1, 200_000.0, "r/min")))]
#[case::poisson(with("/design/material", json!({"poissons_ratio": 0.5})), "/design/material/poissons_ratio", "out-of-range", Some((0.0, 0.49, "1")))]
#[case::accuracy(with("/analysis", json!({"accuracy": 0})), "/analysis/accuracy", "out-of-range", Some((1e-12, 1e-2, "1")))]
#[case::unknown_field(with("/design/modul_mm", json!(6)), "/design/modul_mm", "unknown-field", None)]
#[case::unknown_at_the_top(with("/designs", json!({})), "/designs", "unknown-field", None)]
#[case::escaped_pointer(with("/design/pinion/a~b", json!(1)), "/design/pinion/a~0b", "unknown-field", None)]
#[case::unknown_word(with("/kind", json!("fatigue")), "/kind", "not-one-of", None)]
#[case::wrong_case(with("/design/pressure_angle_plane", json!("Normal")), "/design/pressure_angle_plane", "not-one-of", None)]
#[case::unknown_source(with("/model", json!({"mesh_stiffness": {"source": "measured"}})), "/model/mesh_stiffness/source", "not-one-of", None)]
#[case::long_name(with("/name", json!("x".repeat(201))), "/name", "too-long", None)]
#[case::control_characters(with("/name", json!("a\u{0}b")), "/name", "out-of-range", None)]
#[case::same_hands(with("/design/gear/left_half_hand", json!("left")), "/design/gear/left_half_hand", "conflict", None)]
#[case::relief_without_length(with("/design/pinion/tip_relief", json!({"amount_um": 10})), "/design/pinion/tip_relief/length_mm", "conflict", None)]
#[case::end_relief_without_length(with("/design/gear/end_relief", json!({"amount_um": 5})), "/design/gear/end_relief/length_mm", "conflict", None)]
#[case::relief_of_one_half(with("/design/pinion/left", json!({"tip_relief": {"amount_um": -1}})), "/design/pinion/left/tip_relief/amount_um", "out-of-range", Some((0.0, 1000.0, "um")))]
#[case::more_recorded_than_run(with("/analysis", json!({"mesh_periods": 10, "record_mesh_periods": 20})), "/analysis/record_mesh_periods", "conflict", None)]
#[case::too_many_samples(with("/analysis", json!({"mesh_periods": 100_000, "record_mesh_periods": 100_000, "samples_per_mesh_period": 4096})), "/analysis/samples_per_mesh_period", "conflict", None)]
#[case::short_state(with("/analysis", json!({"method": "integrate", "initial_state": [0, 0]})), "/analysis/initial_state", "out-of-range", Some((24.0, 24.0, "")))]
#[case::point_of_a_sweep_that_is_one(with("/kind", json!("sweep")).replacen('{', "{\"sweep_point\": {\"job\": \"a\", \"position\": 0, \"input_hash\": \"b\"},", 1), "/sweep_point", "conflict", None)]
#[case::given_without_mean(with("/model", json!({"mesh_stiffness": {"source": "given"}})), "/model/mesh_stiffness/mean_n_per_um", "missing", None)]
#[case::given_twice(with("/model", json!({"mesh_stiffness": {"source": "given", "mean_n_per_um": 900, "samples_n_per_um": [1, 2]}})), "/model/mesh_stiffness/samples_n_per_um", "conflict", None)]
#[case::negative_sample(with("/model", json!({"mesh_stiffness": {"source": "given", "samples_n_per_um": [900, -1]}})), "/model/mesh_stiffness/samples_n_per_um/1", "out-of-range", Some((1e-3, 1e7, "N/um")))]
#[case::given_impact_without_force(with("/model", json!({"impact": {"source": "given", "duration_mesh_periods": 0.1}})), "/model/impact/force_n", "missing", None)]
#[case::axes_of_no_sweep(with("/axes", json!([{"pointer": "/operation/pinion_speed_rpm", "values": [1000]}])), "/axes", "conflict", None)]
#[case::sweep_without_axes(with("/kind", json!("sweep")), "/axes", "missing", None)]
#[tokio::test]
async fn invalid(
    #[case] body: String,
    #[case] pointer: &str,
    #[case] code: &str,
    #[case] range: Option<(f64, f64, &str)>,
) {
    let app = app().await;
    for path in ["/api/v1/jobs", "/api/v1/jobs/validate"] {
        let answer = app.send(Method::POST, path, &[JSON], body.clone()).await;
        answer.assert_problem(422, "invalid-design");
        let violation = answer.violation(pointer);
        assert_eq!(violation["code"], code, "{answer:?}");
        assert!(violation["detail"].as_str().is_some_and(|detail| !detail.is_empty()));
        if let Some((minimum, maximum, unit)) = range {
            assert_eq!((violation["minimum"].as_f64(), violation["maximum"].as_f64()), (Some(minimum), Some(maximum)));
            assert_eq!(violation["unit"].as_str().unwrap_or_default(), unit);
        }
    }
}

/// Documents that hold together but describe a gear that cannot exist.
#[rstest]
#[case::pointed_tip("/design/pinion/profile_shift", json!(1.9))]
#[case::bore_larger_than_the_root("/design/pinion/bore_diameter_mm", json!(200.0))]
#[case::gears_apart("/design/center_distance_mm", json!(400.0))]
#[case::gears_overlapping("/design/center_distance_mm", json!(150.0))]
#[tokio::test]
async fn impossible(#[case] pointer: &str, #[case] value: Value) {
    let app = app().await;
    let answer = app.send(Method::POST, "/api/v1/jobs", &[JSON], with(pointer, value)).await;
    answer.assert_problem(422, "invalid-design");
    let errors = answer.json["errors"].as_array().expect("errors");
    assert!(!errors.is_empty());
    for error in errors {
        assert!(error["pointer"].as_str().is_some_and(|pointer| pointer.starts_with('/')), "{answer:?}");
    }
}

fn sweep_over(axes: Value) -> Value {
    let mut sweep = document();
    sweep["kind"] = json!("sweep");
    sweep["axes"] = axes;
    sweep
}

#[track_caller]
fn assert_axes_refused(answer: &Answer) {
    answer.assert_problem(422, "invalid-design");
    let errors = answer.json["errors"].as_array().expect("errors");
    assert!(errors.iter().all(|error| error["pointer"].as_str().is_some_and(|p| p.starts_with("/axes"))), "{answer:?}");
}

/// Sweeps whose axes cannot be read.
#[rstest]
#[case::too_many_points(json!([
    {"pointer": "/operation/pinion_speed_rpm", "from": 1, "to": 2, "points": 100_000},
    {"pointer": "/operation/pinion_torque_nm", "from": 1, "to": 2, "points": 100_000},
]))]
#[case::three_axes(json!([
    {"pointer": "/operation/pinion_speed_rpm", "values": [1000]},
    {"pointer": "/operation/pinion_torque_nm", "values": [1000]},
    {"pointer": "/design/backlash_um", "values": [1]},
]))]
#[case::no_values(json!([{"pointer": "/operation/pinion_speed_rpm", "values": []}]))]
#[case::half_a_range(json!([{"pointer": "/operation/pinion_speed_rpm", "from": 300}]))]
#[tokio::test]
async fn unreadable_axes(#[case] axes: Value) {
    let app = app().await;
    assert_axes_refused(&app.submit_with(&sweep_over(axes), &[]).await);
}

/// Sweeps whose axes contradict each other or lead nowhere.
#[rstest]
#[case::duplicate_axes(json!([
    {"pointer": "/operation/pinion_speed_rpm", "values": [1000, 2000]},
    {"pointer": "/operation/pinion_speed_rpm", "values": [1500]},
]))]
#[case::no_such_input(json!([{"pointer": "/operation/speed", "values": [1000]}]))]
#[case::not_a_number(json!([{"pointer": "/kind", "values": [1000]}]))]
#[case::no_pointer(json!([{"pointer": "operation.pinion_speed_rpm", "values": [1000]}]))]
#[case::out_of_range(json!([{"pointer": "/operation/pinion_speed_rpm", "values": [1000, -5]}]))]
#[tokio::test]
async fn axes_that_lead_nowhere(#[case] axes: Value) {
    let app = app().await;
    assert_axes_refused(&app.submit_with(&sweep_over(axes), &[]).await);
}

/// Everything wrong is told at once.
#[tokio::test]
async fn all_at_once() {
    let app = app().await;
    let mut document = document();
    set(&mut document, "/kind", json!("fatigue"));
    set(&mut document, "/design/pinion/teeth", json!(-1));
    set(&mut document, "/design/colour", json!("red"));
    set(&mut document, "/operation/pinion_speed_rpm", json!("fast"));
    let answer = app.submit_with(&document, &[]).await;
    answer.assert_problem(422, "invalid-design");
    for pointer in ["/kind", "/design/pinion/teeth", "/design/colour", "/operation/pinion_speed_rpm"] {
        answer.violation(pointer);
    }
    assert_eq!(answer.json["errors"].as_array().map(Vec::len), Some(4));
}
