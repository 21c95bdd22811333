//! Beats of a worker: what it computes, every second. Their answers say what is no longer wanted.

use super::Worker;
use crate::store::{ChunkKey, JobId};
use crate::work::cluster::message::{Beat, BeatAnswer, BeatChunk, SCHEMA};
use crate::work::stop_signal::{StopReason, StopSignal};
use futures_util::StreamExt;
use herringbone_job::study::Stage;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Pause between two beats, and between those of an idle worker.
const PAUSE: Duration = Duration::from_secs(1);
const IDLE_PAUSE: Duration = Duration::from_secs(5);
/// Longest wait for an answer.
const ANSWER_WAIT: Duration = Duration::from_millis(900);

/// The chunks that are being computed.
#[derive(Default)]
pub(super) struct Registry {
    running: Mutex<HashMap<ChunkKey, Running>>,
    changed: tokio::sync::Notify,
}

#[derive(Clone)]
pub(super) struct Running {
    pub stop: Arc<StopSignal>,
    pub progress: tokio::sync::watch::Receiver<(Stage, f64)>,
}

impl Registry {
    /// False when the chunk is being computed already.
    pub(super) fn insert(&self, key: ChunkKey, running: Running) -> bool {
        let mut chunks = self.lock();
        let is_new = !chunks.contains_key(&key);
        if is_new {
            chunks.insert(key, running);
            self.changed.notify_one();
        }
        is_new
    }

    pub(super) fn remove(&self, key: ChunkKey) {
        self.lock().remove(&key);
        self.changed.notify_one();
    }

    pub(super) fn stop_all(&self) {
        self.lock().values().for_each(|running| running.stop.request(StopReason::Shutdown));
    }

    fn stop_job(&self, job: JobId) {
        let chunks = self.lock();
        let of_job = chunks.iter().filter(|(key, _)| key.job == job);
        of_job.for_each(|(_, running)| running.stop.request(StopReason::Cancel));
    }

    fn list(&self) -> Vec<(ChunkKey, Running)> {
        self.lock().iter().map(|(key, running)| (*key, running.clone())).collect()
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<ChunkKey, Running>> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

pub(super) async fn run_beats(worker: Arc<Worker>) {
    let host = std::fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default().trim().to_owned();
    let mut cancels = worker.nats.client.subscribe(worker.space.subject("cancel")).await.ok();
    loop {
        let running = worker.registry.list();
        beat(&worker, &host, worker.threads, &running).await;
        let pause = tokio::time::sleep(if running.is_empty() { IDLE_PAUSE } else { PAUSE });
        let mut pause = std::pin::pin!(pause);
        loop {
            let canceled = async {
                match &mut cancels {
                    Some(cancels) => cancels.next().await,
                    None => std::future::pending().await,
                }
            };
            tokio::select! {
                () = &mut pause => break,
                // An idle worker that becomes busy, or the reverse, says so at once.
                () = worker.registry.changed.notified() => if running.is_empty() != worker.registry.lock().is_empty() { break },
                message = canceled => match message {
                    Some(message) => {
                        let job = std::str::from_utf8(&message.payload).ok().and_then(|id| id.parse().ok());
                        job.into_iter().for_each(|job| worker.registry.stop_job(job));
                    }
                    None => cancels = None,
                },
            }
        }
    }
}

/// Tells the service that the worker ends.
pub(super) async fn say_goodbye(worker: &Worker) {
    beat(worker, "", 0, &[]).await;
}

/// Sends a beat, and stops what its answer names. Without an answer the work goes on.
async fn beat(worker: &Worker, host: &str, slots: usize, running: &[(ChunkKey, Running)]) {
    let chunk = |(key, running): &(ChunkKey, Running)| {
        let (stage, fraction) = *running.progress.borrow();
        BeatChunk {
            job: key.job.to_string(),
            attempt: key.attempt,
            chunk: key.chunk,
            stage: stage.as_str().to_owned(),
            fraction,
        }
    };
    let beat = Beat {
        schema: SCHEMA,
        worker: worker.id.clone(),
        host: host.to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        solver_version: worker.solver.version().to_owned(),
        solvers: worker.solvers.clone(),
        slots: u32::try_from(slots).unwrap_or(u32::MAX),
        running: running.iter().map(chunk).collect(),
    };
    let Ok(json) = serde_json::to_vec(&beat) else { return };
    let request = worker.nats.client.request(worker.space.subject("beat"), json.into());
    let Ok(Ok(answer)) = tokio::time::timeout(ANSWER_WAIT, request).await else { return };
    let Ok(BeatAnswer { stop }) = serde_json::from_slice(&answer.payload) else { return };
    for (_, unwanted) in stop.into_iter().filter_map(|place| running.get(place as usize)) {
        unwanted.stop.request(StopReason::Cancel);
    }
}
