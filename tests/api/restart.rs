use crate::support::*;
use herringbone::store::{Store, StoreConfig, WorkClass};
use jiff::Timestamp;

#[tokio::test]
async fn waiting_and_running_jobs_run_after_a_shutdown() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let mut paths = Vec::new();
    for _ in 0..4 {
        paths.push(app.submit(&document()).await);
    }
    app.solver.breakpoints.reached("solve", 2).await;
    let app = app.restart().await;
    for path in &paths {
        assert_eq!(app.ended(path).await["state"], "succeeded");
    }
    let attempts: Vec<_> = futures_util::future::join_all(paths.iter().map(|path| app.get(path))).await;
    let attempts: Vec<_> = attempts.iter().map(|answer| answer.json["attempt"].as_i64().unwrap()).collect();
    assert_eq!(attempts, [2, 2, 1, 1]);
}

#[tokio::test]
async fn a_job_that_ran_when_the_process_died_runs_again() {
    let app = app().await;
    let (done, before) = app.run(&document()).await;
    app.solver.breakpoints.hold("solve");
    let database = app.database();
    let path = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 2).await;
    // What a killed process leaves: the database as it was while the job ran.
    let directory = tempfile::tempdir().unwrap();
    for suffix in ["", "-wal"] {
        let name = format!("jobs.db{suffix}");
        std::fs::copy(database.with_file_name(&name), directory.path().join(&name)).unwrap();
    }
    app.solver.breakpoints.release("solve");
    let store = Store::open(&StoreConfig::at(directory.path().join("jobs.db"))).await.unwrap();
    let id = path.rsplit('/').next().unwrap().parse().unwrap();
    assert_eq!(store.job(id).await.unwrap().unwrap().state.as_str(), "running");
    assert_eq!(store.recover(3, false, Timestamp::now()).await.unwrap().requeued, 1);
    let claim = store.claim_next(WorkClass::Single, Timestamp::now()).await.unwrap().unwrap();
    assert_eq!((claim.job.id, claim.job.attempt), (id, 2));
    let kept = store.job(done.rsplit('/').next().unwrap().parse().unwrap()).await.unwrap().unwrap();
    assert_eq!(kept.revision, before["revision"].as_i64().unwrap());
}

#[tokio::test]
async fn a_job_being_canceled_at_the_shutdown_ends_canceled() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 1).await;
    app.post(&format!("{path}/cancel")).await;
    let app = app.restart().await;
    assert_eq!(app.get(&path).await.json["state"], "canceled");
}

#[tokio::test]
async fn a_service_that_shuts_down_takes_no_jobs() {
    let app = app().await;
    app.jobs.close().await;
    let answer = app.submit_with(&document(), &[]).await;
    answer.assert_problem(503, "shutting-down");
    assert_eq!(answer.header("retry-after"), "5");
    app.get("/readyz").await.assert_problem(503, "shutting-down");
    assert_eq!(app.get("/healthz").await.status, 200);
}

#[tokio::test]
async fn a_shutdown_ends_waits() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 1).await;
    let waiting = app.get_with(&path, &[("prefer", "wait=30")]);
    let (answer, closed) = tokio::join!(waiting, app.jobs.close());
    assert!(closed);
    assert_eq!(answer.status, 200);
}
