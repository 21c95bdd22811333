use super::*;
use serde_json::json;

/// The reference arrangement of the specification: pinion and gear between their bearings.
fn straddle() -> Value {
    let segments = |pieces: &[(f64, f64)]| -> Value {
        pieces.iter().map(|(length, diameter)| json!({"length_mm": length, "diameter_mm": diameter})).collect()
    };
    json!({
        "pinion": {
            "gear_position_mm": 290.0,
            "segments": segments(&[
                (100.0, 65.0), (40.0, 75.0), (60.0, 80.0), (75.0, 97.0), (30.0, 90.0), (75.0, 97.0), (60.0, 80.0), (40.0, 75.0),
            ]),
            "bearings": [{"position_mm": 120.0, "radial_n_per_um": 1000.0}, {"position_mm": 460.0, "radial_n_per_um": 1000.0}],
            "coupling": {"position_mm": 0.0},
        },
        "gear": {
            "gear_position_mm": 190.0,
            "segments": segments(&[
                (40.0, 110.0), (60.0, 120.0), (75.0, 275.0), (30.0, 200.0), (75.0, 275.0), (60.0, 120.0), (40.0, 110.0),
                (60.0, 100.0),
            ]),
            "bearings": [
                {"position_mm": 20.0, "radial_n_per_um": 1200.0, "axial_n_per_um": 400.0},
                {"position_mm": 360.0, "radial_n_per_um": 1200.0},
            ],
            "coupling": {"position_mm": 440.0},
        },
    })
}

fn with_shafts(shafts: Value) -> Value {
    let mut document: Value = serde_json::from_str(include_str!("../../../../examples/contact.json")).unwrap();
    document["design"]["shafts"] = shafts;
    document
}

fn read(shafts: Value) -> JobDocument {
    parse_value(&with_shafts(shafts)).unwrap_or_else(|error| panic!("{error:#?}"))
}

fn violations(document: &Value) -> Vec<Violation> {
    match parse_value(document) {
        Err(DocumentError::Invalid(violations)) => violations,
        other => panic!("not refused: {other:?}"),
    }
}

/// Blocks that cannot work: a change of the reference arrangement, pointer (below `/design/shafts`) and part of the
/// reason.
type Malformed = (&'static str, fn(&mut Value), &'static str, &'static str);

const MALFORMED: &[Malformed] = &[
    (
        "no pinion",
        |s| drop(s.as_object_mut().unwrap().remove("pinion")),
        "/pinion",
        "the pinion's shaft, or an arrangement",
    ),
    ("no gear", |s| s["gear"] = Value::Null, "/gear", "the gear's shaft, or an arrangement"),
    ("a shaft that is none", |s| s["gear"] = json!("solid"), "/gear", "needed: an object"),
    (
        "no segments",
        |s| drop(s["pinion"].as_object_mut().unwrap().remove("segments")),
        "/pinion/segments",
        "is required",
    ),
    ("empty segments", |s| s["pinion"]["segments"] = json!([]), "/pinion/segments", "permitted: 1 to 64"),
    (
        "no bearings",
        |s| drop(s["pinion"].as_object_mut().unwrap().remove("bearings")),
        "/pinion/bearings",
        "is required",
    ),
    ("empty bearings", |s| s["pinion"]["bearings"] = json!([]), "/pinion/bearings", "nothing carries the shaft"),
    (
        "one bearing without tilting stiffness",
        |s| drop(s["pinion"]["bearings"].as_array_mut().unwrap().pop()),
        "/pinion/bearings",
        "would tilt about that bearing",
    ),
    (
        "one of two bearings holds nothing along y",
        |s| s["pinion"]["bearings"][0]["radial_y_n_per_um"] = json!(0.0),
        "/pinion/bearings",
        "at one place along y",
    ),
    (
        "nothing along x",
        |s| (0..2).for_each(|index| s["gear"]["bearings"][index]["radial_x_n_per_um"] = json!(0.0)),
        "/gear/bearings",
        "nothing along x",
    ),
    (
        "a bearing that carries nothing",
        |s| s["pinion"]["bearings"][1]["radial_n_per_um"] = json!(0.0),
        "/pinion/bearings/1/radial_n_per_um",
        "the bearing carries nothing",
    ),
    (
        "both free along the axis",
        |s| s["gear"]["bearings"][0]["axial_n_per_um"] = json!(0.0),
        "/gear/bearings",
        "both would wander off together",
    ),
    (
        "two bearings at one place",
        |s| s["gear"]["bearings"][1]["position_mm"] = json!(20.0),
        "/gear/bearings/1/position_mm",
        "where bearing 0 stands",
    ),
    (
        "a bearing outside",
        |s| s["pinion"]["bearings"][1]["position_mm"] = json!(480.1),
        "/pinion/bearings/1/position_mm",
        "permitted: 0 to 480 mm",
    ),
    (
        "a bearing left of the shaft",
        |s| s["pinion"]["bearings"][0]["position_mm"] = json!(-1.0),
        "/pinion/bearings/0/position_mm",
        "permitted: 0 to 50000 mm",
    ),
    (
        "a bearing in a face",
        |s| s["pinion"]["bearings"][1]["position_mm"] = json!(320.0),
        "/pinion/bearings/1/position_mm",
        "in the right half",
    ),
    (
        "the coupling outside",
        |s| s["gear"]["coupling"]["position_mm"] = json!(500.0),
        "/gear/coupling/position_mm",
        "permitted: 0 to 440 mm",
    ),
    ("no coupling", |s| drop(s["gear"].as_object_mut().unwrap().remove("coupling")), "/gear/coupling", "is required"),
    (
        "an inertia outside",
        |s| {
            let body = json!({"position_mm": 481.0, "mass_kg": 1.0, "polar_inertia_kg_m2": 0.1, "diametral_inertia_kg_m2": 0.1});
            s["pinion"]["inertias"] = json!([body]);
        },
        "/pinion/inertias/0/position_mm",
        "permitted: 0 to 480 mm",
    ),
    (
        "the gear outside the shaft",
        |s| s["gear"]["gear_position_mm"] = json!(441.0),
        "/gear/gear_position_mm",
        "permitted: 0 to 440 mm",
    ),
    (
        "faces beyond the left end",
        |s| s["pinion"]["gear_position_mm"] = json!(89.0),
        "/pinion/gear_position_mm",
        "permitted: 90 to 390 mm",
    ),
    (
        "a shaft shorter than the faces",
        |s| {
            s["pinion"] = json!({
                "gear_position_mm": 50.0, "segments": [{"length_mm": 100.0, "diameter_mm": 97.0}],
                "bearings": [{"position_mm": 50.0, "tilting_nm_per_rad": 1e6}], "coupling": {"position_mm": 0.0},
            });
        },
        "/pinion/gear_position_mm",
        "need 180 mm",
    ),
    (
        "a bore as wide as the shaft",
        |s| s["pinion"]["segments"][2]["bore_mm"] = json!(80.0),
        "/pinion/segments/2/bore_mm",
        "in a diameter of 80 mm",
    ),
    (
        "a segment without length",
        |s| s["pinion"]["segments"][0]["length_mm"] = json!(0.0),
        "/pinion/segments/0/length_mm",
        "permitted: 0.1 to 20000 mm",
    ),
    (
        "a body without teeth",
        |s| s["pinion"]["segments"][3]["diameter_mm"] = json!(130.0),
        "/pinion/segments/3/diameter_mm",
        "the tip circle is 124.0",
    ),
    (
        "a negative stiffness",
        |s| s["pinion"]["bearings"][0]["radial_n_per_um"] = json!(-5.0),
        "/pinion/bearings/0/radial_n_per_um",
        "permitted: 0 to 1e7 N/µm",
    ),
    (
        "a table and a constant",
        |s| s["pinion"]["bearings"][0]["speed_table"] = table(&[(0.0, 1.0, 0.0)]),
        "/pinion/bearings/0/radial_n_per_um",
        "together with speed_table",
    ),
    (
        "speeds that do not ascend",
        |s| {
            s["pinion"]["bearings"][0] = json!({"position_mm": 120.0, "speed_table": table(&[(0.0, 1.0, 0.0), (900.0, 1.0, 0.0), (900.0, 2.0, 0.0)])});
        },
        "/pinion/bearings/0/speed_table/2/speed_rpm",
        "is 900 r/min after 900 r/min",
    ),
    (
        "a table without stiffness",
        |s| s["pinion"]["bearings"][0] = json!({"position_mm": 120.0, "speed_table": table(&[(0.0, 0.0, 0.0)])}),
        "/pinion/bearings/0/speed_table/0/stiffness_xx_n_per_um",
        "above 0 N/µm",
    ),
    (
        "a singular table",
        |s| s["pinion"]["bearings"][0] = json!({"position_mm": 120.0, "speed_table": table(&[(0.0, 10.0, 10.0)])}),
        "/pinion/bearings/0/speed_table/0/stiffness_xy_n_per_um",
        "singular or negative",
    ),
    (
        "a damper that feeds energy in",
        |s| {
            let mut rows = table(&[(0.0, 10.0, 0.0)]);
            rows[0]["damping_xy_ns_per_m"] = json!(10.0);
            s["pinion"]["bearings"][0] = json!({"position_mm": 120.0, "speed_table": rows});
        },
        "/pinion/bearings/0/speed_table/0/damping_xy_ns_per_m",
        "feed energy in",
    ),
    (
        "a spring to nothing",
        |s| s["pinion"]["coupling"]["torsional_nm_per_rad"] = json!(1e5),
        "/pinion/coupling/inertia_kg_m2",
        "a spring to nothing",
    ),
    (
        "a machine without a spring",
        |s| s["pinion"]["coupling"]["inertia_kg_m2"] = json!(0.3),
        "/pinion/coupling/torsional_nm_per_rad",
        "what connects the machine",
    ),
    (
        "a body that cannot be",
        |s| {
            s["pinion"]["half_body"] =
                json!({"mass_kg": 1.0, "polar_inertia_kg_m2": 0.4, "diametral_inertia_kg_m2": 0.1});
        },
        "/pinion/half_body/diametral_inertia_kg_m2",
        "0.2 kg·m² and more",
    ),
    (
        "a body without mass",
        |s| s["gear"]["half_body"] = json!({"polar_inertia_kg_m2": 0.4, "diametral_inertia_kg_m2": 0.2}),
        "/gear/half_body/mass_kg",
        "0 to 1000000 kg",
    ),
    (
        "a misspelt field",
        |s| s["gear"]["bearings"][0]["radial_stiffness_n_per_um"] = json!(1.0),
        "/gear/bearings/0/radial_stiffness_n_per_um",
        "is not a field",
    ),
    (
        "an arrangement in the faces",
        |s| *s = json!({"arrangement": {"bearing_span_mm": 150.0}}),
        "/arrangement/bearing_span_mm",
        "permitted: 180 mm and more",
    ),
    (
        "an arrangement that there is not",
        |s| *s = json!({"arrangement": {"type": "cantilever"}}),
        "/arrangement/type",
        "permitted: straddle, overhung",
    ),
];

/// Rows (speed, direct stiffness, cross stiffness) of a table.
fn table(rows: &[(f64, f64, f64)]) -> Value {
    let row = |&(speed, direct, cross): &(f64, f64, f64)| {
        json!({"speed_rpm": speed, "stiffness_xx_n_per_um": direct, "stiffness_yy_n_per_um": direct,
            "stiffness_xy_n_per_um": cross, "stiffness_yx_n_per_um": cross})
    };
    rows.iter().map(row).collect()
}

#[test]
fn what_cannot_work_is_refused_where_it_stands_with_the_reason() {
    assert!(MALFORMED.len() >= 25);
    for (name, change, pointer, reason) in MALFORMED {
        let mut shafts = straddle();
        change(&mut shafts);
        let found = violations(&with_shafts(shafts));
        let pointer = format!("/design/shafts{pointer}");
        let fits = |violation: &&Violation| violation.pointer == pointer && violation.detail.contains(reason);
        assert!(found.iter().any(|violation| fits(&violation)), "{name}: {found:#?}");
        // A mistake has one reason, but for an empty list, whose consequence is said too.
        let elsewhere = found.iter().filter(|violation| violation.pointer != pointer).count();
        assert_eq!(elsewhere, 0, "{name}: {found:#?}");
    }
}

#[test]
fn a_permitted_range_is_given_as_numbers_too() {
    let mut shafts = straddle();
    shafts["pinion"]["bearings"][1]["position_mm"] = json!(500.0);
    let found = violations(&with_shafts(shafts));
    let [violation] = found.as_slice() else { panic!("{found:#?}") };
    assert_eq!(
        (violation.code.as_str(), violation.minimum, violation.maximum, violation.unit.as_deref()),
        ("conflict", Some(0.0), Some(480.0), Some("mm"))
    );
}

#[test]
fn the_reference_shafts_are_read_with_every_default_and_resolved_as_they_are() {
    let document = read(straddle());
    let written = serde_json::to_value(&document).unwrap();
    let bearing = &written["design"]["shafts"]["gear"]["bearings"][0];
    assert_eq!(bearing["radial_x_n_per_um"], Value::Null);
    assert_eq!((&bearing["tilting_nm_per_rad"], &bearing["axial_n_per_um"]), (&json!(0.0), &json!(400.0)));
    assert_eq!(written["design"]["shafts"]["pinion"]["coupling"]["axial_friction_n"], json!(0.0));
    assert!(written["design"]["shafts"].get("arrangement").is_none());
    let resolved = document.design.resolved_shafts().unwrap();
    let given = document.design.shafts.as_ref().unwrap();
    assert_eq!((Some(&resolved.pinion), Some(&resolved.gear)), (given.pinion.as_ref(), given.gear.as_ref()));
    assert!(resolved.assumed_bearings.is_empty() && resolved.derived.is_empty());
    assert!(!resolved.pinion.is_held_axially() && resolved.gear.is_held_axially());
    assert!(resolved.pinion.is_undamped());
    assert_eq!(resolved.pinion.length_mm(), 480.0);
}

#[test]
fn without_shafts_a_document_is_as_it_was() {
    let mut document: Value = serde_json::from_str(include_str!("../../../../examples/contact.json")).unwrap();
    let before = serde_json::to_string(&parse_value(&document).unwrap()).unwrap();
    for name in ["shafts", "mesh_damping_ns_per_m", "excitation_um"] {
        assert!(!before.contains(name), "{name}");
    }
    document["design"]["shafts"] = Value::Null;
    document["model"]["excitation_um"] = Value::Null;
    assert_eq!(serde_json::to_string(&parse_value(&document).unwrap()).unwrap(), before);
}

#[test]
fn a_bearing_without_stiffness_has_that_of_its_shaft_and_it_is_told() {
    let mut shafts = straddle();
    for name in ["radial_n_per_um", "axial_n_per_um"] {
        shafts["pinion"]["bearings"][1].as_object_mut().unwrap().remove(name);
    }
    shafts["gear"]["bearings"][1] = json!({"position_mm": 360.0, "radial_x_n_per_um": 7.0});
    let resolved = read(shafts).design.resolved_shafts().unwrap();
    // On segments of 75 mm and 110 mm.
    assert_eq!(resolved.pinion.bearings[1].radial_n_per_um, Some(750.0));
    assert_eq!(resolved.gear.bearings[1].given_radial_n_per_um(), [Some(7.0), Some(1100.0)]);
    let told: Vec<_> =
        resolved.assumed_bearings.iter().map(|one| (one.pointer.as_str(), one.value, one.unit)).collect();
    assert_eq!(
        told,
        [
            ("/design/shafts/pinion/bearings/1/radial_n_per_um", 750.0, "N/um"),
            ("/design/shafts/gear/bearings/1/radial_n_per_um", 1100.0, "N/um"),
        ]
    );
}

#[test]
fn an_arrangement_of_four_numbers_gives_both_shafts() {
    let document = read(json!({"arrangement": {
        "type": "straddle", "input": "left", "bearing_span_mm": 340.0, "pinion_shaft_diameter_mm": 80.0, "gear_shaft_diameter_mm": 110.0,
    }}));
    let resolved = document.design.resolved_shafts().unwrap();
    let near = |value: f64, expected: f64| assert!((value - expected).abs() < 1e-9, "{value} is not {expected}");
    let z = |shaft: &ShaftInput, position_mm: f64| position_mm - shaft.gear_position_mm;
    let ResolvedShafts { pinion, gear, .. } = &resolved;
    for (shaft, coupling_mm) in [(pinion, -170.0 - 120.0), (gear, 170.0 + 165.0)] {
        near(z(shaft, shaft.bearings[0].position_mm), -170.0);
        near(z(shaft, shaft.bearings[1].position_mm), 170.0);
        near(z(shaft, shaft.coupling.position_mm), coupling_mm);
        // The body over the faces: the root circle, of equal length on both sides of the groove.
        let body: Vec<_> =
            shaft.places_mm().map(|(ends, segment)| (ends.map(|end| z(shaft, end)), segment.diameter_mm)).collect();
        near(body[1].0[0], -90.0);
        near(body[2].0[0], -15.0);
        near(body[3].0[0], 15.0);
        near(body[4].0[0], 90.0);
    }
    // d = z m_n / cos β, d_f = d - 2 · 1.25 m_n: 97.03 and 274.97 mm.
    let d = |teeth: f64| teeth * 6.0 / 24.43_f64.to_radians().cos();
    assert_eq!((pinion.segments[1].diameter_mm, gear.segments[3].diameter_mm), (97.03, 275.0));
    assert!((97.03 - d(17.0) + 15.0).abs() < 5e-3 && (275.0 - d(44.0) + 15.0).abs() < 5e-2);
    assert_eq!(pinion.bearings[0].radial_n_per_um, Some(800.0));
    // The gear is located opposite of its coupling, which is opposite of the input.
    assert!(gear.bearings[0].axial_n_per_um > 0.0 && gear.bearings[1].axial_n_per_um == 0.0);
    assert!(!pinion.is_held_axially());
    // The teeth of a half beside the body, as in the reference of the geared rotor.
    let teeth = pinion.half_body.as_ref().unwrap();
    for (value, expected) in
        [(teeth.mass_kg, 1.45), (teeth.polar_inertia_kg_m2, 0.003978), (teeth.diametral_inertia_kg_m2, 0.002669)]
    {
        assert!((value / expected - 1.0).abs() < 3e-3, "{value} is not {expected}");
    }
    let assumed: Vec<_> = resolved.assumed_bearings.iter().map(|one| one.pointer.rsplit('/').next().unwrap()).collect();
    assert_eq!(
        assumed,
        ["pinion_bearing_radial_n_per_um", "gear_bearing_radial_n_per_um", "gear_bearing_axial_n_per_um"]
    );
}

#[test]
fn an_arrangement_is_mirrored_with_its_input() {
    let shafts = |input: &str, kind: &str| {
        read(json!({"arrangement": {"input": input, "type": kind}})).design.resolved_shafts().unwrap()
    };
    for kind in ["straddle", "overhung"] {
        let (left, right) = (shafts("left", kind), shafts("right", kind));
        for (left, right) in [(&left.pinion, &right.pinion), (&left.gear, &right.gear)] {
            let length_mm = left.length_mm();
            assert!((length_mm - right.length_mm()).abs() < 1e-9);
            let mirrored = |position_mm: f64| length_mm - position_mm;
            for (one, other) in left.bearings.iter().zip(right.bearings.iter().rev()) {
                assert!((one.position_mm - mirrored(other.position_mm)).abs() < 1e-9, "{kind}");
                assert_eq!((one.radial_n_per_um, one.axial_n_per_um), (other.radial_n_per_um, other.axial_n_per_um));
            }
            assert!((left.coupling.position_mm - mirrored(right.coupling.position_mm)).abs() < 1e-9);
            for (one, other) in left.segments.iter().zip(right.segments.iter().rev()) {
                assert!((one.length_mm - other.length_mm).abs() < 1e-9 && one.diameter_mm == other.diameter_mm);
            }
        }
        let beside = left.pinion.bearings.iter().all(|bearing| bearing.position_mm < left.pinion.gear_position_mm);
        assert_eq!(beside, kind == "overhung");
    }
}

/// Derived shafts fulfil the rules for given ones, whatever the size of the pair.
#[test]
fn derived_shafts_can_be_given() {
    let mut seen = 0;
    for (scale, gap_mm, widths) in
        [(1.0, 30.0, [None, None]), (0.1, 0.0, [None, None]), (4.0, 20.0, [Some(95.0), Some(60.0)])]
    {
        for kind in ["straddle", "overhung"] {
            for output in ["left", "right"] {
                let mut value = with_shafts(json!({"arrangement": {"type": kind, "output": output}}));
                value["design"]["normal_module_mm"] = json!(6.0 * scale);
                value["design"]["gap_width_mm"] = json!(gap_mm);
                for (name, width_mm) in ["pinion", "gear"].into_iter().zip(widths) {
                    value["design"][name]["face_width_mm"] = json!(width_mm);
                }
                let document = parse_value(&value).unwrap();
                let resolved = document.design.resolved_shafts().unwrap();
                value["design"]["shafts"] = json!({"pinion": resolved.pinion, "gear": resolved.gear});
                let given = parse_value(&value).unwrap_or_else(|error| panic!("{error:#?}"));
                let again = given.design.resolved_shafts().unwrap();
                assert_eq!((again.pinion, again.gear), (resolved.pinion, resolved.gear));
                seen += 1;
            }
        }
    }
    assert_eq!(seen, 12);
}

#[test]
fn a_body_held_at_the_bore_would_yield_twice() {
    let mut value = with_shafts(straddle());
    value["model"]["mesh_stiffness"] = json!({"source": "ltca", "body": "bore"});
    let found = violations(&value);
    assert!(
        found.iter().any(|one| one.pointer == "/model/mesh_stiffness/body" && one.detail.contains("twice")),
        "{found:#?}"
    );
    value["model"]["mesh_stiffness"]["fidelity"] = json!("uniform");
    parse_value(&value).unwrap();
}

#[test]
fn a_displacement_excitation_needs_a_stiffness_in_the_equations() {
    let mut value = with_shafts(straddle());
    value["model"]["excitation_um"] = json!({"left": 1.0});
    let found = violations(&value);
    assert!(found.iter().any(|one| one.pointer == "/model/excitation_um"), "{found:#?}");
    value["model"]["mesh_force"] = json!("stiffness");
    value["model"]["mesh_damping_ns_per_m"] = json!(4000.0);
    let model = parse_value(&value).unwrap().model;
    assert_eq!(model.excitation_um, Some(ExcitationInput { left: 1.0, right: 0.0 }));
    assert_eq!(model.mesh_damping_ns_per_m, Some(4000.0));
}

#[test]
fn a_sweep_can_vary_the_arrangement_and_the_bearings() {
    let mut value = with_shafts(json!({"arrangement": {}, "pinion": straddle()["pinion"].clone()}));
    value["kind"] = json!("sweep");
    for pointer in [
        "/design/shafts/arrangement/bearing_span_mm",
        "/design/shafts/arrangement/gear_shaft_diameter_mm",
        "/design/shafts/pinion/bearings/1/position_mm",
        "/design/shafts/pinion/segments/2/diameter_mm",
        "/design/gap_width_mm",
    ] {
        value["axes"] = json!([{"pointer": pointer, "from": 1.0, "to": 2.0}]);
        let mut document = parse_value(&value).unwrap();
        assert!(document.slot(pointer).is_some_and(|slot| slot.is_number()), "{pointer}");
    }
}
