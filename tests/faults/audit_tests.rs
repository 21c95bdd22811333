//! The audit of a sound database finds nothing; of each doctored one, what is wrong with it.

use crate::audit::{Accepted, audit};
use crate::documents::{response, sweep};
use crate::program::Program;
use rstest::rstest;
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions, Connection};
use tempfile::TempDir;

/// A response and a sweep of five points that succeeded.
fn sound() -> (TempDir, Accepted) {
    let directory = tempfile::tempdir().expect("a directory");
    let service = Program::at(directory.path()).start();
    let mut accepted = Accepted::default();
    for document in [response(), sweep(5)] {
        let path = service.submit(&document);
        assert_eq!(service.ended(&path)["state"], "succeeded");
        accepted.ids.push(path.rsplit('/').next().expect("an id").to_owned());
    }
    assert!(service.end().0.success());
    (directory, accepted)
}

#[test]
fn a_sound_database_has_nothing_broken() {
    let (directory, accepted) = sound();
    let findings = audit(&directory.path().join("jobs.db"), &accepted);
    assert!(findings.broken.is_empty(), "{findings:?}");
    assert_eq!((findings.states["succeeded"], findings.points), (2, 5));
}

#[test]
fn a_key_with_two_jobs_is_found() {
    let (directory, mut accepted) = sound();
    accepted.keys = accepted.ids.iter().map(|id| ("key".to_owned(), id.clone())).collect();
    let findings = audit(&directory.path().join("jobs.db"), &accepted);
    assert!(findings.broken.iter().any(|broken| broken.contains("was answered with")), "{findings:?}");
}

#[rstest]
#[case::lost("DELETE FROM jobs WHERE kind = 'response'", "was accepted and is not there")]
#[case::doubled(
    "INSERT INTO job_events SELECT job_id, revision + 1, at_us, state, attempt FROM job_events WHERE state = 'succeeded'",
    "ended 2 times"
)]
#[case::not_ended("UPDATE jobs SET state = 'queued', ended_at_us = NULL", "which its history does not end with")]
#[case::ended_without_a_word("DELETE FROM job_events WHERE state = 'succeeded'", "ended 0 times")]
#[case::started_in_secret("DELETE FROM job_events WHERE state = 'running'", "was started 0 times and counts 1")]
#[case::without_result("DELETE FROM results", "and has 0 results")]
#[case::a_gap("DELETE FROM sweep_points WHERE position = 2", "are not 0 to 5")]
#[case::other_points("UPDATE sweep_points SET body = '{}' WHERE position = 2", "are not those of its result")]
#[case::a_dataset_without_jobs("INSERT INTO datasets VALUES ('0')", "the dataset 0 has no job")]
#[case::a_result_without_dataset("UPDATE results SET dataset_id = NULL", "a result without a dataset")]
#[case::a_channel_without_samples("DELETE FROM series_samples", "has no samples of a_x_left")]
#[case::samples_without_a_result(
    "DELETE FROM results WHERE dataset_id IN (SELECT dataset_id FROM series)",
    "samples and no result"
)]
fn what_was_doctored_is_found(#[case] doctored: &'static str, #[case] found: &str) {
    let (directory, accepted) = sound();
    let database = directory.path().join("jobs.db");
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    runtime.block_on(async {
        let mut connection = SqliteConnectOptions::new().filename(&database).connect().await.expect("it opens");
        let done = sqlx::query(doctored).execute(&mut connection).await.expect("executed");
        assert!(done.rows_affected() > 0);
        connection.close().await.expect("closed");
    });
    let findings = audit(&database, &accepted);
    assert!(findings.broken.iter().any(|broken| broken.contains(found)), "{findings:?}");
}
