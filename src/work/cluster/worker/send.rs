//! Sending the results of a chunk.

use super::Worker;
use crate::store::ChunkKey;
use crate::work::cluster::message::{
    ID_HEADER, MessageError, ResultContent, ResultMessage, SCHEMA, SCHEMA_HEADER, SOLVER_HEADER, pack,
};
use crate::work::stop_signal::{StopReason, StopSignal};
use async_nats::jetstream::message::PublishMessage;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// First and longest pause before a message is sent again.
const RETRY_AFTER: Duration = Duration::from_millis(200);
const MAX_RETRY_AFTER: Duration = Duration::from_secs(10);

/// Sends the results of one computation of a chunk, one after the other.
pub(super) struct Sender {
    pub worker: Arc<Worker>,
    pub key: ChunkKey,
    /// The computation. It is part of the messages' ids: those of another one, with rows in other batches, must not be
    /// taken for these.
    pub run: String,
    pub stop: Arc<StopSignal>,
    next: AtomicU32,
}

/// The result is no longer wanted, or the worker has ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Unsent;

impl Sender {
    pub(super) fn new(worker: &Arc<Worker>, key: ChunkKey, stop: &Arc<StopSignal>) -> Self {
        let run = uuid::Uuid::new_v4().simple().to_string()[..12].to_owned();
        Self { worker: Arc::clone(worker), key, run, stop: Arc::clone(stop), next: AtomicU32::new(0) }
    }

    /// Sends a part of the result until NATS has acknowledged it. A stream that is full refuses it: that is how workers
    /// wait for the service.
    ///
    /// # Errors
    /// [`Unsent`].
    pub(super) async fn send(&self, content: ResultContent, bytes: &[u8]) -> Result<(), Unsent> {
        let number = self.next.fetch_add(1, Ordering::Relaxed);
        let payload = self.message(content, bytes).map_err(|error| {
            tracing::error!(%error, "result not written");
            Unsent
        })?;
        let (id, subject) = (format!("{}.{}.{number}", self.key, self.run), self.worker.space.result(self.key.job));
        let mut pause = RETRY_AFTER;
        loop {
            let message = PublishMessage::build()
                .header(ID_HEADER, id.as_str())
                .header(SCHEMA_HEADER, SCHEMA.to_string())
                .header(SOLVER_HEADER, self.worker.solver.version())
                .payload(payload.clone().into());
            let sent = async { self.worker.nats.jetstream.send_publish(subject.clone(), message).await?.await };
            match sent.await {
                Ok(_) => return Ok(()),
                Err(error) => tracing::debug!(%error, "result not taken; it is sent again"),
            }
            tokio::select! {
                () = tokio::time::sleep(pause) => pause = (2 * pause).min(MAX_RETRY_AFTER),
                () = self.worker.ended.cancelled() => return Err(Unsent),
            }
            if self.stop.reason() == Some(StopReason::Cancel) {
                return Err(Unsent);
            }
        }
    }

    fn message(&self, content: ResultContent, bytes: &[u8]) -> Result<Vec<u8>, MessageError> {
        let message = ResultMessage {
            schema: SCHEMA,
            job: self.key.job.to_string(),
            attempt: self.key.attempt,
            chunk: self.key.chunk,
            run: self.run.clone(),
            worker: self.worker.id.clone(),
            content,
        };
        pack(&message, bytes)
    }
}
