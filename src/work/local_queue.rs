//! The queue in this process: workers that claim queued jobs from the database.

use super::config::WorkConfig;
use super::measure;
use super::queue::{BoxFuture, Queue, Workers};
use super::recorder::JobRecorder;
use super::runner::{Runner, pool};
use super::solver::Solver;
use crate::store::{JobId, WorkClass};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{Notify, watch};
use tokio_util::task::TaskTracker;
use tracing::Instrument;

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
    runner: Runner,
    is_recovered: watch::Receiver<bool>,
    single_wake: Notify,
    sweep_wake: Notify,
}

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
        let (singles, sweeps, threads) = (config.worker_count(), config.sweep_workers as usize, config.thread_count());
        let shared_pool = Arc::new(pool(threads, "solve")?);
        let mut workers = vec![(WorkClass::Single, shared_pool); singles];
        for number in 0..sweeps {
            workers.push((WorkClass::Sweep, Arc::new(pool(threads, &format!("sweep-{number}"))?)));
        }
        let shared = Arc::new(QueueShared {
            runner: Runner::new(config, recorder, solver),
            is_recovered,
            single_wake: Notify::new(),
            sweep_wake: Notify::new(),
        });
        let tasks = TaskTracker::new();
        for (class, pool) in workers {
            tasks.spawn(Arc::clone(&shared).run_worker(class, pool));
        }
        Ok(Self { shared, tasks, totals: (singles, sweeps) })
    }
}

impl Queue for LocalQueue {
    fn announce(&self, _job: JobId, class: WorkClass) {
        self.shared.wake(class).notify_one();
    }

    fn stop(&self, job: JobId) {
        self.shared.runner.cancel(job);
    }

    fn workers(&self) -> Workers {
        let ((total, sweeps_total), (busy, sweeps_busy)) = (self.totals, self.shared.runner.busy());
        Workers { total, busy, sweeps_total, sweeps_busy }
    }

    fn close(&self, limit: Duration) -> BoxFuture<'_, bool> {
        self.shared.runner.close();
        self.tasks.close();
        Box::pin(async move { tokio::time::timeout(limit, self.tasks.wait()).await.is_ok() })
    }
}

impl QueueShared {
    async fn run_worker(self: Arc<Self>, class: WorkClass, pool: Arc<rayon::ThreadPool>) {
        let mut is_recovered = self.is_recovered.clone();
        self.pause(async { drop(is_recovered.wait_for(|is_recovered| *is_recovered).await) }).await;
        let mut refusal = String::new();
        while !self.runner.closing().is_cancelled() {
            match self.runner.recorder().claim_next(class).await {
                Ok(Some(claim)) => {
                    refusal.clear();
                    // Several jobs may have caused one notification: each worker that claims a job wakes the next.
                    self.wake(class).notify_one();
                    let span = measure::span(&claim.job);
                    self.runner.run_job(claim, class, &pool, false, None).instrument(span).await;
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
            () = self.runner.closing().cancelled() => {}
        }
    }
}
