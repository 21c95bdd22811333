//! Tests of the reader: job documents and their violations.

use super::document::*;
use super::{DocumentError, Violation, parse, parse_value, schema};
use serde_json::{Value, json};

fn table1() -> Value {
    serde_json::from_str(include_str!("../../../examples/table1.json")).expect("the example is JSON")
}

fn violations(value: &Value) -> Vec<Violation> {
    match parse_value(value) {
        Err(DocumentError::Invalid(violations)) => violations,
        other => panic!("expected violations, got {other:?}"),
    }
}

/// The document of the example with `value` at `pointer`.
fn with(pointer: &str, value: Value) -> Value {
    let mut document = table1();
    let (parent, name) = pointer.rsplit_once('/').expect("a pointer");
    document.pointer_mut(parent).expect("the parent exists")[name] = value;
    document
}

#[test]
fn the_example_is_read_as_written() {
    let document = parse(include_bytes!("../../../examples/table1.json")).expect("valid");
    assert_eq!(document.kind, JobKind::Response);
    assert_eq!(document.design.pinion.teeth, 17);
    assert_eq!(document.design.pressure_angle_plane, PressureAnglePlane::Transverse);
    assert_eq!(document.design.gear.left_half_hand, Hand::Right);
    assert_eq!(document.operation.pinion_torque_nm, 800.0);
    assert!(matches!(document.model.impact, ImpactInput::CornerContact(_)));
}

#[test]
fn a_document_written_out_reads_back_as_itself() {
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples")).expect("examples") {
        let path = entry.expect("entry").path();
        if path.extension().is_some_and(|extension| extension == "json") {
            let document =
                parse(&std::fs::read(&path).expect("readable")).unwrap_or_else(|e| panic!("{path:?}: {e:?}"));
            let written = serde_json::to_value(&document).expect("serialisable");
            assert_eq!(parse_value(&written).expect("valid when written out"), document, "{path:?}");
        }
    }
}

#[test]
fn every_word_of_a_choice_is_written_as_it_is_read() {
    for (pointer, word) in [
        ("/analysis/integrator", "runge_kutta_4"),
        ("/model/impact/source", "zhou2008"),
        ("/model/mesh_stiffness/source", "iso6336"),
        ("/model/mesh_stiffness/law", "transmission_error"),
        ("/model/impact/duration", "energy_balance"),
        ("/operation/rotation", "apex_trailing"),
    ] {
        let written = serde_json::to_value(parse_value(&with(pointer, json!(word))).expect("valid")).expect("JSON");
        assert_eq!(written.pointer(pointer), Some(&json!(word)));
        assert!(parse_value(&written).is_ok(), "{pointer} {word}");
    }
}

#[test]
fn half_flanks_inherit_what_they_leave_out() {
    let mut document = table1();
    document["design"]["pinion"]["lead_crowning_um"] = json!(5.0);
    document["design"]["pinion"]["right"] = json!({"helix_slope_um": 3.0});
    let pinion = parse_value(&document).expect("valid").design.pinion;
    assert_eq!(pinion.left, None);
    let right = pinion.right.expect("given");
    assert_eq!((right.lead_crowning_um, right.helix_slope_um), (5.0, 3.0));
}

#[test]
fn all_violations_come_at_once_with_pointer_and_range() {
    let mut document = table1();
    document["design"]["normal_module_mm"] = json!(-1.0);
    document["design"]["pinion"]["teeth"] = json!("seventeen");
    document["operation"]["pinion_sped_rpm"] = json!(1.0);
    document["model"]["plane"] = json!("sideways");
    let found = violations(&document);
    let of =
        |pointer: &str| found.iter().find(|v| v.pointer == pointer).unwrap_or_else(|| panic!("{pointer}: {found:?}"));
    let module = of("/design/normal_module_mm");
    assert_eq!((module.code.as_str(), module.minimum, module.maximum), ("out-of-range", Some(0.1), Some(100.0)));
    assert_eq!(module.unit.as_deref(), Some("mm"));
    assert_eq!(of("/design/pinion/teeth").code, "wrong-type");
    assert!(of("/operation/pinion_sped_rpm").detail.contains("pinion_speed_rpm"));
    assert_eq!(of("/model/plane").code, "not-one-of");
    assert_eq!(found.len(), 4);
}

#[test]
fn an_empty_document_names_what_is_missing_once() {
    let found = violations(&json!({}));
    let pointers: Vec<_> = found.iter().map(|v| v.pointer.as_str()).collect();
    assert_eq!(pointers, ["/design", "/operation"]);
}

#[test]
fn single_violations() {
    let cases = [
        ("/design/pinion/teeth", json!(0), "out-of-range"),
        ("/design/pinion/teeth", json!(17.5), "wrong-type"),
        ("/design/face_width_mm", json!(1e308), "out-of-range"),
        ("/design/helix_angle_deg", json!("NaN"), "wrong-type"),
        ("/design/gear", json!([]), "wrong-type"),
        ("/design/gear/left_half_hand", json!("left"), "conflict"),
        ("/design/pinion/tip_relief", json!({"amount_um": 10.0}), "conflict"),
        ("/model/mesh_stiffness", json!({"source": "given"}), "missing"),
        ("/model/impact", json!({"source": "given", "force_n": 1.0}), "missing"),
        ("/analysis/initial_state", json!([0.0, 1.0]), "out-of-range"),
        ("/analysis/accuracy", json!(0.0), "out-of-range"),
        ("/name", json!("x".repeat(201)), "too-long"),
        ("/axes", json!([{"pointer": "/operation/pinion_speed_rpm", "values": [1.0]}]), "conflict"),
        ("/kind", json!("sweep"), "missing"),
    ];
    for (pointer, value, code) in cases {
        let found = violations(&with(pointer, value.clone()));
        assert!(
            found.iter().any(|v| v.pointer.starts_with(pointer) || pointer == "/kind"),
            "{pointer} {value}: {found:?}"
        );
        assert!(found.iter().any(|v| v.code == code), "{pointer} {value}: {found:?}");
    }
}

#[test]
fn what_is_not_json_says_where() {
    for bytes in [&b""[..], b"{\"kind\": ", b"{\"a\": NaN}", b"{\"a\": 1e400}"] {
        assert!(matches!(parse(bytes), Err(DocumentError::Malformed { .. })));
    }
    let deep = "[".repeat(10_000);
    assert!(matches!(parse(deep.as_bytes()), Err(DocumentError::Malformed { .. })));
}

#[test]
fn sweep_axes_meet_their_ends() {
    let mut document = table1();
    document["kind"] = json!("sweep");
    document["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 300.0, "to": 6000.0, "points": 1000, "spacing": "logarithmic"}]);
    let document = parse_value(&document).expect("valid");
    let axis = &document.axes[0];
    assert_eq!((axis.len(), axis.value(0), axis.value(999)), (1000, 300.0, 6000.0));
    assert!((axis.value(1) / axis.value(0) - (20f64).powf(1.0 / 999.0)).abs() < 1e-12);
}

#[test]
fn the_schema_accepts_the_examples_and_rejects_what_the_reader_rejects() {
    let schema = schema::job_document_schema();
    let validator = jsonschema::validator_for(&schema).expect("a valid schema");
    assert!(validator.is_valid(&table1()));
    assert!(validator.is_valid(&serde_json::to_value(parse_value(&table1()).expect("valid")).expect("JSON")));
    assert!(!validator.is_valid(&with("/design/face_width_mm", json!(-3.0))));
    assert!(!validator.is_valid(&with("/design/face_widht_mm", json!(3.0))));
    assert_eq!(schema["properties"]["design"]["properties"]["gap_width_mm"]["default"], json!(30.0));
    assert_eq!(schema["properties"]["design"]["properties"]["gap_width_mm"]["x-unit"], json!("mm"));
}

#[test]
fn a_sweep_records_what_it_knows_and_no_more() {
    let mut document = table1();
    document["kind"] = json!("sweep");
    document["axes"] = json!([{"pointer": "/operation/pinion_speed_rpm", "from": 500, "to": 900, "points": 5}]);
    document["record"] = json!(["spectrum", "poincare"]);
    document["continuation"] = json!("both");
    let parsed = parse_value(&document).expect("valid");
    assert_eq!(
        (parsed.record, parsed.continuation),
        (vec![Recorded::Spectrum, Recorded::Poincare], Some(Continuation::Both))
    );
    document["record"] = json!(["waterfall"]);
    assert_eq!(violations(&document)[0].pointer, "/record/0");
    document["record"] = json!(["poincare"]);
    document["axes"][0]["points"] = json!(100_000);
    assert_eq!(violations(&document)[0].pointer, "/record");
    let alone = with("/record", json!(["poincare"]));
    assert_eq!(violations(&alone)[0].pointer, "/record");
}

#[test]
fn the_input_of_a_row_has_all_that_its_axes_move() {
    let mut document = table1();
    document["kind"] = json!("sweep");
    document["axes"] = json!([
        {"pointer": "/design/pinion/teeth", "also": ["/design/gear/teeth"], "values": [20, 30]},
        {"pointer": "/operation/pinion_speed_rpm", "values": [500.0, 600.0, 700.0]},
    ]);
    let sweep = parse_value(&document).expect("valid");
    let row = sweep.of_row(3).expect("a row");
    assert_eq!((row.kind, row.axes.len(), row.continuation), (JobKind::Response, 0, None));
    assert_eq!((row.design.pinion.teeth, row.design.gear.teeth, row.operation.pinion_speed_rpm), (30, 30, 600.0));
    assert_eq!(sweep.of_row(6), None);
}
