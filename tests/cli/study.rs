//! docs/STUDY.md says what the program answers: its Tables 2 and 3, by the source's model and with the contact in the
//! equations, in the digits that it prints; docs/study/shafts.md, the answers to the examples on shafts.

use super::*;

/// The rows of the table that follows a mark, as cells.
fn rows(page: &str, mark: &str) -> Vec<Vec<String>> {
    let after = page.split(&format!("<!-- headline: {mark} -->")).nth(1).unwrap_or_else(|| panic!("no {mark}"));
    let lines = after.trim_start().lines().take_while(|line| line.starts_with('|')).skip(2);
    lines.map(|line| line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
}

/// A number as the page prints it, without what stands in brackets, and half of its last digit.
fn printed(cell: &str) -> (f64, f64) {
    let text = cell.split(" (").next().unwrap_or_default().replace('−', "-");
    let decimals = text.split('.').nth(1).map_or(0, str::len) as i32;
    (text.parse().unwrap_or_else(|_| panic!("no number: {cell}")), 0.51 * 10f64.powi(-decimals))
}

/// The result of an example of the source's tables, its document changed.
fn solve_changed(name: &str, change: impl FnOnce(&mut Value)) -> Value {
    let text = std::fs::read_to_string(example(name)).expect("the example");
    let mut document = serde_json::from_str(&text).expect("JSON");
    change(&mut document);
    let output = with_input(&["solve", "-"], document.to_string().as_bytes());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    json(&output.stdout)
}

#[test]
fn the_page_of_the_study_says_what_contact_in_the_equations_answers() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/STUDY.md")).expect("the page");
    let table = rows(&page, "table 3, contact");
    assert_eq!(table.len(), 5);
    // The ends and the middle: each is a contact analysis of its own.
    for row in table.iter().step_by(2) {
        let name = format!("table2_{}.json", row[0].replace('.', "_"));
        let free = solve_changed(&name, |document| document["model"]["mesh_force"] = "contact".into());
        let body = solve_changed(&name, |document| {
            document["model"]["mesh_force"] = "contact".into();
            let damping = document["design"]["supports"]["damping_ratio"].clone();
            document["design"]["supports"] = serde_json::json!({"damping_ratio": damping});
        });
        let number = |result: &Value, pointer: &str| result.pointer(pointer).and_then(Value::as_f64).expect("a number");
        for (result, cells) in [(&free, &row[3..6]), (&body, &row[6..9])] {
            for (cell, pointer) in cells.iter().zip([
                "/response/rms/mesh_circumferential_acceleration_m_s2/left",
                "/response/rms/pinion_axial_acceleration_m_s2/left",
                "/response/dynamic_factor",
            ]) {
                let ((stated, rounding), value) = (printed(cell), number(result, pointer));
                assert!((value - stated).abs() <= rounding, "{name}: the page says {cell}, the program {value}");
            }
        }
        assert_eq!(row[10], body["response"]["contact"].as_str().expect("a word"));
    }
}

#[test]
fn the_page_of_the_study_says_what_the_program_answers() {
    let page = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/STUDY.md")).expect("the page");
    let [impacts, vibrations] = ["table 2", "table 3"].map(|mark| rows(&page, mark));
    assert_eq!([impacts.len(), vibrations.len()], [5, 5]);
    for (impact, vibration) in impacts.iter().zip(&vibrations) {
        assert_eq!(impact[0], vibration[0]);
        let name = format!("table2_{}.json", impact[0].replace('.', "_"));
        let result = solve(&name);
        let number = |pointer: &str| result.pointer(pointer).and_then(Value::as_f64).expect("a number");
        for (cell, value) in [
            (&impact[2], number("/mesh/loaded_contact_ratio")),
            (&impact[3], 100.0 * number("/mesh/load_share_at_mesh_in")),
            (&impact[4], number("/impact/velocity_m_s")),
            (&impact[5], number("/impact/zhou2008_force_n") / 1e3),
            (&impact[6], number("/impact/force_n") / 1e3),
            (&impact[7], number("/impact/reduction_percent")),
            (&vibration[1], number("/response/rms/mesh_circumferential_acceleration_m_s2/left")),
            (&vibration[2], number("/response/rms/pinion_axial_acceleration_m_s2/left")),
            (&vibration[5], number("/response/dynamic_factor")),
        ] {
            let (stated, rounding) = printed(cell);
            assert!((value - stated).abs() <= rounding, "{name}: the page says {cell}, the program {value}");
        }
        assert_eq!(vibration[6], result["response"]["contact"].as_str().expect("a word"));
    }
}

#[test]
fn the_page_of_the_study_on_shafts_says_what_the_program_answers() {
    let page =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/study/shafts.md")).expect("the page");
    let table = rows(&page, "shafts");
    assert_eq!(table.len(), 3);
    for row in table {
        let name = row[0].trim_matches('`').trim_start_matches("examples/").to_owned();
        let result = solve(&name);
        for (cell, pointer) in row[1..].iter().zip([
            "/shafts/left/k_h_beta_5mm",
            "/shafts/right/k_h_beta_5mm",
            "/response/rms/mesh_circumferential_acceleration_m_s2/left",
            "/response/rms/pinion_axial_acceleration_m_s2/left",
            "/response/dynamic_factor",
            "/response/largest_bearing_force_rms_n",
        ]) {
            let (stated, rounding) = printed(cell);
            let value = result.pointer(pointer).and_then(Value::as_f64).expect("a number");
            assert!(
                (value - stated).abs() <= rounding,
                "{name}: the page says {cell}, the program {value} ({pointer})"
            );
        }
    }
}
