//! Runs of claimed jobs on thread pools of this process.

use super::config::WorkConfig;
use super::job_run::JobRun;
use super::recorder::JobRecorder;
use super::running_points::EvaluateElsewhere;
use super::solver::Solver;
use super::stop_signal::{StopReason, StopSignal};
use crate::store::{Claim, JobId, WorkClass};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio_util::sync::CancellationToken;

/// Stack size of the threads of the pools, sufficient for recursive numerics.
const STACK_BYTES: usize = 8 << 20;

/// The jobs that run in this process.
pub(super) struct Runner {
    config: WorkConfig,
    recorder: JobRecorder,
    solver: Arc<dyn Solver>,
    closing: CancellationToken,
    running: Mutex<RunningJobs>,
}

type RunningJobs = HashMap<JobId, (WorkClass, Arc<StopSignal>)>;

impl Runner {
    pub(super) fn new(config: &WorkConfig, recorder: JobRecorder, solver: Arc<dyn Solver>) -> Self {
        let (config, closing) = (config.clone(), CancellationToken::new());
        Self { config, recorder, solver, closing, running: Mutex::default() }
    }

    pub(super) fn recorder(&self) -> &JobRecorder {
        &self.recorder
    }

    /// Cancelled when the process is to end.
    pub(super) fn closing(&self) -> &CancellationToken {
        &self.closing
    }

    /// Starts no further job and requests the running ones to stop.
    pub(super) fn close(&self) {
        self.closing.cancel();
        for (_, stop) in self.running().values() {
            stop.request(StopReason::Shutdown);
        }
    }

    /// Requests a job to stop, if it runs.
    pub(super) fn cancel(&self, job: JobId) {
        if let Some((_, stop)) = self.running().get(&job) {
            stop.request(StopReason::Cancel);
        }
    }

    /// Numbers of running jobs of one operating point, and of sweeps.
    pub(super) fn busy(&self) -> (usize, usize) {
        let running = self.running();
        let sweeps = running.values().filter(|(class, _)| *class == WorkClass::Sweep).count();
        (running.len() - sweeps, sweeps)
    }

    /// Runs a claimed job to its end. `rows_are_own`: the rows that are stored are of this attempt, computed on other
    /// machines. `elsewhere`: what makes evaluations on other machines.
    pub(super) async fn run_job(
        &self,
        claim: Claim,
        class: WorkClass,
        pool: &rayon::ThreadPool,
        rows_are_own: bool,
        elsewhere: Option<Arc<dyn EvaluateElsewhere>>,
    ) {
        let id = claim.job.id;
        tracing::info!("job started");
        let stop = Arc::new(StopSignal::default());
        self.running().insert(id, (class, Arc::clone(&stop)));
        self.stop_if_requested(id, &stop).await;
        let run = JobRun {
            job: claim.job,
            computed_before: claim.computed,
            class,
            rows_are_own,
            elsewhere,
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

    fn running(&self) -> MutexGuard<'_, RunningJobs> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A pool of so many threads.
///
/// # Errors
/// The threads cannot be started.
pub(super) fn pool(threads: usize, name: &str) -> Result<rayon::ThreadPool, rayon::ThreadPoolBuildError> {
    let name = name.to_owned();
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .stack_size(STACK_BYTES)
        .thread_name(move |index| format!("{name}-{index}"))
        .build()
}
