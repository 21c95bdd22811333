mod chunks;
mod history;
mod lifecycle;
mod listing;
mod opening;
mod retention;
mod schema;
mod series;
mod stages;

use super::*;
use jiff::Timestamp;
use tempfile::TempDir;

pub(super) struct Fixture {
    pub store: Store,
    pub directory: TempDir,
}

pub(super) async fn fixture() -> Fixture {
    let directory = tempfile::tempdir().expect("temporary directory");
    let store = Store::open(&StoreConfig::at(directory.path().join("jobs.db"))).await.expect("store opens");
    Fixture { store, directory }
}

pub(super) fn at(second: i64) -> Timestamp {
    Timestamp::from_second(1_800_000_000 + second).expect("a valid time")
}

pub(super) fn new_job(hash: &str) -> NewJob {
    NewJob {
        id: JobId::new(),
        kind: "response",
        name: Some("name".into()),
        label: None,
        input: format!("{{\"hash\":\"{hash}\"}}"),
        input_hash: hash.into(),
        solver_version: "test-1",
        request_id: Some("request".into()),
        traceparent: None,
        idempotency: None,
    }
}

pub(super) fn completion(hash: &str) -> Completion {
    Completion {
        body: format!("{{\"of\":\"{hash}\"}}"),
        input_hash: hash.into(),
        solver_version: "test-1".into(),
        series: Vec::new(),
        samples: SampleBatch::default(),
        rows: None,
        unwritten: PointBatch::default(),
        reused_from: None,
    }
}

pub(super) async fn queued(store: &Store, hash: &str) -> JobRecord {
    match store.submit(new_job(hash), None, 100, at(0)).await.expect("submits") {
        Submission::Accepted(job) => job,
        other => panic!("not accepted: {other:?}"),
    }
}

pub(super) async fn running(store: &Store, hash: &str) -> JobRecord {
    queued(store, hash).await;
    store.claim_next(WorkClass::Single, at(1)).await.expect("claims").expect("a job waits").job
}

/// A job that succeeded, in a database of any schema; without its result.
pub(super) async fn insert_succeeded(store: &Store, hash: &str) -> JobId {
    let id = JobId::new();
    let insert = "INSERT INTO jobs (id, kind, state, revision, attempt, input, input_hash, solver_version, \
                  submitted_at_us, started_at_us, ended_at_us) \
                  VALUES ($1, 'response', 'succeeded', 3, 1, '{}', $2, 'test-1', 0, 1, 2)";
    sqlx::query(insert).bind(id.to_string()).bind(hash).execute(&store.writer).await.expect("inserted");
    id
}
