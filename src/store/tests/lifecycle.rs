use super::*;
use std::time::Duration;

#[tokio::test]
async fn queued_running_succeeded() {
    let Fixture { store, .. } = &fixture().await;
    let job = queued(store, "a").await;
    assert_eq!((job.state, job.revision, job.attempt), (JobState::Queued, 1, 0));
    let claim = store.claim_next(WorkClass::Single, at(1)).await.unwrap().unwrap();
    assert_eq!((claim.job.id, claim.job.state, claim.job.attempt), (job.id, JobState::Running, 1));
    assert_eq!(claim.input, "{\"hash\":\"a\"}");
    let progressed = store.progress(job.id, 1, "mesh", 0.5, &PointBatch::default()).await.unwrap().unwrap();
    assert_eq!((progressed.progress, progressed.stage.as_deref(), progressed.revision), (0.5, Some("mesh"), 3));
    let done = store.succeed(job.id, 1, &completion("a"), at(2)).await.unwrap().unwrap();
    assert_eq!((done.state, done.progress, done.ended_at), (JobState::Succeeded, 1.0, Some(at(2))));
    assert_eq!(store.result(job.id).await.unwrap().unwrap().body, "{\"of\":\"a\"}");
    assert_eq!(store.job(job.id).await.unwrap(), Some(done));
}

#[tokio::test]
async fn first_in_first_out() {
    let Fixture { store, .. } = &fixture().await;
    let first = queued(store, "a").await.id;
    let second = queued(store, "b").await.id;
    assert_eq!(store.claim_next(WorkClass::Single, at(1)).await.unwrap().unwrap().job.id, first);
    assert_eq!(store.claim_next(WorkClass::Single, at(1)).await.unwrap().unwrap().job.id, second);
    assert!(store.claim_next(WorkClass::Single, at(1)).await.unwrap().is_none());
}

#[tokio::test]
async fn an_error_exactly_when_failed() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    let failure = Failure { sim_time_s: Some(0.25), step: Some(7), ..Failure::new("diverged", "too large") };
    let failed = store.fail(job.id, 1, &failure, at(2)).await.unwrap().unwrap();
    assert_eq!((failed.state, failed.error.as_ref()), (JobState::Failed, Some(&failure)));
    assert!(store.result(job.id).await.unwrap().is_none());
}

#[tokio::test]
async fn terminal_is_final() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    let done = store.succeed(job.id, 1, &completion("a"), at(2)).await.unwrap().unwrap();
    assert!(store.succeed(job.id, 1, &completion("b"), at(3)).await.unwrap().is_none());
    assert!(store.fail(job.id, 1, &Failure::new("diverged", ""), at(3)).await.unwrap().is_none());
    assert!(store.release(job.id, 1, ReleaseReason::Shutdown, Duration::ZERO, at(3)).await.unwrap().is_none());
    assert!(store.progress(job.id, 1, "mesh", 0.1, &PointBatch::default()).await.unwrap().is_none());
    assert_eq!(store.cancel(job.id, at(3)).await.unwrap(), Cancellation::Ended(done.clone()));
    assert_eq!(store.job(job.id).await.unwrap(), Some(done));
}

#[tokio::test]
async fn a_lost_worker_is_fenced_out() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    store.release(job.id, 1, ReleaseReason::Shutdown, Duration::ZERO, at(2)).await.unwrap().unwrap();
    let again = store.claim_next(WorkClass::Single, at(3)).await.unwrap().unwrap().job;
    assert_eq!((again.id, again.attempt), (job.id, 2));
    assert!(store.succeed(job.id, 1, &completion("a"), at(4)).await.unwrap().is_none());
    assert!(store.progress(job.id, 1, "mesh", 0.5, &PointBatch::default()).await.unwrap().is_none());
    assert!(store.result(job.id).await.unwrap().is_none());
    assert!(store.succeed(job.id, 2, &completion("a"), at(5)).await.unwrap().is_some());
}

#[tokio::test]
async fn canceling_a_queued_job_ends_it() {
    let Fixture { store, .. } = &fixture().await;
    let job = queued(store, "a").await;
    let Cancellation::Canceled(canceled) = store.cancel(job.id, at(1)).await.unwrap() else { panic!("not canceled") };
    assert_eq!(canceled.cancel_requested_at, Some(at(1)));
    assert!(store.claim_next(WorkClass::Single, at(2)).await.unwrap().is_none());
    assert_eq!(store.cancel(job.id, at(2)).await.unwrap(), Cancellation::Ended(canceled));
    assert_eq!(store.cancel(JobId::new(), at(2)).await.unwrap(), Cancellation::NotFound);
}

#[tokio::test]
async fn canceling_a_running_job_is_noted_once_and_decides_its_release() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    let Cancellation::Requested(requested) = store.cancel(job.id, at(2)).await.unwrap() else {
        panic!("not requested")
    };
    let Cancellation::Requested(again) = store.cancel(job.id, at(3)).await.unwrap() else { panic!("not requested") };
    assert_eq!(requested, again);
    let released = store.release(job.id, 1, ReleaseReason::Shutdown, Duration::ZERO, at(4)).await.unwrap().unwrap();
    assert_eq!((released.state, released.ended_at), (JobState::Canceled, Some(at(4))));
}

#[tokio::test]
async fn deleting_takes_ended_jobs_with_all_they_left() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    assert_eq!(store.delete(job.id).await.unwrap(), Deletion::NotEnded);
    store.succeed(job.id, 1, &completion("a"), at(2)).await.unwrap().unwrap();
    assert_eq!(store.delete(job.id).await.unwrap(), Deletion::Deleted);
    assert_eq!(store.delete(job.id).await.unwrap(), Deletion::NotFound);
    assert!(store.result(job.id).await.unwrap().is_none());
    assert!(store.history(job.id).await.unwrap().is_empty());
}

#[tokio::test]
async fn jobs_of_a_dead_process_are_queued_again() {
    let Fixture { store, directory } = fixture().await;
    let lost = running(&store, "lost").await;
    let asked = running(&store, "asked").await;
    store.cancel(asked.id, at(2)).await.unwrap();
    let waiting = queued(&store, "waiting").await;
    store.close().await;
    drop(store);
    let store = Store::open(&StoreConfig::at(directory.path().join("jobs.db"))).await.unwrap();
    let recovery = store.recover(3, false, at(10)).await.unwrap();
    assert_eq!(recovery, Recovery { requeued: 1, canceled: 1, given_up: 0, queued: 2 });
    assert_eq!(store.claim_next(WorkClass::Single, at(11)).await.unwrap().unwrap().job.id, lost.id);
    assert_eq!(store.claim_next(WorkClass::Single, at(11)).await.unwrap().unwrap().job.id, waiting.id);
    assert_eq!(store.job(asked.id).await.unwrap().unwrap().state, JobState::Canceled);
}

#[tokio::test]
async fn a_job_that_keeps_killing_its_process_fails() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    for attempt in 1..5 {
        // Shutdowns do not count.
        store.release(job.id, attempt, ReleaseReason::Shutdown, Duration::ZERO, at(2)).await.unwrap().unwrap();
        store.claim_next(WorkClass::Single, at(2)).await.unwrap().unwrap();
    }
    assert_eq!(store.recover(2, false, at(2)).await.unwrap().requeued, 1);
    store.claim_next(WorkClass::Single, at(3)).await.unwrap().unwrap();
    assert_eq!(store.recover(2, false, at(4)).await.unwrap().given_up, 1);
    let failed = store.job(job.id).await.unwrap().unwrap();
    assert_eq!((failed.state, failed.error.unwrap().code.as_str()), (JobState::Failed, "worker-lost"));
}

#[tokio::test]
async fn the_queue_is_bounded() {
    let Fixture { store, .. } = &fixture().await;
    assert!(matches!(store.submit(new_job("a"), None, 1, at(0)).await.unwrap(), Submission::Accepted(_)));
    assert_eq!(store.submit(new_job("b"), None, 1, at(0)).await.unwrap(), Submission::Full);
    assert_eq!(store.queued_count(), 1);
    store.claim_next(WorkClass::Single, at(1)).await.unwrap().unwrap();
    assert!(matches!(store.submit(new_job("b"), None, 1, at(0)).await.unwrap(), Submission::Accepted(_)));
}

#[tokio::test]
async fn an_idempotency_key_names_one_submission() {
    let Fixture { store, .. } = &fixture().await;
    let keyed = |hash: &str| NewJob { idempotency: Some(("key".into(), hash.into())), ..new_job(hash) };
    let Submission::Accepted(job) = store.submit(keyed("a"), None, 1, at(0)).await.unwrap() else { panic!("first") };
    assert_eq!(store.submit(keyed("a"), None, 1, at(1)).await.unwrap(), Submission::Replayed(job));
    assert_eq!(store.submit(keyed("b"), None, 1, at(1)).await.unwrap(), Submission::KeyReused);
}

#[tokio::test]
async fn a_reused_result_ends_the_job_at_once_and_is_not_queued() {
    let Fixture { store, .. } = &fixture().await;
    let source = running(store, "a").await;
    store.succeed(source.id, 1, &completion("a"), at(2)).await.unwrap().unwrap();
    let found = store.reusable("a", "test-1").await.unwrap().unwrap();
    assert_eq!(found.job, source.id);
    assert!(store.reusable("a", "test-2").await.unwrap().is_none());
    let reuse = Completion { reused_from: Some(found.job), ..completion("a") };
    let Submission::Accepted(job) = store.submit(new_job("a"), Some(reuse), 0, at(3)).await.unwrap() else {
        panic!("not accepted")
    };
    assert_eq!((job.state, job.reused_from), (JobState::Succeeded, Some(source.id)));
    let states: Vec<JobState> = store.history(job.id).await.unwrap().into_iter().map(|(_, state)| state).collect();
    assert_eq!(states, [JobState::Queued, JobState::Running, JobState::Succeeded]);
}

#[tokio::test]
async fn a_result_deleted_before_it_is_reused_is_computed_again() {
    let Fixture { store, .. } = &fixture().await;
    let reuse = Completion { reused_from: Some(JobId::new()), ..completion("a") };
    let Submission::Accepted(job) = store.submit(new_job("a"), Some(reuse), 1, at(3)).await.unwrap() else {
        panic!("not accepted")
    };
    assert_eq!((job.state, job.revision), (JobState::Queued, 1));
}

/// The clock is set back while a job waits, and again while it runs.
#[tokio::test]
async fn the_times_of_a_job_never_run_backwards() {
    let Fixture { store, .. } = &fixture().await;
    let ordered = |job: &JobRecord| {
        let (started, ended) = (job.started_at.unwrap_or(job.submitted_at), job.ended_at.unwrap());
        assert!(job.submitted_at <= started && started <= ended, "{job:?}");
    };
    for (hash, ends) in [("a", "succeeds"), ("b", "fails"), ("c", "is canceled"), ("d", "waits")] {
        let job = match store.submit(new_job(hash), None, 100, at(1000)).await.unwrap() {
            Submission::Accepted(job) => job,
            other => panic!("{other:?}"),
        };
        if ends == "waits" {
            let Cancellation::Canceled(job) = store.cancel(job.id, at(10)).await.unwrap() else {
                panic!("not canceled")
            };
            ordered(&job);
            continue;
        }
        let job = store.claim_next(WorkClass::Single, at(500)).await.unwrap().unwrap().job;
        assert_eq!(job.started_at, Some(at(1000)));
        let ended = match ends {
            "succeeds" => store.succeed(job.id, 1, &completion(hash), at(20)).await.unwrap(),
            "fails" => store.fail(job.id, 1, &Failure::new("diverged", ""), at(20)).await.unwrap(),
            _ => {
                store.cancel(job.id, at(20)).await.unwrap();
                store.release(job.id, 1, ReleaseReason::Shutdown, Duration::ZERO, at(10)).await.unwrap()
            }
        };
        ordered(&ended.unwrap());
    }
    let found = store.reusable("a", "test-1").await.unwrap().unwrap();
    let reuse = Completion { reused_from: Some(found.job), ..completion("a") };
    let Submission::Accepted(job) = store.submit(new_job("a"), Some(reuse), 0, at(5)).await.unwrap() else {
        panic!("full")
    };
    ordered(&job);
}
