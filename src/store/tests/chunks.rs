use super::*;

fn record(job: &JobRecord, chunk: u32, part: ChunkPart) -> ChunkRecord {
    let key = ChunkKey { job: job.id, attempt: job.attempt, chunk };
    let solver = "test-1".to_owned();
    ChunkRecord { key, class: ChunkClass::Sweep, solver, state: ChunkState::Waiting, issue: 1, part, sequence: None }
}

fn points(from: u64, to: u64) -> ChunkPart {
    ChunkPart::Points { ranges: vec![[from, to]] }
}

fn rows(key: ChunkKey, positions: std::ops::Range<u64>) -> ChunkResult {
    let row = |position| PointRow { position, body: format!("{{\"p\":{position}}}") };
    let batch =
        PointBatch { solver_version: "test-1".into(), rows: positions.map(row).collect(), ..Default::default() };
    ChunkResult { key, content: ChunkContent::Rows(batch) }
}

fn end(key: ChunkKey, from: u64, to: u64) -> ChunkResult {
    ChunkResult { key, content: ChunkContent::End { ranges: vec![[from, to]], line_end: None } }
}

async fn store_all(store: &Store, results: &[ChunkResult]) -> Vec<ChunkOutcome> {
    store.store_chunk_results(results, at(3)).await.expect("stored")
}

#[tokio::test]
async fn a_chunk_is_a_row_before_it_is_published_and_gone_after_its_job() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    let chunk = record(&job, 0, points(0, 3));
    assert_eq!(store.add_chunks(std::slice::from_ref(&chunk)).await.unwrap(), [true]);
    assert_eq!(store.chunks(job.id, 1).await.unwrap(), std::slice::from_ref(&chunk));
    // Another issue was published meanwhile: nothing is marked.
    store.mark_issued(&[(chunk.key, 2, 7)], at(2)).await.unwrap();
    assert_eq!(store.open_chunk_counts().await.unwrap(), [1, 0]);
    assert_eq!(store.reissue(chunk.key).await.unwrap(), None, "it was not issued");
    store.mark_issued(&[(chunk.key, 1, 7)], at(2)).await.unwrap();
    assert_eq!((store.open_chunk_counts().await.unwrap(), store.last_chunk_sequence().await.unwrap()), ([0, 1], 7));
    assert!(store.is_chunk_wanted(chunk.key, 1).await.unwrap());
    assert_eq!(store.reissue(chunk.key).await.unwrap(), Some(2));
    assert!(!store.is_chunk_wanted(chunk.key, 1).await.unwrap(), "a later issue is out");
    assert!(store.is_chunk_wanted(chunk.key, 2).await.unwrap());
    store.succeed(job.id, 1, &completion("a"), at(4)).await.unwrap().unwrap();
    assert_eq!(store.chunks(job.id, 1).await.unwrap(), []);
    assert!(!store.is_chunk_wanted(chunk.key, 2).await.unwrap());
}

#[tokio::test]
async fn results_are_stored_once_and_a_chunk_ends_with_all_its_rows() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    let key = record(&job, 0, points(0, 4)).key;
    store.add_chunks(&[record(&job, 0, points(0, 4))]).await.unwrap();
    let stored = |new_rows| ChunkOutcome::Stored { new_rows };
    let first = store_all(store, &[rows(key, 0..2), rows(key, 1..3), end(key, 0, 4)]).await;
    assert_eq!(first, [stored(2), stored(1), ChunkOutcome::Incomplete]);
    let second = store_all(store, &[rows(key, 0..4), end(key, 0, 4), rows(key, 0..4), end(key, 0, 4)]).await;
    let duplicate = ChunkOutcome::Dropped(DropReason::Duplicate);
    assert_eq!(second, [stored(1), ChunkOutcome::Done, duplicate.clone(), duplicate.clone()]);
    assert_eq!(store_all(store, &[end(key, 0, 4)]).await, [duplicate]);
    assert_eq!(store.point_positions(job.id).await.unwrap(), [0, 1, 2, 3]);
    assert_eq!(store.distributed_jobs().await.unwrap().len(), 1);
    store.end_chunks(job.id).await.unwrap();
    assert!(store.distributed_jobs().await.unwrap().is_empty());
}

#[tokio::test]
async fn results_of_another_attempt_or_of_a_job_to_be_canceled_change_nothing() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    let old = record(&job, 0, points(0, 2)).key;
    store.add_chunks(&[record(&job, 0, points(0, 2))]).await.unwrap();
    store.release(job.id, 1, ReleaseReason::Turn, std::time::Duration::ZERO, at(2)).await.unwrap();
    let again = store.claim_next(WorkClass::Single, at(3)).await.unwrap().unwrap().job;
    let new = record(&again, 0, points(0, 2));
    store.add_chunks(std::slice::from_ref(&new)).await.unwrap();
    let late = ChunkOutcome::Dropped(DropReason::Late);
    assert_eq!(store_all(store, &[rows(old, 0..2), end(old, 0, 2)]).await, [late.clone(), late.clone()]);
    assert_eq!(store.point_count(job.id).await.unwrap(), 0);
    let failure = ChunkResult { key: old, content: ChunkContent::Failure(Failure::new("diverged", "")) };
    assert_eq!(store_all(store, &[failure]).await, std::slice::from_ref(&late));
    store.cancel(job.id, at(4)).await.unwrap();
    assert_eq!(store_all(store, &[rows(new.key, 0..2)]).await, [late]);
    assert_eq!(store.add_chunks(&[record(&again, 1, points(2, 3))]).await.unwrap(), [false]);
    assert!(!store.is_chunk_wanted(new.key, 1).await.unwrap());
}

#[tokio::test]
async fn a_failure_ends_the_job_and_drops_what_comes_after_it() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    let keys = [0, 1].map(|chunk| record(&job, chunk, points(0, 1)).key);
    store.add_chunks(&[record(&job, 0, points(0, 1)), record(&job, 1, points(1, 2))]).await.unwrap();
    let failure = ChunkResult { key: keys[0], content: ChunkContent::Failure(Failure::new("diverged", "far away")) };
    let outcomes = store_all(store, &[rows(keys[1], 1..2), failure, rows(keys[1], 1..2)]).await;
    let ChunkOutcome::JobFailed(failed) = &outcomes[1] else { panic!("{outcomes:?}") };
    assert_eq!(
        (failed.state, failed.error.as_ref().map(|error| error.code.as_str())),
        (JobState::Failed, Some("diverged"))
    );
    assert_eq!(outcomes[2], ChunkOutcome::Dropped(DropReason::Late));
}

#[tokio::test]
async fn pieces_of_one_computation_are_joined() {
    let Fixture { store, .. } = &fixture().await;
    let job = running(store, "a").await;
    let chunk = record(&job, 0, ChunkPart::Whole);
    store.add_chunks(std::slice::from_ref(&chunk)).await.unwrap();
    let piece = |run: &str, piece, bytes: &[u8]| ChunkResult {
        key: chunk.key,
        content: ChunkContent::Piece { run: run.into(), piece, bytes: bytes.to_vec() },
    };
    store_all(store, &[piece("x", 1, b"b"), piece("y", 0, b"other"), piece("x", 1, b"late")]).await;
    assert_eq!(store.chunk_pieces(chunk.key, "x", 2).await.unwrap(), None, "one is missing");
    store_all(store, &[piece("x", 0, b"a")]).await;
    assert_eq!(store.chunk_pieces(chunk.key, "x", 2).await.unwrap().as_deref(), Some(&b"ab"[..]));
    store.fail(job.id, 1, &Failure::new("diverged", ""), at(5)).await.unwrap();
    let left: (i64,) = sqlx::query_as("SELECT COUNT(*) FROM chunk_pieces").fetch_one(&store.reader).await.unwrap();
    assert_eq!(left.0, 0);
}

#[tokio::test]
async fn distributed_jobs_go_on_after_a_restart_or_are_queued_without_a_loss() {
    let Fixture { store, .. } = &fixture().await;
    let (distributed, alone) = (running(store, "a").await, running(store, "b").await);
    store.add_chunks(&[record(&distributed, 0, points(0, 2))]).await.unwrap();
    let recovery = store.recover(3, true, at(5)).await.unwrap();
    assert_eq!((recovery.requeued, recovery.queued), (1, 1));
    let state = async |id| store.job(id).await.unwrap().unwrap().state;
    assert_eq!((state(distributed.id).await, state(alone.id).await), (JobState::Running, JobState::Queued));
    assert_eq!(store.distributed_jobs().await.unwrap()[0].job.id, distributed.id);
    assert_eq!(store.recover(3, false, at(6)).await.unwrap().requeued, 1);
    let losses: Vec<(i64,)> =
        sqlx::query_as("SELECT losses FROM jobs ORDER BY id").fetch_all(&store.reader).await.unwrap();
    assert_eq!(losses, [(0,), (1,)]);
    assert_eq!(store.open_chunk_counts().await.unwrap(), [0, 0]);
}

#[tokio::test]
async fn a_setting_is_made_once() {
    let Fixture { store, .. } = &fixture().await;
    assert_eq!(store.setting_or("space", "a").await.unwrap(), "a");
    assert_eq!(store.setting_or("space", "b").await.unwrap(), "a");
}
