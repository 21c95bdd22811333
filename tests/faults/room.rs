//! No room: jobs are refused with a reason that passes, nothing accepted is lost, and all goes on when there is room
//! again.

use crate::audit::{Accepted, audit};
use crate::documents;
use crate::program::{PATIENCE, Program, Service};
use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// A response whose result needs more room than there is: every channel of the whole transient.
fn voluminous() -> Value {
    let mut document = documents::integration(300);
    let analysis = document["analysis"].as_object_mut().expect("an object");
    analysis.remove("channels");
    analysis.insert("record_mesh_periods".into(), json!(300));
    analysis.insert("samples_per_mesh_period".into(), json!(256));
    document
}

/// Submits until jobs are refused; the paths of those that were accepted.
fn fill(program: &Program, service: &Service, document: impl Fn() -> Value) -> Vec<String> {
    let mut paths = Vec::new();
    let deadline = Instant::now() + PATIENCE;
    loop {
        let answer = service.send("POST", "/api/v1/jobs", &document().to_string());
        match answer.status {
            202 => paths.push(answer.header("location").expect("a location").to_owned()),
            _ => {
                let refused = answer.is_problem(503, "storage-unavailable");
                assert!(refused, "{} {}\n{}", answer.status, answer.text, program.log());
                let seconds: u32 =
                    answer.header("retry-after").and_then(|text| text.parse().ok()).expect("Retry-After");
                assert!(seconds > 0);
                return paths;
            }
        }
        assert!(Instant::now() < deadline, "{} jobs were accepted and there is still room", paths.len());
    }
}

/// The promise, for a service over a few MB of room and a way to make more; the jobs that were accepted.
fn a_full_disk_is_survived(program: &Program, service: &Service, make_room: impl FnOnce()) -> Accepted {
    let large = service.submit(&voluminous());
    // Its result was refused by the database; the worker keeps it.
    let deadline = Instant::now() + PATIENCE;
    while !program.log().contains("it is tried again") {
        assert!(Instant::now() < deadline, "the result was never refused: {}", service.get(&large));
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let mut paths = fill(program, service, documents::response);
    service.until("/readyz", |answer| answer.is_problem(503, "storage-unavailable"));
    assert_eq!(service.get(&large)["state"], "running", "what is there can still be read");
    let log_when_full = program.log();
    make_room();
    service.until("/readyz", |answer| answer.status == 200);
    assert_eq!(service.ended(&large)["state"], "succeeded");
    let series = service.send("GET", &format!("{large}/series"), "");
    assert_eq!(series.status, 200, "{}", series.text);
    paths.push(service.submit(&documents::response()));
    for path in &paths {
        assert_eq!(service.ended(path)["state"], "succeeded");
    }
    println!("{} jobs were accepted before the room was used up", paths.len());
    paths.push(large);
    assert!(!log_when_full.contains("panicked") && !program.log().contains("panicked"), "{}", program.log());
    let id = |path: &String| path.rsplit('/').next().expect("an id").to_owned();
    Accepted { ids: paths.iter().map(id).collect(), keys: Vec::new() }
}

/// Writes fail with EFBIG, which SQLite takes for an I/O error; a plain user can do this.
#[test]
fn a_file_that_may_not_grow_refuses_jobs_until_it_may() {
    let directory = tempfile::tempdir().expect("a directory");
    let command = ["prlimit", "--fsize=2000000:unlimited", "sh", "-c", "trap '' XFSZ; exec \"$@\"", "sh"];
    let program = Program::at(directory.path()).under(&command);
    let service = program.start();
    let id = service.id().to_string();
    let accepted = a_full_disk_is_survived(&program, &service, || {
        let done = Command::new("prlimit").args(["--pid", &id, "--fsize=unlimited"]).status().expect("prlimit runs");
        assert!(done.success());
    });
    assert!(service.end().0.success());
    assert_eq!(audit(program.database(), &accepted).broken, [""; 0]);
}

/// The process died with a running sweep, and there is no room to take it up again: what is stored is served.
#[test]
fn a_start_without_room_serves_what_is_stored_and_goes_on_when_there_is_room() {
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path());
    let service = program.start();
    let done = service.submit(&documents::response());
    service.ended(&done);
    let sweep = service.submit(&documents::sweep(8000));
    service.until(&sweep, |answer| answer.json()["progress"].as_f64() > Some(0.02));
    service.kill();
    // Room for the index of the log, 32 KiB, and not for another page of the log itself.
    let length = std::fs::metadata(directory.path().join("jobs.db-wal")).expect("a log").len();
    assert!(length > 40_000, "{length} bytes");
    let command = ["prlimit", "--fsize=40000:unlimited", "sh", "-c", "trap '' XFSZ; exec \"$@\"", "sh"];
    let service = program.clone().under(&command).start();
    assert_eq!(service.get(&done)["state"], "succeeded");
    assert_eq!(service.send("GET", &format!("{done}/result"), "").status, 200);
    assert_eq!(service.get(&sweep)["state"], "running", "as the killed process left it");
    service.until("/readyz", |answer| answer.is_problem(503, "storage-unavailable"));
    let answer = service.send("POST", "/api/v1/jobs", &documents::response().to_string());
    assert!(answer.is_problem(503, "storage-unavailable"), "{}", answer.text);
    assert!(program.log().contains("jobs of an earlier run not taken up"), "{}", program.log());
    let id = service.id().to_string();
    let made = Command::new("prlimit").args(["--pid", &id, "--fsize=unlimited"]).status().expect("prlimit runs");
    assert!(made.success());
    service.until("/readyz", |answer| answer.status == 200);
    assert_eq!(service.ended(&sweep)["state"], "succeeded");
    assert_eq!(service.ended(&service.submit(&documents::response()))["state"], "succeeded");
    assert!(service.end().0.success());
    assert_eq!(audit(program.database(), &Accepted::default()).broken, [""; 0]);
}

/// Not even the index of the log can be made: one sentence with the path.
#[test]
fn a_start_without_any_room_names_the_database_and_the_remedy() {
    let Some(mut command) = namespace() else { return };
    let directory = tempfile::tempdir().expect("a directory");
    let mount = directory.path().join("mount");
    std::fs::create_dir(&mount).expect("a directory");
    let program = Program::at(directory.path());
    let service = program.start();
    service.ended(&service.submit(&documents::response()));
    assert!(service.end().0.success());
    let script = "mount -t tmpfs -o size=8m tmpfs \"$0\" && cp \"$1\" \"$0\" && head -c 9000000 /dev/zero > \"$0/filler\"; \
                  shift; exec \"$@\"";
    let (place, database) = (mount.to_string_lossy(), program.database().to_string_lossy());
    command.extend(["sh", "-c", script, &place, &database].map(str::to_owned));
    let command: Vec<_> = command.iter().map(String::as_str).collect();
    let status = program.clone().over(&mount.join("jobs.db")).under(&command).try_start().err().expect("not served");
    let log = program.log();
    assert_eq!(status.code(), Some(1), "{log}");
    assert!(log.contains(&format!("no room on the disk for the database {place}/jobs.db")), "{log}");
}

/// Writes fail with ENOSPC on a file system of a few MB in a mount namespace of its own.
#[test]
fn a_full_disk_refuses_jobs_until_there_is_room() {
    let Some(mut command) = namespace() else { return };
    let directory = tempfile::tempdir().expect("a directory");
    let mount = directory.path().join("mount");
    std::fs::create_dir(&mount).expect("a directory");
    let script = "mount -t tmpfs -o size=64m tmpfs \"$0\" && head -c 64000000 /dev/zero > \"$0/filler\" && exec \"$@\"";
    let place = mount.to_string_lossy().into_owned();
    command.extend(["sh", "-c", script, &place].map(str::to_owned));
    let command: Vec<_> = command.iter().map(String::as_str).collect();
    let program = Program::at(directory.path()).over(&mount.join("jobs.db")).under(&command);
    let service = program.start();
    // The mount is seen from outside through the process that lives in it.
    let seen = |name: &str| Path::new(&format!("/proc/{}/root{place}", service.id())).join(name);
    let make_room = || std::fs::remove_file(seen("filler")).expect("removed");
    let accepted = a_full_disk_is_survived(&program, &service, make_room);
    // Copied while it still serves: the file system is gone with the process.
    let copy = directory.path().join("copy.db");
    for suffix in ["", "-wal"] {
        let name = |of: &str| format!("{of}{suffix}");
        std::fs::copy(seen(&name("jobs.db")), directory.path().join(name("copy.db"))).expect("copied");
    }
    assert_eq!(audit(&copy, &accepted).broken, [""; 0]);
    assert!(service.end().0.success());
}

/// The command prefix that starts a program in a mount namespace of its own; `None`, with the reason printed, where
/// that is not permitted.
fn namespace() -> Option<Vec<String>> {
    let mut reasons = Vec::new();
    for options in [&["--user", "--map-root-user", "--mount"][..], &["--mount"]] {
        let try_mount = ["sh", "-c", "mount -t tmpfs tmpfs /mnt"];
        match Command::new("unshare").args(options).args(try_mount).output() {
            Ok(output) if output.status.success() => {
                return Some(["unshare"].iter().chain(options).map(|word| (*word).to_owned()).collect());
            }
            Ok(output) => reasons.push(String::from_utf8_lossy(&output.stderr).trim().to_owned()),
            Err(error) => reasons.push(error.to_string()),
        }
    }
    println!("not tried, a mount namespace is not permitted here: {}", reasons.join("; "));
    None
}

/// Jobs that wait fill the room that `--max-database-mb` allows; nothing that has ended is there to make place.
#[test]
fn a_full_database_refuses_jobs_until_there_is_room() {
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path()).with(&["--max-database-mb", "8", "--sweep-workers", "1"]);
    let service = program.start();
    let long = service.submit(&documents::sweep(100_000));
    service.in_state(&long, "running");
    // The only worker for sweeps is taken, so the others wait; each has a curve of 4096 samples in its document.
    let waiting = fill(&program, &service, || {
        let mut document = documents::sweep(10);
        let samples: Vec<f64> = (0..4096).map(|step| 900.0 + 10.0 * f64::sin(f64::from(step) * 0.0015)).collect();
        document["model"]["mesh_stiffness"] = json!({"source": "given", "samples_n_per_um": samples});
        document
    });
    service.until("/readyz", |answer| answer.is_problem(503, "storage-unavailable"));
    assert!(waiting.iter().all(|path| service.get(path)["state"] == "queued"), "what waits is never touched");
    println!("{} waiting jobs filled 8 MB", waiting.len());
    // Canceled jobs have ended, so retention may take them.
    for path in &waiting[1..] {
        assert_eq!(service.send("POST", &format!("{path}/cancel"), "").status, 200);
    }
    service.until("/readyz", |answer| answer.status == 200);
    assert_eq!(service.ended(&service.submit(&documents::response()))["state"], "succeeded");
    service.send("POST", &format!("{long}/cancel"), "");
    service.in_state(&long, "canceled");
    assert_eq!(service.ended(&waiting[0])["state"], "succeeded");
    assert!(service.end().0.success());
    assert_eq!(audit(program.database(), &Accepted::default()).broken, [""; 0]);
}
