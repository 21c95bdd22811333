//! Calculation files of KISSsoft, made here.

use super::{assert_close, data, geometry, has_warning, imported, number, refused, text};
use herringbone_exchange::{FaceWidth, ImportOptions, RefusalKind};

/// A file with these values after those of a pair 27/51; values given later count.
fn lines(more: &[(&str, &str)]) -> String {
    let mut text = "VERSION=20.0;\r\nKSOFTVERSION=2020 D;\r\nMODULE=Z012;\r\n".to_owned();
    let pair = [
        ("ZS.Geo.mn", "4.5"),
        ("ZS.Geo.alfn", "0.349065850398866"),
        ("ZS.Geo.beta", "0.366519142918809"),
        ("ZR[0].z", "27"),
        ("ZR[1].z", "51"),
        ("ZR[2].z", "0"),
        ("ZR[0].x.nul", "0.231415"),
        ("ZR[1].x.nul", "0.231415"),
        ("ZP[0].a", "190.0"),
        ("ZR[0].da.nul", "141.1796"),
        ("ZR[1].da.nul", "256.8632"),
        ("ZR[0].b", "50"),
        ("ZR[1].b", "48"),
        ("ZR[0].di", "0"),
        ("ZR[1].di", "60"),
        ("ZR[0].Schrage", "0"),
        ("ZR[1].Schrage", "1"),
        ("ZR[0].Tool.type", "2"),
        ("ZR[0].Tool.RefProfile.haP", "1"),
        ("ZR[0].Tool.RefProfile.hfP", "1.25"),
        ("ZR[0].Tool.RefProfile.rhofP", "0.3"),
        ("ZR[0].mat.E", "206000"),
        ("ZR[1].mat.E", "206000"),
        ("ZR[0].mat.ny", "0.3"),
        ("ZR[1].mat.ny", "0.3"),
        ("ZR[0].mat.rho", "7830"),
        ("ZR[1].mat.rho", "7830"),
        ("ZR[0].nnominal", "1500"),
        ("ZR[0].Tnominal", "400"),
        ("ZS.Pnominal", "62.83"),
        ("ZR[0].As.E", "-0.1"),
        ("ZR[0].As.i", "-0.14"),
        ("ZR[1].As.E", "-0.15"),
        ("ZR[1].As.i", "-0.21"),
        ("ZS.PfeilZahn", "0"),
    ];
    for (key, value) in pair.iter().chain(more) {
        text += &format!("{key}={value}¶\r\n");
    }
    // A script in the file, as such files have them.
    text + "ZS.Geo.mn = mn_ref\r\nZR[0].z=99\r\nIF x == 1 THEN\r\n"
}

fn utf16(text: &str) -> Vec<u8> {
    let units = std::iter::once(0xfeff).chain(text.encode_utf16());
    units.flat_map(u16::to_le_bytes).collect()
}

fn file(more: &[(&str, &str)]) -> Vec<u8> {
    utf16(&lines(more))
}

const MIRROR: ImportOptions = ImportOptions {
    pair: None,
    mirror: true,
    gap_width_mm: None,
    torque_nm: None,
    point: herringbone_exchange::PointChoice::First,
    face_width: FaceWidth::Total,
};

#[test]
fn a_single_helical_pair_is_mirrored_when_asked() {
    let refusal = refused(&file(&[]), &ImportOptions::default());
    assert_eq!((refusal.kind, refusal.errors[0].code.as_str()), (RefusalKind::Unsupported, "single-helical"));
    assert!(refusal.errors[0].detail.contains("27 / 51"), "{refusal:?}");
    let import = imported(&file(&[]), &MIRROR);
    assert_eq!((import.source.format.as_str(), import.source.version.as_str()), ("z12", "20.0"));
    assert_eq!(import.source.application, "KISSsoft 2020 D");
    assert!(import.pair.mirrored && has_warning(&import, "mirrored"));
    assert_eq!((number(&import, "/design/pinion/teeth"), number(&import, "/design/gear/teeth")), (27.0, 51.0));
    assert_close(number(&import, "/design/helix_angle_deg"), 21.0, 1e-12);
    assert_close(number(&import, "/design/pressure_angle_deg"), 20.0, 1e-12);
    assert_eq!(
        (text(&import, "/design/pinion/left_half_hand"), number(&import, "/design/face_width_mm")),
        ("right", 48.0)
    );
    assert_eq!(
        (number(&import, "/operation/pinion_torque_nm"), number(&import, "/operation/pinion_speed_rpm")),
        (800.0, 1500.0)
    );
    assert_eq!(number(&import, "/design/material/density_kg_m3"), 7830.0);
    assert_eq!(number(&import, "/design/material/youngs_modulus_gpa"), 206.0);
    assert_eq!(number(&import, "/design/pinion/fillet_radius"), 0.3);
    assert_eq!(number(&import, "/design/gear/bore_diameter_mm"), 60.0);
    assert!(import.document["design"]["pinion"]["bore_diameter_mm"].is_null());
    // 141.2269 mm without alteration.
    assert_close(number(&import, "/design/pinion/tip_alteration"), (141.1796 - 141.2269) / 9.0, 1e-5);
    // The centre distance is that of play-free mesh, as in the REXS models of this gearbox.
    assert!(import.document["design"]["center_distance_mm"].is_null());
    let geometry = geometry(&import);
    assert_close(geometry.center_distance_mm, 190.0, 1e-4);
    assert_close(geometry.working_pressure_angle_deg, 22.80625, 1e-4);
    let backlash = &import.offered[0];
    assert_eq!(backlash.pointer, "/design/backlash_um");
    assert_close(backlash.value, 300.0 * 20f64.to_radians().cos(), 1e-9);
    assert_eq!(import.checks.len(), 1);
    for line in &import.taken {
        assert_eq!(import.document.pointer(&line.pointer), Some(&line.value), "{line:?}");
    }
}

#[test]
fn a_double_helical_pair_has_its_groove_and_its_width_either_way() {
    let double = [
        ("ZS.PfeilZahn", "1"),
        ("ZR[0].PfeilNutB", "20"),
        ("ZR[1].PfeilNutB", "18"),
        ("ZR[0].b", "120"),
        ("ZR[1].b", "118"),
    ];
    let total = imported(&file(&double), &ImportOptions::default());
    assert_eq!((number(&total, "/design/face_width_mm"), number(&total, "/design/gap_width_mm")), (49.0, 20.0));
    assert!(has_warning(&total, "face-width-assumed") && !total.pair.mirrored);
    assert_eq!(number(&total, "/operation/pinion_torque_nm"), 400.0);
    let options = ImportOptions { face_width: FaceWidth::Half, ..ImportOptions::default() };
    let half = imported(&file(&double), &options);
    assert_eq!(number(&half, "/design/face_width_mm"), 118.0);
    assert!(!has_warning(&half, "face-width-assumed"));
}

#[test]
fn the_smaller_gear_is_the_pinion_and_loads_are_carried_to_it() {
    let swapped = [
        ("ZR[0].z", "51"),
        ("ZR[1].z", "27"),
        ("ZR[0].da.nul", "256.8632"),
        ("ZR[1].da.nul", "141.1796"),
        ("ZR[0].nnominal", "900"),
        ("ZR[0].Tnominal", "510"),
    ];
    let import = imported(&file(&swapped), &MIRROR);
    assert_eq!(number(&import, "/design/pinion/teeth"), 27.0);
    assert_eq!(text(&import, "/design/pinion/left_half_hand"), "left");
    assert_close(number(&import, "/operation/pinion_speed_rpm"), 1700.0, 1e-9);
    assert_close(number(&import, "/operation/pinion_torque_nm"), 540.0, 1e-9);
    let by_power = imported(&file(&[("ZR[0].Tnominal", "0"), ("ZS.Pnominal", "62.83185307179586")]), &MIRROR);
    assert_close(number(&by_power, "/operation/pinion_torque_nm"), 800.0, 1e-6);
    let chosen = ImportOptions { torque_nm: Some(123.0), ..MIRROR };
    assert_eq!(number(&imported(&file(&swapped), &chosen), "/operation/pinion_torque_nm"), 123.0);
}

#[test]
fn what_cannot_be_taken_is_told() {
    for (more, words) in [
        (&[("ZR[1].z", "-51")][..], "internal"),
        (&[("MODULE", "Z014")][..], "Z014"),
        (&[("ZS.Geo.alfnLeft", "0.3"), ("ZS.Geo.alfnRight", "0.35")][..], "ZS.Geo.alfnLeft"),
        (&[("ZR[0].Tnominal", "0"), ("ZS.Pnominal", "0")][..], "torque_nm"),
        (&[("ZS.Geo.mn", "4,5")][..], "ZS.Geo.mn is no number"),
        (&[("ZR[0].b", "")][..], "ZR[0].b is not in the file"),
        (&[("ZS.Geo.mn", "1e9")][..], "normal_module_mm"),
        (&[("ZR[0].z", "27.5")][..], "ZR[0].z is 27.5"),
    ] {
        let refusal = refused(&file(more), &MIRROR);
        let said = format!("{refusal:?}");
        assert!(!refusal.errors.is_empty() && said.contains(words), "{words}: {said}");
    }
    let placeholder = imported(&file(&[("ZR[0].da.nul", "1"), ("ZR[0].crowning", "0.012")]), &MIRROR);
    assert_eq!(number(&placeholder, "/design/pinion/tip_alteration"), 0.0);
    let ignored = |from: &str| placeholder.ignored.iter().any(|line| line.from == from);
    assert!(
        ignored("ZR[0].da.nul") && ignored("ZR[0].crowning") && has_warning(&placeholder, "modifications-not-read")
    );
    let single: Vec<u8> = lines(&[]).chars().map(|letter| letter as u32 as u8).collect();
    assert_eq!(imported(&single, &MIRROR).document, imported(&file(&[]), &MIRROR).document);
}

#[test]
fn broken_files_end_in_an_answer() {
    let whole = file(&[]);
    let rexs = data("herringbone_pair_1_7.rexs");
    let mut answers = 0;
    for seed in 0..400_usize {
        let mut bytes = whole.clone();
        // A linear congruence suffices to spread the damage.
        let mut state = seed.wrapping_mul(2_862_933_555_777_941_757).wrapping_add(3_037_000_493);
        let mut next = |most: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) % most.max(1)
        };
        for _ in 0..=next(6) {
            let at = next(bytes.len());
            match next(4) {
                0 => bytes.truncate(at),
                1 => bytes[at] = next(256) as u8,
                2 => {
                    let end = (at + next(200)).min(bytes.len());
                    bytes.drain(at..end);
                }
                _ => {
                    let piece = rexs[..next(300)].to_vec();
                    bytes.splice(at..at, piece);
                }
            }
            if bytes.is_empty() {
                break;
            }
        }
        match herringbone_exchange::import(&bytes, &MIRROR) {
            Ok(import) => {
                herringbone_job::parse_value(&import.document).expect("a valid document");
            }
            Err(refusal) => assert!(!refusal.errors.is_empty(), "{refusal:?}"),
        }
        answers += 1;
    }
    assert_eq!(answers, 400);
}
