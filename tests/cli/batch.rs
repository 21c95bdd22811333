//! `herringbone batch`.

use super::herringbone;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::SystemTime;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

/// Rows of a summary by file: columns by name.
fn summary(path: &Path) -> BTreeMap<String, BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(path).expect("a summary");
    let names = reader.headers().expect("a header").clone();
    let rows = reader.records().map(|record| {
        let record = record.expect("a record");
        let row = names.iter().zip(record.iter()).map(|(name, cell)| (name.to_owned(), cell.to_owned()));
        (record[0].to_owned(), row.collect())
    });
    rows.collect()
}

#[test]
fn a_folder_is_solved_once_and_goes_on_where_it_was_stopped() {
    let directory = tempfile::tempdir().expect("a directory");
    let folder = directory.path();
    let given = fs::read_to_string(root().join("examples/given_stiffness.json")).expect("an example");
    fs::create_dir(folder.join("below")).expect("a folder");
    fs::write(folder.join("a.json"), &given).expect("written");
    let mut sweep: Value = serde_json::from_str(&given).expect("JSON");
    sweep["kind"] = "sweep".into();
    sweep["axes"] = serde_json::json!([{"pointer": "/operation/pinion_speed_rpm", "values": [1000, 1500.5]}]);
    fs::write(folder.join("below/sweep.json"), sweep.to_string()).expect("written");
    let mut wrong: Value = serde_json::from_str(&given).expect("JSON");
    wrong["design"]["normal_module_mm"] = (-1).into();
    fs::write(folder.join("wrong.json"), wrong.to_string()).expect("written");
    fs::write(folder.join("broken.rexs"), "<model>").expect("written");
    fs::write(folder.join("notes.txt"), "not for us").expect("written");

    let arguments = ["batch", text(folder), "--format", "csv,npz,xlsx,mat", "--jobs", "2"];
    let first = herringbone(&arguments);
    assert_eq!(first.status.code(), Some(1), "{first:?}");
    let said = String::from_utf8_lossy(&first.stderr);
    assert!(said.contains("4 files: 2 solved, 0 skipped, 2 failed"), "{said}");
    let out = folder.join("results");
    assert_eq!(String::from_utf8_lossy(&first.stdout).trim(), text(&out.join("summary.csv")));
    let rows = summary(&out.join("summary.csv"));
    assert_eq!(rows.keys().collect::<Vec<_>>(), ["a.json", "below/sweep.json", "broken.rexs", "wrong.json"]);
    assert!(rows["wrong.json"]["error"].contains("/design/normal_module_mm"), "{rows:?}");
    let result: Value =
        serde_json::from_slice(&fs::read(out.join("a.json.result.json")).expect("a result")).expect("JSON");
    let name = "/response/dynamic_factor";
    assert_eq!(rows["a.json"][name].parse().ok(), result.pointer(name).and_then(Value::as_f64));
    assert_eq!(rows["a.json"]["status"], "solved");
    let points = fs::read_to_string(out.join("below/sweep.json.csv")).expect("points");
    assert!(points.starts_with("position,branch,/operation/pinion_speed_rpm,") && points.lines().count() == 3);
    for ending in ["csv", "npz", "xlsx", "mat"] {
        assert!(out.join(format!("a.json.{ending}")).is_file(), "{ending}");
    }

    // What has its result is left alone; what was changed or lost is solved again.
    fs::remove_file(folder.join("wrong.json")).expect("removed");
    fs::remove_file(folder.join("broken.rexs")).expect("removed");
    let written = |name: &str| -> SystemTime {
        fs::metadata(out.join(name)).and_then(|metadata| metadata.modified()).expect("a time")
    };
    let before = written("below/sweep.json.result.json");
    fs::write(folder.join("a.json"), given.replace("\"pinion_speed_rpm\": ", "\"pinion_speed_rpm\": 1"))
        .expect("written");
    let second = herringbone(&arguments);
    assert_eq!(second.status.code(), Some(0), "{second:?}");
    let rows = summary(&out.join("summary.csv"));
    let status = |file: &str| rows[file]["status"].clone();
    assert_eq!((status("a.json"), status("below/sweep.json")), ("solved".to_owned(), "skipped".to_owned()));
    assert_eq!(written("below/sweep.json.result.json"), before);

    let parts = herringbone(&["batch", text(folder), "--part", "2/2", "--force"]);
    assert_eq!(parts.status.code(), Some(0), "{parts:?}");
    let rows = summary(&out.join("summary-2-of-2.csv"));
    assert_eq!(rows.keys().collect::<Vec<_>>(), ["below/sweep.json"]);
    assert_eq!(rows["below/sweep.json"]["status"], "solved");
    assert!(written("below/sweep.json.result.json") > before);
}

#[test]
fn a_batch_without_a_folder_or_with_a_wrong_part_is_refused() {
    for arguments in [&["batch", "/nowhere/at/all"][..], &["batch", "/tmp", "--part", "3/2"][..]] {
        let output = herringbone(arguments);
        assert_eq!(output.status.code(), Some(2), "{output:?}");
    }
}

/// A service solves the files; what it has answered is what this process would have written.
#[test]
fn a_service_solves_the_files_of_a_folder() {
    let directory = tempfile::tempdir().expect("a directory");
    let folder = directory.path().join("in");
    fs::create_dir(&folder).expect("a folder");
    let given = fs::read_to_string(root().join("examples/given_stiffness.json")).expect("an example");
    fs::write(folder.join("a.json"), &given).expect("written");
    let mut sweep: Value = serde_json::from_str(&given).expect("JSON");
    sweep["kind"] = "sweep".into();
    sweep["axes"] = serde_json::json!([{"pointer": "/operation/pinion_speed_rpm", "values": [1000, 1500.5]}]);
    fs::write(folder.join("sweep.json"), sweep.to_string()).expect("written");
    sweep["axes"][0]["values"] = serde_json::json!([-1]);
    fs::write(folder.join("wrong.json"), sweep.to_string()).expect("written");
    let service = Service::start(directory.path());
    let (near, far) = (directory.path().join("near"), directory.path().join("far"));
    let forms = ["--format", "csv,npz,xlsx,mat", "--decimal", "comma"];
    let here = herringbone(&[&["batch", text(&folder), "--out", text(&near)][..], &forms].concat());
    let there =
        herringbone(&[&["batch", text(&folder), "--out", text(&far), "--server", &service.url][..], &forms].concat());
    assert_eq!((here.status.code(), there.status.code()), (Some(1), Some(1)), "{there:?}");
    let said = String::from_utf8_lossy(&there.stderr);
    assert!(said.contains("3 files: 2 solved, 0 skipped, 1 failed") && said.contains("/axes/0 at"), "{said}");
    let read = |out: &Path, name: &str| fs::read(out.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
    for name in ["sweep.json.csv", "a.json.npz", "sweep.json.npz", "sweep.json.mat"] {
        assert!(read(&near, name) == read(&far, name), "{name} differs");
    }
    let without_times = |out: &Path| {
        let text = String::from_utf8(read(out, "a.json.csv")).expect("UTF-8");
        text.lines().filter(|line| !line.contains("wall_ms")).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(without_times(&near), without_times(&far));
    for name in ["a.json.xlsx", "sweep.json.xlsx", "a.json.mat"] {
        assert!(!read(&far, name).is_empty(), "{name}");
    }
    let result = |out: &Path, name: &str| -> Value {
        let mut result: Value = serde_json::from_slice(&read(out, name)).expect("JSON");
        result["numerics"].as_object_mut().expect("numerics").remove("wall_ms");
        result
    };
    for name in ["a.json.result.json", "sweep.json.result.json"] {
        assert_eq!(result(&near, name), result(&far, name), "{name}");
    }
    // What has its result is not asked for again, and a service that is not there is named.
    drop(service);
    fs::remove_file(folder.join("wrong.json")).expect("removed");
    let again = herringbone(&["batch", text(&folder), "--out", text(&far), "--server", "http://127.0.0.1:1"]);
    assert_eq!(again.status.code(), Some(0), "{again:?}");
    for wrong in ["127.0.0.1:8080", "ftp://host", "http://user:secret@host", "http://host/path"] {
        let refused = herringbone(&["batch", text(&folder), "--server", wrong]);
        assert_eq!(refused.status.code(), Some(2), "{wrong}: {refused:?}");
    }
}

/// The service as a process; killed when it is dropped.
struct Service {
    process: std::process::Child,
    url: String,
}

impl Service {
    fn start(folder: &Path) -> Self {
        use std::io::{BufRead, BufReader};
        use std::process::{Command, Stdio};
        let mut command = Command::new(env!("CARGO_BIN_EXE_herringbone"));
        command.args(["serve", "--listen", "127.0.0.1:0", "--log", "warn", "--database"]).arg(folder.join("jobs.db"));
        let mut process = command.stdout(Stdio::piped()).stdin(Stdio::null()).spawn().expect("a process");
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("output")).read_line(&mut line).expect("a line");
        let address = line.trim_end().trim_end_matches('/').rsplit('/').next().expect("an address").to_owned();
        Self { process, url: format!("http://{address}") }
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
