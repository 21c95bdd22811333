use super::*;

/// A store with a size limit.
async fn limited(max_database_mb: u32) -> Fixture {
    let directory = tempfile::tempdir().expect("temporary directory");
    let retention = RetentionConfig { keep_days: None, max_database_mb: Some(max_database_mb) };
    let config = StoreConfig { retention, ..StoreConfig::at(directory.path().join("jobs.db")) };
    Fixture { store: Store::open(&config).await.expect("store opens"), directory }
}

/// A job that ended with a result of so many bytes, or the error that prevented it.
async fn ended(store: &Store, second: i64, bytes: usize) -> Result<JobId, StoreError> {
    let hash = format!("{second}");
    store.submit(new_job(&hash), None, 100, at(second)).await?;
    let job = store.claim_next(WorkClass::Single, at(second)).await?.expect("a job waits").job;
    let body = format!("\"{}\"", "x".repeat(bytes));
    let done = store.succeed(job.id, 1, &Completion { body, ..completion(&hash) }, at(second)).await?;
    Ok(done.expect("its own attempt").id)
}

async fn exists(store: &Store, id: JobId) -> bool {
    store.job(id).await.expect("reads").is_some()
}

#[tokio::test]
async fn jobs_that_ended_long_ago_are_deleted_and_live_jobs_are_not() {
    let Fixture { store, .. } = &fixture().await;
    let old = ended(store, 0, 10).await.unwrap();
    let young = ended(store, 100, 10).await.unwrap();
    let runs = running(store, "runs").await.id;
    let waits = queued(store, "waits").await.id;
    assert_eq!(store.delete_ended_before(at(100), 8).await.unwrap(), 1);
    assert_eq!(store.delete_ended_before(at(100), 8).await.unwrap(), 0);
    assert!(!exists(store, old).await && exists(store, young).await, "the one that ended at the bound stays");
    assert_eq!(store.delete_ended_before(at(1_000_000), 8).await.unwrap(), 1);
    assert!(exists(store, runs).await && exists(store, waits).await);
}

#[tokio::test]
async fn ended_jobs_are_deleted_in_small_transactions() {
    let Fixture { store, .. } = &fixture().await;
    for second in 0..20 {
        ended(store, second, 10).await.unwrap();
    }
    let mut batches = Vec::new();
    loop {
        match store.delete_ended_before(at(1000), 8).await.unwrap() {
            0 => break,
            n => batches.push(n),
        }
    }
    assert_eq!(batches, [8, 8, 4]);
}

#[tokio::test]
async fn a_clock_behind_deletes_nothing_and_one_ahead_no_live_job() {
    let config = RetentionConfig { keep_days: Some(30), max_database_mb: None };
    let Fixture { store, .. } = &fixture().await;
    let done = ended(store, 0, 10).await.unwrap();
    let runs = running(store, "runs").await.id;
    let behind = config.keep_from(at(-100 * 86_400)).unwrap();
    assert_eq!(store.delete_ended_before(behind, 8).await.unwrap(), 0);
    assert!(exists(store, done).await);
    let ahead = config.keep_from(at(31 * 86_400)).unwrap();
    assert_eq!(store.delete_ended_before(ahead, 8).await.unwrap(), 1);
    assert!(exists(store, runs).await);
    assert_eq!(config.keep_from(Timestamp::MIN), None, "no time before all times");
}

#[tokio::test]
async fn the_oldest_jobs_are_deleted_down_to_nine_tenths_and_the_file_shrinks() {
    let Fixture { store, .. } = &limited(10).await;
    let mut ids = Vec::new();
    for second in 0..21 {
        ids.push(ended(store, second, 500_000).await.unwrap());
    }
    let before = store.usage().await.unwrap();
    assert!(before.used_bytes > 10_000_000);
    assert_eq!(store.delete_for_size(false, 8).await.unwrap(), 8, "a batch");
    assert_eq!(store.delete_for_size(true, 8).await.unwrap(), 0, "that was enough");
    assert!(!exists(store, ids[7]).await && exists(store, ids[8]).await, "the oldest went");
    store.release_space().await.unwrap();
    let after = store.usage().await.unwrap();
    assert!(after.used_bytes < 9_000_000 && after.free_bytes() == 0 && after.log_bytes == 0, "{after:?}");
    let on_disk = std::fs::metadata(store.file.path()).unwrap().len();
    assert_eq!(on_disk, after.file_bytes);
}

#[tokio::test]
async fn a_database_full_of_live_jobs_refuses_jobs_and_recovers() {
    let Fixture { store, .. } = &limited(20).await;
    store.admit().await.unwrap();
    // Live jobs with long documents: nothing may be deleted.
    let mut live = Vec::new();
    let error = loop {
        if let Err(error) = store.admit().await {
            break error;
        }
        let job = NewJob { input: format!("\"{}\"", "x".repeat(400_000)), ..new_job("live") };
        live.push(job.id);
        store.submit(job, None, 1000, at(0)).await.unwrap();
    };
    assert_eq!(error.unavailable(), Some(Unavailable::Full));
    assert_eq!(store.writable().await.err().and_then(|error| error.unavailable()), Some(Unavailable::Full));
    assert_eq!(store.delete_for_size(false, 8).await.unwrap(), 0);
    for id in live {
        assert!(exists(store, id).await);
        store.cancel(id, at(1)).await.unwrap();
    }
    assert!(store.delete_for_size(false, 8).await.unwrap() > 0);
    while store.delete_for_size(true, 8).await.unwrap() > 0 {}
    store.admit().await.unwrap();
    store.writable().await.unwrap();
    ended(store, 5, 100_000).await.unwrap();
}

/// Without the check before, SQLite stops at 110 % of the limit.
#[tokio::test]
async fn the_file_never_outgrows_its_limit_by_more_than_a_tenth() {
    let Fixture { store, .. } = &limited(8).await;
    store.save_stage("a", "mesh", "v", &[7; 1_500_000], at(0)).await.unwrap();
    let error = loop {
        let job = NewJob { input: format!("\"{}\"", "x".repeat(400_000)), ..new_job("live") };
        if let Err(error) = store.submit(job, None, 1000, at(0)).await {
            break error;
        }
    };
    assert_eq!(error.unavailable(), Some(Unavailable::Full), "{error}");
    let usage = store.usage().await.unwrap();
    assert!(usage.used_bytes > 8_000_000 && usage.file_bytes <= 8_800_000, "{usage:?}");
    // No job has ended: the stage cache is deleted, so that live jobs can continue.
    assert_eq!(store.delete_for_size(false, 8).await.unwrap(), 0);
    assert!(store.stage("a").await.unwrap().is_none());
    let waiting = store.claim_next(WorkClass::Single, at(1)).await.unwrap().expect("a job waits").job;
    store.cancel(waiting.id, at(2)).await.unwrap();
}

/// The space for jobs is used up to the last page; canceling writes an event and moves the job in every index.
#[tokio::test]
async fn canceling_and_failing_work_in_a_full_database() {
    let Fixture { store, .. } = &limited(8).await;
    let runs = running(store, "runs").await;
    let mut waiting = Vec::new();
    for length in [200_000, 20_000, 2_000, 1] {
        loop {
            let job = NewJob { input: format!("\"{}\"", "x".repeat(length)), ..new_job("live") };
            let id = job.id;
            match store.submit(job, None, 10_000, at(0)).await {
                Ok(_) => waiting.push(id),
                Err(error) => break assert_eq!(error.unavailable(), Some(Unavailable::Full), "{error}"),
            }
        }
    }
    assert!(waiting.len() > 50, "{}", waiting.len());
    for id in waiting {
        assert!(matches!(store.cancel(id, at(1)).await.unwrap(), Cancellation::Canceled(_)));
    }
    let failure = Failure::new("diverged", "");
    assert_eq!(store.fail(runs.id, 1, &failure, at(2)).await.unwrap().map(|job| job.state), Some(JobState::Failed));
}

/// Ended jobs can be deleted when the file may not grow.
#[tokio::test]
async fn deleting_works_in_a_full_database() {
    let Fixture { store, .. } = &limited(8).await;
    let mut second = 0;
    let error = loop {
        second += 1;
        if let Err(error) = ended(store, second, 100_000).await {
            break error;
        }
    };
    assert_eq!(error.unavailable(), Some(Unavailable::Full), "{error}");
    assert_eq!(store.delete_for_size(false, 8).await.unwrap(), 8);
    while store.delete_for_size(true, 8).await.unwrap() > 0 {}
    store.admit().await.unwrap();
    store.release_space().await.unwrap();
    // The write that failed before succeeds now.
    let left = store.claim_next(WorkClass::Single, at(second)).await.unwrap();
    if left.is_none() {
        ended(store, second + 1, 100_000).await.unwrap();
    }
}

#[tokio::test]
async fn the_stage_cache_is_bounded_by_a_quarter_of_the_limit() {
    let Fixture { store, .. } = &limited(8).await;
    for second in 0..10 {
        let hash = format!("{second}");
        store.save_stage(&hash, "mesh", "v", &[7; 900_000], at(second)).await.unwrap();
    }
    let used = store.usage().await.unwrap().used_bytes;
    assert!(used < 2_500_000, "stages take a quarter of the room: {used} bytes");
}
