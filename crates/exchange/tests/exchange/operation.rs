//! Speed, torque and sense of rotation.

use super::gearbox::{Gearbox, LOAD, PINION, PINION_SHAFT, Part, STAGE, WHEEL, WHEEL_SHAFT};
use super::*;
use herringbone_exchange::PointChoice;
use rstest::rstest;
use serde_json::json;

#[rstest]
// Speed about u, hand of the left half (1 right), apex.
#[case(1800.0, 1.0, "apex_leading")]
#[case(-1800.0, 1.0, "apex_trailing")]
#[case(1800.0, -1.0, "apex_trailing")]
#[case(-1800.0, -1.0, "apex_leading")]
fn rotation_follows_from_speed_and_hand(#[case] speed_rpm: f64, #[case] hand: f64, #[case] rotation: &str) {
    let mut model = Gearbox::double_helical("1.6");
    model.attribute(PINION_SHAFT, "rotational_speed", "1 / min", json!(speed_rpm));
    model.attribute(LOAD, "torque_around_u_axis", "N m", json!(900.0 * speed_rpm.signum()));
    for half in [0, 1] {
        let side = if half == 0 { hand } else { -hand };
        model.attribute(PINION[half], "helix_angle_reference_diameter", "deg", json!(25.0 * side));
        model.attribute(WHEEL[half], "helix_angle_reference_diameter", "deg", json!(-25.0 * side));
    }
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(text(&import, "/operation/rotation"), rotation);
    assert_eq!(text(&import, "/design/pinion/left_half_hand"), if hand > 0.0 { "right" } else { "left" });
    assert_eq!(number(&import, "/operation/pinion_speed_rpm"), 1800.0);
    assert_eq!(number(&import, "/operation/pinion_torque_nm"), 900.0);
}

/// The same motion and power, told on the wheel's shaft.
#[test]
fn speed_and_torque_of_the_gear_are_carried_to_the_pinion() {
    let mut model = Gearbox::double_helical("1.6");
    for name in ["rotational_speed", "defines_speed"] {
        model.without(PINION_SHAFT, name);
    }
    model.attribute(WHEEL_SHAFT, "rotational_speed", "1 / min", json!(-1800.0 * 29.0 / 67.0));
    model.ties.retain(|tie| !tie.refs.contains(&("part".to_owned(), LOAD)));
    model.tie("assembly", None, &[("assembly", WHEEL_SHAFT), ("part", LOAD)]);
    // The output takes power out: torque against the speed.
    model.attribute(LOAD, "torque_around_u_axis", "N m", json!(900.0 * 67.0 / 29.0));
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_close(number(&import, "/operation/pinion_speed_rpm"), 1800.0, 1e-9);
    assert_close(number(&import, "/operation/pinion_torque_nm"), 900.0, 1e-9);
    assert_eq!(text(&import, "/operation/rotation"), "apex_leading");
    // The gear drives where its torque goes with its speed.
    model.attribute(LOAD, "torque_around_u_axis", "N m", json!(-900.0 * 67.0 / 29.0));
    let driven = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_close(number(&driven, "/operation/pinion_torque_nm"), -900.0, 1e-9);
}

#[test]
fn speed_and_torque_pass_couplings_and_stages() {
    let mut model = Gearbox::double_helical("1.6");
    // Motor shaft – coupling – shaft with a gear 20 – gear 50 on the pinion's shaft; the torque is the motor's.
    for name in ["rotational_speed", "defines_speed"] {
        model.without(PINION_SHAFT, name);
    }
    for (shaft, speed) in [(70, Some(5000.0)), (71, None)] {
        model.part(shaft, "shaft", &[("u_axis_vector", "mm", json!([1.0, 0.0, 0.0]))]);
        if let Some(speed) = speed {
            model.attribute(shaft, "rotational_speed", "1 / min", json!(speed));
            model.attribute(shaft, "defines_speed", "none", json!(true));
        }
    }
    model.part(72, "coupling", &[]);
    model.tie("side", None, &[("assembly", 72), ("inner_part", 70), ("outer_part", 71)]);
    for (gear, shaft, teeth) in [(73, 71, 20), (74, PINION_SHAFT, 50)] {
        model.part(gear, "cylindrical_gear", &[("number_of_teeth", "none", json!(teeth))]);
        model.tie("assembly", None, &[("assembly", shaft), ("part", gear)]);
    }
    model.part(75, "cylindrical_stage", &[]);
    model.tie("stage", None, &[("stage", 75), ("gear_1", 73), ("gear_2", 74)]);
    model.ties.retain(|tie| !tie.refs.contains(&("part".to_owned(), LOAD)));
    model.tie("assembly", None, &[("assembly", 70), ("part", LOAD)]);
    model.attribute(LOAD, "torque_around_u_axis", "N m", json!(100.0));
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_close(number(&import, "/operation/pinion_speed_rpm"), 2000.0, 1e-9);
    assert_close(number(&import, "/operation/pinion_torque_nm"), 250.0, 1e-9);
    // One mesh before the pinion turns it the other way.
    assert_eq!(text(&import, "/operation/rotation"), "apex_trailing");
    let line = import.taken.iter().find(|line| line.pointer == "/operation/pinion_torque_nm").unwrap();
    assert!(line.why.as_deref().is_some_and(|why| why.contains("part 72") && why.contains("part 75")), "{line:?}");
}

#[test]
fn power_in_place_of_a_torque() {
    let mut model = Gearbox::double_helical("1.6");
    model.without(LOAD, "torque_around_u_axis");
    model.attribute(LOAD, "power", "kW", json!(150.0));
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_close(number(&import, "/operation/pinion_torque_nm"), 150e3 / (1800.0 * std::f64::consts::PI / 30.0), 1e-9);
}

#[test]
fn without_a_torque_the_file_is_refused_unless_one_is_given() {
    let mut model = Gearbox::double_helical("1.6");
    model.without(LOAD, "torque_around_u_axis");
    let refusal = refused(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(refusal.errors[0].pointer, "/operation/pinion_torque_nm");
    assert!(refusal.errors[0].detail.contains("torque_nm"));
    let given = ImportOptions { torque_nm: Some(-750.0), ..ImportOptions::default() };
    assert_eq!(number(&imported(model.xml().as_bytes(), &given), "/operation/pinion_torque_nm"), -750.0);
    // A torque of the file is then not taken, and that is said.
    let import = imported(Gearbox::double_helical("1.6").xml().as_bytes(), &given);
    assert_eq!(number(&import, "/operation/pinion_torque_nm"), -750.0);
    assert!(import.ignored.iter().any(|line| line.from == "external_load[60].torque_around_u_axis"));
}

#[test]
fn without_a_speed_one_is_assumed() {
    let mut model = Gearbox::double_helical("1.6");
    model.without(PINION_SHAFT, "rotational_speed");
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(number(&import, "/operation/pinion_speed_rpm"), 1000.0);
    assert!(has_warning(&import, "speed-assumed"));
}

#[test]
fn load_cases_override_the_model() {
    let mut model = Gearbox::double_helical("1.6");
    let part = |id: i64, kind: &str, name: &str, unit: &str, value: f64| Part {
        id,
        kind: kind.to_owned(),
        attributes: vec![(name.to_owned(), unit.to_owned(), json!(value))],
    };
    model.cases = [(1500.0, 400.0, 3.0), (3000.0, 1000.0, 1.0)]
        .into_iter()
        .map(|(speed, torque, hours)| {
            vec![
                part(1, "gear_unit", "operating_time", "h", hours),
                part(PINION_SHAFT, "shaft", "rotational_speed", "1 / min", speed),
                part(LOAD, "external_load", "torque_around_u_axis", "N m", torque),
            ]
        })
        .collect();
    for bytes in [model.xml(), model.json()] {
        let import = imported(bytes.as_bytes(), &ImportOptions::default());
        assert_eq!(number(&import, "/operation/pinion_torque_nm"), 400.0);
        let shares: Vec<_> = import.operating_points.iter().map(|point| point.share.unwrap()).collect();
        assert_eq!(shares, [0.75, 0.25]);
        let heaviest = ImportOptions { point: PointChoice::Heaviest, ..ImportOptions::default() };
        assert_eq!(number(&imported(bytes.as_bytes(), &heaviest), "/operation/pinion_speed_rpm"), 3000.0);
    }
}

#[test]
fn a_mirrored_stage_has_twice_the_torque_and_a_gap_of_choice() {
    let mut model = Gearbox::double_helical("1.6");
    // The right half taken out.
    model.parts.retain(|part| part.id != STAGE[1]);
    model.ties.retain(|tie| !tie.refs.iter().any(|(_, id)| *id == STAGE[1]));
    let options = ImportOptions { mirror: true, gap_width_mm: Some(12.0), ..ImportOptions::default() };
    let import = imported(model.xml().as_bytes(), &options);
    assert!(import.pair.mirrored && has_warning(&import, "mirrored"));
    assert_eq!(number(&import, "/operation/pinion_torque_nm"), 1800.0);
    assert_eq!(number(&import, "/design/gap_width_mm"), 12.0);
    assert_eq!(text(&import, "/operation/rotation"), "apex_leading");
    assert!(import.document["design"].get("shafts").is_none());
}
