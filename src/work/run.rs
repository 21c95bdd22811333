//! One claimed job, from its document to what is written.

use super::config::WorkConfig;
use super::failure::{document_failure, failure_of, internal, panic_failure, public};
use super::measure;
use super::points::{RunningPoints, place_of_points};
use super::recorder::Recorder;
use super::reuse::stored_completion;
use super::solver::Solver;
use super::stages::StoredStages;
use super::stop::{Reason, Stop};
use crate::store::{
    Completion, Failure, JobRecord, PackedSeries, Pause, PointBatch, PointsOfResult, State, StoreError, WorkClass,
};
use herringbone_job;
use herringbone_job::document::JobDocument;
use herringbone_job::result::JobResult;
use herringbone_job::study::{Outcome, SolveContext, SolveError, Stage};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::runtime::Handle;
use tokio::sync::{oneshot, watch};
use tokio_util::sync::CancellationToken;

/// Progress is written and told at most this often.
const PROGRESS_EVERY: Duration = Duration::from_millis(250);
/// First and longest pause before what the database refused is tried again.
const RETRY_AFTER: Duration = Duration::from_secs(1);
const RETRY_AFTER_AT_MOST: Duration = Duration::from_secs(30);

/// The stage that runs, and the fraction of the whole job.
type Progress = (Stage, f64);

/// How a calculation ended.
enum Ending {
    Solved(Box<Completion>),
    Stopped,
    Failed(Failure),
}

/// A job on its way through this worker.
pub(super) struct Run<'a> {
    pub job: JobRecord,
    /// Time that earlier attempts took.
    pub computed_before: Duration,
    pub class: WorkClass,
    pub config: &'a WorkConfig,
    pub recorder: &'a Recorder,
    pub solver: &'a Arc<dyn Solver>,
    pub pool: &'a rayon::ThreadPool,
    pub stop: &'a Arc<Stop>,
    pub closing: &'a CancellationToken,
}

impl Run<'_> {
    /// Runs the job on the pool and records what becomes of it. What the database refuses is kept and tried again until it is
    /// taken or the service closes; then the job is still running in the store, and is taken up after the restart.
    pub async fn to_its_end(&self, input: &str) {
        let document = match herringbone_job::parse(input.as_bytes()) {
            Ok(document) => document,
            Err(error) => return self.fail(document_failure(error)).await,
        };
        // Stored under the version that solves now: the job may have waited through an upgrade.
        let input_hash = self.solver.input_hash(&document);
        let (store, version) = (self.recorder.store(), self.solver.version());
        let Some(reusable) = self.patiently(|| stored_completion(store, &input_hash, version)).await else { return };
        if let Some(completion) = reusable
            && self.patiently(|| self.recorder.succeed(&self.job, &completion)).await.unwrap_or(true)
        {
            return;
        }
        let (id, attempt) = (self.job.id, self.job.attempt);
        let written = match self.class {
            WorkClass::Single => Some(PointBatch::default()),
            WorkClass::Sweep => self.patiently(|| store.kept_points(id, attempt, &input_hash, version)).await,
        };
        let Some(written) = written else { return };
        let points = Arc::new(RunningPoints::after(written, version));
        let started = Instant::now();
        let progress = watch::Sender::new((Stage::Geometry, self.job.progress));
        let mut progressed = progress.subscribe();
        match self.calculate(document, input_hash, &points, progress, &mut progressed, started).await {
            Ending::Solved(completion) => {
                if self.patiently(|| self.recorder.succeed(&self.job, &completion)).await == Some(false) {
                    tracing::warn!("a result came too late and was dropped");
                }
            }
            Ending::Failed(failure) => {
                let last = *progressed.borrow();
                self.write_points(&points, last).await;
                self.fail(failure).await;
            }
            Ending::Stopped => {
                let last = *progressed.borrow();
                self.write_points(&points, last).await;
                self.stopped(started.elapsed()).await;
            }
        }
    }

    async fn calculate(
        &self,
        document: JobDocument,
        input_hash: String,
        points: &Arc<RunningPoints>,
        progress: watch::Sender<Progress>,
        progressed: &mut watch::Receiver<Progress>,
        started: Instant,
    ) -> Ending {
        let (send, mut receive) = oneshot::channel();
        let stages = StoredStages {
            store: self.recorder.store().clone(),
            runtime: Handle::current(),
            solver_version: self.solver.version(),
            now: self.recorder.now(),
        };
        let (solver, stop, points_here) = (Arc::clone(self.solver), Arc::clone(self.stop), Arc::clone(points));
        let span = tracing::Span::current();
        self.pool.spawn(move || {
            let _entered = span.entered();
            let work = Work { solver: solver.as_ref(), stages: &stages, points: &points_here, stop: &stop };
            // A panic that leaves a closure of `spawn` would abort the process.
            let ending = catch_unwind(AssertUnwindSafe(|| work.solve(document, input_hash, &progress)));
            let _ = send.send(ending.unwrap_or_else(|panic| Ending::Failed(panic_failure(panic.as_ref()))));
        });
        loop {
            // The next word on progress may wait, the end may not; a short job writes none.
            tokio::select! {
                ending = &mut receive => {
                    return ending.unwrap_or_else(|_| Ending::Failed(internal("the calculation vanished")));
                }
                () = tokio::time::sleep(PROGRESS_EVERY) => {}
            }
            let batch = points.take_unwritten();
            if progressed.has_changed().unwrap_or(false) || !batch.is_empty() {
                let (stage, fraction) = *progressed.borrow_and_update();
                if let Err(error) = self.recorder.progress(&self.job, stage.as_str(), fraction, &batch).await {
                    tracing::warn!(%error, "progress not written");
                    points.put_back(batch);
                }
            }
            self.stop_when_due(started).await;
        }
    }

    /// Stops a calculation that took too long, and a sweep that had its turn while others wait.
    async fn stop_when_due(&self, started: Instant) {
        let elapsed = started.elapsed();
        if self.computed_before + elapsed > self.config.time_limit(self.class) {
            self.stop.ask(Reason::TimeLimit);
        }
        let turn = Duration::from_secs(self.config.sweep_turn_s.into());
        if self.class == WorkClass::Sweep && elapsed > turn {
            match self.recorder.store().is_waiting(self.class).await {
                Ok(true) => self.stop.ask(Reason::Turn),
                Ok(false) => {}
                Err(error) => tracing::warn!(%error, "not known whether others wait"),
            }
        }
    }

    async fn stopped(&self, computed: Duration) {
        let pause = match self.stop.reason() {
            None => return self.fail(internal("the calculation stopped although nobody asked")).await,
            Some(Reason::TimeLimit) => {
                let limit_s = self.config.time_limit(self.class).as_secs();
                let detail = format!("the job had computed for {limit_s} s, the longest time permitted");
                return self.fail(Failure::new("time-limit", detail)).await;
            }
            Some(Reason::Turn) => Pause::Turn,
            Some(Reason::Cancel | Reason::Shutdown) => Pause::Shutdown,
        };
        let released = self.patiently(|| self.recorder.release(&self.job, pause, computed)).await;
        if let Some(Some(State::Queued)) = released {
            let why = if pause == Pause::Turn { "others had waited" } else { "the service shuts down" };
            tracing::info!(why, "job stopped; it goes on later");
        }
    }

    /// Points that were solved after the last word on progress.
    async fn write_points(&self, points: &RunningPoints, (stage, fraction): Progress) {
        let batch = points.take_unwritten();
        if !batch.is_empty() {
            self.patiently(|| self.recorder.progress(&self.job, stage.as_str(), fraction, &batch)).await;
        }
    }

    async fn fail(&self, failure: Failure) {
        tracing::warn!(code = failure.code, detail = failure.detail, "job failed");
        let failure = public(failure);
        self.patiently(|| self.recorder.fail(&self.job, &failure)).await;
    }

    /// Tries until the database takes it; none when the service closed before that.
    async fn patiently<T, F>(&self, mut attempt: impl FnMut() -> F) -> Option<T>
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
                () = tokio::time::sleep(pause) => pause = (2 * pause).min(RETRY_AFTER_AT_MOST),
                () = self.closing.cancelled() => {
                    tracing::error!("what became of the job is not written; it runs again after the restart");
                    return None;
                }
            }
        }
    }
}

/// What a thread of the pool works with.
struct Work<'a> {
    solver: &'a dyn Solver,
    stages: &'a StoredStages,
    points: &'a RunningPoints,
    stop: &'a Stop,
}

impl Work<'_> {
    fn solve(&self, document: JobDocument, input_hash: String, progress: &watch::Sender<Progress>) -> Ending {
        let started = Instant::now();
        let context = SolveContext {
            stages: self.stages,
            points: self.points,
            progress: &|stage, fraction| {
                progress.send_replace((stage, fraction));
            },
            canceled: &|| self.stop.is_asked(),
            clock_ms: &|| started.elapsed().as_secs_f64() * 1e3,
        };
        let solved = self.solver.check(document).map_err(SolveError::from);
        match solved.and_then(|job| self.solver.solve(&job, &context)) {
            Ok(outcome) => self.packed(outcome, input_hash).unwrap_or_else(|error| Ending::Failed(internal(&error))),
            Err(SolveError::Canceled(_)) => Ending::Stopped,
            Err(error) => Ending::Failed(failure_of(error)),
        }
    }

    fn packed(&self, outcome: Outcome, input_hash: String) -> Result<Ending, String> {
        let Outcome { mut result, series } = outcome;
        measure::computed(&result.numerics);
        let points = result.sweep.as_mut().map(|sweep| std::mem::take(&mut sweep.points));
        result.note_not_finite();
        let body = serde_json::to_string::<JobResult>(&result).map_err(|error| error.to_string())?;
        let (rows, points): (PointBatch, Option<PointsOfResult>) = match points.zip(place_of_points(&body)) {
            None => Default::default(),
            Some((points, at)) => {
                let (rows, points) = self.points.finished(&points, at).map_err(|error| error.to_string())?;
                (rows, Some(points))
            }
        };
        let packed: Result<Vec<_>, _> = series.iter().map(PackedSeries::pack).collect();
        Ok(Ending::Solved(Box::new(Completion {
            body,
            input_hash,
            solver_version: self.solver.version().to_owned(),
            series: packed.map_err(|error| error.to_string())?,
            points,
            rows,
            reused_from: None,
        })))
    }
}
