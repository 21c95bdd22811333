//! The run of a chunk: asked for, computed, its results sent, acknowledged; in this order, so that each step may happen
//! again.

use super::Worker;
use super::beats::Running;
use super::send::{Sender, Unsent};
use super::stages::WorkerStages;
use crate::store::{ChunkPart, Failure, PackedSeries, PointBatch};
use crate::work::cluster::answers::header;
use crate::work::cluster::message::{
    ChunkMessage, EndMessage, LineEndMessage, PART_BYTES, ResultContent, SCHEMA, StartAnswer, StartRequest, State,
    Summary, TRACE_HEADER, compress, unpack,
};
use crate::work::failure::{document_failure, internal_failure, panic_failure, solve_failure};
use crate::work::running_points::RunningPoints;
use crate::work::stop_signal::{StopReason, StopSignal};
use crate::work::trace::is_traceparent;
use async_nats::jetstream::{AckKind, Message};
use herringbone_job::document::JobDocument;
use herringbone_job::study::{LineEnd, Outcome, SolveContext, SolveError, Stage, SweepPart, solve_part};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::runtime::Handle;
use tokio::sync::{OwnedSemaphorePermit, oneshot, watch};
use tracing::Instrument;

/// Longest wait for the answer whether a chunk is to be computed.
const START_WAIT: Duration = Duration::from_secs(2);
/// Deliveries after which a chunk counts as the reason why its workers die.
const MOST_DELIVERIES: i64 = 5;
/// Longest wait before solved rows are sent.
const ROWS_WAIT: Duration = Duration::from_millis(250);
/// Time in which a message is extended, as a fraction of the time after which it is delivered again.
const EXTENSIONS: u32 = 3;
/// Wait that is assumed where the consumer does not say it.
const ACK_WAIT: Duration = Duration::from_secs(30);
/// Pause before a chunk that was given back is delivered again.
const GIVE_BACK_AFTER: Duration = Duration::from_secs(1);
/// Samples in a part: half a megabyte before the compression.
const PART_SAMPLES: usize = PART_BYTES / 8;

/// A chunk that was received.
pub(super) struct ChunkRun {
    worker: Arc<Worker>,
    message: Message,
}

/// What a computation has found.
enum Solved {
    /// Rows were stored; where a line was left.
    Part(Option<LineEnd>),
    Whole {
        summary: Box<Summary>,
        parts: Vec<(u32, u32, Vec<u8>)>,
    },
    Stopped,
    Failed(Failure),
}

impl ChunkRun {
    pub(super) fn new(worker: &Arc<Worker>, message: Message) -> Self {
        Self { worker: Arc::clone(worker), message }
    }

    /// Runs the chunk; its place is free when it is done with.
    pub(super) async fn run(self, place: OwnedSemaphorePermit) {
        match unpack::<ChunkMessage>(&self.message.payload) {
            Ok((chunk, _)) if chunk.schema == SCHEMA => {
                let id = chunk.request_id.clone().unwrap_or_default();
                let trace = header(&self.message, TRACE_HEADER).filter(|text| is_traceparent(text));
                let span = tracing::error_span!(
                    "chunk",
                    job = chunk.job,
                    attempt = chunk.attempt,
                    chunk = chunk.chunk,
                    issue = chunk.issue,
                    request_id = id,
                    traceparent = trace
                );
                self.run_chunk(chunk).instrument(span).await;
            }
            // Of another version of the messages: for others, after the wait.
            Ok(_) => tracing::warn!("a chunk of another version of the service was left"),
            Err(error) => {
                tracing::error!(%error, "a chunk that cannot be read was left");
            }
        }
        drop(place);
    }

    async fn run_chunk(&self, chunk: ChunkMessage) {
        let Ok(key) = chunk.key() else { return };
        let (stop, progress) = (Arc::new(StopSignal::default()), watch::Sender::new((Stage::Geometry, 0.0)));
        let running = Running { stop: Arc::clone(&stop), progress: progress.subscribe() };
        let sender = Sender::new(&self.worker, key, &stop);
        let delivered = self.message.info().map_or(1, |info| info.delivered);
        if delivered > MOST_DELIVERIES {
            return self.give_up(&sender, delivered).await;
        }
        if !self.is_wanted(&chunk, delivered).await {
            tracing::debug!("chunk dropped: it is not wanted any more");
            return self.acknowledge().await;
        }
        if !self.worker.registry.insert(key, running) {
            // Delivered again although this worker computes it.
            return;
        }
        tracing::debug!(delivered, "chunk taken");
        let done = tokio::select! {
            done = self.compute(&chunk, &sender, progress) => done,
            () = self.extend() => Err(Unsent),
        };
        match (done, stop.reason()) {
            (Ok(()), _) => {
                tracing::debug!("chunk computed");
                self.acknowledge().await;
            }
            (Err(Unsent), Some(StopReason::Cancel)) => {
                tracing::debug!("chunk left: it is not wanted any more");
                self.acknowledge().await;
            }
            (Err(Unsent), _) => {
                tracing::debug!("chunk left: it is given back");
                let give_back = AckKind::Nak(Some(GIVE_BACK_AFTER));
                let _ = self.message.ack_with(give_back).await;
            }
        }
        self.worker.registry.remove(key);
    }

    /// Asks the service whether the chunk is still to be computed. It is when no answer comes: the result waits.
    async fn is_wanted(&self, chunk: &ChunkMessage, delivered: i64) -> bool {
        let start = StartRequest {
            job: chunk.job.clone(),
            attempt: chunk.attempt,
            chunk: chunk.chunk,
            issue: chunk.issue,
            worker: self.worker.id.clone(),
            delivered,
        };
        let Ok(json) = serde_json::to_vec(&start) else { return true };
        let request = self.worker.nats.client.request(self.worker.space.subject("start"), json.into());
        let Ok(Ok(answer)) = tokio::time::timeout(START_WAIT, request).await else { return true };
        serde_json::from_slice::<StartAnswer>(&answer.payload).map_or(true, |answer| answer.go)
    }

    /// Ends the job of a chunk whose workers died one after the other.
    async fn give_up(&self, sender: &Sender, delivered: i64) {
        let detail = format!(
            "the workers that computed it ended or were lost, {} times; it is not started again",
            delivered - 1
        );
        let failure = Failure::new("worker-lost", detail);
        if sender.send(ResultContent::Failure { failure }, &[]).await.is_ok() {
            self.acknowledge().await;
        }
    }

    /// Acknowledges the chunk. When that fails it is delivered again, and is then not wanted.
    async fn acknowledge(&self) {
        if let Err(error) = self.message.double_ack().await {
            tracing::debug!(%error, "chunk not acknowledged");
        }
    }

    /// Extends the time after which the chunk is delivered again, until the end of the computation.
    async fn extend(&self) {
        let wait = self.ack_wait().await;
        loop {
            tokio::time::sleep(wait / EXTENSIONS).await;
            let _ = self.message.ack_with(AckKind::Progress).await;
        }
    }

    async fn ack_wait(&self) -> Duration {
        let Ok(info) = self.message.info() else { return ACK_WAIT };
        let consumer: Result<async_nats::jetstream::consumer::PullConsumer, _> =
            self.message.context.get_consumer_from_stream(info.consumer, info.stream).await;
        consumer.map_or(ACK_WAIT, |consumer| consumer.cached_info().config.ack_wait)
    }

    /// Computes the chunk and sends its results.
    async fn compute(
        &self,
        chunk: &ChunkMessage,
        sender: &Sender,
        progress: watch::Sender<(Stage, f64)>,
    ) -> Result<(), Unsent> {
        let document = match herringbone_job::parse(chunk.document.as_bytes()) {
            Ok(document) => document,
            Err(error) => return fail(sender, document_failure(error)).await,
        };
        let points = Arc::new(RunningPoints::resume(PointBatch::default(), self.worker.solver.version()));
        let started = Instant::now();
        let mut solved = self.spawn(chunk, document, &points, sender, progress);
        let outcome = loop {
            tokio::select! {
                outcome = &mut solved => break outcome,
                () = tokio::time::sleep(ROWS_WAIT) => {}
            }
            send_rows(sender, points.take_unwritten()).await?;
        };
        let work_s = started.elapsed().as_secs_f64();
        let outcome = outcome.unwrap_or_else(|_| Solved::Failed(internal_failure("the calculation vanished")));
        match outcome {
            Solved::Part(line_end) => {
                send_rows(sender, points.take_unwritten()).await?;
                let line_end = line_end.map(|end| LineEndMessage {
                    line: end.line as u64,
                    position: end.position as u64,
                    state: end.state.as_deref().map(State::of),
                });
                let end = EndMessage { points: points_of(&chunk.part), work_s, line_end, pieces: 0 };
                sender.send(ResultContent::End(end), &[]).await
            }
            Solved::Whole { summary, parts } => send_whole(sender, &summary, parts, work_s).await,
            Solved::Failed(failure) => fail(sender, failure).await,
            Solved::Stopped => {
                if sender.stop.reason() == Some(StopReason::Shutdown) {
                    // What is solved need not be solved again.
                    send_rows(sender, points.take_unwritten()).await?;
                }
                Err(Unsent)
            }
        }
    }

    /// Starts the computation on the pool.
    fn spawn(
        &self,
        chunk: &ChunkMessage,
        document: JobDocument,
        points: &Arc<RunningPoints>,
        sender: &Sender,
        progress: watch::Sender<(Stage, f64)>,
    ) -> oneshot::Receiver<Solved> {
        let (send, receive) = oneshot::channel();
        let task = SolveTask {
            worker: Arc::clone(&self.worker),
            stages: WorkerStages { cache: Arc::clone(&self.worker.stages), runtime: Handle::current() },
            points: Arc::clone(points),
            stop: Arc::clone(&sender.stop),
            part: chunk.part.clone(),
            start: chunk.start.clone(),
            time_limit: Duration::from_secs(chunk.time_limit_s),
        };
        let span = tracing::Span::current();
        self.worker.pool.spawn(move || {
            let _entered = span.entered();
            // A panic that leaves the closure would abort the process.
            let outcome = catch_unwind(AssertUnwindSafe(|| task.solve(document, &progress)));
            let _ = send.send(outcome.unwrap_or_else(|panic| Solved::Failed(panic_failure(panic.as_ref()))));
        });
        receive
    }
}

async fn fail(sender: &Sender, failure: Failure) -> Result<(), Unsent> {
    tracing::warn!(code = failure.code, detail = failure.detail, "job failed");
    sender.send(ResultContent::Failure { failure }, &[]).await
}

/// Sends rows, in messages of half a megabyte before the compression.
async fn send_rows(sender: &Sender, mut batch: PointBatch) -> Result<(), Unsent> {
    // Where a line was left is told at the end.
    batch.ends.clear();
    let mut states = std::mem::take(&mut batch.end_states);
    let (mut part, mut bytes) = (PointBatch::default(), 0);
    for row in std::mem::take(&mut batch.rows) {
        if bytes + row.body.len() > PART_BYTES && !part.rows.is_empty() {
            sender.send(ResultContent::rows(std::mem::take(&mut part)), &[]).await?;
            bytes = 0;
        }
        bytes += row.body.len();
        if let Some(place) = states.iter().position(|state| state.position == row.position) {
            part.end_states.push(states.swap_remove(place));
        }
        part.rows.push(row);
    }
    if part.rows.is_empty() {
        return Ok(());
    }
    sender.send(ResultContent::rows(part), &[]).await
}

/// Sends the result of a whole job: samples, then the summary in pieces, then the end.
async fn send_whole(
    sender: &Sender,
    summary: &Summary,
    parts: Vec<(u32, u32, Vec<u8>)>,
    work_s: f64,
) -> Result<(), Unsent> {
    for (position, part, bytes) in parts {
        sender.send(ResultContent::Samples { position, part }, &bytes).await?;
    }
    let packed =
        serde_json::to_vec(summary).map_err(|_| Unsent).and_then(|json| compress(&json).map_err(|_| Unsent))?;
    let mut pieces = 0;
    for piece in packed.chunks(PART_BYTES) {
        sender.send(ResultContent::Piece { piece: pieces }, piece).await?;
        pieces += 1;
    }
    sender.send(ResultContent::End(EndMessage { points: 1, work_s, line_end: None, pieces }), &[]).await
}

fn points_of(part: &ChunkPart) -> u64 {
    match part {
        ChunkPart::Whole => 1,
        ChunkPart::Points { ranges } | ChunkPart::Evaluations { ranges, .. } => {
            ranges.iter().map(|[from, to]| to.saturating_sub(*from)).sum()
        }
        ChunkPart::Stretch { from, to, .. } => to.saturating_sub(*from),
    }
}

/// The computation of a chunk, on a thread of the pool.
struct SolveTask {
    worker: Arc<Worker>,
    stages: WorkerStages,
    points: Arc<RunningPoints>,
    stop: Arc<StopSignal>,
    part: ChunkPart,
    start: Option<State>,
    time_limit: Duration,
}

impl SolveTask {
    fn solve(&self, document: JobDocument, progress: &watch::Sender<(Stage, f64)>) -> Solved {
        let started = Instant::now();
        let context = SolveContext {
            stages: &self.stages,
            points: self.points.as_ref(),
            progress: &|stage, fraction| {
                progress.send_if_modified(|current| {
                    let is_further = fraction >= current.1;
                    if is_further {
                        *current = (stage, fraction);
                    }
                    is_further
                });
            },
            canceled: &|| self.stop.is_requested() || started.elapsed() > self.time_limit,
            clock_ms: &|| started.elapsed().as_secs_f64() * 1e3,
        };
        let solver = &self.worker.solver;
        let job = match solver.check(document) {
            Ok(job) => job,
            Err(error) => return Solved::Failed(document_failure(error)),
        };
        let solved = match self.sweep_part() {
            Ok(Some(part)) => solve_part(&job, &part, &context).map(Solved::Part),
            Err(error) => return Solved::Failed(internal_failure(&error.to_string())),
            Ok(None) => solver.solve(&job, &context).map(|outcome| self.whole(outcome)),
        };
        match solved {
            Ok(solved) => solved,
            Err(SolveError::Canceled(_)) if self.stop.is_requested() => Solved::Stopped,
            Err(SolveError::Canceled(_)) => {
                let limit_s = self.time_limit.as_secs();
                let detail = format!("the job had computed for {limit_s} s, the longest time permitted");
                Solved::Failed(Failure::new("time-limit", detail))
            }
            Err(error) => Solved::Failed(solve_failure(error)),
        }
    }

    /// The part of a sweep or of an optimisation; `None` for a whole job.
    fn sweep_part(&self) -> serde_json::Result<Option<SweepPart>> {
        Ok(match &self.part {
            ChunkPart::Whole => None,
            ChunkPart::Evaluations { batch, .. } => Some(SweepPart::Evaluations(serde_json::from_str(batch)?)),
            ChunkPart::Points { ranges } => {
                let positions = ranges.iter().flat_map(|[from, to]| *from..*to).map(|position| position as usize);
                Some(SweepPart::Points(positions.collect()))
            }
            ChunkPart::Stretch { line, from, to } => {
                let start = self.start.as_ref().and_then(|state| state.values().ok());
                Some(SweepPart::Stretch { line: *line as usize, from: *from as usize, to: *to as usize, start })
            }
        })
    }

    /// The result of a whole job, with its series compressed.
    fn whole(&self, outcome: Outcome) -> Solved {
        let Outcome { mut result, series } = outcome;
        result.note_not_finite();
        let body = match serde_json::to_string(&result) {
            Ok(body) => body,
            Err(error) => return Solved::Failed(internal_failure(&error.to_string())),
        };
        let (mut entries, mut parts) = (Vec::with_capacity(series.len()), Vec::new());
        for (position, channel) in (0u32..).zip(series) {
            match PackedSeries::pack_in_parts(&channel, PART_SAMPLES, &|| self.stop.is_requested()) {
                Ok(Some(packed)) => {
                    let (entry, packed) = packed.into_parts();
                    entries.push(entry);
                    parts.extend((0u32..).zip(packed).map(|(part, bytes)| (position, part, bytes)));
                }
                Ok(None) => return Solved::Stopped,
                Err(error) => return Solved::Failed(internal_failure(&error.to_string())),
            }
        }
        let summary = Summary { body, series: entries, sample_parts: parts.len() as u64 };
        Solved::Whole { summary: Box::new(summary), parts }
    }
}
