//! The run of a claimed job, from its document to the stored result.

use super::config::WorkConfig;
use super::database_stages::DatabaseStages;
use super::failure::{document_failure, internal_failure, panic_failure, public_failure, solve_failure};
use super::measure;
use super::recorder::JobRecorder;
use super::reuse::stored_completion;
use super::running_points::{EvaluateElsewhere, RunningPoints};
use super::solver::Solver;
use super::stop_signal::{StopReason, StopSignal};
use crate::store::{
    Completion, Failure, JobRecord, JobState, PackedSeries, PointBatch, ReleaseReason, SampleBatch, StoreError,
    WorkClass,
};
use herringbone_job::document::JobDocument;
use herringbone_job::result::{JobResult, ReusedStage};
use herringbone_job::study::{Outcome, SolveContext, SolveError, Stage};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tokio::runtime::Handle;
use tokio::sync::{oneshot, watch};
use tokio_util::sync::CancellationToken;

/// Shortest time between two updates of the progress.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(250);
/// Points that are written in one transaction.
const POINTS_PER_TRANSACTION: usize = 2000;
/// First and longest pause before a failed write is retried.
const RETRY_AFTER: Duration = Duration::from_secs(1);
const MAX_RETRY_AFTER: Duration = Duration::from_secs(30);
/// How long the points since the last update are tried to be written when a job stops or fails. They can be solved
/// again; its state must not wait for the room that they would take.
const LAST_POINTS: Duration = Duration::from_secs(3);

/// The current stage, and the completed fraction of the whole job.
type Progress = (Stage, f64);

/// The outcome of a calculation.
enum SolveOutcome {
    Solved(Box<SolvedJob>),
    Stopped,
    Failed(Failure),
}

/// The result of a calculation, to be stored.
struct SolvedJob {
    completion: Completion,
    /// Samples that are stored before it, as one transaction would hold up other writers.
    batches: Vec<SampleBatch>,
}

/// One run of a job on a worker.
pub(super) struct JobRun<'a> {
    pub job: JobRecord,
    /// Computing time of earlier attempts.
    pub computed_before: Duration,
    pub class: WorkClass,
    /// Whether the stored rows are of this attempt, and not reused.
    pub rows_are_own: bool,
    /// What makes evaluations on other machines.
    pub elsewhere: Option<Arc<dyn EvaluateElsewhere>>,
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
        let elsewhere = self.elsewhere.as_ref().map(|elsewhere| (Arc::clone(elsewhere), Arc::clone(self.stop)));
        let points = Arc::new(RunningPoints::resume(stored, version).with_elsewhere(elsewhere));
        let started = Instant::now();
        let progress = watch::Sender::new((Stage::Geometry, self.job.progress));
        let mut updates = progress.subscribe();
        match self.calculate(document, input_hash, &points, progress, &mut updates, started).await {
            SolveOutcome::Solved(solved) => self.store_result(*solved, started).await,
            SolveOutcome::Failed(failure) => {
                let last = *updates.borrow();
                self.store_points(&points, last).await;
                self.fail(failure).await;
            }
            SolveOutcome::Stopped => {
                let last = *updates.borrow();
                // Of points this cheap those of the last moment are solved again sooner than a cancellation waits.
                let is_canceled = self.stop.reason() == Some(StopReason::Cancel);
                if !(is_canceled && points.unwritten() > POINTS_PER_TRANSACTION) {
                    self.store_points(&points, last).await;
                }
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
        let rows_are_own = self.rows_are_own;
        let span = tracing::Span::current();
        self.pool.spawn(move || {
            let _entered = span.entered();
            let task = SolveTask {
                solver: solver.as_ref(),
                stages: &stages,
                points: &shared_points,
                stop: &stop,
                rows_are_own,
            };
            // A panic that leaves the closure would abort the process.
            let outcome = catch_unwind(AssertUnwindSafe(|| task.solve(document, input_hash, &progress)));
            let _ = send.send(outcome.unwrap_or_else(|panic| SolveOutcome::Failed(panic_failure(panic.as_ref()))));
        });
        let mut is_refused = false;
        let mut has_more = false;
        loop {
            // The outcome ends the wait for the next update; short jobs store no progress.
            tokio::select! {
                outcome = &mut receive => {
                    return outcome.unwrap_or_else(|_| SolveOutcome::Failed(internal_failure("the calculation vanished")));
                }
                () = tokio::time::sleep(if has_more { Duration::ZERO } else { PROGRESS_INTERVAL }) => {}
            }
            // A few at a time: a stop waits for the transaction.
            let (batch, more) = points.take_some_unwritten(POINTS_PER_TRANSACTION);
            has_more = more;
            if updates.has_changed().unwrap_or(false) || !batch.is_empty() {
                let (stage, fraction) = *updates.borrow_and_update();
                let written = self.recorder.progress(&self.job, stage.as_str(), fraction, &batch).await;
                if let Err(error) = &written {
                    // Four times a second would fill the log.
                    if !is_refused {
                        tracing::warn!(%error, "progress not written");
                    }
                    points.restore(batch);
                    has_more = false;
                }
                is_refused = written.is_err();
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

    /// Stores the result of a calculation, unless the job is stopped before the last write.
    async fn store_result(&self, solved: SolvedJob, started: Instant) {
        let SolvedJob { completion, batches } = solved;
        for batch in batches {
            if self.stop.is_requested() {
                return self.finish_stopped(started.elapsed()).await;
            }
            match self.retry_unless_stopped(|| self.recorder.save_samples(&self.job, &batch)).await {
                Some(true) => {}
                Some(false) => return self.drop_late_result(started.elapsed()).await,
                None => return self.finish_stopped(started.elapsed()).await,
            }
        }
        match self.retry_unless_stopped(|| self.recorder.succeed(&self.job, &completion)).await {
            Some(true) => {}
            Some(false) => self.drop_late_result(started.elapsed()).await,
            None => self.finish_stopped(started.elapsed()).await,
        }
    }

    /// Ends a job that is to be canceled although it is solved. One that no longer belongs to this attempt stays as it
    /// is.
    async fn drop_late_result(&self, computed: Duration) {
        let release = || self.recorder.release(&self.job, ReleaseReason::Shutdown, computed);
        if self.retry_until_stored(release).await == Some(None) {
            tracing::warn!("a result came too late and was dropped");
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
        if batch.is_empty() {
            return;
        }
        let write = || self.recorder.progress(&self.job, stage.as_str(), fraction, &batch);
        if retry(write, tokio::time::sleep(LAST_POINTS)).await.is_none() {
            tracing::warn!(
                points = batch.rows.len(),
                "the last points are not written; if the job goes on, they are solved again"
            );
        }
    }

    async fn fail(&self, failure: Failure) {
        tracing::warn!(code = failure.code, detail = failure.detail, "job failed");
        let failure = public_failure(failure);
        self.retry_until_stored(|| self.recorder.fail(&self.job, &failure)).await;
    }

    /// Retries an operation until it succeeds; `None` when the service closes before that.
    async fn retry_until_stored<T, F>(&self, attempt: impl FnMut() -> F) -> Option<T>
    where
        F: Future<Output = Result<T, StoreError>>,
    {
        let done = retry(attempt, self.closing.cancelled()).await;
        if done.is_none() {
            tracing::error!("what became of the job is not written; it runs again after the restart");
        }
        done
    }

    /// Retries an operation until it succeeds; `None` when the job is stopped before that.
    async fn retry_unless_stopped<T, F>(&self, attempt: impl FnMut() -> F) -> Option<T>
    where
        F: Future<Output = Result<T, StoreError>>,
    {
        retry(attempt, self.stop.requested()).await
    }
}

/// Retries an operation at growing intervals until it succeeds; `None` when `given_up` ends first.
pub(super) async fn retry<T, F>(mut attempt: impl FnMut() -> F, given_up: impl Future<Output = ()>) -> Option<T>
where
    F: Future<Output = Result<T, StoreError>>,
{
    let mut given_up = std::pin::pin!(given_up);
    let mut pause = RETRY_AFTER;
    loop {
        match attempt().await {
            Ok(done) => return Some(done),
            Err(error) => tracing::error!(%error, "not written; it is tried again"),
        }
        tokio::select! {
            () = tokio::time::sleep(pause) => pause = (2 * pause).min(MAX_RETRY_AFTER),
            () = &mut given_up => return None,
        }
    }
}

/// The calculation of a job, on a thread of the pool.
struct SolveTask<'a> {
    solver: &'a dyn Solver,
    stages: &'a DatabaseStages,
    points: &'a RunningPoints,
    stop: &'a StopSignal,
    rows_are_own: bool,
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
            Ok(outcome) => match self.complete(outcome, input_hash) {
                Ok(Some(solved)) => SolveOutcome::Solved(Box::new(solved)),
                Ok(None) => SolveOutcome::Stopped,
                Err(error) => SolveOutcome::Failed(internal_failure(&error)),
            },
            Err(SolveError::Canceled(_)) => SolveOutcome::Stopped,
            Err(error) => SolveOutcome::Failed(solve_failure(error)),
        }
    }

    /// The completion of a solved job, with its series compressed; `None` when it is stopped meanwhile.
    fn complete(&self, outcome: Outcome, input_hash: String) -> Result<Option<SolvedJob>, String> {
        let Outcome { mut result, series } = outcome;
        let is_stopped = || self.stop.is_requested();
        if self.rows_are_own {
            result.numerics.reused.retain(|reused| *reused != ReusedStage::Points);
        }
        measure::record_stages(&result.numerics);
        let points = result.rows_mut().map(std::mem::take);
        result.note_not_finite();
        let body = serde_json::to_string::<JobResult>(&result).map_err(|error| error.to_string())?;
        let (unwritten, rows) = match points {
            None => (PointBatch::default(), None),
            Some(points) => match self.points.finish(&points, &is_stopped).map_err(|error| error.to_string())? {
                None => return Ok(None),
                Some((unwritten, rows)) => (unwritten, Some(rows)),
            },
        };
        let mut packed = Vec::with_capacity(series.len());
        for channel in series {
            match PackedSeries::pack(&channel, &is_stopped).map_err(|error| error.to_string())? {
                None => return Ok(None),
                Some(channel) => packed.push(channel),
            }
        }
        let (series, mut batches) = SampleBatch::split(packed);
        // The last batch, often the only one, goes with the result.
        let samples = batches.pop().unwrap_or_default();
        let (solver_version, reused_from) = (self.solver.version().to_owned(), None);
        let completion = Completion { body, input_hash, solver_version, series, samples, rows, unwritten, reused_from };
        Ok(Some(SolvedJob { completion, batches }))
    }
}
