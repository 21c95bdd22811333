//! Shafts, bearings, couplings and masses.

use super::gearbox::{Gearbox, MIDDLES_MM, PINION_SHAFT, WHEEL, WHEEL_SHAFT, WIDTH_MM};
use super::*;
use serde_json::json;

fn segments(import: &Import, member: &str) -> Vec<(f64, f64, f64)> {
    let list = import
        .document
        .pointer(&format!("/design/shafts/{member}/segments"))
        .and_then(Value::as_array)
        .expect("segments");
    let number = |segment: &Value, name: &str| segment[name].as_f64().expect("a number");
    list.iter().map(|one| (number(one, "length_mm"), number(one, "diameter_mm"), number(one, "bore_mm"))).collect()
}

#[test]
fn sections_and_bodies_are_segments() {
    let import = imported(Gearbox::double_helical("1.7").with_shafts().xml().as_bytes(), &ImportOptions::default());
    let root_mm = 5.0 * 29.0 / 25f64.to_radians().cos() - 2.0 * 5.0 * (1.3 - 0.1);
    let pinion = segments(&import, "pinion");
    let expected = [
        (60.0, 70.0, 20.0),
        (15.0, 80.0, 20.0),
        (WIDTH_MM, root_mm, 20.0),
        (40.0, 80.0, 20.0),
        (WIDTH_MM, root_mm, 20.0),
        (15.0, 80.0, 20.0),
        (80.0, 70.0, 20.0),
    ];
    assert_eq!(pinion.len(), expected.len(), "{pinion:?}");
    for (one, other) in pinion.iter().zip(expected) {
        assert_close(one.0, other.0, 1e-9);
        assert_close(one.1, other.1, 1e-9);
        assert_close(one.2, other.2, 1e-9);
    }
    assert_eq!(number(&import, "/design/shafts/pinion/gear_position_mm"), 0.5 * (MIDDLES_MM[0] + MIDDLES_MM[1]));
    assert_eq!(number(&import, "/design/shafts/pinion/coupling/position_mm"), 0.0);
    assert_eq!(number(&import, "/design/shafts/gear/coupling/position_mm"), 350.0);
    for (name, value) in [
        ("position_mm", 30.0),
        ("radial_n_per_um", 600.0),
        ("axial_n_per_um", 200.0),
        ("tilting_nm_per_rad", 3e6),
        ("radial_damping_ns_per_m", 6000.0),
    ] {
        assert_eq!(number(&import, &format!("/design/shafts/gear/bearings/0/{name}")), value, "{name}");
    }
    assert_eq!(number(&import, "/design/shafts/gear/bearings/1/axial_n_per_um"), 0.0);
    let line =
        import.taken.iter().find(|line| line.pointer == "/design/shafts/gear/bearings/0/radial_n_per_um").unwrap();
    assert_eq!((line.from.as_str(), line.file_value.as_f64()), ("concept_bearing[230].radial_stiffness", Some(6e8)));
    geometry(&import);
}

#[test]
fn a_shaft_whose_axis_points_the_other_way_is_turned_round() {
    let mut model = Gearbox::double_helical("1.7").with_shafts();
    let plain = imported(model.xml().as_bytes(), &ImportOptions::default());
    // The same wheel, told from its other end.
    let length_mm = 350.0;
    let origin = model.of(WHEEL_SHAFT).attributes.iter().find(|(id, ..)| id == "support_vector").unwrap().2.clone();
    model.attribute(WHEEL_SHAFT, "support_vector", "mm", json!([length_mm, origin[1], 0.0]));
    model.attribute(WHEEL_SHAFT, "u_axis_vector", "mm", json!([-1.0, 0.0, 0.0]));
    for (gear, middle_mm) in WHEEL.into_iter().zip(MIDDLES_MM) {
        model.attribute(gear, "u_coordinate_on_shaft", "mm", json!(length_mm - middle_mm));
    }
    for section in [220, 221, 222] {
        let of = |name: &str| {
            model
                .parts
                .iter()
                .find(|part| part.id == section)
                .unwrap()
                .attributes
                .iter()
                .find(|(id, ..)| id == name)
                .unwrap()
                .2
                .as_f64()
                .unwrap()
        };
        let start_mm = length_mm - of("u_coordinate_on_shaft") - of("length");
        model.attribute(section, "u_coordinate_on_shaft", "mm", json!(start_mm));
    }
    for (bearing, place_mm) in [(230, 320.0), (231, 50.0)] {
        model.attribute(bearing, "u_coordinate_on_shaft_inner_side", "mm", json!(place_mm));
    }
    model.attribute(61, "u_coordinate_on_shaft", "mm", json!(0.0));
    let turned = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(turned.document["design"]["shafts"], plain.document["design"]["shafts"]);
    assert_eq!(turned.document["design"]["gap_width_mm"], plain.document["design"]["gap_width_mm"]);
}

#[test]
fn placeholders_of_bearings_are_told_from_stiffnesses() {
    let mut model = Gearbox::double_helical("1.7").with_shafts();
    // As other programs write what they will calculate.
    model.of(210).kind = "rolling_bearing_with_catalog_geometry".to_owned();
    model.attribute(210, "radial_stiffness", "N / m", json!(1e23));
    model.attribute(210, "bending_stiffness", "N mm / rad", json!(1e15));
    model.attribute(210, "axial_force_absorption", "none", json!("positive"));
    model.attribute(210, "axial_stiffness", "N / m", json!(0.0));
    model.without(211, "radial_stiffness");
    model.attribute(211, "operating_point_stiffness_f_v_d_v", "N / m", json!(-4e8));
    model.attribute(211, "operating_point_stiffness_f_w_d_w", "N / m", json!(-2e8));
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    // 10 N/µm per mm of the shaft's diameter there.
    assert_eq!(number(&import, "/design/shafts/pinion/bearings/0/radial_n_per_um"), 700.0);
    assert_eq!(number(&import, "/design/shafts/pinion/bearings/0/axial_n_per_um"), 233.3);
    assert_eq!(number(&import, "/design/shafts/pinion/bearings/0/tilting_nm_per_rad"), 0.0);
    assert_eq!(number(&import, "/design/shafts/pinion/bearings/1/radial_n_per_um"), 300.0);
    assert!(
        import.assumed.iter().any(|line| line.pointer == "/design/shafts/pinion/bearings/0/radial_n_per_um"
            && line.why.contains("placeholder"))
    );
    assert!(import.ignored.iter().any(|line| line.from.ends_with("[210].bending_stiffness")));
}

#[test]
fn masses_and_couplings_are_bodies_on_the_shaft() {
    let mut model = Gearbox::double_helical("1.7").with_shafts();
    model.part(
        80,
        "additional_mass",
        &[
            ("u_coordinate_on_shaft", "mm", json!(320.0)),
            ("mass_of_component", "kg", json!(12.0)),
            ("moment_of_inertia_u_axis", "kg m^2", json!(0.06)),
            ("moment_of_inertia_v_axis", "kg m^2", json!(0.04)),
            ("moment_of_inertia_w_axis", "kg m^2", json!(0.04)),
        ],
    );
    model.tie("assembly", None, &[("assembly", PINION_SHAFT), ("part", 80)]);
    model.part(81, "shaft", &[]);
    model.part(
        82,
        "additional_mass",
        &[("u_coordinate_on_shaft", "mm", json!(0.0)), ("moment_of_inertia_u_axis", "kg m^2", json!(1.5))],
    );
    model.tie("assembly", None, &[("assembly", 81), ("part", 82)]);
    model.part(
        83,
        "coupling",
        &[("rotational_stiffness", "N mm / rad", json!(4e8)), ("u_coordinate_on_shaft_inner_side", "mm", json!(0.0))],
    );
    model.tie("side", None, &[("assembly", 83), ("inner_part", PINION_SHAFT), ("outer_part", 81)]);
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    for (pointer, value) in [
        ("/design/shafts/pinion/inertias/0/position_mm", 320.0),
        ("/design/shafts/pinion/inertias/0/mass_kg", 12.0),
        ("/design/shafts/pinion/inertias/0/polar_inertia_kg_m2", 0.06),
        ("/design/shafts/pinion/inertias/0/diametral_inertia_kg_m2", 0.04),
        ("/design/shafts/pinion/coupling/torsional_nm_per_rad", 4e5),
        ("/design/shafts/pinion/coupling/inertia_kg_m2", 1.5),
    ] {
        assert_eq!(number(&import, pointer), value, "{pointer}");
    }
    // Without sections the mass belongs to the gear.
    model.parts.retain(|part| part.kind != "shaft_section");
    model.ties.retain(|tie| !tie.refs.iter().any(|(_, id)| [200, 201, 202, 220, 221, 222].contains(id)));
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert!(has_warning(&import, "no-shafts"));
    assert!(number(&import, "/design/pinion/inertia_kg_m2") > 0.06);
}

#[test]
fn shafts_that_a_document_cannot_have_leave_the_teeth() {
    let mut model = Gearbox::double_helical("1.7").with_shafts();
    // A bearing in the face.
    model.attribute(210, "u_coordinate_on_shaft_inner_side", "mm", json!(MIDDLES_MM[0]));
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert!(import.document["design"].get("shafts").is_none());
    assert!(has_warning(&import, "shafts-not-taken"), "{:?}", import.warnings);
    assert_eq!(number(&import, "/design/pinion/teeth"), 29.0);
    assert!(import.taken.iter().all(|line| !line.pointer.starts_with("/design/shafts")));
}

#[test]
fn without_an_axial_bearing_the_gear_is_held() {
    let mut model = Gearbox::double_helical("1.7").with_shafts();
    model.attribute(230, "axial_force_absorption", "none", json!("no_direction"));
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(number(&import, "/design/shafts/gear/bearings/0/axial_n_per_um"), 200.0);
    assert!(import.assumed.iter().any(|line| line.pointer == "/design/shafts/gear/bearings/0/axial_n_per_um"));
}

#[test]
fn the_projects_own_pair_has_its_shafts() {
    let import = imported(&data("herringbone_pair_1_7.rexs"), &ImportOptions::default());
    assert_eq!(number(&import, "/design/shafts/pinion/bearings/0/radial_n_per_um"), 500.0);
    assert_eq!(number(&import, "/design/shafts/gear/bearings/0/axial_n_per_um"), 100.0);
    assert_eq!(number(&import, "/design/shafts/gear/gear_position_mm"), 150.0);
    let length: f64 = segments(&import, "gear").iter().map(|segment| segment.0).sum();
    assert_close(length, 300.0, 1e-9);
}
