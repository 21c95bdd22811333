//! The queue of this process: workers that take what waits in the store.

use super::config::WorkConfig;
use super::measure;
use super::queue::{Pending, Queue, Workers};
use super::recorder::Recorder;
use super::run::Run;
use super::solver::Solver;
use super::stop::{Reason, Stop};
use crate::store::{Claim, JobId, WorkClass};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::Notify;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tracing::Instrument;

/// Stack of the pools' threads: deep enough for recursive numerics.
const STACK_BYTES: usize = 8 << 20;
/// Pause after the database did not answer.
const RETRY_AFTER: Duration = Duration::from_secs(1);

/// Runs jobs in this process.
///
/// Within one pool a thread takes up parts of the job it is at before it looks for another job, so a long sweep would keep
/// everything else waiting. Therefore the jobs of one operating point have a pool of their own, and so has each sweep; between
/// pools the operating system shares the processors out. An idle pool costs nothing, so a lone job has every processor.
pub struct LocalQueue {
    shared: Arc<Shared>,
    tasks: TaskTracker,
    totals: (usize, usize),
}

struct Shared {
    config: WorkConfig,
    recorder: Recorder,
    solver: Arc<dyn Solver>,
    single_wake: Notify,
    sweep_wake: Notify,
    closing: CancellationToken,
    /// The running jobs.
    running: Mutex<HashMap<JobId, (WorkClass, Arc<Stop>)>>,
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
        let (singles, sweeps) = (config.worker_count(), config.sweep_workers as usize);
        let shared_pool = Arc::new(pool(config, "solve")?);
        let mut workers = vec![(WorkClass::Single, shared_pool); singles];
        for number in 0..sweeps {
            workers.push((WorkClass::Sweep, Arc::new(pool(config, &format!("sweep-{number}"))?)));
        }
        let shared = Arc::new(Shared {
            config: config.clone(),
            recorder,
            solver,
            single_wake: Notify::new(),
            sweep_wake: Notify::new(),
            closing: CancellationToken::new(),
            running: Mutex::default(),
        });
        let tasks = TaskTracker::new();
        for (class, pool) in workers {
            tasks.spawn(Arc::clone(&shared).work(class, pool));
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
            stop.ask(Reason::Cancel);
        }
    }

    fn workers(&self) -> Workers {
        let running = self.shared.running();
        let sweeps_busy = running.values().filter(|(class, _)| *class == WorkClass::Sweep).count();
        let (total, sweeps_total) = self.totals;
        Workers { total, busy: running.len() - sweeps_busy, sweeps_total, sweeps_busy }
    }

    fn close(&self, limit: Duration) -> Pending<'_, bool> {
        self.shared.closing.cancel();
        self.tasks.close();
        for (_, stop) in self.shared.running().values() {
            stop.ask(Reason::Shutdown);
        }
        Box::pin(async move { tokio::time::timeout(limit, self.tasks.wait()).await.is_ok() })
    }
}

impl Shared {
    async fn work(self: Arc<Self>, class: WorkClass, pool: Arc<rayon::ThreadPool>) {
        while !self.closing.is_cancelled() {
            match self.recorder.claim_next(class).await {
                Ok(Some(claim)) => {
                    // One announcement may have come for several jobs: whoever finds work wakes the next.
                    self.wake(class).notify_one();
                    let span = measure::span(&claim.job);
                    self.run(claim, class, &pool).instrument(span).await;
                }
                Ok(None) => self.pause(self.wake(class).notified()).await,
                Err(error) => {
                    tracing::error!(%error, "next job not read");
                    measure::claim_retried();
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

    async fn run(&self, claim: Claim, class: WorkClass, pool: &rayon::ThreadPool) {
        let id = claim.job.id;
        tracing::info!("job started");
        let stop = Arc::new(Stop::default());
        self.running().insert(id, (class, Arc::clone(&stop)));
        self.stop_if_asked(id, &stop).await;
        let run = Run {
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
        run.to_its_end(&claim.input).await;
        self.running().remove(&id);
    }

    /// A wish to stop may have come between the claim and the entry among the running jobs.
    async fn stop_if_asked(&self, id: JobId, stop: &Stop) {
        match self.recorder.store().job(id).await {
            Ok(Some(job)) if job.cancel_requested_at.is_some() => stop.ask(Reason::Cancel),
            Ok(_) => {}
            Err(error) => tracing::error!(job = %id, %error, "job not read"),
        }
        if self.closing.is_cancelled() {
            stop.ask(Reason::Shutdown);
        }
    }

    fn running(&self) -> std::sync::MutexGuard<'_, HashMap<JobId, (WorkClass, Arc<Stop>)>> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
