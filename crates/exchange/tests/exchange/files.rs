//! Files that other programs wrote.

use super::*;

const INDUSTRIAL: [&str; 3] = [
    "FVA-Industriegetriebe_2stufig_1-4.rexs",
    "FVA-Industriegetriebe_2stufig_1-4.rexsj",
    "FVA-Industriegetriebe_2_stufig_1-6.rexs",
];

fn mirrored(pair: u64) -> ImportOptions {
    ImportOptions { pair: Some(pair), mirror: true, ..ImportOptions::default() }
}

#[test]
fn first_stage_of_the_industrial_gearbox() {
    for file in INDUSTRIAL {
        let import = imported(&data(file), &mirrored(1));
        assert_eq!((number(&import, "/design/pinion/teeth"), number(&import, "/design/gear/teeth")), (27.0, 51.0));
        assert_eq!(number(&import, "/design/normal_module_mm"), 4.5);
        assert_eq!(number(&import, "/design/helix_angle_deg"), 21.0);
        assert_eq!(number(&import, "/design/pressure_angle_deg"), 20.0);
        assert_eq!(text(&import, "/design/pressure_angle_plane"), "normal");
        assert_eq!(number(&import, "/design/pinion/profile_shift"), 0.231415);
        assert_eq!(number(&import, "/design/gear/profile_shift"), 0.231415);
        assert_eq!(number(&import, "/design/face_width_mm"), 50.0);
        // The profile shifts are rounded: the play-free distance is the file's within half a micrometre.
        assert_eq!(import.document["design"]["center_distance_mm"], Value::Null);
        assert_eq!(text(&import, "/design/pinion/left_half_hand"), "right");
        assert_eq!(number(&import, "/design/material/youngs_modulus_gpa"), 210.0);
        assert_eq!(number(&import, "/design/pinion/bore_diameter_mm"), 60.0);
        let geometry = geometry(&import);
        assert_close(geometry.center_distance_mm, 190.0, 1e-4);
        assert_close(geometry.working_pressure_angle_deg, 22.80625, 1e-5);
        assert_close(geometry.pinion.tip_diameter_mm, 141.2269, 1e-4);
        assert_close(geometry.gear.tip_diameter_mm, 256.9105, 1e-4);
        assert_close(geometry.transverse_contact_ratio, 1.47047, 1e-5);
        assert_close(geometry.overlap_ratio, 1.26747, 1e-5);
    }
}

#[test]
fn second_stage_of_the_industrial_gearbox() {
    for file in INDUSTRIAL {
        let import = imported(&data(file), &mirrored(2));
        assert_eq!((number(&import, "/design/pinion/teeth"), number(&import, "/design/gear/teeth")), (23.0, 34.0));
        assert_eq!(text(&import, "/design/pinion/left_half_hand"), "left");
        let geometry = geometry(&import);
        assert_close(geometry.transverse_contact_ratio, 1.53764, 1e-5);
        assert_close(geometry.overlap_ratio, 0.62927, 1e-5);
        assert_close(geometry.center_distance_mm, 190.0, 1e-3);
        // The torque of the first stage, carried by its tooth ratio, twice for two halves.
        assert_close(number(&import, "/operation/pinion_torque_nm"), 2.0 * 567.0 * 51.0 / 27.0, 1e-9);
        assert_close(number(&import, "/operation/pinion_speed_rpm"), 543.0 * 27.0 / 51.0, 1e-9);
    }
}

#[test]
fn a_tip_diameter_of_one_millimetre_is_a_placeholder() {
    let import = imported(&data(INDUSTRIAL[0]), &mirrored(2));
    assert_eq!(number(&import, "/design/pinion/tip_alteration"), 0.0);
    let line = import.ignored.iter().find(|line| line.from == "cylindrical_gear[16].tip_diameter").expect("reported");
    assert_eq!(line.amount.as_deref(), Some("1 mm"));
    assert!(has_warning(&import, "tip-diameter-ignored"));
}

#[test]
fn both_forms_of_a_model_give_one_result() {
    for (one, other) in [(INDUSTRIAL[0], INDUSTRIAL[1]), ("herringbone_pair_1_7.rexs", "herringbone_pair_1_7.rexsj")] {
        let options = if one.starts_with("FVA") { mirrored(1) } else { ImportOptions::default() };
        let [one, other] = [one, other].map(|file| imported(&data(file), &options));
        assert_eq!(one.document, other.document);
        assert_eq!((&one.taken, &one.assumed), (&other.taken, &other.assumed));
        assert_eq!(
            (&one.pair, &one.operating_points, &one.warnings),
            (&other.pair, &other.operating_points, &other.warnings)
        );
    }
}

#[test]
fn the_load_spectrum_is_a_list_of_operating_points() {
    for file in INDUSTRIAL {
        let import = imported(&data(file), &mirrored(1));
        let points: Vec<_> = import
            .operating_points
            .iter()
            .map(|point| (point.pinion_speed_rpm.unwrap(), point.pinion_torque_nm.unwrap(), point.share.unwrap()))
            .collect();
        let expected = [(543.0, 1134.0, 0.2), (3456.0, 690.0, 0.3), (1234.0, 912.0, 0.35), (789.0, 1578.0, 0.15)];
        assert_eq!(points, expected, "{file}");
        assert_eq!(import.operating_points.iter().filter(|point| point.chosen).count(), 1);
        assert_eq!(number(&import, "/operation/pinion_torque_nm"), 1134.0);
        let chosen = ImportOptions { point: herringbone_exchange::PointChoice::Number(3), ..mirrored(1) };
        assert_eq!(number(&imported(&data(file), &chosen), "/operation/pinion_speed_rpm"), 1234.0);
        let heaviest = ImportOptions { point: herringbone_exchange::PointChoice::Heaviest, ..mirrored(1) };
        assert_eq!(number(&imported(&data(file), &heaviest), "/operation/pinion_torque_nm"), 1578.0);
        let beyond = ImportOptions { point: herringbone_exchange::PointChoice::Number(5), ..mirrored(1) };
        assert!(refused(&data(file), &beyond).errors[0].detail.contains("1 to 4"));
    }
}

#[test]
fn a_pair_of_two_halves_is_taken_without_asking() {
    let import = imported(&data("herringbone_pair_1_7.rexs"), &ImportOptions::default());
    assert_eq!((import.pair.number, import.pair.stages.clone(), import.pair.mirrored), (1, vec![60, 61], false));
    assert!(import.alternatives.is_empty());
    for (pointer, expected) in [
        ("/design/pinion/teeth", 17.0),
        ("/design/gear/teeth", 44.0),
        ("/design/normal_module_mm", 6.0),
        ("/design/helix_angle_deg", 24.43),
        ("/design/face_width_mm", 55.0),
        ("/design/gap_width_mm", 30.0),
        ("/design/backlash_um", 120.0),
        ("/design/pinion/profile_shift", 0.2),
        ("/design/gear/profile_shift", -0.2),
        ("/design/pinion/dedendum", 1.25),
        ("/design/pinion/tip_relief/amount_um", 20.0),
        ("/design/pinion/tip_relief/length_mm", 3.0),
        ("/design/gear/lead_crowning_um", 8.0),
        ("/design/material/youngs_modulus_gpa", 206.0),
        ("/design/material/density_kg_m3", 7850.0),
        ("/operation/pinion_speed_rpm", 1500.0),
        ("/operation/pinion_torque_nm", 400.0),
    ] {
        assert_close(number(&import, pointer), expected, 1e-12 * expected.abs());
    }
    assert_eq!(text(&import, "/design/pinion/left_half_hand"), "right");
    assert_eq!(text(&import, "/operation/rotation"), "apex_leading");
    assert_eq!(text(&import, "/design/pinion/tip_relief/shape"), "linear");
    assert_eq!(import.document["design"]["center_distance_mm"], Value::Null);
    let custom = import.ignored.iter().filter(|line| line.from.contains("custom_herringbone")).count();
    assert_eq!(custom, 4, "{:?}", import.ignored);
    assert_eq!(geometry(&import).center_distance_mm.round(), 201.0);
}

/// Each field of the document with a value of its own has a line that says where it is from.
#[test]
fn no_field_is_filled_silently() {
    for (file, options) in [
        (INDUSTRIAL[0], mirrored(1)),
        (INDUSTRIAL[2], mirrored(2)),
        ("herringbone_pair_1_7.rexs", ImportOptions::default()),
    ] {
        let import = imported(&data(file), &options);
        let said: Vec<&str> = import
            .taken
            .iter()
            .map(|line| line.pointer.as_str())
            .chain(import.assumed.iter().map(|line| line.pointer.as_str()))
            .collect();
        let plain: Value = serde_json::from_str(
            r#"{"design": {"normal_module_mm": 6, "helix_angle_deg": 20,
            "face_width_mm": 50, "pinion": {"teeth": 17}, "gear": {"teeth": 44}},
            "operation": {"pinion_speed_rpm": 1000, "pinion_torque_nm": 800}}"#,
        )
        .unwrap();
        let plain = serde_json::to_value(herringbone_job::parse_value(&plain).unwrap()).unwrap();
        let mut compared = 0;
        let mut different = Vec::new();
        leaves(&import.document, "", &mut |pointer, value| {
            compared += 1;
            if plain.pointer(pointer) != Some(value) && !said.iter().any(|line| pointer.starts_with(line)) {
                different.push(pointer.to_owned());
            }
        });
        // Fields of shafts at their defaults.
        let is_default = |pointer: &String| {
            let value = import.document.pointer(pointer);
            pointer.starts_with("/design/shafts")
                && value.is_some_and(|value| value.is_null() || value.as_f64() == Some(0.0))
        };
        different.retain(|pointer| pointer != "/name" && !is_default(pointer));
        assert!(compared > 60, "{compared}");
        assert!(different.is_empty(), "{file}: {different:?}");
        for line in &import.taken {
            assert_eq!(import.document.pointer(&line.pointer), Some(&line.value), "{line:?}");
        }
    }
}

fn leaves(value: &Value, pointer: &str, visit: &mut impl FnMut(&str, &Value)) {
    match value {
        Value::Object(members) => {
            members.iter().for_each(|(name, inner)| leaves(inner, &format!("{pointer}/{name}"), visit));
        }
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(index, inner)| leaves(inner, &format!("{pointer}/{index}"), visit));
        }
        leaf => visit(pointer, leaf),
    }
}

#[test]
fn single_helical_stages_are_listed_with_a_way_out() {
    for file in INDUSTRIAL {
        let refusal = refused(&data(file), &ImportOptions::default());
        assert_eq!(refusal.kind, herringbone_exchange::RefusalKind::Unsupported);
        let lines: Vec<_> = refusal.errors.iter().map(|error| (error.pointer.as_str(), error.code.as_str())).collect();
        assert_eq!(lines, [("/pair/1", "single-helical"), ("/pair/2", "single-helical")]);
        assert!(refusal.errors[0].detail.contains("z 27/51, m_n 4.5 mm, β 21°"), "{}", refusal.errors[0].detail);
        assert!(refusal.summary.contains("mirror"));
        let asked = refused(&data(file), &ImportOptions { mirror: true, ..ImportOptions::default() });
        assert_eq!(asked.errors[1].code, "choose-pair");
        let by_id = ImportOptions {
            pair: Some(if file.contains("1-6") { 11 } else { 20 }),
            mirror: true,
            ..ImportOptions::default()
        };
        assert_eq!(number(&imported(&data(file), &by_id), "/design/pinion/teeth"), 23.0);
    }
}
