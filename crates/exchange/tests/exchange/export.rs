//! Export of documents: schema, attributes, and the way back.

use super::*;
use herringbone_exchange::{ExportForm, ExportOptions, export_rexs};
use herringbone_job::document::JobDocument;
use proptest::prelude::*;
use serde_json::json;
use std::collections::{HashMap, HashSet};

const XML: ExportOptions = ExportOptions {
    form: ExportForm::Xml,
    date: "2026-01-31T08:00:00+00:00",
    application_version: "0.1.0",
    result: None,
    result_id: None,
};
const JSON: ExportOptions = ExportOptions { form: ExportForm::Json, ..XML };

fn document(value: &Value) -> JobDocument {
    herringbone_job::parse_value(value).unwrap_or_else(|error| panic!("{error:#?}"))
}

/// A document with everything that the format can carry.
fn full() -> JobDocument {
    let mut value = imported(&data("herringbone_pair_1_7.rexs"), &ImportOptions::default()).document;
    value["design"]["pinion"]["helix_slope_um"] = json!(3.0);
    value["design"]["pinion"]["end_relief"] = json!({"amount_um": 5.0, "length_mm": 6.0});
    value["design"]["gear"]["right"] = json!({"lead_crowning_um": 11.0});
    value["design"]["gear"]["material"] =
        json!({"youngs_modulus_gpa": 175.0, "poissons_ratio": 0.28, "density_kg_m3": 7100.0});
    value["design"]["half_stagger"] = json!(0.5);
    value["design"]["shafts"]["pinion"]["inertias"] =
        json!([{"position_mm": 10.0, "mass_kg": 5.0, "polar_inertia_kg_m2": 0.02, "diametral_inertia_kg_m2": 0.015}]);
    document(&value)
}

#[test]
fn a_model_fits_the_schema_of_files() {
    let schema: Value = serde_json::from_slice(&data("rexs-file.json")).expect("JSON");
    let schema = jsonschema::validator_for(&schema).expect("a schema");
    let written: Value = serde_json::from_str(&export_rexs(&full(), &JSON).expect("written")).expect("JSON");
    let errors: Vec<_> =
        schema.iter_errors(&written).map(|error| format!("{error} at {}", error.instance_path())).collect();
    assert!(errors.is_empty(), "{errors:?}");
    let broken = json!({"model": {"version": "1.7"}});
    assert!(!schema.is_valid(&broken));
}

/// Ids, units and types as the format's own database of attributes has them, and the roles of relations.
#[test]
fn every_attribute_is_one_of_the_format() {
    let table = String::from_utf8(data("rexs_1_7_attributes.csv")).expect("UTF-8");
    let known: HashMap<(String, String), (String, String)> = table
        .lines()
        .skip(1)
        .map(|line| {
            let fields: Vec<_> = line.split(',').map(str::to_owned).collect();
            ((fields[0].clone(), fields[1].clone()), (fields[2].clone(), fields[3].clone()))
        })
        .collect();
    let kinds: HashSet<_> = known.keys().map(|(kind, _)| kind.clone()).collect();
    let written: Value = serde_json::from_str(&export_rexs(&full(), &JSON).expect("written")).expect("JSON");
    let (mut checked, mut custom) = (0, 0);
    let mut ids = HashSet::new();
    for component in written["model"]["components"].as_array().expect("components") {
        let kind = component["type"].as_str().expect("a type");
        assert!(ids.insert(component["id"].as_i64().expect("an id")), "{component}");
        assert!(
            kinds.contains(kind) || ["gear_casing", "cylindrical_gear_manufacturing_settings"].contains(&kind),
            "{kind}"
        );
        for attribute in component["attributes"].as_array().expect("attributes") {
            let id = attribute["id"].as_str().expect("an id");
            if id.starts_with("custom_herringbone_") {
                assert!(
                    id.chars().all(|letter| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '_')
                );
                custom += 1;
                continue;
            }
            let (unit, value) = &known.get(&(kind.to_owned(), id.to_owned())).unwrap_or_else(|| panic!("{kind}.{id}"));
            assert_eq!(
                (attribute["unit"].as_str(), attribute.get(value).is_some()),
                (Some(unit.as_str()), true),
                "{kind}: {attribute} {value}"
            );
            checked += 1;
        }
    }
    assert!(checked > 300 && custom >= 8, "{checked} attributes, {custom} of our own");
    let roles: HashMap<&str, Vec<&str>> = HashMap::from([
        ("assembly", vec!["assembly", "part"]),
        ("stage", vec!["stage", "gear_1", "gear_2"]),
        ("flank", vec!["gear", "left", "right"]),
        ("stage_gear_data", vec!["stage", "gear", "stage_gear_data"]),
        ("reference", vec!["origin", "referenced"]),
        ("manufacturing_step", vec!["workpiece", "tool", "manufacturing_settings"]),
        ("side", vec!["assembly", "inner_part", "outer_part"]),
    ]);
    for relation in written["model"]["relations"].as_array().expect("relations") {
        let found: Vec<_> =
            relation["refs"].as_array().expect("refs").iter().map(|one| one["role"].as_str().unwrap()).collect();
        assert_eq!(roles.get(relation["type"].as_str().unwrap()), Some(&found), "{relation}");
        assert!(
            relation["refs"].as_array().unwrap().iter().all(|one| ids.contains(&one["id"].as_i64().unwrap())),
            "{relation}"
        );
    }
}

/// What the format can carry, compared field by field.
fn assert_returned(document: &JobDocument, returned: &Import) {
    let value = serde_json::to_value(document).expect("JSON");
    let returned = &returned.document;
    let mut compared = 0;
    let mut compare = |pointer: &str, sent: &Value, back: &Value| {
        compared += 1;
        match (sent.as_f64(), back.as_f64()) {
            (Some(sent), Some(back)) => {
                assert!((sent - back).abs() <= 1e-12 * sent.abs().max(1.0), "{pointer}: {sent} came back as {back}");
            }
            _ => assert_eq!(sent, back, "{pointer}"),
        }
    };
    for pointer in [
        "/design/normal_module_mm",
        "/design/helix_angle_deg",
        "/design/face_width_mm",
        "/design/gap_width_mm",
        "/design/half_stagger",
        "/design/backlash_um",
        "/design/pinion/teeth",
        "/design/gear/teeth",
        "/design/pinion/left_half_hand",
        "/design/gear/left_half_hand",
        "/design/pinion/profile_shift",
        "/design/gear/profile_shift",
        "/design/pinion/dedendum",
        "/design/gear/dedendum",
        "/design/pinion/fillet_radius",
        "/design/gear/fillet_radius",
        "/design/pinion/mass_kg",
        "/operation/pinion_speed_rpm",
        "/operation/pinion_torque_nm",
        "/operation/rotation",
        "/design/material/youngs_modulus_gpa",
        "/design/material/poissons_ratio",
        "/design/material/density_kg_m3",
    ] {
        let at = |value: &Value| value.pointer(pointer).cloned().unwrap_or(Value::Null);
        compare(pointer, &at(&value), &at(returned));
    }
    for member in ["pinion", "gear"] {
        let height = |value: &Value| {
            let gear = &value["design"][member];
            gear["addendum"].as_f64().unwrap() + gear["tip_alteration"].as_f64().unwrap()
        };
        compare("tooth height", &height(&value).into(), &height(returned).into());
        for half in ["left", "right"] {
            let flank = |value: &Value, name: &str| {
                let gear = &value["design"][member];
                let own = if gear[half].is_object() { &gear[half] } else { gear };
                own.pointer(name).cloned().unwrap_or(Value::Null)
            };
            for name in [
                "/tip_relief/amount_um",
                "/tip_relief/length_mm",
                "/lead_crowning_um",
                "/helix_slope_um",
                "/end_relief/amount_um",
                "/end_relief/length_mm",
            ] {
                compare(name, &flank(&value, name), &flank(returned, name));
            }
            if flank(&value, "/tip_relief/amount_um") != json!(0.0) {
                compare("shape", &flank(&value, "/tip_relief/shape"), &flank(returned, "/tip_relief/shape"));
            }
        }
    }
    assert!(compared > 45, "{compared}");
}

#[test]
fn what_is_written_comes_back_with_its_shafts() {
    let document = full();
    let [xml, json] = [XML, JSON].map(|options| export_rexs(&document, &options).expect("written"));
    assert!(xml.contains("date=\"2026-01-31T08:00:00+00:00\"") && xml.contains("<c>1.0</c>"));
    let returned = imported(xml.as_bytes(), &ImportOptions::default());
    assert_eq!(returned.document, imported(json.as_bytes(), &ImportOptions::default()).document);
    assert_returned(&document, &returned);
    let sent = serde_json::to_value(&document).expect("JSON");
    for pointer in [
        "/design/shafts/pinion/segments",
        "/design/shafts/gear/segments",
        "/design/shafts/gear/bearings",
        "/design/shafts/pinion/inertias",
        "/design/shafts/pinion/coupling",
    ] {
        assert_eq!(sent.pointer(pointer), returned.document.pointer(pointer), "{pointer}");
    }
    assert!(returned.checks.iter().all(|check| check.agrees) && returned.checks.len() >= 6, "{:?}", returned.checks);
}

#[test]
fn without_our_own_attributes_the_model_is_complete() {
    let document = full();
    let mut written: Value = serde_json::from_str(&export_rexs(&document, &JSON).expect("written")).expect("JSON");
    for component in written["model"]["components"].as_array_mut().expect("components") {
        let attributes = component["attributes"].as_array_mut().expect("attributes");
        attributes.retain(|attribute| !attribute["id"].as_str().unwrap_or_default().starts_with("custom_"));
    }
    assert_returned(&document, &imported(written.to_string().as_bytes(), &ImportOptions::default()));
}

fn documents() -> impl Strategy<Value = Value> {
    let flank = || {
        (0.0..40.0f64, 0.5..4.0f64, any::<bool>(), -10.0..20.0f64, -15.0..15.0f64, 0.0..12.0f64).prop_map(
        |(amount, length, linear, crowning, slope, end)| json!({
            "tip_relief": {"amount_um": amount, "length_mm": length, "shape": if linear { "linear" } else { "parabolic" }},
            "lead_crowning_um": crowning, "helix_slope_um": slope, "end_relief": {"amount_um": end, "length_mm": 5.0},
        }),
    )
    };
    let gear =
        (18..60u32, -0.2..0.4f64, 1.2..1.35f64, 0.1..0.3f64, -0.05..0.02f64, flank(), proptest::option::of(flank()));
    let mate =
        (60..150u32, -0.2..0.4f64, 1.2..1.35f64, 0.1..0.3f64, -0.05..0.02f64, flank(), proptest::option::of(flank()));
    let member =
        |(teeth, shift, dedendum, fillet, tip, flank, right): (u32, f64, f64, f64, f64, Value, Option<Value>)| {
            let mut gear = flank;
            for (name, value) in [
                ("teeth", json!(teeth)),
                ("profile_shift", json!(shift)),
                ("dedendum", json!(dedendum)),
                ("fillet_radius", json!(fillet)),
                ("tip_alteration", json!(tip)),
            ] {
                gear[name] = value;
            }
            if let Some(right) = right {
                gear["right"] = right;
            }
            gear
        };
    let sizes =
        (1.0..20.0f64, 8.0..35.0f64, 15.0..24.0f64, 20.0..200.0f64, 0.0..80.0f64, proptest::option::of(1.0..900.0f64));
    let rest = (
        any::<bool>(),
        any::<bool>(),
        any::<bool>(),
        50.0..9000.0f64,
        -3000.0..3000.0f64,
        0.0..0.99f64,
        proptest::option::of(1.0..80.0f64),
    );
    (gear.prop_map(member), mate.prop_map(member), sizes, rest).prop_map(
        |(mut pinion, gear, (module, helix, pressure, width, gap, backlash), (right, leading, staggered, speed, torque, stagger, mass))| {
            pinion["left_half_hand"] = json!(if right { "right" } else { "left" });
            pinion["mass_kg"] = json!(mass);
            json!({
                "design": {
                    "normal_module_mm": module, "helix_angle_deg": helix, "pressure_angle_deg": pressure, "face_width_mm": width,
                    "gap_width_mm": gap, "backlash_um": backlash, "half_stagger": if staggered { stagger } else { 0.0 },
                    "pinion": pinion, "gear": gear,
                },
                "operation": {"pinion_speed_rpm": speed, "pinion_torque_nm": torque, "rotation": if leading { "apex_leading" } else { "apex_trailing" }},
            })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    #[test]
    fn any_pair_comes_back(value in documents()) {
        let document = document(&value);
        // Pairs that cannot exist are not written.
        if let Ok(text) = export_rexs(&document, &XML) {
            assert_returned(&document, &imported(text.as_bytes(), &ImportOptions::default()));
        }
    }
}
