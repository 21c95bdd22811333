//! Inputs and outputs as other programs write and read them: encodings of documents, CSV with decimal commas.

use super::{example, herringbone, json, with_input};

fn given() -> String {
    std::fs::read_to_string(example("given_stiffness.json")).expect("the example")
}

#[test]
fn f07_a_byte_order_mark_before_the_document_is_read_from_files_and_standard_input() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("marked.json");
    std::fs::write(&file, format!("\u{feff}{}", given())).expect("written");
    for command in ["check", "solve"] {
        let expected = herringbone(&[command, example("given_stiffness.json").to_str().expect("UTF-8")]);
        let from_file = herringbone(&[command, file.to_str().expect("UTF-8")]);
        let from_input = with_input(&[command, "-"], format!("\u{feff}{}", given()).as_bytes());
        for output in [from_file, from_input] {
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            assert_eq!(json(&output.stdout)["geometry"], json(&expected.stdout)["geometry"]);
        }
    }
}

#[test]
fn f07_other_encodings_are_named() {
    let utf16: Vec<u8> = format!("\u{feff}{}", given()).encode_utf16().flat_map(u16::to_le_bytes).collect();
    let latin1: Vec<u8> =
        given().replacen('{', "{\"name\": \"Gr@e\",", 1).bytes().map(|b| if b == b'@' { 0xf6 } else { b }).collect();
    for command in ["check", "solve"] {
        for (input, name) in [(&utf16, "UTF-16 (little-endian)"), (&latin1, "Windows-1252")] {
            let output = with_input(&[command, "-"], input);
            assert_eq!(output.status.code(), Some(2));
            let problem = json(&output.stderr);
            assert_eq!(problem["code"], "malformed-json");
            assert!(problem["detail"].as_str().is_some_and(|detail| detail.contains(name)), "{problem}");
        }
    }
}

#[test]
fn f12_a_series_can_have_decimal_commas() {
    let folder = tempfile::tempdir().expect("a folder");
    let example = example("given_stiffness.json");
    let written = |decimal: &[&str]| {
        let file = folder.path().join("x.csv");
        let target = format!("x_left={}", file.display());
        let output =
            herringbone(&[&["solve", example.to_str().expect("UTF-8"), "--series", &target], decimal].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        std::fs::read_to_string(&file).expect("written")
    };
    let point = written(&[]);
    assert_eq!(written(&["--decimal", "point"]), point);
    let comma = written(&["--decimal", "comma"]);
    let expected = format!("\u{feff}{}", point.replace(',', ";").replace('.', ",").replace('\n', "\r\n"));
    assert_eq!(comma, expected);
    let refused = herringbone(&["solve", example.to_str().expect("UTF-8"), "--decimal", "period"]);
    assert_eq!(refused.status.code(), Some(2));
}
