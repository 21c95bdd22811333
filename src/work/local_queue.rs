//! The queue in this process: workers that claim queued jobs from the database.

use super::config::WorkConfig;
use super::job_run::JobRun;
use super::measure;
use super::queue::{BoxFuture, Queue, Workers};
use super::recorder::JobRecorder;
use super::solver::Solver;
use super::stop_signal::{StopReason, StopSignal};
use crate::store::{Claim, JobId, WorkClass};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::{Notify, watch};
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tracing::Instrument;

/// Stack size of the threads of the pools, sufficient for recursive numerics.
const STACK_BYTES: usize = 8 << 20;
/// Pause after an error of the database.
const RETRY_AFTER: Duration = Duration::from_secs(1);

/// Runs jobs in this process.
///
/// Jobs of one operating point share one thread pool, and each sweep worker has its own. In a shared pool, threads
/// would work on the tasks of a long sweep before they start another job. The operating system schedules the threads of
/// all pools; an idle pool costs nothing, so that a single job can use every processor.
pub struct LocalQueue {
    shared: Arc<QueueShared>,
    tasks: TaskTracker,
    /// Workers for jobs of one operating point, and for sweeps.
    totals: (usize, usize),
}

struct QueueShared {
    config: WorkConfig,
    recorder: JobRecorder,
    solver: Arc<dyn Solver>,
    is_recovered: watch::Receiver<bool>,
    single_wake: Notify,
    sweep_wake: Notify,
    closing: CancellationToken,
    running: Mutex<RunningJobs>,
}

type RunningJobs = HashMap<JobId, (WorkClass, Arc<StopSignal>)>;

impl LocalQueue {
    /// Starts the workers, which claim queued jobs as soon as those of an earlier process are recovered.
    ///
    /// # Errors
    /// The threads cannot be started.
    pub fn start(
        config: &WorkConfig,
        recorder: JobRecorder,
        solver: Arc<dyn Solver>,
        is_recovered: watch::Receiver<bool>,
    ) -> Result<Self, rayon::ThreadPoolBuildError> {
        let (singles, sweeps) = (config.worker_count(), config.sweep_workers as usize);
        let shared_pool = Arc::new(pool(config, "solve")?);
        let mut workers = vec![(WorkClass::Single, shared_pool); singles];
        for number in 0..sweeps {
            workers.push((WorkClass::Sweep, Arc::new(pool(config, &format!("sweep-{number}"))?)));
        }
        let shared = Arc::new(QueueShared {
            config: config.clone(),
            recorder,
            solver,
            is_recovered,
            single_wake: Notify::new(),
            sweep_wake: Notify::new(),
            closing: CancellationToken::new(),
            running: Mutex::default(),
        });
        let tasks = TaskTracker::new();
        for (class, pool) in workers {
            tasks.spawn(Arc::clone(&shared).run_worker(class, pool));
        }
        Ok(Self { shared, tasks, totals: (singles, sweeps) })
    }
}

fn pool(config: &WorkConfig, name: &str) -> Result<rayon::ThreadPool, rayon::ThreadPoolBuildError> {
    let name = name.to_owned();
    rayon::ThreadPoolBuilder::new()
        .num_threads(config.thread_count())
        .stack_size(STACK_BYTES)
        .thread_name(move |index| format!("{name}-{index}"))
        .build()
}

impl Queue for LocalQueue {
    fn announce(&self, _job: JobId, class: WorkClass) {
        self.shared.wake(class).notify_one();
    }

    fn stop(&self, job: JobId) {
        if let Some((_, stop)) = self.shared.running().get(&job) {
            stop.request(StopReason::Cancel);
        }
    }

    fn workers(&self) -> Workers {
        let running = self.shared.running();
        let sweeps_busy = running.values().filter(|(class, _)| *class == WorkClass::Sweep).count();
        let (total, sweeps_total) = self.totals;
        Workers { total, busy: running.len() - sweeps_busy, sweeps_total, sweeps_busy }
    }

    fn close(&self, limit: Duration) -> BoxFuture<'_, bool> {
        self.shared.closing.cancel();
        self.tasks.close();
        for (_, stop) in self.shared.running().values() {
            stop.request(StopReason::Shutdown);
        }
        Box::pin(async move { tokio::time::timeout(limit, self.tasks.wait()).await.is_ok() })
    }
}

impl QueueShared {
    async fn run_worker(self: Arc<Self>, class: WorkClass, pool: Arc<rayon::ThreadPool>) {
        let mut is_recovered = self.is_recovered.clone();
        self.pause(async { drop(is_recovered.wait_for(|is_recovered| *is_recovered).await) }).await;
        let mut refusal = String::new();
        while !self.closing.is_cancelled() {
            match self.recorder.claim_next(class).await {
                Ok(Some(claim)) => {
                    refusal.clear();
                    // Several jobs may have caused one notification: each worker that claims a job wakes the next.
                    self.wake(class).notify_one();
                    let span = measure::span(&claim.job);
                    self.run_job(claim, class, &pool).instrument(span).await;
                }
                Ok(None) => {
                    refusal.clear();
                    self.pause(self.wake(class).notified()).await;
                }
                Err(error) => {
                    // Logged once for each reason in a row: it is tried again every second.
                    let reason = error.to_string();
                    if refusal != reason {
                        tracing::error!(%error, "next job not read");
                        refusal = reason;
                    }
                    measure::record_claim_retry();
                    self.pause(tokio::time::sleep(RETRY_AFTER)).await;
                }
            }
        }
    }

    fn wake(&self, class: WorkClass) -> &Notify {
        match class {
            WorkClass::Single => &self.single_wake,
            WorkClass::Sweep => &self.sweep_wake,
        }
    }

    async fn pause(&self, until: impl Future<Output = ()>) {
        tokio::select! {
            () = until => {}
            () = self.closing.cancelled() => {}
        }
    }

    async fn run_job(&self, claim: Claim, class: WorkClass, pool: &rayon::ThreadPool) {
        let id = claim.job.id;
        tracing::info!("job started");
        let stop = Arc::new(StopSignal::default());
        self.running().insert(id, (class, Arc::clone(&stop)));
        self.stop_if_requested(id, &stop).await;
        let run = JobRun {
            job: claim.job,
            computed_before: claim.computed,
            class,
            config: &self.config,
            recorder: &self.recorder,
            solver: &self.solver,
            pool,
            stop: &stop,
            closing: &self.closing,
        };
        run.run(&claim.input).await;
        self.running().remove(&id);
    }

    /// Handles a cancellation or shutdown that came between the claim and the registration of the job as running.
    async fn stop_if_requested(&self, id: JobId, stop: &StopSignal) {
        match self.recorder.store().job(id).await {
            Ok(Some(job)) if job.cancel_requested_at.is_some() => stop.request(StopReason::Cancel),
            Ok(_) => {}
            Err(error) => tracing::error!(job = %id, %error, "job not read"),
        }
        if self.closing.is_cancelled() {
            stop.request(StopReason::Shutdown);
        }
    }

    fn running(&self) -> std::sync::MutexGuard<'_, RunningJobs> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
