//! Tests of gears of different material and width, of large backlash, and of inputs that a sweep varies together.

use super::*;

const TOPIC: &str = "Job: members of different material and width";

fn plastic() -> Value {
    json!({"youngs_modulus_gpa": 2.8, "poissons_ratio": 0.38, "density_kg_m3": 1410})
}

fn mesh(value: &Value) -> crate::result::Mesh {
    let value =
        json!({"kind": "mesh", "design": value["design"], "operation": value["operation"], "model": value["model"]});
    solved(&value).result.mesh.expect("a mesh")
}

fn violations(value: &Value) -> Vec<crate::Violation> {
    let checked = parse_value(value).and_then(|document| check(&document));
    let Err(DocumentError::Invalid(violations)) = checked else { panic!("refused: {checked:?}") };
    violations
}

#[test]
fn a_plastic_gear_runs_on_a_steel_pinion() {
    let mut value = example("table1");
    value["design"]["gear"]["material"] = plastic();
    let outcome = solved(&value);
    let written = serde_json::to_value(document(&value)).expect("numbers and texts");
    assert_eq!(written["design"]["gear"]["material"], plastic_as_numbers());
    assert_eq!(written["design"].pointer("/pinion/material"), None);
    let response = outcome.result.response.expect("a response");
    assert!(response.rms.mesh_circumferential_acceleration_m_s2.left.is_finite());
    let steel = mesh(&example("table1"));
    let mixed = outcome.result.mesh.expect("a mesh");
    // The plastic tooth alone against both of steel: an order of magnitude, but not E over E, as it has half of the
    // compliance of two.
    let ratio = mixed.stiffness_mean_n_per_um / steel.stiffness_mean_n_per_um;
    assert!(ratio > 2.8 / 206.0 && ratio < 4.0 * 2.8 / 206.0, "{ratio}");
    assert!(mixed.max_contact_pressure_mpa < steel.max_contact_pressure_mpa);
    // The mass that is not given is that of the gear's own material.
    let [own, all] = [outcome.result.geometry, check(&document(&example("table1"))).map(|r| r.geometry).ok()]
        .map(|geometry| geometry.expect("a geometry"));
    check_value(
        TOPIC,
        "mass of the plastic gear over steel",
        own.gear.mass_kg / all.gear.mass_kg,
        1410.0 / 7850.0,
        Relative(1e-12),
    );
    assert_eq!(own.pinion.mass_kg.to_bits(), all.pinion.mass_kg.to_bits());
    assert_eq!(own.gear.inertia_kg_m2, 3.7);
}

fn plastic_as_numbers() -> Value {
    json!({"youngs_modulus_gpa": 2.8, "poissons_ratio": 0.38, "density_kg_m3": 1410.0})
}

#[test]
fn the_closed_form_takes_the_reduced_modulus_of_both() {
    let mut value = example("table1");
    value["model"]["mesh_stiffness"] = json!({"source": "iso6336"});
    value["model"]["impact"] = json!({"source": "none"});
    let steel = mesh(&value).stiffness_mean_n_per_um;
    for member in ["pinion", "gear"] {
        let mut value = value.clone();
        value["design"][member]["material"] = plastic();
        let ratio = mesh(&value).stiffness_mean_n_per_um / steel;
        check_value(
            TOPIC,
            &format!("ISO 6336-1, plastic {member} over steel"),
            ratio,
            2.0 * 2.8 / 208.8,
            Relative(1e-12),
        );
    }
}

#[test]
fn own_values_that_are_the_designs_change_not_a_bit() {
    for name in ["table1", "tip_relief", "given_stiffness"] {
        let plain = example(name);
        let mut own = plain.clone();
        own["design"]["pinion"]["material"] = json!({});
        own["design"]["gear"]["material"] = json!({"density_kg_m3": 7850});
        own["design"]["gear"]["face_width_mm"] = plain["design"]["face_width_mm"].clone();
        own["design"]["pinion"]["coast"] = json!({"lead_crowning_um": 12.0});
        assert_eq!(solved(&own), solved(&plain), "{name}");
    }
    // Fields left out of a gear's material default to those of the design's material, not to steel.
    let mut soft = example("table1");
    soft["design"]["material"] = json!({"youngs_modulus_gpa": 100});
    soft["design"]["gear"]["material"] = json!({"density_kg_m3": 7000});
    let material = document(&soft).design.gear.material.expect("given");
    assert_eq!((material.youngs_modulus_gpa, material.density_kg_m3), (100.0, 7000.0));
}

/// Results of the examples, unchanged since before gears had materials and widths of their own.
#[test]
fn numbers_of_the_examples_stay() {
    let topic = "Job: example documents";
    let table1 = mesh(&example("table1"));
    check_value(topic, "table1, mean stiffness, N/µm", table1.stiffness_mean_n_per_um, TABLE1[0], Relative(1e-10));
    check_value(topic, "table1, transmission error, µm", table1.transmission_error_pp_um, TABLE1[1], Relative(1e-10));
    let mut iso = example("table1");
    iso["model"]["mesh_stiffness"] = json!({"source": "iso6336"});
    check_value(topic, "table1, ISO 6336-1, N/µm", mesh(&iso).stiffness_mean_n_per_um, TABLE1[2], Relative(1e-12));
}

/// Mean stiffness and transmission error of the loaded contact, mean stiffness of the closed form.
const TABLE1: [f64; 3] = [1_404.804_610_565_309_3, 0.458_324_402_579_982_64, 1_187.469_502_748_527_7];

#[test]
fn the_common_width_bears_and_each_gear_has_its_own_mass() {
    let mut value = example("table1");
    value["model"]["impact"] = json!({"source": "none"});
    let plain = mesh(&value);
    let geometry = |value: &Value| check(&document(value)).expect("feasible").geometry;
    let mut wide = value.clone();
    wide["design"]["pinion"]["face_width_mm"] = json!(87.0);
    assert_eq!(geometry(&wide).overlap_ratio, geometry(&value).overlap_ratio);
    check_value(
        TOPIC,
        "mass of a wider pinion",
        geometry(&wide).pinion.mass_kg / geometry(&value).pinion.mass_kg,
        87.0 / 75.0,
        Relative(1e-12),
    );
    let stiffer = mesh(&wide).stiffness_mean_n_per_um / plain.stiffness_mean_n_per_um;
    assert!(stiffer > 1.001 && stiffer < 1.06, "{stiffer}");
    // A narrower gear bears over its own width, on the middles of the halves: a pair of that width with a wider pinion.
    let mut narrow = value.clone();
    narrow["design"]["gear"]["face_width_mm"] = json!(60.0);
    let mut same = value.clone();
    same["design"]["face_width_mm"] = json!(60.0);
    same["design"]["gap_width_mm"] = json!(45.0);
    same["design"]["pinion"]["face_width_mm"] = json!(75.0);
    assert_eq!(mesh(&narrow), mesh(&same));
    check_value(
        TOPIC,
        "overlap ratio of the common width",
        geometry(&narrow).overlap_ratio / geometry(&value).overlap_ratio,
        0.8,
        Relative(1e-12),
    );
    // Impossible ones, with their field.
    for (width, code) in [(0.1, "out-of-range"), (2001.0, "out-of-range"), (105.5, "conflict")] {
        let mut value = example("table1");
        value["design"]["gear"]["face_width_mm"] = json!(width);
        let found = violations(&value);
        assert!(found.iter().any(|v| v.pointer == "/design/gear/face_width_mm" && v.code == code), "{width} {found:?}");
    }
    value["design"]["gear"]["face_width_mm"] = json!(105.0);
    assert!(check(&document(&value)).is_ok());
}

#[test]
fn play_goes_up_to_five_millimetres() {
    let mut value = example("given_stiffness");
    value["design"]["backlash_um"] = json!(5000);
    assert!(check(&document(&value)).is_ok());
    value["design"]["backlash_um"] = json!(5001);
    assert!(violations(&value).iter().any(|v| v.pointer == "/design/backlash_um" && v.maximum == Some(5000.0)));
}

#[test]
fn further_inputs_move_with_an_axis() {
    let mut value = example("given_stiffness");
    value["kind"] = json!("sweep");
    let (first, second) = ("/design/supports/pinion_lateral_n_per_um", "/design/supports/gear_lateral_n_per_um");
    let also = "/design/supports/gear_axial_n_per_um";
    value["axes"] = json!([{"pointer": first, "also": [second, also], "values": [300.0, 500.0]}]);
    value["analysis"] = json!({"method": "periodic"});
    let sweep = solved(&value).result.sweep.expect("a sweep");
    assert_eq!(sweep.axes[0].also, [second, also]);
    for row in &sweep.points {
        let mut single = value.clone();
        single["kind"] = json!("response");
        single.as_object_mut().map(|fields| fields.remove("axes"));
        for pointer in [first, second, also] {
            let name = pointer.rsplit('/').next().expect("a name");
            single["design"]["supports"][name] = json!(row.values[0]);
        }
        let response = solved(&single).result.response.expect("a response");
        assert_eq!(
            row.mesh_circumferential_acceleration_rms_m_s2.map(|rms| rms.left),
            Some(response.rms.mesh_circumferential_acceleration_m_s2.left)
        );
    }
    // Checked like the pointer itself.
    for (also, pointer) in [
        (json!(["/design/nothing"]), "/axes/0/also/0"),
        (json!([second, "/design/pinion"]), "/axes/0/also/1"),
        (json!([first]), "/axes/0/also/0"),
        (json!([second, second]), "/axes/0/also/1"),
        // In range where it points, out of range where it also points.
        (json!(["/design/pinion/profile_shift"]), "/axes/0"),
        (json!(["/design/pinion/teeth", "/operation/pinion_speed_rpm"]), "/axes/1/pointer"),
    ] {
        let mut value = value.clone();
        value["axes"][0]["also"] = also;
        let speed = json!({"pointer": "/operation/pinion_speed_rpm", "values": [1000.0]});
        value["axes"].as_array_mut().expect("axes").push(speed);
        let found = violations(&value);
        assert!(found.iter().any(|v| v.pointer == pointer), "{pointer} {found:?}");
    }
    // A speed that moves along makes a Campbell diagram too.
    value["axes"] = json!([{"pointer": "/design/supports/pinion_lateral_n_per_um", "also": ["/operation/pinion_speed_rpm"], "values": [600.0, 3000.0]}]);
    assert_eq!(solved(&value).result.sweep.expect("a sweep").campbell.len(), 1);
}
