//! What one can do with jobs: submit, wait for, cancel.

use super::config::WorkConfig;
use super::hub::{Listener, Subscription};
use super::local::LocalQueue;
use super::measure;
use super::memory::MemoryBound;
use super::queue::{Queue, Workers};
use super::recorder::{Clock, Recorder};
use super::reuse::stored_completion;
use super::solver::Solver;
use crate::store::{Cancellation, Deletion, JobId, JobRecord, NewJob, Store, StoreError, Submission, WorkClass};
use herringbone_job::DocumentError;
use herringbone_job::document::JobDocument;
use herringbone_job::drawing::Drawing;
use herringbone_job::study::CheckedJob;
use sha2::{Digest, Sha256};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

/// A job to be submitted.
#[derive(Debug, Clone)]
pub struct SubmitRequest {
    pub document: JobDocument,
    /// The client's name for this submission; submitting again under it answers the first job.
    pub idempotency_key: Option<String>,
    pub request_id: Option<String>,
}

/// Why a job was not accepted.
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

/// Everything that happens to jobs. Cheap to clone.
#[derive(Clone)]
pub struct Jobs(Arc<Inner>);

struct Inner {
    recorder: Recorder,
    solver: Arc<dyn Solver>,
    queue: Arc<dyn Queue>,
    capacity: u32,
    drain: Duration,
    memory: MemoryBound,
    closing: CancellationToken,
}

impl Jobs {
    /// Takes up what a dead process left and starts the workers of this process.
    ///
    /// # Errors
    /// When the store does not answer or the threads cannot be started.
    pub async fn start(
        store: Store,
        config: &WorkConfig,
        solver: Arc<dyn Solver>,
        clock: Clock,
    ) -> Result<Self, Box<dyn std::error::Error + Send + Sync>> {
        let recovery = store.recover(config.max_losses, clock()).await?;
        if recovery.waiting > 0 || recovery.given_up > 0 || recovery.canceled > 0 {
            let (waiting, requeued, given_up) = (recovery.waiting, recovery.requeued, recovery.given_up);
            tracing::info!(
                waiting,
                requeued,
                given_up,
                canceled = recovery.canceled,
                "jobs of an earlier run taken up"
            );
        }
        let recorder = Recorder::new(store, clock);
        let queue = LocalQueue::start(config, recorder.clone(), Arc::clone(&solver))?;
        Ok(Self::over(recorder, solver, Arc::new(queue), config))
    }

    /// As [`Jobs::start`], over a queue that runs already.
    pub fn over(recorder: Recorder, solver: Arc<dyn Solver>, queue: Arc<dyn Queue>, config: &WorkConfig) -> Self {
        let (capacity, drain) = (config.queue_capacity, config.drain());
        let memory = MemoryBound::new(config);
        Self(Arc::new(Inner { recorder, solver, queue, capacity, drain, memory, closing: CancellationToken::new() }))
    }

    pub fn store(&self) -> &Store {
        self.0.recorder.store()
    }

    pub fn workers(&self) -> Workers {
        self.0.queue.workers()
    }

    /// Jobs that may wait.
    pub fn capacity(&self) -> u32 {
        self.0.capacity
    }

    /// How long [`Jobs::close`] waits at most.
    pub fn drain(&self) -> Duration {
        self.0.drain
    }

    pub fn solver_version(&self) -> &'static str {
        self.0.solver.version()
    }

    /// Canceled when the service shuts down: whoever waits stops waiting then.
    pub fn closing(&self) -> &CancellationToken {
        &self.0.closing
    }

    pub fn is_closing(&self) -> bool {
        self.0.closing.is_cancelled()
    }

    /// Checks a document, without a job.
    ///
    /// # Errors
    /// [`SubmitError::Document`] when the gear cannot exist, is not supported, or would take more memory than one job may.
    pub async fn check(&self, document: JobDocument) -> Result<CheckedJob, SubmitError> {
        let (solver, memory) = (Arc::clone(&self.0.solver), self.0.memory);
        let checked = tokio::task::spawn_blocking(move || {
            let job = solver.check(document)?;
            memory.check(job.document()).map(|()| job)
        });
        Ok(checked.await??)
    }

    /// The pair of a job to scale.
    ///
    /// # Errors
    /// When the thread that draws fails.
    pub async fn drawing(&self, job: CheckedJob) -> Result<Drawing, SubmitError> {
        Ok(tokio::task::spawn_blocking(move || Drawing::of(&job)).await?)
    }

    /// Accepts a job: checks it, writes it, and has it run; the job has ended already when its result was there.
    ///
    /// # Errors
    /// [`SubmitError`].
    pub async fn submit(&self, request: SubmitRequest) -> Result<Submitted, SubmitError> {
        if self.is_closing() {
            return Err(SubmitError::Closing);
        }
        self.store().admit().await?;
        let SubmitRequest { document, idempotency_key, request_id } = request;
        let document = self.check(document).await?.into_document();
        let input = serde_json::to_string(&document)?;
        let input_hash = self.0.solver.input_hash(&document);
        let solver_version = self.0.solver.version();
        let reuse = stored_completion(self.store(), &input_hash, solver_version).await?;
        let idempotency = idempotency_key.map(|key| (key, hash_of(&input)));
        let job = NewJob {
            id: self.store().next_id(),
            kind: document.kind.as_str(),
            name: document.name,
            label: document.label,
            input,
            input_hash,
            solver_version,
            request_id,
            idempotency,
        };
        match self.store().submit(job, reuse, self.0.capacity, self.0.recorder.now()).await? {
            Submission::Accepted(job) => {
                metrics::counter!("herringbone_jobs_submitted_total", "kind" => job.kind.clone()).increment(1);
                if job.reused_from.is_some() {
                    measure::result_reused();
                }
                self.0.recorder.submitted(&job);
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

    /// The job as soon as `enough` holds for it, or as it is after `limit` or at the shutdown; holds no database connection meanwhile.
    ///
    /// # Errors
    /// When the store does not answer.
    pub async fn wait(
        &self,
        id: JobId,
        limit: Duration,
        enough: impl Fn(&JobRecord) -> bool,
    ) -> Result<Option<JobRecord>, StoreError> {
        let deadline = Instant::now() + limit;
        let mut changes = self.subscribe(id);
        let Some(mut job) = self.store().job(id).await? else { return Ok(None) };
        while !enough(&job) {
            tokio::select! {
                newer = changes.after(job.revision) => job = newer.as_ref().clone(),
                () = tokio::time::sleep_until(deadline) => break,
                () = self.0.closing.cancelled() => break,
            }
        }
        Ok(Some(job))
    }

    /// Hears of every later change of a job.
    pub fn subscribe(&self, id: JobId) -> Subscription {
        self.0.recorder.subscribe(id)
    }

    /// Hears of every later change of any job.
    pub fn listen(&self) -> Listener {
        self.0.recorder.listen()
    }

    /// Cancels a job that waits, asks one that runs to stop.
    ///
    /// # Errors
    /// When the store does not answer.
    pub async fn cancel(&self, id: JobId) -> Result<Cancellation, StoreError> {
        let cancellation = self.0.recorder.cancel(id).await?;
        if let Cancellation::Asked(_) = &cancellation {
            self.0.queue.stop(id);
        }
        Ok(cancellation)
    }

    /// Deletes an ended job with everything it left.
    ///
    /// # Errors
    /// When the store does not answer.
    pub async fn delete(&self, id: JobId) -> Result<Deletion, StoreError> {
        self.0.recorder.delete(id).await
    }

    /// Tells those who listen that many jobs were deleted at once.
    pub(super) fn deleted_several(&self) {
        self.0.recorder.deleted_several();
    }

    /// Takes no more jobs, stops the running ones (they run again after the restart) and waits for them within the
    /// configured limit. True when all had stopped.
    pub async fn close(&self) -> bool {
        self.0.closing.cancel();
        self.0.queue.close(self.0.drain).await
    }
}

/// An accepted job.
#[derive(Debug, Clone, PartialEq)]
pub struct Submitted {
    pub job: JobRecord,
    /// Whether the same submission had been made before.
    pub replayed: bool,
}

fn hash_of(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}
