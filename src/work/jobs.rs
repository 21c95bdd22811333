//! Operations on jobs: submit, wait, cancel, delete.

#[cfg(feature = "cluster")]
use super::cluster::{ClusterConfig, NatsQueue, NatsSetup};
use super::config::WorkConfig;
use super::estimate::{Estimate, estimate};
use super::hub::{JobEventListener, JobSubscription};
use super::local_queue::LocalQueue;
use super::measure;
use super::memory::MemoryLimit;
use super::queue::{Member, Queue, Transport, WaitingWork, Workers};
use super::recorder::{Clock, JobRecorder};
use super::reuse::stored_completion;
use super::solver::Solver;
use crate::store::{
    Cancellation, Deletion, Described, JobDescription, JobId, JobRecord, NewJob, Store, StoreError, Submission,
    WorkClass,
};
use herringbone_job::DocumentError;
use herringbone_job::document::JobDocument;
use herringbone_job::drawing::Drawing;
use herringbone_job::study::CheckedJob;
use sha2::{Digest, Sha256};
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::watch;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

/// Pause before jobs of an earlier process are recovered again.
const RECOVER_AFTER: Duration = Duration::from_secs(1);

/// A job to be submitted.
#[derive(Debug, Clone)]
pub struct SubmitRequest {
    pub document: JobDocument,
    /// The client's idempotency key: submitting again with it returns the first job.
    pub idempotency_key: Option<String>,
    pub request_id: Option<String>,
    /// Trace of the request (W3C Trace Context).
    pub traceparent: Option<String>,
}

/// Failure to submit a job.
#[derive(Debug, thiserror::Error)]
pub enum SubmitError {
    #[error(transparent)]
    Document(#[from] DocumentError),
    #[error("the key was used with another document")]
    KeyReused,
    #[error("{capacity} jobs wait; no more are taken")]
    Full { capacity: u32 },
    #[error("the service is shutting down")]
    Closing,
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error("the document could not be written: {0}")]
    Unwritable(#[from] serde_json::Error),
    #[error("threads: {0}")]
    Threads(#[from] tokio::task::JoinError),
}

/// The jobs of this service. Cheap to clone.
#[derive(Clone)]
pub struct Jobs(Arc<JobsShared>);

struct JobsShared {
    recorder: JobRecorder,
    solver: Arc<dyn Solver>,
    queue: Arc<dyn Queue>,
    capacity: u32,
    drain: Duration,
    memory: MemoryLimit,
    closing: CancellationToken,
}

impl Jobs {
    /// Recovers the jobs of an earlier process and starts the workers. While the database cannot be written for a
    /// reason that may pass, a full disk, the workers wait; what is stored can be read.
    ///
    /// # Errors
    /// The database cannot be written, or the threads cannot be started.
    pub async fn start(store: Store, config: &WorkConfig, solver: Arc<dyn Solver>, clock: Clock) -> Started<Self> {
        let recorder = JobRecorder::new(store, clock);
        let recovery = Recovery::begin(&recorder, config, false).await?;
        let is_recovered = recovery.is_done.subscribe();
        let queue = LocalQueue::start(config, recorder.clone(), Arc::clone(&solver), is_recovered)?;
        let jobs = Self::with_queue(recorder, solver, Arc::new(queue), config);
        recovery.finish(&jobs);
        Ok(jobs)
    }

    /// As [`Jobs::start`], with jobs that workers on other machines compute. Those of an earlier process go on.
    ///
    /// # Errors
    /// The database cannot be written, or the threads cannot be started.
    #[cfg(feature = "cluster")]
    pub async fn start_with_workers(
        store: Store,
        (config, cluster): (&WorkConfig, &ClusterConfig),
        setup: NatsSetup,
        solver: Arc<dyn Solver>,
        clock: Clock,
    ) -> Started<Self> {
        let recorder = JobRecorder::new(store, clock);
        let recovery = Recovery::begin(&recorder, config, true).await?;
        let is_recovered = recovery.is_done.subscribe();
        let queue = NatsQueue::start(setup, (config, cluster), recorder.clone(), Arc::clone(&solver), is_recovered)?;
        let jobs = Self::with_queue(recorder, solver, Arc::new(queue), config);
        recovery.finish(&jobs);
        Ok(jobs)
    }

    /// Jobs with a queue that is running already.
    pub fn with_queue(
        recorder: JobRecorder,
        solver: Arc<dyn Solver>,
        queue: Arc<dyn Queue>,
        config: &WorkConfig,
    ) -> Self {
        let (capacity, drain) = (config.queue_capacity, config.drain());
        let memory = MemoryLimit::new(config);
        Self(Arc::new(JobsShared {
            recorder,
            solver,
            queue,
            capacity,
            drain,
            memory,
            closing: CancellationToken::new(),
        }))
    }

    pub fn store(&self) -> &Store {
        self.0.recorder.store()
    }

    pub fn workers(&self) -> Workers {
        self.0.queue.workers()
    }

    pub fn transport(&self) -> Transport {
        self.0.queue.transport()
    }

    /// The workers on other machines.
    pub fn members(&self) -> Vec<Member> {
        self.0.queue.members()
    }

    /// Work that waits for workers on other machines.
    pub fn waiting_work(&self) -> Vec<WaitingWork> {
        self.0.queue.waiting_work()
    }

    /// Largest number of queued jobs.
    pub fn capacity(&self) -> u32 {
        self.0.capacity
    }

    /// Longest wait of [`Jobs::close`].
    pub fn drain(&self) -> Duration {
        self.0.drain
    }

    pub fn solver_version(&self) -> &'static str {
        self.0.solver.version()
    }

    /// Cancelled when the service shuts down, which ends all waits.
    pub fn closing(&self) -> &CancellationToken {
        &self.0.closing
    }

    pub fn is_closing(&self) -> bool {
        self.0.closing.is_cancelled()
    }

    /// Checks a document without submitting it.
    ///
    /// # Errors
    /// [`SubmitError::Document`] when the gear is infeasible, unsupported, or needs more memory than permitted.
    pub async fn check(&self, document: JobDocument) -> Result<CheckedJob, SubmitError> {
        let (solver, memory) = (Arc::clone(&self.0.solver), self.0.memory);
        let checked = tokio::task::spawn_blocking(move || {
            let job = solver.check(document)?;
            memory.check(job.document()).map(|()| job)
        });
        Ok(checked.await??)
    }

    /// Estimates the duration of a job by similar jobs that have ended.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn estimate(&self, document: &JobDocument) -> Result<Estimate, StoreError> {
        estimate(self.store(), document, self.solver_version()).await
    }

    /// The data of a drawing of the pair of a job.
    ///
    /// # Errors
    /// [`SubmitError::Threads`] when the thread that computes it fails.
    pub async fn drawing(&self, job: CheckedJob) -> Result<Drawing, SubmitError> {
        Ok(tokio::task::spawn_blocking(move || Drawing::of(&job)).await?)
    }

    /// Submits a job: checks, stores and queues it. The job has ended already when a stored result is reused.
    ///
    /// # Errors
    /// [`SubmitError`].
    pub async fn submit(&self, request: SubmitRequest) -> Result<Submitted, SubmitError> {
        if self.is_closing() {
            return Err(SubmitError::Closing);
        }
        self.store().admit().await?;
        let SubmitRequest { document, idempotency_key, request_id, traceparent } = request;
        let document = self.check(document).await?.into_document();
        let input = serde_json::to_string(&document)?;
        let input_hash = self.0.solver.input_hash(&document);
        let solver_version = self.0.solver.version();
        let reuse = stored_completion(self.store(), &input_hash, solver_version).await?;
        let idempotency = idempotency_key.map(|key| (key, hex::encode(Sha256::digest(&input))));
        let job = NewJob {
            id: self.store().next_id(),
            kind: document.kind.as_str(),
            name: document.name,
            label: document.label,
            input,
            input_hash,
            solver_version,
            request_id,
            traceparent,
            idempotency,
        };
        match self.store().submit(job, reuse, self.0.capacity, self.0.recorder.now()).await? {
            Submission::Accepted(job) => {
                metrics::counter!("herringbone_jobs_submitted_total", "kind" => job.kind.clone()).increment(1);
                if job.reused_from.is_some() {
                    measure::record_result_reuse();
                }
                self.0.recorder.publish_submission(&job);
                if !job.state.is_ended() {
                    self.0.queue.announce(job.id, WorkClass::of_kind(&job.kind));
                }
                Ok(Submitted { job, replayed: false })
            }
            Submission::Replayed(job) => Ok(Submitted { job, replayed: true }),
            Submission::KeyReused => Err(SubmitError::KeyReused),
            Submission::Full => Err(SubmitError::Full { capacity: self.0.capacity }),
        }
    }

    /// Waits until `condition` holds for a job, for `limit` at most or until the shutdown, and returns the job; `None`
    /// when it does not exist. Holds no database connection meanwhile.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn wait(
        &self,
        id: JobId,
        limit: Duration,
        condition: impl Fn(&JobRecord) -> bool,
    ) -> Result<Option<JobRecord>, StoreError> {
        let deadline = Instant::now() + limit;
        let mut changes = self.subscribe(id);
        let Some(mut job) = self.store().job(id).await? else { return Ok(None) };
        while !condition(&job) {
            tokio::select! {
                newer = changes.after(job.revision) => job = newer.as_ref().clone(),
                () = tokio::time::sleep_until(deadline) => break,
                () = self.0.closing.cancelled() => break,
            }
        }
        Ok(Some(job))
    }

    /// Subscribes to later changes of a job.
    pub fn subscribe(&self, id: JobId) -> JobSubscription {
        self.0.recorder.subscribe(id)
    }

    /// Listens to later events of all jobs.
    pub fn listen(&self) -> JobEventListener {
        self.0.recorder.listen()
    }

    /// Cancels a queued job, or requests a running one to stop.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn cancel(&self, id: JobId) -> Result<Cancellation, StoreError> {
        let cancellation = self.0.recorder.cancel(id).await?;
        if let Cancellation::Requested(_) = &cancellation {
            self.0.queue.stop(id);
        }
        Ok(cancellation)
    }

    /// Changes name, label or notes of a job.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn describe(&self, id: JobId, description: &JobDescription) -> Result<Described, StoreError> {
        self.0.recorder.describe(id, description).await
    }

    /// Deletes an ended job with its result, series and history.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn delete(&self, id: JobId) -> Result<Deletion, StoreError> {
        self.0.recorder.delete(id).await
    }

    /// Notifies listeners that the list of jobs is to be read again.
    pub(super) fn publish_resync(&self) {
        self.0.recorder.publish_resync();
    }

    /// Refuses further jobs, stops the running ones (they run again after the restart) and waits for them, for the
    /// configured time at most. Returns whether all have stopped.
    pub async fn close(&self) -> bool {
        self.0.closing.cancel();
        self.0.queue.close(self.0.drain).await
    }
}

/// The jobs, started.
type Started<T> = Result<T, Box<dyn std::error::Error + Send + Sync>>;

/// Takes up the jobs that were running or queued when the last process ended, later if the database refuses now.
struct Recovery {
    max_losses: u32,
    keep_distributed: bool,
    is_done: watch::Sender<bool>,
    refusal: Option<StoreError>,
}

impl Recovery {
    /// `keep_distributed`: jobs that workers on other machines compute go on.
    async fn begin(recorder: &JobRecorder, config: &WorkConfig, keep_distributed: bool) -> Result<Self, StoreError> {
        let max_losses = config.max_losses;
        let refusal = match recover(recorder, max_losses, keep_distributed).await {
            Ok(()) => None,
            Err(error) if error.unavailable().is_some() => Some(error),
            Err(error) => return Err(error),
        };
        Ok(Self { max_losses, keep_distributed, is_done: watch::Sender::new(refusal.is_none()), refusal })
    }

    /// Goes on with the recovery if the database refused.
    fn finish(self, jobs: &Jobs) {
        if let Some(error) = &self.refusal {
            tracing::error!(%error, "jobs of an earlier run not taken up; none runs until the database can be written");
            tokio::spawn(self.try_later(jobs.clone()));
        }
    }

    /// Tries until it succeeds, then lets the workers begin.
    async fn try_later(self, jobs: Jobs) {
        loop {
            tokio::select! {
                () = tokio::time::sleep(RECOVER_AFTER) => {}
                () = jobs.closing().cancelled() => return,
            }
            match recover(&jobs.0.recorder, self.max_losses, self.keep_distributed).await {
                Ok(()) => break,
                Err(error) => tracing::debug!(%error, "jobs of an earlier run not taken up"),
            }
        }
        jobs.publish_resync();
        self.is_done.send_replace(true);
    }
}

async fn recover(recorder: &JobRecorder, max_losses: u32, keep_distributed: bool) -> Result<(), StoreError> {
    let recovery = recorder.store().recover(max_losses, keep_distributed, recorder.now()).await?;
    if recovery.queued > 0 || recovery.given_up > 0 || recovery.canceled > 0 {
        let (waiting, requeued, given_up) = (recovery.queued, recovery.requeued, recovery.given_up);
        tracing::info!(waiting, requeued, given_up, canceled = recovery.canceled, "jobs of an earlier run taken up");
    }
    Ok(())
}

/// An accepted job.
#[derive(Debug, Clone, PartialEq)]
pub struct Submitted {
    pub job: JobRecord,
    /// Whether the submission is a repetition.
    pub replayed: bool,
}
