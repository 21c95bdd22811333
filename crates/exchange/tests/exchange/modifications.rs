//! Flank modifications, backlash and other details of the teeth.

use super::gearbox::{Gearbox, PINION, STAGE, WHEEL, WIDTH_MM};
use super::*;
use serde_json::json;

/// Both halves of the pinion.
fn modified(kind: &str, attributes: &[(&str, &str, Value)]) -> Gearbox {
    let mut model = Gearbox::double_helical("1.7");
    for (index, gear) in PINION.into_iter().enumerate() {
        model.modify(gear, 3000 + 10 * index as i64, kind, attributes);
    }
    model
}

/// Of a gear with z 20, m_n 8 mm, β 21.7°: the length that belongs to two diameters.
#[test]
fn a_relief_between_two_diameters_has_a_roll_length() {
    for (teeth, start_mm, end_mm) in [(20.0, 176.76424, 188.20363), (39.0, 341.40713, 351.79708)] {
        let mut model = modified(
            "tip_relief",
            &[
                ("tip_relief_depth", "mum", json!(25.0)),
                ("tip_relief_datum_diameter", "mm", json!(start_mm)),
                ("tip_relief_evaluation_reference", "mm", json!(end_mm)),
                ("shape_of_relief", "none", json!("parabolic")),
            ],
        );
        for half in [0, 1] {
            for (gear, z) in [(PINION[half], teeth), (WHEEL[half], 67.0)] {
                let sign = model
                    .of(gear)
                    .attributes
                    .iter()
                    .find(|(id, ..)| id == "helix_angle_reference_diameter")
                    .unwrap()
                    .2
                    .as_f64()
                    .unwrap()
                    .signum();
                model.attribute(gear, "number_of_teeth", "none", json!(z));
                model.attribute(gear, "normal_module", "mm", json!(8.0));
                model.attribute(gear, "helix_angle_reference_diameter", "deg", json!(21.7 * sign));
                model.without(gear, "tip_diameter");
            }
            model.without(STAGE[half], "center_distance");
            for gear in [PINION[half], WHEEL[half]] {
                model.without(gear, "support_vector");
            }
        }
        model.without(gearbox::PINION_SHAFT, "support_vector");
        let import = imported(model.xml().as_bytes(), &ImportOptions::default());
        assert_close(number(&import, "/design/pinion/tip_relief/length_mm"), 12.0696, 5e-5);
        assert_eq!(number(&import, "/design/pinion/tip_relief/amount_um"), 25.0);
        assert_eq!(text(&import, "/design/pinion/tip_relief/shape"), "parabolic");
        assert!(has_warning(&import, "modification-section"));
    }
}

#[test]
fn crowning_is_scaled_to_the_ends_and_unequal_ends_are_a_slope() {
    let crowning = |ends: [f64; 2], at_mm: f64| {
        let mut model = modified(
            "helix_crowning",
            &[
                ("helix_crowning_amount_datum_face", "mum", json!(ends[0])),
                ("helix_crowning_amount_non_datum_face", "mum", json!(ends[1])),
                ("coordinate_where_helix_crowning_is_specified_datum_face", "mm", json!(-at_mm)),
                ("coordinate_where_helix_crowning_is_specified_non_datum_face", "mm", json!(at_mm)),
            ],
        );
        for gear in PINION {
            model.attribute(gear, "datum_face_orientation", "none", json!("negative"));
        }
        imported(model.xml().as_bytes(), &ImportOptions::default())
    };
    assert_close(number(&crowning([6.0, 6.0], 0.5 * WIDTH_MM), "/design/pinion/lead_crowning_um"), 6.0, 1e-12);
    assert_close(number(&crowning([6.0, 6.0], 0.25 * WIDTH_MM), "/design/pinion/lead_crowning_um"), 24.0, 1e-12);
    // The datum face is at the lower end: the outer one of the left half, the inner one of the right half.
    let unequal = crowning([9.0, 5.0], 0.5 * WIDTH_MM);
    assert_close(number(&unequal, "/design/pinion/left/lead_crowning_um"), 7.0, 1e-12);
    assert_close(number(&unequal, "/design/pinion/left/helix_slope_um"), 4.0, 1e-12);
    assert_close(number(&unequal, "/design/pinion/right/helix_slope_um"), -4.0, 1e-12);
}

#[test]
fn a_slope_is_to_be_confirmed_and_end_reliefs_are_one() {
    let mut model = modified("helix_slope", &[("helix_slope", "mum", json!(-7.0))]);
    for (index, gear) in PINION.into_iter().enumerate() {
        let first = 3100 + 20 * index as i64;
        model.modify(
            gear,
            first,
            "end_relief_datum_face",
            &[("end_relief_depth_datum_face", "mm", json!(0.01)), ("end_relief_length_datum_face", "mm", json!(8.0))],
        );
        model.modify(
            gear,
            first + 10,
            "end_relief_non_datum_face",
            &[
                ("end_relief_depth_non_datum_face", "mm", json!(0.012)),
                ("end_relief_length_non_datum_face", "mm", json!(9.0)),
            ],
        );
        model.modify(gear, first + 4, "root_relief", &[("root_relief_depth", "mum", json!(12.0))]);
    }
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(number(&import, "/design/pinion/helix_slope_um"), -7.0);
    assert!(has_warning(&import, "slope-sign") && has_warning(&import, "ends-differ"));
    assert_eq!(number(&import, "/design/pinion/end_relief/amount_um"), 12.0);
    assert_eq!(number(&import, "/design/pinion/end_relief/length_mm"), 9.0);
    let ignored = import.ignored.iter().find(|line| line.from.starts_with("root_relief")).expect("reported");
    assert!(ignored.amount.as_deref().is_some_and(|amount| amount.contains("12")), "{ignored:?}");
}

#[test]
fn the_loaded_flank_counts_and_halves_may_differ() {
    let mut model = Gearbox::double_helical("1.7");
    // Left flank of the left half only.
    model.part(
        3000,
        "tip_relief",
        &[("tip_relief_depth", "mum", json!(30.0)), ("tip_relief_datum_length", "mm", json!(5.0))],
    );
    model.tie("reference", None, &[("origin", PINION[0] * 10), ("referenced", 3000)]);
    let larger = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(number(&larger, "/design/pinion/left/tip_relief/amount_um"), 30.0);
    assert_eq!(number(&larger, "/design/pinion/tip_relief/amount_um"), 0.0);
    assert!(has_warning(&larger, "flanks-differ"));
    model.attribute(PINION[0] + 100, "loaded_tooth_flank", "none", json!("right"));
    let loaded = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_eq!(loaded.document.pointer("/design/pinion/left"), None);
    assert!(!has_warning(&loaded, "flanks-differ"));
}

#[test]
fn additive_modifications_add_up() {
    let mut model = modified(
        "helix_crowning",
        &[
            ("helix_crowning_amount_datum_face", "mum", json!(4.0)),
            ("helix_crowning_amount_non_datum_face", "mum", json!(4.0)),
        ],
    );
    for (index, gear) in PINION.into_iter().enumerate() {
        model.modify(
            gear,
            3100 + 10 * index as i64,
            "helix_crowning",
            &[
                ("helix_crowning_amount_datum_face", "mum", json!(3.0)),
                ("helix_crowning_amount_non_datum_face", "mum", json!(3.0)),
                ("is_additive_modification", "none", json!(true)),
            ],
        );
    }
    assert_eq!(
        number(&imported(model.xml().as_bytes(), &ImportOptions::default()), "/design/pinion/lead_crowning_um"),
        7.0
    );
}

#[test]
fn transverse_backlash_is_carried_to_the_path_of_contact() {
    let mut model = Gearbox::double_helical("1.7");
    for stage in STAGE {
        model.attribute(stage, "minimum_transverse_backlash", "mm", json!(0.1));
        model.attribute(stage, "maximum_transverse_backlash", "mm", json!(0.3));
    }
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    let geometry = geometry(&import);
    let factor =
        geometry.working_pressure_angle_deg.to_radians().cos() * geometry.base_helix_angle_deg.to_radians().cos();
    assert_close(number(&import, "/design/backlash_um"), 200.0 * factor, 1e-9);
}

#[test]
fn a_rounding_that_the_rack_cannot_have_is_reduced() {
    let mut model = Gearbox::double_helical("1.7");
    for gear in PINION {
        model.attribute(gear + 1000, "tip_radius_factor", "none", json!(0.6));
    }
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert!(has_warning(&import, "fillet-reduced"));
    let reduced = number(&import, "/design/pinion/fillet_radius");
    assert!((0.3..0.6).contains(&reduced), "{reduced}");
    geometry(&import);
}

#[test]
fn without_a_tool_the_root_circle_counts() {
    let mut model = Gearbox::double_helical("1.7");
    for half in [0, 1] {
        for gear in [PINION[half], WHEEL[half]] {
            model.ties.retain(|tie| {
                tie.kind != "manufacturing_step"
                    || !tie.refs.iter().any(|(_, id)| [gear * 10, gear * 10 + 1].contains(id))
            });
        }
        let reference_mm = 29.0 * 5.0 / 25f64.to_radians().cos();
        model.attribute(PINION[half], "root_diameter", "mm", json!(reference_mm - 2.0 * 5.0 * (1.4 - 0.1)));
    }
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    assert_close(number(&import, "/design/pinion/dedendum"), 1.4, 1e-12);
    assert_eq!(number(&import, "/design/gear/dedendum"), 1.25);
    assert!(import.assumed.iter().any(|line| line.pointer == "/design/gear/dedendum"));
}

#[test]
fn results_in_the_file_are_checks() {
    let mut model = Gearbox::double_helical("1.6");
    let plain = geometry(&imported(model.xml().as_bytes(), &ImportOptions::default()));
    model.attribute(STAGE[0], "radial_contact_ratio", "none", json!(plain.transverse_contact_ratio));
    model.attribute(STAGE[1], "overlap_contact_ratio", "none", json!(plain.overlap_ratio + 0.01));
    model.attribute(PINION[0], "single_pitch_deviation", "mm", json!(0.004));
    let import = imported(model.xml().as_bytes(), &ImportOptions::default());
    let checks: Vec<_> = import.checks.iter().map(|check| (check.name.as_str(), check.agrees)).collect();
    assert_eq!(checks, [("transverse contact ratio", true), ("overlap ratio", false)]);
    assert!(has_warning(&import, "check-differs"));
    assert_eq!(
        (import.offered[0].pointer.as_str(), import.offered[0].value),
        ("/model/impact/base_pitch_error_um", 4.0)
    );
}
