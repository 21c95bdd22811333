//! Documents through the stages.

use super::*;
use crate::job::parse_value;
use serde_json::{Value, json};

fn example(name: &str) -> Value {
    let path = format!("{}/examples/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_slice(&std::fs::read(path).expect("readable")).expect("JSON")
}

fn document(value: &Value) -> JobDocument {
    parse_value(value).expect("valid")
}

#[test]
fn table1_has_the_contact_ratios_of_its_geometry() {
    let report = check(&document(&example("table1"))).expect("feasible");
    let geometry = &report.geometry;
    assert!((geometry.transverse_contact_ratio - 1.4968).abs() < 5e-5, "{geometry:?}");
    assert!((geometry.overlap_ratio - 1.6456).abs() < 5e-5, "{geometry:?}");
    assert!((geometry.mesh_frequency_hz - 566.6667).abs() < 1e-3);
    assert_eq!(geometry.pinion.inertia_kg_m2, 0.065);
}

#[test]
fn the_variants_of_table2_reach_their_contact_ratios() {
    for (name, ratio) in [
        ("table2_2_72", 2.72),
        ("table2_2_91", 2.91),
        ("table2_3_30", 3.30),
        ("table2_3_68", 3.68),
        ("table2_4_07", 4.07),
    ] {
        let report = check(&document(&example(name))).expect("feasible");
        assert!((report.geometry.total_contact_ratio - ratio).abs() < 5e-4, "{name}: {:?}", report.geometry);
    }
}

#[test]
fn an_impossible_gear_is_refused_with_its_field() {
    let mut value = example("table1");
    value["design"]["pinion"]["profile_shift"] = json!(1.9);
    let Err(DocumentError::Invalid(violations)) = check(&document(&value)) else { panic!("refused") };
    assert!(violations.iter().all(|v| v.pointer.starts_with("/design/")), "{violations:?}");
    assert!(violations.iter().any(|v| v.code == "pointed-tip"), "{violations:?}");
}

#[test]
fn a_hash_depends_on_what_decides_and_on_nothing_else() {
    let base = document(&example("table1"));
    let mut renamed = base.clone();
    renamed.name = Some("another name".into());
    assert_eq!(input_hash(&base), input_hash(&renamed));
    let mut faster = base.clone();
    faster.operation.pinion_speed_rpm += 1.0;
    assert_ne!(input_hash(&base), input_hash(&faster));
    assert_eq!(hash::mesh_hash(&base), hash::mesh_hash(&faster));
    let mut loaded = base.clone();
    loaded.operation.pinion_torque_nm += 1.0;
    assert_ne!(hash::mesh_hash(&base), hash::mesh_hash(&loaded));
}
