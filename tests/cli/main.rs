//! The command line as a user meets it: exit codes, what goes to which stream, every name of the result.

mod backup;
mod batch;
mod cases;
mod deploy;
mod import;
mod opening;
mod study;

use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Every number and list that a response job's result must have (docs of the interface: `JobResult`).
const RESULT_NUMBERS: [&str; 38] = [
    "/geometry/transverse_contact_ratio",
    "/geometry/overlap_ratio",
    "/geometry/total_contact_ratio",
    "/geometry/working_pressure_angle_deg",
    "/geometry/center_distance_mm",
    "/geometry/mesh_frequency_hz",
    "/mesh/stiffness_mean_n_per_um",
    "/mesh/stiffness_min_n_per_um",
    "/mesh/stiffness_max_n_per_um",
    "/mesh/secant_stiffness_mean_n_per_um",
    "/mesh/transmission_error_mean_um",
    "/mesh/transmission_error_pp_um",
    "/mesh/load_share_at_mesh_in",
    "/mesh/loaded_contact_ratio",
    "/impact/force_n",
    "/impact/zhou2008_force_n",
    "/impact/reduction_percent",
    "/impact/velocity_m_s",
    "/impact/duration_us",
    "/impact/theta_deg",
    "/impact/equivalent_mass_kg",
    "/impact/single_pair_stiffness_n_per_um",
    "/impact/other_pairs_stiffness_n_per_um",
    "/response/rms/mesh_circumferential_acceleration_m_s2/left",
    "/response/rms/mesh_circumferential_acceleration_m_s2/right",
    "/response/rms/pinion_axial_acceleration_m_s2/left",
    "/response/rms/pinion_axial_acceleration_m_s2/right",
    "/response/dynamic_factor",
    "/response/min_displacement_um",
    "/response/error_estimate",
    "/numerics/wall_ms/geometry",
    "/numerics/wall_ms/mesh",
    "/numerics/wall_ms/impact",
    "/numerics/wall_ms/response",
    "/numerics/steps",
    "/numerics/rejected_steps",
    "/numerics/force_evaluations",
    "/numerics/degrees_of_freedom",
];

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(name)
}

fn herringbone(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_herringbone")).args(arguments).output().expect("the binary runs")
}

fn with_input(arguments: &[&str], input: &[u8]) -> Output {
    let mut child = Command::new(env!("CARGO_BIN_EXE_herringbone"))
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary runs");
    child.stdin.take().expect("a pipe").write_all(input).expect("written");
    child.wait_with_output().expect("it ends")
}

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap_or_else(|error| panic!("{error}: {}", String::from_utf8_lossy(bytes)))
}

fn solve(name: &str) -> Value {
    let output = herringbone(&["solve", example(name).to_str().expect("UTF-8")]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    json(&output.stdout)
}

#[test]
fn the_first_example_has_every_name_with_a_finite_value() {
    let result = solve("table1.json");
    for pointer in RESULT_NUMBERS {
        assert!(result.pointer(pointer).and_then(Value::as_f64).is_some_and(f64::is_finite), "{pointer}");
    }
    for pointer in ["/mesh/curve/phase", "/mesh/curve/stiffness_n_per_um", "/mesh/curve/transmission_error_um"] {
        let list = result.pointer(pointer).and_then(Value::as_array).unwrap_or_else(|| panic!("{pointer}"));
        assert!(list.len() >= 8 && list.iter().all(Value::is_f64), "{pointer}");
    }
    assert!(result.pointer("/mesh/curve/load_share/0").and_then(Value::as_array).is_some_and(|list| list.len() > 8));
    for pointer in ["/response/regime", "/response/contact", "/response/method"] {
        assert!(result.pointer(pointer).is_some_and(Value::is_string), "{pointer}");
    }
    assert_eq!(result["response"]["natural_frequencies_hz"].as_array().map(Vec::len), Some(12));
    assert_eq!(result["numerics"]["degrees_of_freedom"], 6);
    assert!(result["warnings"].is_array());
}

/// The buffered force lies below Zhou's by what the load share at mesh-in says, on every variant of the source's Table
/// 2.
#[test]
fn the_buffer_takes_a_few_percent_off_the_impact_and_less_with_more_contact() {
    let mut last = f64::INFINITY;
    for name in ["table2_2_72.json", "table2_2_91.json", "table2_3_30.json", "table2_3_68.json", "table2_4_07.json"] {
        let result = solve(name);
        let number = |pointer: &str| result.pointer(pointer).and_then(Value::as_f64).expect("a number");
        let reduction = number("/impact/reduction_percent");
        assert!(number("/impact/force_n") < number("/impact/zhou2008_force_n"), "{name}");
        assert!(reduction > 0.5 && reduction < 5.0 && reduction < last, "{name}: {reduction} %");
        let share = number("/mesh/load_share_at_mesh_in");
        let cos = number("/impact/theta_deg").to_radians().cos();
        let expected = 100.0 * (1.0 - 1.0 / (1.0 + share / (1.0 - share) * cos * cos).sqrt());
        assert!((reduction - expected).abs() < 1e-9, "{name}: {reduction} % and {expected} %");
        last = reduction;
    }
}

#[test]
fn assembly_errors_part_the_halves_but_not_their_load() {
    let result = solve("assembly_errors.json");
    let axial = &result["mesh"]["axial_force_n"];
    let (left, right) = (axial["left"].as_f64().expect("left"), axial["right"].as_f64().expect("right"));
    assert!((left / right - 1.0).abs() < 1e-9, "{left} N, {right} N");
    assert_eq!(result["numerics"]["degrees_of_freedom"], 12);
    assert_ne!(result["impact"]["force_n"], Value::Null);
    let rms = &result["response"]["rms"]["mesh_circumferential_acceleration_m_s2"];
    assert_ne!(rms["left"], rms["right"]);
}

#[test]
fn a_series_is_written_at_full_resolution() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("x.csv");
    let target = format!("x_left={}", file.display());
    let example = example("given_stiffness.json");
    let output = herringbone(&["solve", example.to_str().expect("UTF-8"), "--series", &target]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(&file).expect("written");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("t_s,value"));
    let rows: Vec<(f64, f64)> = lines
        .map(|line| line.split_once(',').map(|(t, v)| (t.parse().expect("t"), v.parse().expect("v"))).expect("a row"))
        .collect();
    assert_eq!(rows.len(), 100 * 256);
    assert!(rows.windows(2).all(|pair| pair[1].0 > pair[0].0));
    let result = json(&output.stdout);
    let mean = rows.iter().map(|row| row.1).sum::<f64>() / rows.len() as f64;
    let sampled = (rows.iter().map(|row| (row.1 - mean).powi(2)).sum::<f64>() / rows.len() as f64).sqrt();
    let exact = result["response"]["rms"]["channels"]["x_left"].as_f64().expect("an RMS");
    assert!((sampled / exact - 1.0).abs() < 1e-4, "{sampled} and {exact}");
}

#[test]
fn an_unknown_channel_is_refused_with_the_list() {
    let example = example("given_stiffness.json");
    let output = herringbone(&["solve", example.to_str().expect("UTF-8"), "--series", "nonsense=/dev/null"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("a_x_left"));
}

#[test]
fn a_cache_keeps_the_contact_analysis() {
    let directory = tempfile::tempdir().expect("a directory");
    let cache = directory.path().join("stages");
    let solve = || {
        let output = herringbone(&[
            "solve",
            example("table1.json").to_str().expect("UTF-8"),
            "--cache",
            cache.to_str().expect("UTF-8"),
        ]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        json(&output.stdout)
    };
    let (first, second) = (solve(), solve());
    assert_eq!(first["numerics"]["reused"], serde_json::json!([]));
    assert_eq!(second["numerics"]["reused"], serde_json::json!(["mesh"]));
    assert_eq!(first["mesh"], second["mesh"]);
}

#[test]
fn unfinished_files_of_killed_processes_are_removed_from_the_cache() {
    let directory = tempfile::tempdir().expect("a directory");
    let (old, young) = (directory.path().join("a.4000001.partial"), directory.path().join("b.4000001.partial"));
    for path in [&old, &young] {
        std::fs::write(path, "part").expect("written");
    }
    let yesterday = std::time::SystemTime::now() - std::time::Duration::from_secs(86_400);
    std::fs::File::options().write(true).open(&old).and_then(|file| file.set_modified(yesterday)).expect("set");
    let document = example("given_stiffness.json");
    let options = ["--cache", directory.path().to_str().expect("UTF-8")];
    let output = herringbone(&[&["solve", document.to_str().expect("UTF-8")], &options[..]].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!((old.exists(), young.exists()), (false, true));
}

#[test]
fn the_table_is_for_people() {
    let output = herringbone(&["solve", example("table1.json").to_str().expect("UTF-8"), "--table"]);
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    assert!(output.status.success() && text.contains("mesh-in impact force") && text.contains("m/s2"), "{text}");
}

#[test]
fn check_gives_geometry_and_warnings_and_solves_nothing() {
    let output = herringbone(&["check", example("table2_3_30.json").to_str().expect("UTF-8")]);
    assert!(output.status.success());
    let report = json(&output.stdout);
    assert!((report["geometry"]["total_contact_ratio"].as_f64().expect("a ratio") - 3.30).abs() < 5e-4);
    assert!(report["warnings"].as_array().is_some_and(|warnings| warnings.iter().any(|w| w["code"] == "undercut")));
}

#[test]
fn invalid_input_is_exit_code_2_with_the_problem_on_standard_error() {
    for command in ["solve", "check"] {
        for (input, code) in [
            (&b"{\"kind\":"[..], "malformed-json"),
            (&b""[..], "malformed-json"),
            (&b"{}"[..], "invalid-design"),
            (&b"[1, 2]"[..], "invalid-design"),
        ] {
            let output = with_input(&[command, "-"], input);
            assert_eq!(output.status.code(), Some(2), "{command} {input:?}");
            assert!(output.stdout.is_empty());
            let problem = json(&output.stderr);
            assert_eq!(problem["code"], code);
            assert!(problem["errors"].as_array().is_some_and(|errors| !errors.is_empty()));
        }
    }
    let output = herringbone(&["solve", "/no/such/file.json"]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn a_pointed_tooth_names_its_field() {
    let mut document: Value =
        serde_json::from_slice(&std::fs::read(example("table1.json")).expect("readable")).expect("JSON");
    document["design"]["pinion"]["addendum"] = 2.0.into();
    let output = with_input(&["solve", "-"], document.to_string().as_bytes());
    assert_eq!(output.status.code(), Some(2));
    let problem = json(&output.stderr);
    let errors = problem["errors"].as_array().expect("errors");
    assert!(
        errors.iter().any(|e| e["code"] == "pointed-tip" && e["pointer"] == "/design/pinion/addendum"),
        "{problem}"
    );
}

#[test]
fn the_document_of_the_interface_is_printed() {
    let output = herringbone(&["openapi"]);
    assert!(output.status.success());
    assert_eq!(json(&output.stdout)["info"]["title"], "herringbone");
}

#[test]
fn the_forces_of_the_bearings_are_written_by_order() {
    let folder = tempfile::tempdir().expect("a folder");
    let (file, target) = (folder.path().join("job.json"), folder.path().join("forces.csv"));
    let [path, csv] = [&file, &target].map(|path| path.to_str().expect("UTF-8"));
    let cases = include_str!("../data/shafts_dynamic.json");
    let cases: Value = serde_json::from_str(cases).expect("JSON");
    std::fs::write(&file, cases[0]["input"].to_string()).expect("written");
    let output = herringbone(&["solve", path, "--bearing-forces", csv]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = std::fs::read_to_string(&target).expect("written");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("shaft,bearing,position_mm,axis,mesh_order,frequency_hz,amplitude_n,phase_rad"));
    let result = json(&output.stdout);
    let mut rows = 0;
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |at: usize| cells[at].parse::<f64>().unwrap_or_else(|_| panic!("{line}"));
        let bearings = result["response"]["bearings"].as_array().expect("bearings");
        let bearing = bearings
            .iter()
            .find(|bearing| bearing["shaft"] == cells[0] && bearing["index"].as_f64() == Some(number(1) - 1.0))
            .unwrap_or_else(|| panic!("{line}"));
        let force = &bearing["force_n"][cells[3]];
        let order = number(4) as usize;
        let expected = if order == 0 { &force["mean"] } else { &force["amplitudes"][order - 1] };
        assert_eq!((expected.as_f64(), bearing["position_mm"].as_f64()), (Some(number(6)), Some(number(2))), "{line}");
        let hertz = result["response"]["mesh_frequency_hz"].as_f64().expect("a frequency");
        assert_eq!(number(5), order as f64 * hertz, "{line}");
        rows += 1;
    }
    assert!(rows >= 4 * 2 * 11, "{rows} rows");
    let example = example("given_stiffness.json");
    let without = herringbone(&["solve", example.to_str().expect("UTF-8"), "--bearing-forces", csv]);
    assert_eq!(without.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&without.stderr).contains("design.shafts"));
}
