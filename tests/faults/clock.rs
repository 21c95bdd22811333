//! A clock that is set back: jobs run all the same, in their order, and no duration is negative.

use crate::documents;
use herringbone::store::{JobId, JobRecord, Store, StoreConfig};
use herringbone::work::{Jobs, StudySolver, SubmitRequest, WorkConfig};
use jiff::Timestamp;
use sqlx::ConnectOptions;
use sqlx::sqlite::SqliteConnectOptions;
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};
use std::time::Duration;

#[tokio::test]
async fn jobs_run_in_their_order_when_the_clock_goes_backwards() {
    let directory = tempfile::tempdir().expect("a directory");
    let database = directory.path().join("jobs.db");
    let store = Store::open(&StoreConfig::at(&database)).await.expect("it opens");
    // Every look at the clock finds it a minute earlier.
    let now_s = AtomicI64::new(1_800_000_000);
    let clock = move || Timestamp::from_second(now_s.fetch_sub(60, Ordering::Relaxed)).expect("a time");
    let config = WorkConfig { workers: Some(1), ..WorkConfig::default() };
    let jobs = Jobs::start(store, &config, Arc::new(StudySolver), Arc::new(clock)).await.expect("it starts");
    let mut ids: Vec<JobId> = Vec::new();
    for _ in 0..8 {
        let document = herringbone_job::parse(documents::response().to_string().as_bytes()).expect("a document");
        let request = SubmitRequest { document, idempotency_key: None, request_id: None, traceparent: None };
        ids.push(jobs.submit(request).await.expect("accepted").job.id);
    }
    let mut ended: Vec<JobRecord> = Vec::new();
    for id in &ids {
        let job = jobs.wait(*id, Duration::from_secs(60), |job| job.state.is_ended()).await.expect("a store");
        ended.push(job.expect("a job"));
    }
    for job in &ended {
        let (started_at, ended_at) = (job.started_at.expect("started"), job.ended_at.expect("ended"));
        assert_eq!(job.state.as_str(), "succeeded");
        assert!(job.submitted_at <= started_at && started_at <= ended_at, "{job:?}");
    }
    assert!(ids.windows(2).all(|two| two[0] < two[1]), "ids are in the order of submission, and so all different");
    assert!(jobs.close().await);
    jobs.store().close().await;
    // One worker: the rows of the history are in the order in which things happened.
    let mut connection = SqliteConnectOptions::new().filename(&database).connect().await.expect("it opens");
    let sql = "SELECT job_id FROM job_events WHERE state = 'running' ORDER BY rowid";
    let started: Vec<String> = sqlx::query_scalar(sql).fetch_all(&mut connection).await.expect("rows");
    assert_eq!(started, ids.iter().map(JobId::to_string).collect::<Vec<_>>());
}
