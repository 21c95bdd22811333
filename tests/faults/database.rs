//! A database that is locked, damaged or of another time: said clearly, never a panic, and the file is left alone.

use crate::chance::{Chance, setting};
use crate::client::send;
use crate::documents;
use crate::program::{Program, Service};
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{ConnectOptions, Connection};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use tokio::runtime::Runtime;

fn runtime() -> Runtime {
    tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime")
}

async fn open(database: &Path) -> SqliteConnection {
    SqliteConnectOptions::new().filename(database).connect().await.expect("the database opens")
}

/// A database with some jobs, closed.
fn closed() -> (TempDir, PathBuf) {
    let directory = tempfile::tempdir().expect("a directory");
    let service = Program::at(directory.path()).start();
    let mut paths: Vec<_> = (0..20).map(|_| service.submit(&documents::response())).collect();
    paths.push(service.submit(&documents::sweep(20)));
    for path in &paths {
        assert_eq!(service.ended(path)["state"], "succeeded");
    }
    assert!(service.end().0.success());
    let database = directory.path().join("jobs.db");
    (directory, database)
}

/// Not served: exit code 1, one sentence with the path, the file as it was; what was said.
fn refused(database: &Path, program: &Program) -> String {
    let before = fs::read(database).expect("readable");
    let earlier = program.log().len();
    let status = program.try_start().err().expect("it must not serve");
    let said = program.log()[earlier..].to_owned();
    assert_eq!(status.code(), Some(1), "{said}");
    assert!(said.contains(&*database.to_string_lossy()) && !said.contains("panicked"), "{said}");
    assert!(fs::read(database).expect("readable") == before, "the file was changed");
    said
}

/// While another program holds the lock, reading goes on, and writing waits and then says why it cannot.
#[test]
fn a_database_locked_by_another_program_is_waited_for_and_then_refused() {
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path());
    let service = program.start();
    let before = service.submit(&documents::response());
    service.ended(&before);
    let runtime = runtime();
    let mut other = runtime.block_on(open(program.database()));
    let lock = |connection: &mut SqliteConnection, sql: &'static str| {
        runtime.block_on(sqlx::query(sql).execute(connection)).expect("executed");
    };
    // Held for a moment: the submission waits and is accepted.
    lock(&mut other, "BEGIN EXCLUSIVE");
    let (address, document) = (service.address, documents::response().to_string());
    let submission = std::thread::spawn(move || send(address, "POST", "/api/v1/jobs", &[], &document));
    std::thread::sleep(std::time::Duration::from_millis(500));
    lock(&mut other, "ROLLBACK");
    let answer = submission.join().expect("no panic").expect("an answer");
    assert_eq!(answer.status, 202, "{}", answer.text);
    // Held until it is refused.
    lock(&mut other, "BEGIN EXCLUSIVE");
    let answer = service.send("POST", "/api/v1/jobs", &documents::response().to_string());
    assert!(answer.is_problem(503, "storage-unavailable"), "{} {}", answer.status, answer.text);
    assert!(answer.header("retry-after").is_some());
    assert_eq!(service.get(&before)["state"], "succeeded");
    lock(&mut other, "ROLLBACK");
    service.until("/readyz", |answer| answer.status == 200);
    assert_eq!(service.ended(&service.submit(&documents::response()))["state"], "succeeded");
    assert!(service.end().0.success());
    // And at the start.
    lock(&mut other, "BEGIN EXCLUSIVE");
    let earlier = program.log().len();
    // Nothing may read the file here: closing it would give up the lock of this process.
    let status = program.try_start().err().expect("it must not serve");
    let said = program.log()[earlier..].to_owned();
    assert!(status.code() == Some(1) && said.contains("locked by another program"), "{said}");
}

#[test]
fn a_destroyed_header_is_refused() {
    let (directory, database) = closed();
    let mut bytes = fs::read(&database).expect("readable");
    bytes[..100].fill(0xa5);
    fs::write(&database, bytes).expect("written");
    let said = refused(&database, &Program::at(directory.path()));
    assert!(said.contains("is not an SQLite database"), "{said}");
}

#[test]
fn a_truncated_file_is_refused() {
    let (directory, database) = closed();
    let bytes = fs::read(&database).expect("readable");
    fs::write(&database, &bytes[..bytes.len() / 2]).expect("written");
    let said = refused(&database, &Program::at(directory.path()));
    assert!(said.contains("damaged"), "{said}");
}

#[test]
fn a_newer_schema_is_refused() {
    let (directory, database) = closed();
    runtime().block_on(async {
        let mut connection = open(&database).await;
        let sql = "INSERT INTO _sqlx_migrations (version, description, success, checksum, execution_time) \
                   VALUES (9999, 'of the future', TRUE, x'00', 0)";
        sqlx::query(sql).execute(&mut connection).await.expect("written");
        sqlx::query("PRAGMA wal_checkpoint(TRUNCATE)").execute(&mut connection).await.expect("written");
        connection.close().await.expect("closed");
    });
    let said = refused(&database, &Program::at(directory.path()));
    assert!(said.contains("written by a newer herringbone") && said.contains("9999"), "{said}");
}

/// Every page in turn is not affordable; a few, chosen by `FAULTS_SEED`. After a clean end the file is not read through
/// at the start, so the damage may be met by a request: that one fails and says so, the process goes on.
#[test]
fn an_overwritten_page_is_reported_and_nothing_panics() {
    let (_directory, original) = closed();
    let bytes = fs::read(&original).expect("readable");
    let pages = (bytes.len() / 4096) as u64;
    let seed = setting("FAULTS_SEED", 7);
    println!("FAULTS_SEED={seed}");
    let mut chance = Chance::new(seed);
    for _ in 0..6 {
        // The first page holds the header, which has a test of its own.
        let page = 1 + chance.below(pages - 1);
        let mut damaged = bytes.clone();
        for byte in &mut damaged[page as usize * 4096..][..4096] {
            *byte = chance.next() as u8;
        }
        let directory = tempfile::tempdir().expect("a directory");
        let program = Program::at(directory.path());
        fs::write(program.database(), &damaged).expect("written");
        let report = match program.try_start() {
            Ok(service) => met_by_requests(service),
            Err(status) => format!("refused at the start, {status}"),
        };
        println!("page {page} of {pages}: {report}");
        let log = program.log();
        assert!(!log.contains("panicked"), "page {page}: {log}");
    }
}

/// Asks for everything; how it was answered.
fn met_by_requests(service: Service) -> String {
    let list = service.send("GET", "/api/v1/jobs?limit=200", "");
    let jobs = list.json()["items"].as_array().cloned().unwrap_or_default();
    let mut statuses = vec![list.status];
    for path in jobs.iter().filter_map(|job| job["links"]["self"].as_str()) {
        for what in ["", "/input", "/result", "/series", "/points?limit=5"] {
            statuses.push(service.send("GET", &format!("{path}{what}"), "").status);
        }
    }
    statuses.push(service.send("POST", "/api/v1/jobs", &documents::response().to_string()).status);
    assert_eq!(service.send("GET", "/healthz", "").status, 200);
    assert!(statuses.iter().all(|status| [200, 202, 404, 500, 503].contains(status)), "{statuses:?}");
    let failed = statuses.iter().filter(|status| **status >= 500).count();
    let ended = service.end().0;
    assert!(ended.success(), "{ended}");
    format!("served, {failed} of {} requests failed", statuses.len())
}
