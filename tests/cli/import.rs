//! `herringbone import`.

use super::{herringbone, json, with_input};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn model(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/exchange/tests/data").join(name)
}

fn path(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

#[test]
fn a_document_on_standard_output_and_the_report_beside_it() {
    let model = model("herringbone_pair_1_7.rexs");
    let output = herringbone(&["import", path(&model)]);
    assert!(output.status.success(), "{output:?}");
    let document = json(&output.stdout);
    assert_eq!(document["design"]["pinion"]["teeth"], 17);
    let said = String::from_utf8_lossy(&output.stderr);
    for words in [
        "REXS 1.7 by illustration 0: pair 1, Mesh left half + Mesh right half",
        "/design/normal_module_mm = 6.0 mm ← cylindrical_gear[40].normal_module",
        "/design/pinion/fillet_radius = 0.38: no tip rounding",
        "cylindrical_stage[60].custom_herringbone_gap = 30 mm: another program's",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    // What comes out goes in.
    let checked = with_input(&["check", "-"], &output.stdout);
    assert!(checked.status.success(), "{checked:?}");
    assert_eq!(json(&checked.stdout)["geometry"]["center_distance_mm"].as_f64().map(f64::round), Some(201.0));
}

#[test]
fn files_for_document_and_report_and_the_choices() {
    let directory = tempfile::tempdir().expect("a directory");
    let (job, report) = (directory.path().join("job.json"), directory.path().join("report.json"));
    let model = model("FVA-Industriegetriebe_2stufig_1-4.rexsj");
    let arguments = [
        "import",
        path(&model),
        "--pair",
        "2",
        "--mirror",
        "--gap-mm",
        "20",
        "--torque-nm",
        "-500",
        "--point",
        "3",
        "-o",
        path(&job),
        "--report",
        path(&report),
    ];
    let output = herringbone(&arguments);
    assert!(output.status.success() && output.stdout.is_empty(), "{output:?}");
    let read = |path: &Path| -> Value { json(&std::fs::read(path).expect("written")) };
    let (document, report) = (read(&job), read(&report));
    assert_eq!(report["document"], document);
    assert_eq!(document["operation"]["pinion_torque_nm"], -500.0);
    assert_eq!(document["design"]["gap_width_mm"], 20.0);
    assert_eq!(report["pair"]["mirrored"], true);
    assert_eq!(report["operating_points"][2]["chosen"], true);
    assert_eq!(report["source"]["sha256"].as_str().map(str::len), Some(64));
}

#[test]
fn refusals_end_with_2_and_a_problem() {
    let industrial = model("FVA-Industriegetriebe_2stufig_1-4.rexs");
    let single = herringbone(&["import", path(&industrial)]);
    assert_eq!((single.status.code(), single.stdout.len()), (Some(2), 0));
    let problem = json(&single.stderr);
    assert_eq!(
        (&problem["code"], &problem["errors"][0]["code"]),
        (&"unsupported-design".into(), &"single-helical".into())
    );
    assert_eq!(problem["errors"][1]["pointer"], "/pair/2");
    let unreadable = with_input(&["import", "-"], b"<model>");
    assert_eq!(unreadable.status.code(), Some(2));
    assert_eq!(json(&unreadable.stderr)["code"], "invalid-design");
    let missing = herringbone(&["import", "no-such-file.rexs"]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&missing.stderr).contains("no-such-file.rexs"));
    for wrong in [["--torque-nm", "NaN"], ["--gap-mm", "-1"], ["--point", "0"], ["--pair", "x"]] {
        assert_eq!(herringbone(&["import", path(&industrial), wrong[0], wrong[1]]).status.code(), Some(2), "{wrong:?}");
    }
}

#[test]
fn what_is_exported_is_imported() {
    let directory = tempfile::tempdir().expect("a directory");
    let example = super::example("tip_relief.json");
    let [xml, json_file] = ["pair.rexs", "pair.rexsj"].map(|name| directory.path().join(name));
    for file in [&xml, &json_file] {
        let output = herringbone(&["export", path(&example), "--rexs", path(file)]);
        assert!(output.status.success(), "{output:?}");
    }
    assert!(std::fs::read_to_string(&xml).expect("written").starts_with("<?xml"));
    let [from_xml, from_json] = [&xml, &json_file].map(|file| herringbone(&["import", path(file)]));
    assert!(from_xml.status.success(), "{from_xml:?}");
    assert_eq!(from_xml.stdout, from_json.stdout);
    let (sent, back) = (json(&std::fs::read(&example).expect("read")), json(&from_xml.stdout));
    assert_eq!(back["design"]["pinion"]["tip_relief"], sent["design"]["pinion"]["tip_relief"]);
    assert_eq!(herringbone(&["export", path(&example)]).status.code(), Some(2), "a format is needed");
}
