//! A database that is locked, damaged or of another time: said clearly, never a panic, and the file is left alone.

use crate::audit::{Accepted, audit};
use crate::chance::{Chance, setting};
use crate::client::send;
use crate::documents;
use crate::program::{PATIENCE, Program, Service};
use sqlx::migrate::Migrator;
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection};
use sqlx::{ConnectOptions, Connection};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
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
    std::thread::sleep(Duration::from_millis(500));
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

/// The name of the file is taken away while the service runs, then given back.
#[test]
fn a_database_that_is_moved_away_refuses_jobs_until_it_is_back() {
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path());
    let service = program.start();
    let before = service.submit(&documents::response());
    service.ended(&before);
    let running = service.submit(&documents::integration(20_000));
    service.in_state(&running, "running");
    let away = directory.path().join("away.db");
    fs::rename(program.database(), &away).expect("moved");
    service.until("/readyz", |answer| answer.is_problem(503, "storage-unavailable"));
    let answer = service.send("POST", "/api/v1/jobs", &documents::response().to_string());
    assert!(
        answer.is_problem(503, "storage-unavailable") && answer.text.contains("moved or deleted"),
        "{}",
        answer.text
    );
    assert!(answer.header("retry-after").is_some());
    assert_eq!(service.get(&before)["state"], "succeeded", "what was stored can be read");
    let said = |what: &str| program.log().lines().filter(|line| line.contains(what)).count();
    let lost = "a file of the database is lost";
    assert_eq!((said(lost), said("complete again")), (1, 0), "{}", program.log());
    fs::rename(&away, program.database()).expect("moved");
    service.until("/readyz", |answer| answer.status == 200);
    let after = service.submit(&documents::response());
    for path in [&running, &after] {
        assert_eq!(service.ended(path)["state"], "succeeded");
    }
    assert_eq!((said(lost), said("complete again")), (1, 1), "{}", program.log());
    assert!(service.end().0.success());
    let ids = [before, running, after].map(|path| path.rsplit('/').next().expect("an id").to_owned());
    assert_eq!(audit(program.database(), &Accepted { ids: ids.into(), keys: Vec::new() }).broken, [""; 0]);
}

/// It is noticed without a request, and whoever ends the service does not wait for it.
#[test]
fn a_deleted_database_is_noticed_and_the_service_ends() {
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path());
    let service = program.start();
    let running = service.submit(&documents::sweep(100_000));
    service.in_state(&running, "running");
    fs::remove_file(program.database()).expect("deleted");
    let deadline = Instant::now() + PATIENCE;
    while !program.log().contains("a file of the database is lost") {
        assert!(Instant::now() < deadline, "{}", program.log());
        std::thread::sleep(Duration::from_millis(20));
    }
    let (status, _) = service.end();
    assert!(status.success() && !program.log().contains("panicked"), "{status}: {}", program.log());
}

/// After an unclean end the database is moved away, and the service started: its log is all that is left of the jobs.
#[test]
fn a_log_without_its_database_is_not_thrown_away() {
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path());
    let service = program.start();
    let path = service.submit(&documents::response());
    service.ended(&path);
    service.kill();
    let (away, log) = (directory.path().join("away.db"), directory.path().join("jobs.db-wal"));
    let content = fs::read(&log).expect("a log");
    fs::rename(program.database(), &away).expect("moved");
    for _ in 0..2 {
        let status = program.try_start().err().expect("it must not serve");
        assert_eq!(status.code(), Some(1));
    }
    let said = program.log();
    assert!(said.contains("jobs.db-wal is there") && said.contains("put the database back"), "{said}");
    assert!(fs::read(&log).expect("a log") == content && !program.database().exists(), "nothing was changed");
    fs::rename(&away, program.database()).expect("moved");
    assert_eq!(program.start().get(&path)["state"], "succeeded");
}

/// Each would treat the jobs of the other as lost.
#[test]
fn a_second_service_on_the_same_file_is_refused_whatever_its_name() {
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path());
    let service = program.start();
    let path = service.submit(&documents::response());
    service.ended(&path);
    let elsewhere = tempfile::tempdir_in(directory.path()).expect("a directory");
    let (symbolic, hard) = (elsewhere.path().join("symbolic.db"), elsewhere.path().join("hard.db"));
    std::os::unix::fs::symlink(program.database(), &symbolic).expect("a link");
    fs::hard_link(program.database(), &hard).expect("a link");
    for name in [&symbolic, &hard] {
        let other = Program::at(elsewhere.path()).over(name);
        let status = other.try_start().err().expect("it must not serve");
        assert!(status.code() == Some(1) && other.log().contains("in use by another herringbone"), "{}", other.log());
    }
    service.kill();
    // The log of the killed service lies beside the first name: under the second one its jobs would be missing.
    let other = Program::at(elsewhere.path()).over(&hard);
    assert_eq!(other.try_start().err().expect("it must not serve").code(), Some(1));
    assert!(other.log().contains("has 2 names (hard links)"), "{}", other.log());
    fs::remove_file(&hard).expect("removed");
    assert_eq!(Program::at(elsewhere.path()).over(&symbolic).start().get(&path)["state"], "succeeded");
}

/// An upgrade over all steps is killed at many moments: the database is of the first schema or of the last, and the
/// copy made before it is never replaced.
#[test]
fn an_upgrade_that_is_killed_keeps_the_copy_made_before() {
    let directory = tempfile::tempdir().expect("a directory");
    let program = Program::at(directory.path());
    let all = sqlx::migrate!("./migrations");
    let last = all.iter().map(|step| step.version).max().expect("steps");
    let copy = directory.path().join(format!("jobs.db.before-schema-{last}"));
    let first: Vec<_> = all.iter().filter(|step| step.version == 1).cloned().collect();
    let (id, rows) = ("01a00000-0000-7000-8000-000000000000", 4000u16);
    runtime().block_on(async {
        let options = SqliteConnectOptions::new().filename(program.database()).create_if_missing(true);
        let mut connection = options.connect().await.expect("made");
        Migrator::with_migrations(first).run(&mut connection).await.expect("of the first schema");
        let job = "INSERT INTO jobs (id, kind, state, revision, attempt, input_hash, solver_version, submitted_at_us, \
                   ended_at_us, input) VALUES ($1, 'mesh', 'succeeded', 3, 1, 'a', 'old', 0, 1, '{}')";
        sqlx::query(job).bind(id).execute(&mut connection).await.expect("written");
        let result =
            "INSERT INTO results (job_id, body, etag, input_hash, solver_version) VALUES ($1, '{}', 'a', 'a', 'old')";
        sqlx::query(result).bind(id).execute(&mut connection).await.expect("written");
        let series = "WITH RECURSIVE numbers (n) AS (SELECT 0 UNION ALL SELECT n + 1 FROM numbers WHERE n < $2 - 1) \
                      INSERT INTO series (job_id, position, channel, quantity, unit, n, t0_s, dt_s, samples) \
                      SELECT $1, n, 'channel ' || n, '', '', 1, 0, 1, randomblob(5000) FROM numbers";
        sqlx::query(series).bind(id).bind(rows).execute(&mut connection).await.expect("written");
        connection.close().await.expect("closed");
    });
    let schema = |database: &Path| -> i64 {
        runtime().block_on(async {
            let mut connection = open(database).await;
            let row = sqlx::query_as::<_, (i64,)>("SELECT MAX(version) FROM _sqlx_migrations");
            let (schema,) = row.fetch_one(&mut connection).await.expect("a schema");
            connection.close().await.expect("closed");
            schema
        })
    };
    let mut kept = None;
    let mut interrupted = 0;
    let mut delay = Duration::from_millis(10);
    while schema(program.database()) == 1 && delay < PATIENCE {
        program.start_and_kill(delay);
        delay = delay * 5 / 4;
        let found = fs::read(&copy).ok();
        interrupted += u32::from(kept.is_some());
        assert!(kept.is_none() || kept == found, "the copy was replaced");
        kept = found;
        assert!([1, last].contains(&schema(program.database())), "between two schemas");
    }
    println!("{interrupted} upgrades were killed after the copy was made");
    let service = program.start();
    assert_eq!(
        service.send("GET", &format!("/api/v1/jobs/{id}/series"), "").json()["items"].as_array().map(Vec::len),
        Some(rows.into())
    );
    assert!(service.end().0.success());
    assert_eq!((schema(&copy), schema(program.database())), (1, last));
    let left = fs::read_dir(directory.path()).expect("a directory").filter_map(Result::ok);
    let left: Vec<_> = left.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    assert!(!left.iter().any(|name| name.contains(".partial-") || name.ends_with(".2")), "{left:?}");
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
