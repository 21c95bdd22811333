//! Retention: responses of a full database, and its recovery.

use crate::support::*;
use herringbone::store::{Completion, JobId, NewJob, PointBatch, RetentionConfig, SampleBatch, Store, StoreConfig};
use herringbone::work::{RetentionPass, run_retention, run_retention_pass};
use jiff::Timestamp;
use serde_json::json;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions, SqliteConnection};
use std::path::Path;
use std::time::{Duration, Instant};
use tokio_util::sync::CancellationToken;

async fn raw_connection(database: &Path) -> SqliteConnection {
    SqliteConnectOptions::new().filename(database).connect().await.expect("opens")
}

#[tokio::test]
async fn a_full_database_refuses_jobs_keeps_accepted_ones_and_recovers() {
    let app = limited_app(8).await;
    let (done, _) = app.run(&document()).await;
    app.solver.breakpoints.hold("solve");
    let live = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 2).await;
    let mut database = raw_connection(&app.database()).await;
    let filling = "INSERT INTO stages VALUES ('ballast', 'mesh', '', 8400000, 0, zeroblob(8400000))";
    sqlx::query(filling).execute(&mut database).await.expect("filled");
    let answer = app.submit_with(&document(), &[]).await;
    answer.assert_problem(503, "storage-unavailable");
    assert_eq!(answer.header("retry-after"), "5");
    app.get("/readyz").await.assert_problem(503, "storage-unavailable");
    assert_eq!(app.get("/healthz").await.status, 200);
    for path in ["/metrics", "/api/v1/system", "/api/v1/jobs", &done, &format!("{done}/result")] {
        assert_eq!(app.get(path).await.status, 200, "{path}: what is there can be read");
    }
    // A tenth above the limit is for jobs that were accepted.
    app.solver.breakpoints.release("solve");
    assert_eq!(app.ended(&live).await["state"], "succeeded");
    sqlx::query("DELETE FROM stages").execute(&mut database).await.expect("room made");
    app.run(&document()).await;
    assert_eq!(app.get("/readyz").await.status, 200);
}

#[tokio::test]
async fn messages_of_the_database_are_not_shown_to_clients() {
    let app = limited_app(8).await;
    let mut database = raw_connection(&app.database()).await;
    // Room for a submission and not for its event: SQLite's own word, from within a transaction.
    let filling = "INSERT INTO stages VALUES ('ballast', 'mesh', '', 0, 0, zeroblob(8700000))";
    sqlx::query(filling).execute(&mut database).await.expect("filled");
    let answer = app.submit_with(&document(), &[]).await;
    answer.assert_problem(503, "storage-unavailable");
    let text = answer.text().to_lowercase();
    for word in ["sqlite", "sqlx", "code:", ".db", "select", "insert"] {
        assert!(!text.contains(word), "{text}");
    }
}

/// A closed database with ended jobs of half a megabyte each, one a second; the newest at `until`.
async fn filled(database: &Path, jobs: i64, until: Timestamp) -> Vec<JobId> {
    let store = Store::open(&StoreConfig::at(database)).await.expect("opens");
    let mut ids = Vec::new();
    for number in 0..jobs {
        let at = Timestamp::from_second(until.as_second() - jobs + number).expect("a time");
        let id = JobId::new();
        ids.push(id);
        let job = NewJob {
            id,
            kind: "mesh",
            name: None,
            label: None,
            input: "{}".into(),
            input_hash: format!("{number}"),
            solver_version: "test",
            request_id: None,
            traceparent: None,
            idempotency: None,
        };
        store.submit(job, None, 10, at).await.expect("submits");
        let claim = store.claim_next(herringbone::store::WorkClass::Single, at).await.expect("claims").expect("waits");
        let completion = Completion {
            body: json!("x".repeat(500_000)).to_string(),
            input_hash: format!("{number}"),
            solver_version: "test".into(),
            series: Vec::new(),
            samples: SampleBatch::default(),
            rows: None,
            unwritten: PointBatch::default(),
            reused_from: None,
        };
        store.succeed(id, claim.job.attempt, &completion, at).await.expect("succeeds").expect("its own");
    }
    store.close().await;
    ids
}

#[tokio::test]
async fn a_pass_deletes_by_age_then_by_size_and_shrinks_the_file() {
    let directory = tempfile::tempdir().expect("temporary directory");
    let database = directory.path().join("jobs.db");
    let now = Timestamp::from_second(1_800_000_000).expect("a time");
    let ids = filled(&database, 40, now).await;
    let retention = RetentionConfig { keep_days: Some(1), max_database_mb: Some(10) };
    let store = Store::open(&StoreConfig { retention, ..StoreConfig::at(&database) }).await.expect("opens");
    let open = CancellationToken::new();
    let keep_from = Timestamp::from_second(now.as_second() - 30).expect("a time");
    let deleted = run_retention_pass(&store, Some(keep_from), &open).await.expect("a pass");
    // Ten are too old; of the other 15 MB at least 6 go. How many more depends on the size of the last transaction.
    assert!(deleted.by_age == 10 && (12..=20).contains(&deleted.by_size), "{deleted:?}");
    let count = 10 + deleted.by_size as usize;
    let left: Vec<bool> = futures_util::future::join_all(ids.iter().map(|id| store.job(*id)))
        .await
        .into_iter()
        .map(|job| job.expect("reads").is_some())
        .collect();
    assert!(left[..count].iter().all(|left| !left) && left[count..].iter().all(|left| *left), "{left:?}");
    let usage = store.usage().await.expect("usage");
    assert!(usage.file_bytes < 9_000_000 && usage.log_bytes == 0, "{usage:?}");
    assert_eq!(run_retention_pass(&store, Some(keep_from), &open).await.expect("a pass"), RetentionPass::default());
}

/// Clients that follow all jobs are told at once to read the list again.
#[tokio::test]
async fn followers_of_all_jobs_are_told_to_read_the_list_again() {
    let app = limited_app(8).await;
    let (done, _) = app.run(&document()).await;
    let mut events = app.stream("/api/v1/jobs/events", &[]).await;
    assert_eq!(events.next().await.expect("an event").name, "reload");
    let retention = run_retention(app.jobs.clone(), RetentionConfig::default(), std::sync::Arc::new(Timestamp::now));
    let retention = tokio::spawn(retention);
    let mut database = raw_connection(&app.database()).await;
    let filling = "INSERT INTO stages VALUES ('ballast', 'mesh', '', 0, 0, zeroblob(8600000))";
    sqlx::query(filling).execute(&mut database).await.expect("filled");
    app.submit_with(&document(), &[]).await.assert_problem(503, "storage-unavailable");
    assert_eq!(events.next().await.expect("an event").name, "reload");
    assert_eq!(app.get(&done).await.status, 404);
    app.jobs.close().await;
    retention.await.expect("ends with the jobs");
}

/// The real program: a refused job starts a pass.
#[test]
fn ended_jobs_are_deleted_for_new_ones() {
    let directory = tempfile::tempdir().expect("temporary directory");
    let runtime = tokio::runtime::Runtime::new().expect("a runtime");
    runtime.block_on(filled(&directory.path().join("jobs.db"), 20, Timestamp::now()));
    let arguments = ["--max-database-mb", "8", "--log", "info", "--log-json"];
    let service = Service::start_with(directory.path(), &arguments);
    let mut document = document();
    document["kind"] = json!("mesh");
    document["model"] = json!({"mesh_stiffness": {"source": "iso6336"}, "impact": {"source": "none"}});
    let deadline = Instant::now() + Duration::from_secs(60);
    loop {
        let (status, body) = service.exchange("POST", "/api/v1/jobs", &[], &document.to_string());
        if status == 202 {
            break;
        }
        assert!(status == 503 && body.contains("storage-unavailable"), "{status} {body}");
        assert!(Instant::now() < deadline, "no room was made");
        std::thread::sleep(Duration::from_millis(20));
    }
    // Jobs are accepted before the pass has ended.
    let deleted = || {
        let (_, metrics) = service.exchange("GET", "/metrics", &[], "");
        let deleted = "herringbone_retention_deleted_jobs_total{reason=\"size\"} ";
        let deleted = metrics.lines().find_map(|line| line.strip_prefix(deleted)).expect("a count");
        deleted.parse::<u32>().expect("a number")
    };
    while deleted() < 6 {
        assert!(Instant::now() < deadline, "{} were deleted", deleted());
        std::thread::sleep(Duration::from_millis(20));
    }
    let lines = service.stop();
    let line = lines.iter().find(|line| line.contains("ended jobs deleted")).expect("a line");
    let line: serde_json::Value = serde_json::from_str(line).expect("JSON");
    assert!(line["by_size"].as_u64().is_some_and(|n| n >= 6) && line["freed_mb"].as_f64().is_some_and(|mb| mb > 2.0));
}
