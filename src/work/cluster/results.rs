//! Results of workers: stored, then acknowledged. What is not stored is not acknowledged, so that results wait in NATS
//! while the database is not available, and workers wait when NATS is full.

use super::active::State;
use super::message::{
    EndMessage, PART_BYTES, ResultContent, ResultMessage, SCHEMA, Summary, batch_of, decompress, unpack,
};
use super::reconcile::reissue;
use super::shared::Shared;
use crate::store::{
    ChunkContent, ChunkKey, ChunkOutcome, ChunkPart, ChunkResult, Completion, Failure, LineEndRow, PointBatch,
    SampleBatch,
};
use crate::work::measure;
use crate::work::stop_signal::StopReason;
use async_nats::jetstream::consumer::PullConsumer;
use async_nats::jetstream::{AckKind, Message};
use futures_util::StreamExt;
use futures_util::future::join_all;
use herringbone_job::result::{JobResult, SweepPoint};
use std::sync::Arc;
use std::time::Duration;

/// Most messages of a batch, which are held in memory, and the longest wait for one.
const BATCH: usize = 100;
const BATCH_WAIT: Duration = Duration::from_secs(1);
/// Pause after an error of NATS, and after one of the database.
const PULL_AGAIN: Duration = Duration::from_millis(300);
const STORE_AGAIN: Duration = Duration::from_secs(1);
/// How often a chunk may end without all its results.
const MOST_INCOMPLETE: u32 = 5;
/// Longest text of a failure from a worker.
const DETAIL_CHARS: usize = 2000;

/// A result that fits the chunk it belongs to.
struct Checked {
    key: ChunkKey,
    worker: String,
    content: Content,
}

enum Content {
    /// For the transaction of the batch.
    Part(ChunkContent),
    /// The end of a part of a sweep.
    End { content: ChunkContent, points: u64, work_s: f64, line_end: Option<LineEndRow> },
    /// The end of a whole job.
    Whole { run: String, end: EndMessage },
}

pub(super) async fn run_results(shared: Arc<Shared>, mut consumer: PullConsumer) {
    let mut empty_pulls = 0;
    while !shared.closing().is_cancelled() {
        let messages = tokio::select! {
            messages = pull(&consumer) => messages,
            () = shared.closing().cancelled() => return,
        };
        match messages {
            Ok(messages) if messages.is_empty() => {
                empty_pulls += 1;
                // A consumer that stopped delivering is bound anew.
                if empty_pulls % 5 == 0
                    && let Ok(again) = shared.streams.result_consumer().await
                {
                    if again.cached_info().num_pending > 0 {
                        tracing::warn!(pending = again.cached_info().num_pending, "results wait and none arrives");
                    }
                    consumer = again;
                }
            }
            Ok(messages) => {
                empty_pulls = 0;
                take(&shared, messages).await;
            }
            Err(error) => {
                tracing::debug!(%error, "results not read");
                if !shared.pause(PULL_AGAIN).await {
                    return;
                }
                if let Ok(again) = shared.streams.result_consumer().await {
                    consumer = again;
                }
            }
        }
    }
}

/// All messages that are there, or the first one that comes.
async fn pull(consumer: &PullConsumer) -> Result<Vec<Message>, async_nats::Error> {
    let mut there = consumer.fetch().max_messages(BATCH).messages().await?;
    let mut messages = Vec::new();
    while let Ok(Some(message)) = tokio::time::timeout(BATCH_WAIT, there.next()).await {
        match message {
            Ok(message) => messages.push(message),
            Err(error) if messages.is_empty() => return Err(error),
            Err(_) => break,
        }
    }
    if messages.is_empty()
        && let Some(first) = consumer.batch().max_messages(1).expires(BATCH_WAIT).messages().await?.next().await
    {
        messages.push(first?);
    }
    Ok(messages)
}

/// Stores a batch of results and acknowledges it. While the database refuses, the messages are held.
async fn take(shared: &Shared, messages: Vec<Message>) {
    let results: Vec<Checked> = messages.iter().filter_map(|message| read(shared, &message.payload)).collect();
    let mut left = results.into_iter().peekable();
    while left.peek().is_some() {
        let mut batch = Vec::new();
        let mut whole = None;
        for result in left.by_ref() {
            match result.content {
                Content::Whole { run, end } => {
                    whole = Some((result.key, run, end));
                    break;
                }
                _ => batch.push(result),
            }
        }
        if !store(shared, &messages, batch).await {
            return;
        }
        if let Some((key, run, end)) = whole
            && !store_whole(shared, &messages, key, &run, &end).await
        {
            return;
        }
    }
    shared.state().results_taken += messages.len() as u64;
    shared.wake.notify_one();
    for failed in
        join_all(messages.iter().map(|message| message.double_ack())).await.into_iter().filter_map(Result::err)
    {
        // It is delivered again, and is then a duplicate.
        tracing::debug!(error = %failed, "a stored result was not acknowledged");
    }
}

/// Reads a message and compares it with the chunk that was issued. `None`, and counted, when it does not fit.
fn read(shared: &Shared, payload: &[u8]) -> Option<Checked> {
    let dropped = |reason: &'static str| {
        metrics::counter!("herringbone_results_dropped_total", "reason" => reason).increment(1);
        None
    };
    let Ok((message, bytes)) = unpack::<ResultMessage>(payload) else { return dropped("unreadable") };
    let Ok(key) = message.key() else { return dropped("unreadable") };
    if message.schema != SCHEMA || bytes.len() > 2 * PART_BYTES {
        return dropped("unreadable");
    }
    let (worker, run) = (message.worker.clone(), message.run.clone());
    let content = match message.content {
        ResultContent::Rows { rows } => {
            let ranges = positions(&mut shared.state(), key);
            let Some(ranges) = ranges else { return dropped("late") };
            let fits = |position: u64| ranges.iter().any(|[from, to]| (*from..*to).contains(&position));
            let is_row = |body: &str| serde_json::from_str::<SweepPoint>(body).is_ok();
            if !rows.iter().all(|row| fits(row.position) && is_row(&row.body)) {
                tracing::warn!(chunk = %key, worker, "rows that do not belong to their chunk were dropped");
                return dropped("unfit");
            }
            match batch_of(rows, shared.solver.version()) {
                Ok(batch) => Content::Part(ChunkContent::Rows(batch)),
                Err(_) => return dropped("unfit"),
            }
        }
        ResultContent::Samples { .. } | ResultContent::Piece { .. } if !is_whole(&mut shared.state(), key) => {
            return dropped("unfit");
        }
        ResultContent::Samples { position, part } => {
            Content::Part(ChunkContent::Samples(SampleBatch::of_part(position as usize, part as usize, bytes.to_vec())))
        }
        ResultContent::Piece { piece } => Content::Part(ChunkContent::Piece { run, piece, bytes: bytes.to_vec() }),
        ResultContent::Failure { mut failure } => {
            failure.detail = failure.detail.chars().take(DETAIL_CHARS).collect();
            tracing::warn!(chunk = %key, worker, code = failure.code, detail = failure.detail, "job failed");
            Content::Part(ChunkContent::Failure(crate::work::failure::public_failure(failure)))
        }
        ResultContent::End(end) if end.pieces > 0 => Content::Whole { run, end },
        ResultContent::End(end) => {
            let Some(ranges) = positions(&mut shared.state(), key) else { return dropped("late") };
            let Ok(line_end) = end.line_end.as_ref().map(super::message::LineEndMessage::row).transpose() else {
                return dropped("unfit");
            };
            let (points, work_s) = (end.points, end.work_s);
            let content = ChunkContent::End { ranges, line_end: line_end.clone() };
            Content::End { content, points, work_s, line_end }
        }
    };
    Some(Checked { key, worker, content })
}

/// Whether an open chunk is a whole job, or is not open.
fn is_whole(state: &mut State, key: ChunkKey) -> bool {
    state.chunk(key).is_none_or(|chunk| chunk.part == ChunkPart::Whole)
}

/// Positions of the points of an open chunk of a sweep.
fn positions(state: &mut State, key: ChunkKey) -> Option<Vec<[u64; 2]>> {
    let job = state.job(key)?;
    let chunk = job.open.get(&key.chunk)?;
    job.positions(&chunk.part)
}

/// Stores results in one transaction, and again until it succeeds; false when the service closes before that.
async fn store(shared: &Shared, messages: &[Message], batch: Vec<Checked>) -> bool {
    if batch.is_empty() {
        return true;
    }
    let mut infos = Vec::with_capacity(batch.len());
    let mut results = Vec::with_capacity(batch.len());
    for Checked { key, worker, content } in batch {
        let (content, end) = match content {
            Content::Part(content) => (content, None),
            Content::End { content, points, work_s, line_end } => (content, Some((points, work_s, line_end))),
            Content::Whole { .. } => continue,
        };
        infos.push((worker, end));
        results.push(ChunkResult { key, content });
    }
    let stored = held(shared, messages, || shared.store().store_chunk_results(&results, shared.recorder().now())).await;
    let Some(outcomes) = stored else { return false };
    for ((result, (worker, end)), outcome) in results.iter().zip(infos).zip(outcomes) {
        match outcome {
            ChunkOutcome::Stored { new_rows } => {
                if let Some(job) = shared.state().job(result.key) {
                    job.rows += new_rows;
                }
            }
            ChunkOutcome::Done => {
                let (points, work_s, line_end) = end.unwrap_or_default();
                tracing::debug!(chunk = %result.key, worker, points, work_s, "chunk stored");
                metrics::histogram!("herringbone_chunk_seconds", "of" => "work").record(work_s.max(0.0));
                note_time(shared, result.key, work_s);
                shared.state().store(result.key, Some((points, work_s)), line_end.as_ref());
            }
            ChunkOutcome::Incomplete => incomplete(shared, result.key).await,
            ChunkOutcome::JobFailed(job) => {
                shared.state().remove(job.id);
                shared.recorder().publish_ended(*job);
            }
            ChunkOutcome::Dropped(reason) => {
                metrics::counter!("herringbone_results_dropped_total", "reason" => reason.as_str()).increment(1);
            }
        }
    }
    true
}

/// Records how long a chunk took from its publication to the store, without the computing time.
fn note_time(shared: &Shared, key: ChunkKey, work_s: f64) {
    if let Some(chunk) = shared.state().chunk(key) {
        let rest = chunk.issued.elapsed().as_secs_f64() - work_s;
        metrics::histogram!("herringbone_chunk_seconds", "of" => "wait").record(rest.max(0.0));
    }
}

/// Stores the result of a whole job. False when the service closes before that.
async fn store_whole(shared: &Shared, messages: &[Message], key: ChunkKey, run: &str, end: &EndMessage) -> bool {
    let known = shared.state().job(key).map(|job| (job.job.clone(), job.input.clone()));
    let Some((job, input)) = known else {
        metrics::counter!("herringbone_results_dropped_total", "reason" => "late").increment(1);
        return true;
    };
    let pieces = held(shared, messages, || shared.store().chunk_pieces(key, run, end.pieces)).await;
    let Some(pieces) = pieces else { return false };
    let parts = held(shared, messages, || shared.store().sample_parts(key.job)).await;
    let Some(parts) = parts else { return false };
    let Some(summary) = pieces.as_deref().and_then(summary) else {
        incomplete(shared, key).await;
        return true;
    };
    if summary.sample_parts != parts {
        incomplete(shared, key).await;
        return true;
    }
    if let Ok(result) = serde_json::from_str::<JobResult>(&summary.body) {
        measure::record_stages(&result.numerics);
    }
    metrics::histogram!("herringbone_chunk_seconds", "of" => "work").record(end.work_s.max(0.0));
    note_time(shared, key, end.work_s);
    // By the document here: it decides for which jobs the result is reused.
    let Ok(document) = herringbone_job::parse(input.as_bytes()) else { return true };
    let completion = Completion {
        body: summary.body,
        input_hash: shared.solver.input_hash(&document),
        solver_version: shared.solver.version().to_owned(),
        series: summary.series,
        samples: SampleBatch::default(),
        rows: None,
        unwritten: PointBatch::default(),
        reused_from: None,
    };
    let done = held(shared, messages, || shared.recorder().succeed(&job, &completion)).await;
    let Some(is_stored) = done else { return false };
    let mut state = shared.state();
    if is_stored {
        state.remove(key.job);
    } else if let Some(job) = state.job(key) {
        // It is to be canceled, or no longer ours: the database says which when it is ended.
        job.stop = Some(StopReason::Cancel);
    }
    true
}

/// Reads the summary of a job. `None` when it is not one.
fn summary(bytes: &[u8]) -> Option<Summary> {
    let summary: Summary = serde_json::from_slice(&decompress(bytes).ok()?).ok()?;
    serde_json::from_str::<JobResult>(&summary.body).ok()?;
    Some(summary)
}

/// Has a chunk computed again of which results are missing; its job fails when that happens again and again.
async fn incomplete(shared: &Shared, key: ChunkKey) {
    tracing::warn!(chunk = %key, "results of a chunk are missing; it is computed again");
    metrics::counter!("herringbone_results_dropped_total", "reason" => "incomplete").increment(1);
    let (job, count) = {
        let mut state = shared.state();
        let Some(job) = state.job(key) else { return };
        let record = job.job.clone();
        let Some(chunk) = job.open.get_mut(&key.chunk) else { return };
        chunk.incomplete += 1;
        (record, chunk.incomplete)
    };
    if count < MOST_INCOMPLETE {
        reissue(shared, key).await;
        return;
    }
    let failure = Failure::new("worker-lost", format!("results of a part of the job did not arrive, {count} times"));
    match shared.recorder().fail(&job, &failure).await {
        Ok(_) => drop(shared.state().remove(key.job)),
        Err(error) => tracing::error!(chunk = %key, %error, "not written"),
    }
}

/// Retries an operation of the database until it succeeds, and keeps the messages from being delivered again meanwhile;
/// `None` when the service closes before that.
async fn held<T, F>(shared: &Shared, messages: &[Message], mut attempt: impl FnMut() -> F) -> Option<T>
where
    F: Future<Output = Result<T, crate::store::StoreError>>,
{
    let mut refusal = String::new();
    loop {
        match attempt().await {
            Ok(done) => return Some(done),
            Err(error) => {
                let reason = error.to_string();
                if refusal != reason {
                    tracing::error!(%error, "results not written; it is tried again");
                    refusal = reason;
                }
            }
        }
        join_all(messages.iter().map(|message| message.ack_with(AckKind::Progress))).await;
        if !shared.pause(STORE_AGAIN).await {
            return None;
        }
    }
}
