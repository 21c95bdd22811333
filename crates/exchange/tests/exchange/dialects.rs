//! One pair in the dialects of all versions.

use super::gearbox::{Gearbox, MIDDLES_MM, PINION, STAGE, WHEEL, WIDTH_MM};
use super::*;
use rstest::rstest;
use serde_json::json;

#[rstest]
fn a_pair_is_the_same_in_every_version(
    #[values("1.0", "1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.0.0")] version: &str,
) {
    let model = Gearbox::double_helical(version).with_shafts();
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    let gap_mm = MIDDLES_MM[1] - MIDDLES_MM[0] - WIDTH_MM;
    for (pointer, expected) in [
        ("/design/pinion/teeth", 29.0),
        ("/design/helix_angle_deg", 25.0),
        ("/design/face_width_mm", WIDTH_MM),
        ("/design/gap_width_mm", gap_mm),
        ("/design/pinion/profile_shift", 0.1),
        ("/design/gear/profile_shift", -0.1),
        ("/design/pinion/tip_alteration", -0.02),
        ("/design/gear/tip_alteration", -0.02),
        ("/design/pinion/dedendum", 1.3),
        ("/design/pinion/fillet_radius", 0.3),
        ("/design/material/density_kg_m3", 7830.0),
        ("/operation/pinion_torque_nm", 900.0),
        ("/design/shafts/pinion/gear_position_mm", 165.0),
        ("/design/shafts/pinion/bearings/1/position_mm", 300.0),
    ] {
        assert_close(number(&import, pointer), expected, 1e-12 * expected.abs().max(1.0));
    }
    assert_eq!(import.document["design"]["center_distance_mm"], Value::Null, "{:?}", import.taken);
    assert!(!has_warning(&import, "position-differs"), "{:?}", import.warnings);
    assert!(!has_warning(&import, "shafts-not-taken"), "{:?}", import.warnings);
    let other = imported(model.json().as_bytes(), &ImportOptions::default());
    assert_eq!((&import.document, &import.taken, &import.ignored), (&other.document, &other.taken, &other.ignored));
    let marked = [b"\xef\xbb\xbf".as_slice(), b"\r\n ", model.json().as_bytes()].concat();
    assert_eq!(imported(&marked, &ImportOptions::default()).document, import.document);
}

#[test]
fn names_in_a_namespace_are_read() {
    let text = Gearbox::double_helical("1.6").xml();
    let plain = imported(text.as_bytes(), &ImportOptions::default());
    let with_default = text.replacen("<model ", "<model xmlns=\"http://www.rexs.info\" ", 1);
    assert_eq!(imported(with_default.as_bytes(), &ImportOptions::default()).document, plain.document);
    let prefixed = text.replace("</", "</r:").replace("<?xml", "\u{1}").replace("</r:", "\u{2}").replace('<', "<r:");
    let prefixed =
        prefixed.replace('\u{1}', "<?xml").replace('\u{2}', "</r:").replacen("<r:model ", "<r:model xmlns:r=\"x\" ", 1);
    assert_eq!(imported(prefixed.as_bytes(), &ImportOptions::default()).document, plain.document);
}

#[test]
fn coded_vectors_are_read() {
    let model = Gearbox::double_helical("1.5");
    let plain = imported(model.xml().as_bytes(), &ImportOptions::default());
    let coded = "<array code=\"float64\">AAAAAAAA8D8AAAAAAAAAAAAAAAAAAAAA</array>";
    let text = model.xml().replace("<array><c>1.0</c><c>0.0</c><c>0.0</c></array>", coded);
    assert!(text.matches("float64").count() > 4);
    assert_eq!(imported(text.as_bytes(), &ImportOptions::default()).document, plain.document);
    let unit = json!({"code": "float32", "value": "AACAPwAAAAAAAAAA"});
    let mut value: Value = serde_json::from_str(&model.json()).unwrap();
    let mut replaced = 0;
    for component in value["model"]["components"].as_array_mut().unwrap() {
        for attribute in component["attributes"].as_array_mut().unwrap() {
            if attribute["id"] == "u_axis_vector" {
                *attribute = json!({"id": "u_axis_vector", "floating_point_array_coded": unit});
                replaced += 1;
            }
        }
    }
    assert_eq!(replaced, 6);
    assert_eq!(imported(value.to_string().as_bytes(), &ImportOptions::default()).document, plain.document);
}

#[test]
fn a_unit_may_be_missing_and_is_then_the_formats() {
    let mut model = Gearbox::double_helical("1.4");
    for gear in PINION {
        model
            .of(gear)
            .attributes
            .iter_mut()
            .filter(|(id, ..)| id == "normal_module")
            .for_each(|attribute| attribute.1.clear());
    }
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(number(&import, "/design/normal_module_mm"), 5.0);
    let line = import.taken.iter().find(|line| line.pointer == "/design/normal_module_mm").unwrap();
    assert!(line.why.as_deref().is_some_and(|why| why.contains("no unit in the file: mm")), "{line:?}");
}

#[test]
fn an_unknown_unit_refuses_the_attribute_and_never_guesses() {
    let mut model = Gearbox::double_helical("1.4");
    for stage in STAGE {
        model.attribute(stage, "center_distance", "inch", json!(10.0));
    }
    for gear in [PINION, WHEEL].concat() {
        model.attribute(gear, "tip_diameter", "furlong", json!(1.0));
    }
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(number(&import, "/design/pinion/tip_alteration"), 0.0);
    let unreadable: Vec<_> = import.warnings.iter().filter(|one| one.code == "unreadable-attribute").collect();
    assert_eq!(unreadable.len(), 6, "{unreadable:?}");
    assert!(unreadable[0].detail.contains("furlong") || unreadable[0].detail.contains("inch"));
    // What is required is refused with the reason.
    for gear in [PINION, WHEEL].concat() {
        model.attribute(gear, "normal_module", "inch", json!(0.2));
    }
    let refusal = refused(model.xml().as_bytes(), &ImportOptions::default());
    let error = refusal.errors.iter().find(|error| error.pointer == "/design/normal_module_mm").expect("named");
    assert!(error.detail.contains("cylindrical_gear[31].normal_module is in the unit \"inch\""), "{}", error.detail);
}

#[test]
fn what_a_person_entered_goes_before_what_was_calculated() {
    let model = Gearbox::double_helical("1.6");
    let text = model.xml().replace(
        "<attribute id=\"addendum_modification_coefficient\" unit=\"none\">0.1</attribute>",
        "<attribute id=\"addendum_modification_coefficient\" unit=\"none\" origin=\"calculated\">0.7</attribute>\
         <attribute id=\"addendum_modification_coefficient\" unit=\"none\" origin=\"user_defined\">0.1</attribute>",
    );
    assert_ne!(text, model.xml());
    assert_eq!(number(&imported(text.as_bytes(), &ImportOptions::default()), "/design/pinion/profile_shift"), 0.1);
}

#[test]
fn a_newer_version_is_read_with_a_warning() {
    let import = imported(Gearbox::double_helical("2.1").xml().as_bytes(), &ImportOptions::default());
    assert!(has_warning(&import, "newer-version"));
    assert!(!has_warning(
        &imported(Gearbox::double_helical("2.0.0").xml().as_bytes(), &ImportOptions::default()),
        "newer-version"
    ));
}

#[test]
fn wide_gears_keep_their_own_width_and_place() {
    let mut model = Gearbox::double_helical("1.7");
    for gear in PINION {
        model.attribute(gear, "face_width", "mm", json!(74.0));
    }
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(number(&import, "/design/face_width_mm"), WIDTH_MM);
    assert_eq!(number(&import, "/design/pinion/face_width_mm"), 74.0);
    assert_eq!(number(&import, "/design/gap_width_mm"), MIDDLES_MM[1] - MIDDLES_MM[0] - WIDTH_MM);
}

#[test]
fn a_stagger_is_the_angle_between_first_teeth() {
    let mut model = Gearbox::double_helical("1.7");
    let pitch_rad = std::f64::consts::TAU / 29.0;
    for (gear, pitches) in [(PINION[0], 3.0), (PINION[1], 5.25)] {
        let angle = pitch_rad * pitches;
        model.attribute(gear, "w_axis_vector", "mm", json!([0.0, -angle.sin(), angle.cos()]));
    }
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_close(number(&import, "/design/half_stagger"), 0.25, 1e-12);
}

#[test]
fn missing_profile_shifts_follow_from_the_centre_distance() {
    let mut model = Gearbox::double_helical("1.7");
    for gear in [PINION, WHEEL].concat() {
        for flank in [gear * 10, gear * 10 + 1] {
            model.without(flank, "addendum_modification_coefficient");
        }
    }
    for stage in STAGE {
        model.attribute(stage, "center_distance", "mm", json!(266.5));
    }
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    let [pinion, gear] = ["pinion", "gear"].map(|name| number(&import, &format!("/design/{name}/profile_shift")));
    assert_close(pinion / gear, 29.0 / 67.0, 1e-9);
    assert_close(geometry(&import).center_distance_mm, 266.5, 5e-4);
    assert!(has_warning(&import, "profile-shift-assumed"));
}
