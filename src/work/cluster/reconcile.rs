//! The reconciler: what NATS has lost is published again.

use super::shared::Shared;
use crate::store::{ChunkKey, ChunkState};
use async_nats::jetstream::stream::LastRawMessageErrorKind;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Pause between two passes.
const PAUSE: Duration = Duration::from_secs(5);
/// Silence of a chunk after which the stream is asked for it, in times of the longest silence of a worker.
const SILENT_WAITS: u32 = 3;
/// Silence after which a chunk is published again although the stream has it.
const STUCK_AFTER: Duration = Duration::from_secs(600);

/// Checks the streams whenever the connection is made again, and every few seconds.
pub(super) async fn run_reconciler(shared: Arc<Shared>) {
    let mut connection = shared.nats.connection.clone();
    let mut created = None;
    let mut connections = connection.borrow_and_update().count;
    loop {
        tokio::select! {
            () = tokio::time::sleep(PAUSE) => {}
            changed = connection.changed() => if changed.is_err() { return },
            () = shared.closing().cancelled() => return,
        }
        let state = *connection.borrow_and_update();
        if !state.is_up {
            continue;
        }
        let is_again = state.count != connections;
        if let Err(error) = pass(&shared, &mut created, is_again).await {
            tracing::debug!(%error, "streams not checked");
            continue;
        }
        connections = state.count;
    }
}

async fn pass(shared: &Shared, created: &mut Option<String>, is_again: bool) -> Result<(), async_nats::Error> {
    let info = shared.streams.ensure().await?;
    let last_known = shared.state().last_sequence;
    let found = format!("{:?}", info.created);
    let is_new = created.replace(found.clone()).is_some_and(|known| known != found);
    if is_new || info.state.last_sequence < last_known {
        tracing::warn!("NATS has lost its streams; what was published is published again");
        shared.state().last_sequence = info.state.last_sequence;
        shared.consumers().clear();
        for key in issued(shared, |_| true) {
            reissue_lost(shared, key).await;
        }
        shared.streams.result_consumer().await?;
    } else if is_again {
        // Consumers may have been lost alone.
        shared.consumers().clear();
    }
    let stream = shared.nats.jetstream.get_stream_no_info(shared.space.work_stream()).await?;
    let (now, silent) = (Instant::now(), SILENT_WAITS * shared.streams.ack_wait);
    for (key, sequence, age) in silent_chunks(shared, now, silent) {
        let is_held = match stream.get_raw_message(sequence).await {
            Ok(_) => true,
            Err(error) if error.kind() == LastRawMessageErrorKind::NoMessageFound => false,
            Err(error) => return Err(error.into()),
        };
        if !is_held || (age > STUCK_AFTER && !is_in_line(shared, key).await) {
            reissue(shared, key).await;
        }
    }
    Ok(())
}

/// Chunks that are issued and of which nothing was heard for so long, with their places in the stream.
fn silent_chunks(shared: &Shared, now: Instant, silent: Duration) -> Vec<(ChunkKey, u64, Duration)> {
    let age = |chunk: &super::active::OpenChunk| {
        now.saturating_duration_since(chunk.seen.unwrap_or(chunk.issued).max(chunk.issued))
    };
    issued(shared, |chunk| age(chunk) > silent)
        .into_iter()
        .filter_map(|key| {
            let mut state = shared.state();
            let chunk = state.chunk(key)?;
            Some((key, chunk.sequence?, age(chunk)))
        })
        .collect()
}

fn issued(shared: &Shared, condition: impl Fn(&super::active::OpenChunk) -> bool) -> Vec<ChunkKey> {
    let state = shared.state();
    let chunks = state.jobs.values().flat_map(|job| job.open.iter().map(move |(number, chunk)| (job, *number, chunk)));
    chunks
        .filter(|(_, _, chunk)| chunk.state == ChunkState::Issued && condition(chunk))
        .map(|(job, chunk, _)| ChunkKey { job: job.job.id, attempt: job.job.attempt, chunk })
        .collect()
}

/// Whether a message may only be waiting for its turn: nothing of its class was delivered yet.
async fn is_in_line(shared: &Shared, key: ChunkKey) -> bool {
    let name = {
        let mut state = shared.state();
        let Some(job) = state.job(key) else { return true };
        let Some(chunk) = job.open.get(&key.chunk) else { return true };
        super::names::consumer(&job.solver, chunk.class)
    };
    let stream = shared.space.work_stream();
    let consumer: Result<async_nats::jetstream::consumer::PullConsumer, _> =
        shared.nats.jetstream.get_consumer_from_stream(name, stream).await;
    consumer.is_ok_and(|consumer| consumer.cached_info().num_pending > 0)
}

/// Has an issued chunk published again, under another id; its message is deleted, if there is one.
pub(super) async fn reissue(shared: &Shared, key: ChunkKey) {
    let sequence = shared.state().chunk(key).and_then(|chunk| chunk.sequence);
    if let Some(sequence) = sequence
        && let Ok(stream) = shared.nats.jetstream.get_stream_no_info(shared.space.work_stream()).await
    {
        // It may be gone, or acknowledged later: without effect.
        let _ = stream.delete_message(sequence).await;
    }
    reissue_lost(shared, key).await;
}

async fn reissue_lost(shared: &Shared, key: ChunkKey) {
    match shared.store().reissue(key).await {
        Ok(Some(issue)) => {
            tracing::info!(chunk = %key, issue, "chunk published again");
            metrics::counter!("herringbone_reissued_total").increment(1);
            if let Some(chunk) = shared.state().chunk(key) {
                (chunk.issue, chunk.state, chunk.sequence, chunk.seen) = (issue, ChunkState::Waiting, None, None);
            }
            shared.wake.notify_one();
        }
        Ok(None) => {}
        Err(error) => tracing::error!(chunk = %key, %error, "not published again; it is tried later"),
    }
}
