//! Writes what becomes of a job and tells it to whoever waits; the only way in which a job's state changes.

use super::hub::{Hub, Listener, Subscription};
use super::measure;
use crate::store::{
    Cancellation, Claim, Completion, Deletion, Failure, JobId, JobRecord, Pause, PointBatch, State, Store, StoreError,
    WorkClass,
};
use jiff::Timestamp;
use std::sync::Arc;
use std::time::Duration;

/// Where times come from; fixed in tests that need it.
pub type Clock = Arc<dyn Fn() -> Timestamp + Send + Sync>;

/// Store, subscribers and clock.
#[derive(Clone)]
pub struct Recorder {
    store: Store,
    hub: Arc<Hub>,
    clock: Clock,
}

impl Recorder {
    pub fn new(store: Store, clock: Clock) -> Self {
        Self { store, hub: Arc::default(), clock }
    }

    pub fn store(&self) -> &Store {
        &self.store
    }

    pub fn now(&self) -> Timestamp {
        (self.clock)()
    }

    /// Hears of every later change of a job.
    pub fn subscribe(&self, job: JobId) -> Subscription {
        self.hub.subscribe(job)
    }

    /// Hears of every later change of any job.
    pub fn listen(&self) -> Listener {
        self.hub.listen()
    }

    /// A job was submitted; it may have ended already.
    pub fn submitted(&self, job: &JobRecord) {
        self.hub.publish(job);
    }

    /// Deletes an ended job.
    pub async fn delete(&self, id: JobId) -> Result<Deletion, StoreError> {
        let deletion = self.store.delete(id).await?;
        if deletion == Deletion::Deleted {
            self.hub.publish_deletion(id);
        }
        Ok(deletion)
    }

    /// Many jobs were deleted at once.
    pub fn deleted_several(&self) {
        self.hub.publish_upheaval();
    }

    /// Takes the next job of this class in line.
    pub async fn claim_next(&self, class: WorkClass) -> Result<Option<Claim>, StoreError> {
        let claim = self.store.claim_next(class, self.now()).await?;
        if let Some(claim) = &claim {
            measure::started(&claim.job);
            self.hub.publish(&claim.job);
        }
        Ok(claim)
    }

    /// How far a running job is, with the points that were solved meanwhile.
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

    /// False when the job whose result was to be reused is gone, or the job is no longer this attempt's.
    pub async fn succeed(&self, job: &JobRecord, completion: &Completion) -> Result<bool, StoreError> {
        let done = self.store.succeed(job.id, job.attempt, completion, self.now()).await?;
        if done.is_some() && completion.reused_from.is_some() {
            measure::result_reused();
        }
        Ok(self.ended(done))
    }

    pub async fn fail(&self, job: &JobRecord, failure: &Failure) -> Result<bool, StoreError> {
        let failed = self.store.fail(job.id, job.attempt, failure, self.now()).await?;
        Ok(self.ended(failed))
    }

    /// The worker stopped before the end: canceled if that was asked for, else queued again.
    pub async fn release(
        &self,
        job: &JobRecord,
        pause: Pause,
        computed: Duration,
    ) -> Result<Option<State>, StoreError> {
        let released = self.store.release(job.id, job.attempt, pause, computed, self.now()).await?;
        let state = released.as_ref().map(|job| job.state);
        self.ended(released);
        Ok(state)
    }

    pub async fn cancel(&self, id: JobId) -> Result<Cancellation, StoreError> {
        let cancellation = self.store.cancel(id, self.now()).await?;
        match &cancellation {
            Cancellation::Canceled(job) => {
                self.ended(Some(job.clone()));
            }
            Cancellation::Asked(job) => self.hub.publish(job),
            Cancellation::Ended(_) | Cancellation::NotFound => {}
        }
        Ok(cancellation)
    }

    fn told(&self, job: Option<JobRecord>) -> bool {
        if let Some(job) = &job {
            self.hub.publish(job);
        }
        job.is_some()
    }

    fn ended(&self, job: Option<JobRecord>) -> bool {
        if let Some(job) = job.as_ref().filter(|job| job.state.is_ended()) {
            tracing::info!(job = %job.id, state = job.state.word(), "job ended");
            let labels = [("kind", job.kind.clone()), ("state", job.state.word().to_owned())];
            metrics::counter!("herringbone_jobs_ended_total", &labels).increment(1);
            if let (Some(started_at), Some(ended_at)) = (job.started_at, job.ended_at) {
                let seconds = ended_at.duration_since(started_at).as_secs_f64().max(0.0);
                metrics::histogram!("herringbone_job_duration_seconds", &labels).record(seconds);
            }
        }
        self.told(job)
    }
}
