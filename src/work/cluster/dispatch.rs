//! The dispatcher: publishes only what can be computed soon, so that fairness, priorities and cancellation stay here.

use super::active::ActiveJob;
use super::admit::{LAST_CHUNKS, LEAST_WINDOW, admit, run_here, until_stored};
use super::evaluations::EvaluationPlan;
use super::message::{
    ChunkMessage, ID_HEADER, MESSAGE_BYTES, SCHEMA, SCHEMA_HEADER, SOLVER_HEADER, State as MotionState, TRACE_HEADER,
    pack,
};
use super::shared::Shared;
use crate::store::{
    ChunkKey, ChunkRecord, ChunkState, Claim, Failure, JobId, PointBatch, ReleaseReason, StoreError, WorkClass,
};
use crate::work::stop_signal::StopReason;
use async_nats::jetstream::message::PublishMessage;
use futures_util::future::join_all;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Longest pause between two rounds.
const TICK: Duration = Duration::from_millis(250);
/// Messages that are published side by side.
const PUBLISHED_TOGETHER: usize = 64;
/// First and longest pause after a failed publication.
const RETRY_AFTER: Duration = Duration::from_millis(200);
const MAX_RETRY_AFTER: Duration = Duration::from_secs(5);
/// Change of the progress that is stored.
const PROGRESS_STEP: f64 = 0.01;

/// A chunk to be published.
struct Publication {
    key: ChunkKey,
    issue: u32,
    subject: String,
    consumer: (String, crate::store::ChunkClass),
    message: ChunkMessage,
    traceparent: Option<String>,
}

pub(super) async fn run_dispatcher(shared: Arc<Shared>) {
    let mut dispatcher = Dispatcher {
        shared,
        last_tick: Instant::now(),
        publish_after: Instant::now(),
        pause: RETRY_AFTER,
        refusal: String::new(),
    };
    let closing = dispatcher.shared.closing().clone();
    while !closing.is_cancelled() {
        dispatcher.round().await;
        tokio::select! {
            () = dispatcher.shared.wake.notified() => {}
            () = tokio::time::sleep(TICK) => {}
            () = closing.cancelled() => {}
        }
    }
}

struct Dispatcher {
    shared: Arc<Shared>,
    last_tick: Instant,
    /// After a failed publication, the time of the next attempt, and the pause before the one after it.
    publish_after: Instant,
    pause: Duration,
    /// Last error of the database, which is logged once.
    refusal: String,
}

impl Dispatcher {
    async fn round(&mut self) {
        self.count_time().await;
        let done = self.try_round().await;
        match done {
            Ok(()) => self.refusal.clear(),
            Err(error) => {
                let reason = error.to_string();
                if self.refusal != reason {
                    tracing::error!(%error, "work not given out");
                    self.refusal = reason;
                }
                self.shared.pause(Duration::from_secs(1)).await;
            }
        }
    }

    async fn try_round(&mut self) -> Result<(), StoreError> {
        self.end_stopped().await?;
        self.cut().await;
        admit(&self.shared).await?;
        self.cut().await;
        self.publish().await;
        self.finish().await;
        self.store_progress().await
    }

    /// Adds to the computing time of the jobs, and notes which ones are to be stopped.
    async fn count_time(&mut self) {
        let now = Instant::now();
        let passed = now.saturating_duration_since(self.last_tick);
        self.last_tick = now;
        let turn = Duration::from_secs(self.shared.work.sweep_turn_s.into());
        let mut has_long_turns = false;
        for job in self.shared.state().jobs.values_mut().filter(|job| !job.runs_here()) {
            if job.open.values().any(|chunk| chunk.is_running(now)) {
                job.computed += passed;
            }
            if job.stop.is_none() && job.computed_before + job.computed > self.shared.work.time_limit(job.class) {
                job.stop = Some(StopReason::TimeLimit);
            }
            has_long_turns |= job.stop.is_none() && is_long_turn(job, turn, now);
        }
        if has_long_turns && self.shared.store().has_queued(WorkClass::Sweep).await.unwrap_or(false) {
            let mut state = self.shared.state();
            for job in state.jobs.values_mut().filter(|job| job.stop.is_none() && !job.runs_here()) {
                if is_long_turn(job, turn, now) {
                    job.stop = Some(StopReason::Turn);
                }
            }
        }
    }

    /// Ends the jobs that are to be stopped.
    async fn end_stopped(&self) -> Result<(), StoreError> {
        let now = Instant::now();
        let turn = Duration::from_secs(self.shared.work.sweep_turn_s.into());
        let stopped: Vec<_> = {
            let state = self.shared.state();
            let jobs = state.jobs.values().filter(|job| !job.runs_here()).filter_map(|job| Some((job, job.stop?)));
            let due = jobs.filter(|(job, stop)| match stop {
                // What is being computed is waited for.
                StopReason::Turn => job.open.is_empty() || now > job.turn_started + turn + LAST_CHUNKS,
                _ => true,
            });
            due.map(|(job, stop)| (job.job.clone(), stop, job.computed)).collect()
        };
        for (job, stop, computed) in stopped {
            let recorder = self.shared.recorder();
            match stop {
                StopReason::TimeLimit => {
                    let limit_s = self.shared.work.time_limit(WorkClass::of_kind(&job.kind)).as_secs();
                    let detail = format!("the job had computed for {limit_s} s, the longest time permitted");
                    recorder.fail(&job, &Failure::new("time-limit", detail)).await?;
                }
                StopReason::Turn => {
                    recorder.release(&job, ReleaseReason::Turn, computed).await?;
                }
                StopReason::Cancel | StopReason::Shutdown => {
                    recorder.release(&job, ReleaseReason::Shutdown, computed).await?;
                }
            }
            self.shared.state().remove(job.id);
            self.shared.broadcast_stop(job.id).await;
        }
        Ok(())
    }

    /// Cuts chunks while fewer are out than can be computed soon, by turns.
    async fn cut(&self) {
        loop {
            let chunks = self.next_chunks();
            if chunks.is_empty() {
                return;
            }
            let Some(added) = until_stored(&self.shared, || self.shared.store().add_chunks(&chunks)).await else {
                return;
            };
            for (chunk, _) in chunks.iter().zip(added).filter(|(_, added)| !added) {
                // Canceled, or no longer ours.
                if let Some(job) = self.shared.state().job(chunk.key) {
                    job.stop = Some(StopReason::Cancel);
                }
            }
        }
    }

    fn next_chunks(&self) -> Vec<ChunkRecord> {
        let now = Instant::now();
        let mut state = self.shared.state();
        let mut chunks = Vec::new();
        let mut passed_over = 0;
        while passed_over < state.turns.len() && chunks.len() < PUBLISHED_TOGETHER {
            let Some(id) = state.turns.pop_front() else { break };
            state.turns.push_back(id);
            let (_, of_sweeps) = state.open();
            let Some(solver) = state.jobs.get(&id).map(|job| job.solver.clone()) else { continue };
            let slots = state.members.slots(&solver, now);
            let Some(job) = state.jobs.get_mut(&id) else { continue };
            let is_full = job.class == WorkClass::Sweep && of_sweeps >= (2 * slots).max(LEAST_WINDOW);
            match if is_full { None } else { job.cut(slots, now) } {
                Some(chunk) => {
                    chunks.push(chunk);
                    passed_over = 0;
                }
                None => passed_over += 1,
            }
        }
        chunks
    }

    /// Publishes the chunks that wait for it.
    async fn publish(&mut self) {
        while self.shared.nats.is_up() && Instant::now() >= self.publish_after {
            let publications = self.publications();
            if publications.is_empty() {
                return;
            }
            let sent = join_all(publications.iter().map(|publication| self.publish_one(publication))).await;
            let mut published = Vec::new();
            let mut failure = None;
            for (publication, sent) in publications.iter().zip(sent) {
                match sent {
                    Ok(Some(sequence)) => published.push((publication.key, publication.issue, sequence)),
                    Ok(None) => self.run_here(publication.key),
                    Err(error) => failure = Some(error),
                }
            }
            if !published.is_empty() {
                let now = self.shared.recorder().now();
                let marked = until_stored(&self.shared, || self.shared.store().mark_issued(&published, now)).await;
                if marked.is_none() {
                    return;
                }
                self.note_issued(&published);
                // Workers that have nothing to do ask for work at once.
                let _ = self.shared.nats.client.publish(self.shared.space.subject("wake"), "".into()).await;
            }
            match failure {
                None => self.pause = RETRY_AFTER,
                Some(error) => {
                    tracing::warn!(%error, "work not published; it is tried again");
                    self.publish_after = Instant::now() + self.pause;
                    self.pause = (2 * self.pause).min(MAX_RETRY_AFTER);
                }
            }
        }
    }

    fn publications(&self) -> Vec<Publication> {
        let state = self.shared.state();
        let mut publications = Vec::new();
        for job in state.turns.iter().filter_map(|id| state.jobs.get(id)).filter(|job| job.stop.is_none()) {
            for (number, chunk) in job.open.iter().filter(|(_, chunk)| chunk.state == ChunkState::Waiting) {
                if publications.len() < PUBLISHED_TOGETHER {
                    publications.push(publication(&self.shared, job, *number, chunk));
                }
            }
        }
        publications
    }

    /// The place in the stream; `None` for a job that is too large to be sent.
    async fn publish_one(&self, publication: &Publication) -> Result<Option<u64>, async_nats::Error> {
        let Publication { key, issue, subject, consumer, message, traceparent } = publication;
        let payload = pack(message, &[])?;
        if payload.len() > MESSAGE_BYTES {
            return Ok(None);
        }
        if !self.shared.consumers().contains(consumer) {
            self.shared.streams.work_consumer(&consumer.0, consumer.1).await?;
            self.shared.consumers().insert(consumer.clone());
        }
        let mut message = PublishMessage::build()
            .header(ID_HEADER, format!("{key}.{issue}"))
            .header(SCHEMA_HEADER, SCHEMA.to_string())
            .header(SOLVER_HEADER, self.shared.solver.version())
            .payload(payload.into());
        if let Some(traceparent) = traceparent {
            message = message.header(TRACE_HEADER, traceparent.as_str());
        }
        let started = Instant::now();
        let acknowledged = self.shared.nats.jetstream.send_publish(subject.clone(), message).await?.await?;
        metrics::histogram!("herringbone_nats_publish_seconds").record(started.elapsed().as_secs_f64());
        Ok(Some(acknowledged.sequence))
    }

    fn note_issued(&self, published: &[(ChunkKey, u32, u64)]) {
        let now = Instant::now();
        let mut state = self.shared.state();
        for (key, issue, sequence) in published {
            state.last_sequence = state.last_sequence.max(*sequence);
            if let Some(chunk) = state.chunk(*key).filter(|chunk| chunk.issue == *issue) {
                (chunk.state, chunk.sequence, chunk.issued) = (ChunkState::Issued, Some(*sequence), now);
            }
        }
    }

    /// Runs a job in this process that is too large to be sent.
    fn run_here(&self, key: ChunkKey) {
        let mut state = self.shared.state();
        if let Some(job) = state.jobs.get_mut(&key.job).filter(|job| job.runs_here()) {
            job.open.clear();
            return job.evaluations.iter_mut().for_each(EvaluationPlan::refuse);
        }
        let job = state.remove(key.job);
        drop(state);
        if let Some(job) = job {
            tracing::info!(job = %key.job, "the job is too large to be sent and runs here");
            let class = job.class;
            run_here(&self.shared, claim_of(job), class, false, None, None);
        }
    }

    /// Has the results of computed sweeps put together.
    async fn finish(&self) {
        let computed: Vec<ActiveJob> = {
            let mut state = self.shared.state();
            let ids: Vec<JobId> = state.jobs.values().filter(|job| job.is_computed()).map(|job| job.job.id).collect();
            ids.into_iter().filter_map(|id| state.remove(id)).collect()
        };
        for job in computed {
            // A crash while the result is put together counts as a loss.
            let (id, rows_are_own) = (job.job.id, job.rows_are_own);
            if until_stored(&self.shared, || self.shared.store().end_chunks(id)).await.is_none() {
                return;
            }
            run_here(&self.shared, claim_of(job), WorkClass::Sweep, rows_are_own, None, None);
        }
    }

    async fn store_progress(&self) -> Result<(), StoreError> {
        let changed: Vec<_> = {
            let mut state = self.shared.state();
            let jobs = state.jobs.values_mut().filter(|job| job.stop.is_none() && !job.runs_here());
            jobs.filter_map(|job| {
                let progress = job.progress();
                let is_changed = progress >= job.published + PROGRESS_STEP;
                is_changed.then(|| {
                    job.published = progress;
                    (job.job.clone(), job.stage(), progress)
                })
            })
            .collect()
        };
        for (job, stage, progress) in changed {
            self.shared.recorder().progress(&job, &stage, progress, &PointBatch::default()).await?;
        }
        Ok(())
    }
}

fn is_long_turn(job: &ActiveJob, turn: Duration, now: Instant) -> bool {
    job.class == WorkClass::Sweep && now.saturating_duration_since(job.turn_started) > turn
}

fn claim_of(job: ActiveJob) -> Claim {
    Claim { computed: job.computed_before + job.computed, job: job.job, input: job.input }
}

fn publication(shared: &Shared, job: &ActiveJob, number: u32, chunk: &super::active::OpenChunk) -> Publication {
    let start = job.plan.as_ref().and_then(|plan| plan.start(&chunk.part));
    Publication {
        key: ChunkKey { job: job.job.id, attempt: job.job.attempt, chunk: number },
        issue: chunk.issue,
        subject: shared.space.work(&job.solver, chunk.class),
        consumer: (job.solver.clone(), chunk.class),
        message: ChunkMessage {
            schema: SCHEMA,
            job: job.job.id.to_string(),
            attempt: job.job.attempt,
            chunk: number,
            issue: chunk.issue,
            document: job.input.clone(),
            part: chunk.part.clone(),
            start: start.as_deref().map(MotionState::of),
            time_limit_s: shared.work.time_limit(job.class).as_secs(),
            request_id: job.job.request_id.clone(),
        },
        traceparent: job.job.traceparent.clone(),
    }
}
