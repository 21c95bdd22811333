//! Files that are refused, and what is said.

use super::gearbox::{Gearbox, PINION, PINION_SHAFT, STAGE, WHEEL, WHEEL_SHAFT};
use super::*;
use herringbone_exchange::RefusalKind;
use serde_json::json;

fn said(bytes: &[u8]) -> String {
    let refusal = refused(bytes, &ImportOptions::default());
    assert!(!refusal.errors.is_empty());
    format!(
        "{} {}",
        refusal.summary,
        refusal.errors.iter().map(|error| format!("[{}] {}", error.code, error.detail)).collect::<String>()
    )
}

#[test]
fn other_files_are_named() {
    for (bytes, words) in [
        (b"".as_slice(), "empty"),
        (b" \r\n", "empty"),
        (b"\x89PNG", "neither"),
        (b"VERSION=20.0;\r\nKSOFTVERSION=x", "KISSsoft"),
        (b"\xff\xfeV\0E\0R\0S\0I\0O\0N\0=\x002\0;\0M\0O\0D\0U\0L\0E\0=\0", "KISSsoft"),
        (b"\xff\xfe<\0", "UTF-16"),
        (b"\x1f\x8b\x08", "gzip"),
        (b"<html><body/></html>", "root element is <html>"),
        (b"<model version=\"1.4\"><components>", "ends inside of <components>"),
        (b"<model></components>", "well-formed"),
        (b"<model/>", "without components"),
        (b"{\"design\": {}}", "no member \"model\""),
        (b"{\"model\": {\"components\": [{\"id\": \"x\"}]}}", "not a REXS model"),
        (b"{\"model\": ", "not complete"),
        (b"<?xml version=\"1.0\"?><model><components><component id=\"\xff\"/></components></model>", "UTF-8"),
        (b"<!DOCTYPE model [<!ENTITY a \"b\">]><model/>", "DOCTYPE"),
        (b"<model><components><component id=\"1\" type=\"&a;\"/></components></model>", "&a;"),
        (b"<model><components><component id=\"1\"><attribute id=\"x\">&lol;</attribute></component></components></model>", "entity &lol;"),
    ] {
        let said = said(bytes);
        assert!(said.contains(words), "{words}: {said}");
    }
}

#[test]
fn predefined_entities_and_characters_are_text() {
    let text = Gearbox::double_helical("1.4").xml().replace("name=\"part 51\"", "name=\"a &amp; b &#228; &lt;\"");
    assert!(imported(text.as_bytes(), &ImportOptions::default()).pair.label.starts_with("a & b ä <"));
}

#[test]
fn planetary_and_internal_gears_are_refused_as_such() {
    let mut model = Gearbox::double_helical("1.1");
    model.part(90, "planetary_stage", &[]);
    for stage in STAGE {
        model.tie("assembly", None, &[("assembly", 90), ("part", stage)]);
    }
    let refusal = refused(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(refusal.kind, RefusalKind::Unsupported);
    assert!(refusal.errors[0].detail.contains("planetary"), "{:?}", refusal.errors);
    let mut model = Gearbox::double_helical("1.7");
    for wheel in WHEEL {
        model.of(wheel).kind = "ring_gear".to_owned();
    }
    assert!(said(model.xml().as_bytes()).contains("ring gear"));
}

#[test]
fn models_without_a_cylindrical_stage() {
    let mut model = Gearbox::double_helical("1.7");
    for stage in STAGE {
        model.of(stage).kind = "worm_stage".to_owned();
    }
    assert!(said(model.xml().as_bytes()).contains("worm stage"));
    model.parts.retain(|part| !STAGE.contains(&part.id));
    assert!(said(model.xml().as_bytes()).contains("no-cylindrical-stage"));
}

#[test]
fn two_stages_that_are_no_halves_are_told_why() {
    let change = |change: &dyn Fn(&mut Gearbox)| {
        let mut model = Gearbox::double_helical("1.7");
        change(&mut model);
        said(model.xml().as_bytes())
    };
    let hands = change(&|model| {
        model.attribute(PINION[1], "helix_angle_reference_diameter", "deg", json!(25.0));
        model.attribute(WHEEL[1], "helix_angle_reference_diameter", "deg", json!(-25.0));
    });
    assert!(hands.contains("equal hands"), "{hands}");
    let angles = change(&|model| {
        model.attribute(PINION[1], "helix_angle_reference_diameter", "deg", json!(-25.01));
        model.attribute(WHEEL[1], "helix_angle_reference_diameter", "deg", json!(25.01));
    });
    assert!(angles.contains("different size"), "{angles}");
    let overlap = change(&|model| {
        for gear in [PINION[1], WHEEL[1]] {
            model.attribute(gear, "u_coordinate_on_shaft", "mm", json!(170.0));
            model.without(gear, "support_vector");
        }
    });
    assert!(overlap.contains("overlap by 10"), "{overlap}");
    let shared = change(&|model| {
        for tie in &mut model.ties {
            for (_, id) in tie.refs.iter_mut().filter(|(_, id)| *id == WHEEL[1]) {
                *id = WHEEL[0];
            }
        }
    });
    assert!(shared.contains("share cylindrical_gear[41]"), "{shared}");
    let tied = change(&|model| {
        for (shaft, gear) in [(91, PINION[1]), (92, WHEEL[1])] {
            model.part(shaft, "shaft", &[]);
            for tie in model.ties.iter_mut().filter(|tie| tie.refs.contains(&("part".to_owned(), gear))) {
                tie.refs[0].1 = shaft;
            }
        }
        for (index, (one, other)) in [(PINION_SHAFT, 91), (WHEEL_SHAFT, 92)].into_iter().enumerate() {
            model.part(93 + index as i64, "coupling", &[]);
            model.tie("side", None, &[("assembly", 93 + index as i64), ("inner_part", one), ("outer_part", other)]);
        }
    });
    assert!(tied.contains("tied by couplings"), "{tied}");
    let spur = change(&|model| {
        for gear in [PINION, WHEEL].concat() {
            model.attribute(gear, "helix_angle_reference_diameter", "deg", json!(0.0));
        }
    });
    assert!(spur.contains("spur gears"), "{spur}");
}

/// As in a public model of a shaft with a mass: a stage without helix angle is not called helical.
#[test]
fn a_spur_stage_is_called_so() {
    let mut model = Gearbox::double_helical("1.7");
    for half in [0, 1] {
        for gear in [PINION[half], WHEEL[half]] {
            let angle_deg = if half == 0 { 0.0 } else { 25.0 * if gear == PINION[half] { -1.0 } else { 1.0 } };
            model.attribute(gear, "helix_angle_reference_diameter", "deg", json!(angle_deg));
        }
    }
    let listed = said(model.xml().as_bytes());
    assert!(listed.contains("single-helical and spur stages only"), "{listed}");
    assert!(
        listed.contains("β 0° (stage 51), spur") && listed.contains("β 25° (stage 52), single-helical"),
        "{listed}"
    );
    let chosen = ImportOptions { pair: Some(1), ..ImportOptions::default() };
    let refusal = refused(model.xml().as_bytes(), &chosen);
    assert_eq!(
        (refusal.summary.as_str(), refusal.errors[0].code.as_str()),
        ("The chosen stage is spur.", "single-helical")
    );
    assert!(refusal.errors[0].detail.contains("a spur stage; mirror makes"), "{refusal:?}");
    let import = imported(model.xml().as_bytes(), &ImportOptions { mirror: true, ..chosen });
    assert!(
        import.warnings.iter().any(|warning| warning.detail.contains("is spur: each half is a copy")),
        "{:?}",
        import.warnings
    );
}

#[test]
fn contradictions_within_a_pair_are_refused_with_their_places() {
    let change = |change: &dyn Fn(&mut Gearbox)| {
        let mut model = Gearbox::double_helical("1.7");
        change(&mut model);
        refused(model.xml().as_bytes(), &ImportOptions::default())
    };
    let asymmetric = change(&|model| model.attribute(PINION[0] * 10, "normal_pressure_angle", "deg", json!(25.0)));
    assert_eq!(asymmetric.errors[0].code, "asymmetric");
    assert!(asymmetric.errors[0].detail.contains("[310].normal_pressure_angle 25 deg"), "{:?}", asymmetric.errors);
    let hands = change(&|model| {
        for wheel in WHEEL {
            let pinion = if wheel == WHEEL[0] { 25.0 } else { -25.0 };
            model.attribute(wheel, "helix_angle_reference_diameter", "deg", json!(pinion));
        }
    });
    assert!(hands.errors[0].detail.contains("same hand"), "{:?}", hands.errors);
    let distances = change(&|model| model.attribute(STAGE[1], "center_distance", "mm", json!(300.0)));
    assert_eq!(
        (distances.errors[0].pointer.as_str(), distances.errors[0].code.as_str()),
        ("/design/center_distance_mm", "conflict")
    );
    // All at once.
    let several = change(&|model| {
        for gear in [PINION, WHEEL].concat() {
            model.without(gear, "normal_module");
            model.without(gear, "face_width");
        }
    });
    let pointers: Vec<_> = several.errors.iter().map(|error| error.pointer.as_str()).collect();
    assert!(pointers.contains(&"/pair") || pointers.contains(&"/design/normal_module_mm"), "{several:?}");
}

#[test]
fn values_out_of_range_name_their_place_in_the_file() {
    let mut model = Gearbox::double_helical("1.7");
    model.attribute(gearbox::LOAD, "torque_around_u_axis", "N m", json!(1e12));
    let refusal = refused(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(refusal.errors[0].pointer, "/operation/pinion_torque_nm");
    assert!(refusal.errors[0].detail.contains("external_load[60].torque_around_u_axis"), "{:?}", refusal.errors);
}

#[test]
fn ids_that_are_given_twice_and_references_to_nothing() {
    let mut model = Gearbox::double_helical("1.7");
    model.part(PINION[0], "shaft", &[]);
    let refusal = refused(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(refusal.errors[0].code, "duplicate-id");
    assert!(refusal.errors[0].detail.contains("31"));
    let mut model = Gearbox::double_helical("1.7");
    model.tie("assembly", None, &[("assembly", 4711), ("part", PINION[0])]);
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    let warning = import.warnings.iter().find(|one| one.code == "dangling-reference").expect("said");
    assert!(warning.detail.contains("4711"));
}

#[test]
fn several_pairs_are_listed_and_each_can_be_taken() {
    let mut model = Gearbox::double_helical("1.7");
    let mut other = Gearbox::double_helical("1.7");
    let moved = |id: i64| if (4..100_000).contains(&id) { id + 100_000 } else { id };
    other.parts.retain(|part| part.id >= 4);
    other.parts.iter_mut().for_each(|part| part.id = moved(part.id));
    for tie in &mut other.ties {
        tie.refs.iter_mut().for_each(|(_, id)| *id = moved(*id));
    }
    other.attribute(100_000 + PINION_SHAFT, "rotational_speed", "1 / min", json!(99.0));
    model.parts.extend(other.parts);
    model.ties.extend(other.ties);
    let refusal = refused(model.xml().as_bytes(), &ImportOptions::default());
    let lines: Vec<_> = refusal.errors.iter().map(|error| (error.pointer.as_str(), error.code.as_str())).collect();
    assert_eq!(lines, [("/pair/1", "choose-pair"), ("/pair/2", "choose-pair")]);
    for (pair, speed) in [(1, 1800.0), (2, 99.0), (100_051, 99.0)] {
        let import = imported(model.xml().as_bytes(), &ImportOptions { pair: Some(pair), ..ImportOptions::default() });
        assert_eq!(number(&import, "/operation/pinion_speed_rpm"), speed);
        assert_eq!(import.alternatives.len(), 1);
    }
    assert_eq!(
        refused(model.xml().as_bytes(), &ImportOptions { pair: Some(3), ..ImportOptions::default() }).errors[0].code,
        "out-of-range"
    );
}

#[test]
fn long_arrays_are_passed_over_whatever_stands_in_them() {
    let text = Gearbox::double_helical("1.4").xml();
    let options = ImportOptions::default();
    let plain = imported(text.as_bytes(), &options).document;
    let place = text.find("</component>").expect("a component");
    let cells = "<c>1.5</c>\n".repeat(20);
    let with = |array: &str| {
        let attribute = format!("<attribute id=\"custom_list\">{array}</attribute>");
        [&text[..place], &attribute, &text[place..]].concat()
    };
    for array in [
        format!("<array>{cells}</array>"),
        format!("<array>{cells}<!-- </array> -->{cells}</array >"),
        format!("<array>{cells}<c><![CDATA[</array>]]></c>{cells}</array>"),
        format!("<array>{cells}<array>{cells}</array>{cells}</array>"),
        format!("<matrix><r>{cells}</r><r>{cells}</r></matrix>"),
        format!("<array/><array>{cells}</array>"),
    ] {
        let read = imported(with(&array).as_bytes(), &options).document;
        assert_eq!(read, plain, "{array:.60}");
    }
    // Where something is wrong after such an array, its line is told all the same.
    let broken = with(&format!("<array>{cells}</array></wrong>"));
    let line = 1 + broken[..broken.find("</wrong>").expect("a place")].matches('\n').count();
    let told = said(broken.as_bytes());
    assert!(told.contains(&format!("(line {line})")), "{line}: {told}");
    let cut = with(&format!("<array>{cells}"));
    let told = said(&cut.as_bytes()[..cut.rfind(&cells).expect("cells") + cells.len()]);
    assert!(told.contains("ends inside of <array>"), "{told}");
}
