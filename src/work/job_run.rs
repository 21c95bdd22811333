//! The run of a claimed job, from its document to the stored result.

use super::config::WorkConfig;
use super::database_stages::DatabaseStages;
use super::failure::{document_failure, internal_failure, panic_failure, public_failure, solve_failure};
use super::measure;
use super::recorder::JobRecorder;
use super::reuse::stored_completion;
use super::running_points::RunningPoints;
use super::solver::Solver;
use super::stop_signal::{StopReason, StopSignal};
use crate::store::{
    Completion, Failure, JobRecord, JobState, PackedSeries, PointBatch, ReleaseReason, StoreError, WorkClass,
};
use herringbone_job::document::JobDocument;
use herringbone_job::result::JobResult;
use herringbone_job::study::{Outcome, SolveContext, SolveError, Stage};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tokio::runtime::Handle;
use tokio::sync::{oneshot, watch};
use tokio_util::sync::CancellationToken;

/// Shortest time between two updates of the progress.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(250);
/// First and longest pause before a failed write is retried.
const RETRY_AFTER: Duration = Duration::from_secs(1);
const MAX_RETRY_AFTER: Duration = Duration::from_secs(30);

/// The current stage, and the completed fraction of the whole job.
type Progress = (Stage, f64);

/// The outcome of a calculation.
enum SolveOutcome {
    Solved(Box<Completion>),
    Stopped,
    Failed(Failure),
}

/// One run of a job on a worker.
pub(super) struct JobRun<'a> {
    pub job: JobRecord,
    /// Computing time of earlier attempts.
    pub computed_before: Duration,
    pub class: WorkClass,
    pub config: &'a WorkConfig,
    pub recorder: &'a JobRecorder,
    pub solver: &'a Arc<dyn Solver>,
    pub pool: &'a rayon::ThreadPool,
    pub stop: &'a Arc<StopSignal>,
    pub closing: &'a CancellationToken,
}

impl JobRun<'_> {
    /// Runs the job on the pool and stores its outcome. Failed writes are retried until they succeed or the service
    /// closes; in the latter case the job is still running in the database and runs again after the restart.
    pub(super) async fn run(&self, input: &str) {
        let document = match herringbone_job::parse(input.as_bytes()) {
            Ok(document) => document,
            Err(error) => return self.fail(document_failure(error)).await,
        };
        // The hash of this version: the job may have been queued before an upgrade.
        let input_hash = self.solver.input_hash(&document);
        let (store, version) = (self.recorder.store(), self.solver.version());
        let Some(reusable) = self.retry_until_stored(|| stored_completion(store, &input_hash, version)).await else {
            return;
        };
        if let Some(completion) = reusable
            && self.retry_until_stored(|| self.recorder.succeed(&self.job, &completion)).await.unwrap_or(true)
        {
            return;
        }
        let (id, attempt) = (self.job.id, self.job.attempt);
        let stored = match self.class {
            WorkClass::Single => Some(PointBatch::default()),
            WorkClass::Sweep => {
                self.retry_until_stored(|| store.resume_points(id, attempt, &input_hash, version)).await
            }
        };
        let Some(stored) = stored else { return };
        let points = Arc::new(RunningPoints::resume(stored, version));
        let started = Instant::now();
        let progress = watch::Sender::new((Stage::Geometry, self.job.progress));
        let mut updates = progress.subscribe();
        match self.calculate(document, input_hash, &points, progress, &mut updates, started).await {
            SolveOutcome::Solved(completion) => {
                if self.retry_until_stored(|| self.recorder.succeed(&self.job, &completion)).await == Some(false) {
                    tracing::warn!("a result came too late and was dropped");
                }
            }
            SolveOutcome::Failed(failure) => {
                let last = *updates.borrow();
                self.store_points(&points, last).await;
                self.fail(failure).await;
            }
            SolveOutcome::Stopped => {
                let last = *updates.borrow();
                self.store_points(&points, last).await;
                self.finish_stopped(started.elapsed()).await;
            }
        }
    }

    async fn calculate(
        &self,
        document: JobDocument,
        input_hash: String,
        points: &Arc<RunningPoints>,
        progress: watch::Sender<Progress>,
        updates: &mut watch::Receiver<Progress>,
        started: Instant,
    ) -> SolveOutcome {
        let (send, mut receive) = oneshot::channel();
        let stages = DatabaseStages {
            store: self.recorder.store().clone(),
            runtime: Handle::current(),
            solver_version: self.solver.version(),
            now: self.recorder.now(),
        };
        let (solver, stop, shared_points) = (Arc::clone(self.solver), Arc::clone(self.stop), Arc::clone(points));
        let span = tracing::Span::current();
        self.pool.spawn(move || {
            let _entered = span.entered();
            let task = SolveTask { solver: solver.as_ref(), stages: &stages, points: &shared_points, stop: &stop };
            // A panic that leaves the closure would abort the process.
            let outcome = catch_unwind(AssertUnwindSafe(|| task.solve(document, input_hash, &progress)));
            let _ = send.send(outcome.unwrap_or_else(|panic| SolveOutcome::Failed(panic_failure(panic.as_ref()))));
        });
        loop {
            // The outcome ends the wait for the next update; short jobs store no progress.
            tokio::select! {
                outcome = &mut receive => {
                    return outcome.unwrap_or_else(|_| SolveOutcome::Failed(internal_failure("the calculation vanished")));
                }
                () = tokio::time::sleep(PROGRESS_INTERVAL) => {}
            }
            let batch = points.take_unwritten();
            if updates.has_changed().unwrap_or(false) || !batch.is_empty() {
                let (stage, fraction) = *updates.borrow_and_update();
                if let Err(error) = self.recorder.progress(&self.job, stage.as_str(), fraction, &batch).await {
                    tracing::warn!(%error, "progress not written");
                    points.restore(batch);
                }
            }
            self.stop_when_due(started).await;
        }
    }

    /// Stops a calculation at the time limit, and a sweep whose turn is over while others are queued.
    async fn stop_when_due(&self, started: Instant) {
        let elapsed = started.elapsed();
        if self.computed_before + elapsed > self.config.time_limit(self.class) {
            self.stop.request(StopReason::TimeLimit);
        }
        let turn = Duration::from_secs(self.config.sweep_turn_s.into());
        if self.class == WorkClass::Sweep && elapsed > turn {
            match self.recorder.store().has_queued(self.class).await {
                Ok(true) => self.stop.request(StopReason::Turn),
                Ok(false) => {}
                Err(error) => tracing::warn!(%error, "not known whether others wait"),
            }
        }
    }

    /// Stores the outcome of a calculation that was stopped.
    async fn finish_stopped(&self, computed: Duration) {
        let reason = match self.stop.reason() {
            None => return self.fail(internal_failure("the calculation stopped although nobody asked")).await,
            Some(StopReason::TimeLimit) => {
                let limit_s = self.config.time_limit(self.class).as_secs();
                let detail = format!("the job had computed for {limit_s} s, the longest time permitted");
                return self.fail(Failure::new("time-limit", detail)).await;
            }
            Some(StopReason::Turn) => ReleaseReason::Turn,
            Some(StopReason::Cancel | StopReason::Shutdown) => ReleaseReason::Shutdown,
        };
        let released = self.retry_until_stored(|| self.recorder.release(&self.job, reason, computed)).await;
        if let Some(Some(JobState::Queued)) = released {
            let why = if reason == ReleaseReason::Turn { "others had waited" } else { "the service shuts down" };
            tracing::info!(why, "job stopped; it goes on later");
        }
    }

    /// Stores the points that were solved after the last update.
    async fn store_points(&self, points: &RunningPoints, (stage, fraction): Progress) {
        let batch = points.take_unwritten();
        if !batch.is_empty() {
            self.retry_until_stored(|| self.recorder.progress(&self.job, stage.as_str(), fraction, &batch)).await;
        }
    }

    async fn fail(&self, failure: Failure) {
        tracing::warn!(code = failure.code, detail = failure.detail, "job failed");
        let failure = public_failure(failure);
        self.retry_until_stored(|| self.recorder.fail(&self.job, &failure)).await;
    }

    /// Retries an operation until it succeeds; `None` when the service closes before that.
    async fn retry_until_stored<T, F>(&self, mut attempt: impl FnMut() -> F) -> Option<T>
    where
        F: Future<Output = Result<T, StoreError>>,
    {
        let mut pause = RETRY_AFTER;
        loop {
            match attempt().await {
                Ok(done) => return Some(done),
                Err(error) => tracing::error!(%error, "not written; it is tried again"),
            }
            tokio::select! {
                () = tokio::time::sleep(pause) => pause = (2 * pause).min(MAX_RETRY_AFTER),
                () = self.closing.cancelled() => {
                    tracing::error!("what became of the job is not written; it runs again after the restart");
                    return None;
                }
            }
        }
    }
}

/// The calculation of a job, on a thread of the pool.
struct SolveTask<'a> {
    solver: &'a dyn Solver,
    stages: &'a DatabaseStages,
    points: &'a RunningPoints,
    stop: &'a StopSignal,
}

impl SolveTask<'_> {
    fn solve(&self, document: JobDocument, input_hash: String, progress: &watch::Sender<Progress>) -> SolveOutcome {
        let started = Instant::now();
        // Parts that are solved side by side report in any order: progress never goes back.
        let furthest = Mutex::new(0.0);
        let context = SolveContext {
            stages: self.stages,
            points: self.points,
            progress: &|stage, fraction| {
                let mut furthest = furthest.lock().unwrap_or_else(PoisonError::into_inner);
                if fraction >= *furthest {
                    *furthest = fraction;
                    progress.send_replace((stage, fraction));
                }
            },
            canceled: &|| self.stop.is_requested(),
            clock_ms: &|| started.elapsed().as_secs_f64() * 1e3,
        };
        let solved = self.solver.check(document).map_err(SolveError::from);
        match solved.and_then(|job| self.solver.solve(&job, &context)) {
            Ok(outcome) => self
                .complete(outcome, input_hash)
                .unwrap_or_else(|error| SolveOutcome::Failed(internal_failure(&error))),
            Err(SolveError::Canceled(_)) => SolveOutcome::Stopped,
            Err(error) => SolveOutcome::Failed(solve_failure(error)),
        }
    }

    /// The completion of a solved job, with its series compressed.
    fn complete(&self, outcome: Outcome, input_hash: String) -> Result<SolveOutcome, String> {
        let Outcome { mut result, series } = outcome;
        measure::record_stages(&result.numerics);
        let points = result.sweep.as_mut().map(|sweep| std::mem::take(&mut sweep.points));
        result.note_not_finite();
        let body = serde_json::to_string::<JobResult>(&result).map_err(|error| error.to_string())?;
        let rows = points.map(|points| self.points.finish(&points)).transpose().map_err(|error| error.to_string())?;
        let (unwritten, rows) = rows.unzip();
        let packed: Result<Vec<_>, _> = series.iter().map(PackedSeries::pack).collect();
        Ok(SolveOutcome::Solved(Box::new(Completion {
            body,
            input_hash,
            solver_version: self.solver.version().to_owned(),
            series: packed.map_err(|error| error.to_string())?,
            rows,
            unwritten: unwritten.unwrap_or_default(),
            reused_from: None,
        })))
    }
}
