//! Changes of a job's state: stored, published and counted.

use super::hub::{Hub, JobEventListener, JobSubscription};
use super::measure;
use crate::store::{
    Cancellation, Claim, Completion, Deletion, Described, Failure, JobDescription, JobId, JobRecord, JobState,
    PointBatch, ReleaseReason, SampleBatch, Store, StoreError, WorkClass,
};
use jiff::Timestamp;
use std::sync::Arc;
use std::time::Duration;

/// The source of times, replaceable in tests.
pub type Clock = Arc<dyn Fn() -> Timestamp + Send + Sync>;

/// Stores and publishes all changes of the state of jobs. Cheap to clone.
#[derive(Clone)]
pub struct JobRecorder {
    store: Store,
    hub: Arc<Hub>,
    clock: Clock,
}

impl JobRecorder {
    pub fn new(store: Store, clock: Clock) -> Self {
        Self { store, hub: Arc::default(), clock }
    }

    pub fn store(&self) -> &Store {
        &self.store
    }

    pub fn now(&self) -> Timestamp {
        (self.clock)()
    }

    /// Subscribes to later changes of a job.
    pub fn subscribe(&self, job: JobId) -> JobSubscription {
        self.hub.subscribe(job)
    }

    /// Listens to later events of all jobs.
    pub fn listen(&self) -> JobEventListener {
        self.hub.listen()
    }

    /// Publishes a submitted job, which may have ended already.
    pub fn publish_submission(&self, job: &JobRecord) {
        self.hub.publish(job);
    }

    /// Deletes an ended job.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn delete(&self, id: JobId) -> Result<Deletion, StoreError> {
        let deletion = self.store.delete(id).await?;
        if deletion == Deletion::Deleted {
            self.hub.publish_deletion(id);
        }
        Ok(deletion)
    }

    /// Changes name, label or notes of a job.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn describe(&self, id: JobId, description: &JobDescription) -> Result<Described, StoreError> {
        let described = self.store.describe(id, description).await?;
        if let Described::Changed(job) = &described {
            self.hub.publish(job);
            if description.label.is_some() {
                // Who listens to the jobs of the former label is not told of the job any more.
                self.hub.publish_resync();
            }
        }
        Ok(described)
    }

    /// Notifies listeners that the list of jobs is to be read again.
    pub fn publish_resync(&self) {
        self.hub.publish_resync();
    }

    /// Claims the next job of this class.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn claim_next(&self, class: WorkClass) -> Result<Option<Claim>, StoreError> {
        let claim = self.store.claim_next(class, self.now()).await?;
        if let Some(claim) = &claim {
            measure::record_start(&claim.job);
            self.hub.publish(&claim.job);
        }
        Ok(claim)
    }

    /// Stores the progress of a running job, and points that were solved.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn progress(
        &self,
        job: &JobRecord,
        stage: &str,
        fraction: f64,
        points: &PointBatch,
    ) -> Result<(), StoreError> {
        if let Some(job) = self.store.progress(job.id, job.attempt, stage, fraction, points).await? {
            self.hub.publish_progress(&job);
        }
        Ok(())
    }

    /// Stores samples of a running job before its result. False when the job no longer belongs to this attempt, or is
    /// to be canceled.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn save_samples(&self, job: &JobRecord, batch: &SampleBatch) -> Result<bool, StoreError> {
        self.store.save_samples(job.id, job.attempt, batch).await
    }

    /// Stores the result of a running job. False when the job whose result was to be reused was deleted, or when the
    /// job no longer belongs to this attempt or is to be canceled.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn succeed(&self, job: &JobRecord, completion: &Completion) -> Result<bool, StoreError> {
        let done = self.store.succeed(job.id, job.attempt, completion, self.now()).await?;
        if done.is_some() && completion.reused_from.is_some() {
            measure::record_result_reuse();
        }
        Ok(self.publish_end(done))
    }

    /// Stores the failure of a running job. False when the job no longer belongs to this attempt.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn fail(&self, job: &JobRecord, failure: &Failure) -> Result<bool, StoreError> {
        let failed = self.store.fail(job.id, job.attempt, failure, self.now()).await?;
        Ok(self.publish_end(failed))
    }

    /// Returns a job that was stopped: to canceled if that was requested, else to the queue.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn release(
        &self,
        job: &JobRecord,
        reason: ReleaseReason,
        computed: Duration,
    ) -> Result<Option<JobState>, StoreError> {
        let released = self.store.release(job.id, job.attempt, reason, computed, self.now()).await?;
        let state = released.as_ref().map(|job| job.state);
        self.publish_end(released);
        Ok(state)
    }

    /// Cancels a queued job, or records the request on a running one.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn cancel(&self, id: JobId) -> Result<Cancellation, StoreError> {
        let cancellation = self.store.cancel(id, self.now()).await?;
        match &cancellation {
            Cancellation::Canceled(job) => {
                self.publish_end(Some(job.clone()));
            }
            Cancellation::Requested(job) => self.hub.publish(job),
            Cancellation::Ended(_) | Cancellation::NotFound => {}
        }
        Ok(cancellation)
    }

    /// Publishes and counts a job that has ended, as results of other machines say.
    pub fn publish_ended(&self, job: JobRecord) {
        self.publish_end(Some(job));
    }

    /// Publishes a changed job. Returns whether there is one.
    fn publish(&self, job: Option<JobRecord>) -> bool {
        if let Some(job) = &job {
            self.hub.publish(job);
        }
        job.is_some()
    }

    /// Publishes a job after a transition, and counts it if it has ended. Returns whether there is one.
    fn publish_end(&self, job: Option<JobRecord>) -> bool {
        if let Some(job) = job.as_ref().filter(|job| job.state.is_ended()) {
            tracing::info!(job = %job.id, state = job.state.as_str(), "job ended");
            let labels = [("kind", job.kind.clone()), ("state", job.state.as_str().to_owned())];
            metrics::counter!("herringbone_jobs_ended_total", &labels).increment(1);
            if let (Some(started_at), Some(ended_at)) = (job.started_at, job.ended_at) {
                let seconds = ended_at.duration_since(started_at).as_secs_f64().max(0.0);
                metrics::histogram!("herringbone_job_duration_seconds", &labels).record(seconds);
            }
        }
        self.publish(job)
    }
}
