//! The queue of this process: workers that take what waits in the store, on one pool of threads.

use super::config::WorkConfig;
use super::queue::{Pending, Queue, Workers};
use super::recorder::Recorder;
use super::run::run;
use super::solver::Solver;
use crate::store::{Claim, JobId};
use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;

/// Stack of the pool's threads: deep enough for recursive numerics.
const STACK_BYTES: usize = 8 << 20;
/// Pause after the database did not answer.
const RETRY_AFTER: Duration = Duration::from_secs(1);

/// Runs jobs in this process. All running jobs share one pool, so that a lone sweep has every processor; the price is that
/// a thread which waits for parts of one job may meanwhile work on parts of another.
pub struct LocalQueue {
    shared: Arc<Shared>,
    tasks: TaskTracker,
    total: usize,
}

struct Shared {
    recorder: Recorder,
    solver: Arc<dyn Solver>,
    pool: rayon::ThreadPool,
    wake: Notify,
    closing: CancellationToken,
    /// Stop flags of the running jobs.
    running: Mutex<HashMap<JobId, Arc<AtomicBool>>>,
}

impl LocalQueue {
    /// Starts the workers; they take up at once what waits.
    ///
    /// # Errors
    /// When the threads cannot be started.
    pub fn start(
        config: &WorkConfig,
        recorder: Recorder,
        solver: Arc<dyn Solver>,
    ) -> Result<Self, rayon::ThreadPoolBuildError> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(config.thread_count())
            .stack_size(STACK_BYTES)
            .thread_name(|index| format!("solve-{index}"))
            .build()?;
        let shared = Arc::new(Shared {
            recorder,
            solver,
            pool,
            wake: Notify::new(),
            closing: CancellationToken::new(),
            running: Mutex::default(),
        });
        let total = config.worker_count();
        let tasks = TaskTracker::new();
        for _ in 0..total {
            tasks.spawn(Arc::clone(&shared).work());
        }
        Ok(Self { shared, tasks, total })
    }
}

impl Queue for LocalQueue {
    fn announce(&self, _job: JobId) {
        self.shared.wake.notify_one();
    }

    fn stop(&self, job: JobId) {
        if let Some(flag) = self.shared.flags().get(&job) {
            flag.store(true, Ordering::Relaxed);
        }
    }

    fn workers(&self) -> Workers {
        Workers { total: self.total, busy: self.shared.flags().len() }
    }

    fn close(&self, limit: Duration) -> Pending<'_, bool> {
        self.shared.closing.cancel();
        self.tasks.close();
        for flag in self.shared.flags().values() {
            flag.store(true, Ordering::Relaxed);
        }
        Box::pin(async move { tokio::time::timeout(limit, self.tasks.wait()).await.is_ok() })
    }
}

impl Shared {
    async fn work(self: Arc<Self>) {
        while !self.closing.is_cancelled() {
            match self.recorder.claim_next().await {
                Ok(Some(claim)) => {
                    // One announcement may have come for several jobs: whoever finds work wakes the next.
                    self.wake.notify_one();
                    self.run(claim).await;
                }
                Ok(None) => self.pause(self.wake.notified()).await,
                Err(error) => {
                    tracing::error!(%error, "next job not read");
                    self.pause(tokio::time::sleep(RETRY_AFTER)).await;
                }
            }
        }
    }

    async fn pause(&self, until: impl Future<Output = ()>) {
        tokio::select! {
            () = until => {}
            () = self.closing.cancelled() => {}
        }
    }

    async fn run(&self, claim: Claim) {
        let id = claim.job.id;
        let flag = Arc::new(AtomicBool::new(false));
        self.flags().insert(id, Arc::clone(&flag));
        if self.must_stop(id).await {
            flag.store(true, Ordering::Relaxed);
        }
        if let Err(error) = run(claim, &self.recorder, &self.solver, &self.pool, &flag).await {
            // The job stays running in the store and is taken up after a restart.
            tracing::error!(job = %id, %error, "what became of a job could not be written");
        }
        self.flags().remove(&id);
    }

    /// A wish to stop may have come between the claim and the entry of the flag.
    async fn must_stop(&self, id: JobId) -> bool {
        let asked = match self.recorder.store().job(id).await {
            Ok(job) => job.is_some_and(|job| job.cancel_requested_at.is_some()),
            Err(error) => {
                tracing::error!(job = %id, %error, "job not read");
                false
            }
        };
        asked || self.closing.is_cancelled()
    }

    fn flags(&self) -> std::sync::MutexGuard<'_, HashMap<JobId, Arc<AtomicBool>>> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
