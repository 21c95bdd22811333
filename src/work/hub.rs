//! Events of jobs: the newest state of a job for its subscribers, and every change for listeners of all jobs. No
//! database access.

use crate::store::{JobId, JobRecord};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{broadcast, watch};

type LatestRecord = Option<Arc<JobRecord>>;

/// Number of events buffered for slow listeners; older ones are dropped.
const BACKLOG: usize = 256;

/// One channel for each job with subscribers, and one for the events of all jobs.
pub(super) struct Hub {
    channels: Mutex<HashMap<JobId, watch::Sender<LatestRecord>>>,
    all: broadcast::Sender<JobEvent>,
}

impl Default for Hub {
    fn default() -> Self {
        Self { channels: Mutex::default(), all: broadcast::channel(BACKLOG).0 }
    }
}

/// A change of some job.
#[derive(Debug, Clone, PartialEq)]
pub enum JobEvent {
    /// Only its progress changed.
    Progress(Arc<JobRecord>),
    /// Anything else changed, or the job is new.
    Changed(Arc<JobRecord>),
    Deleted(JobId),
    /// Several jobs were deleted, or events were dropped: the list of jobs is to be read again.
    Resync,
}

impl Hub {
    /// Publishes the new state of a job; subscribers ignore a revision older than the last.
    pub(super) fn publish(&self, job: &JobRecord) {
        self.broadcast(|| JobEvent::Changed(Arc::new(job.clone())));
        self.publish_to_subscribers(job);
    }

    /// As [`Hub::publish`], when only the progress changed.
    pub(super) fn publish_progress(&self, job: &JobRecord) {
        self.broadcast(|| JobEvent::Progress(Arc::new(job.clone())));
        self.publish_to_subscribers(job);
    }

    /// Publishes the deletion of a job.
    pub(super) fn publish_deletion(&self, id: JobId) {
        self.broadcast(|| JobEvent::Deleted(id));
    }

    /// Publishes [`JobEvent::Resync`]: listeners read the list of jobs again.
    pub(super) fn publish_resync(&self) {
        self.broadcast(|| JobEvent::Resync);
    }

    /// Listens to all later events. To miss none, listen first, then list the jobs.
    pub(super) fn listen(&self) -> JobEventListener {
        JobEventListener(self.all.subscribe())
    }

    fn broadcast(&self, event: impl FnOnce() -> JobEvent) {
        if self.all.receiver_count() > 0 {
            // Fails when the last listener was dropped meanwhile.
            let _ = self.all.send(event());
        }
    }

    fn publish_to_subscribers(&self, job: &JobRecord) {
        let channels = self.channels.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(channel) = channels.get(&job.id) {
            channel.send_if_modified(|latest| {
                let newer = latest.as_ref().is_none_or(|known| known.revision < job.revision);
                if newer {
                    *latest = Some(Arc::new(job.clone()));
                }
                newer
            });
        }
    }

    /// Subscribes to later changes of a job. To miss none, subscribe first, then read the job from the store.
    pub(super) fn subscribe(self: &Arc<Self>, job: JobId) -> JobSubscription {
        let mut channels = self.channels.lock().unwrap_or_else(PoisonError::into_inner);
        let receiver = channels.entry(job).or_insert_with(|| watch::channel(None).0).subscribe();
        JobSubscription { job, receiver, hub: Arc::clone(self) }
    }

    fn unsubscribe(&self, job: JobId) {
        let mut channels = self.channels.lock().unwrap_or_else(PoisonError::into_inner);
        // The receiver of this subscription is still counted.
        if channels.get(&job).is_some_and(|channel| channel.receiver_count() <= 1) {
            channels.remove(&job);
        }
    }

    #[cfg(test)]
    fn len(&self) -> usize {
        self.channels.lock().unwrap_or_else(PoisonError::into_inner).len()
    }
}

/// A subscription to the changes of a job; a slow subscriber receives only the newest.
pub struct JobSubscription {
    job: JobId,
    receiver: watch::Receiver<LatestRecord>,
    hub: Arc<Hub>,
}

impl JobSubscription {
    /// Waits for a record with a revision after `revision`.
    pub async fn after(&mut self, revision: i64) -> Arc<JobRecord> {
        let newer = |latest: &LatestRecord| latest.as_ref().is_some_and(|job| job.revision > revision);
        match self.receiver.wait_for(newer).await {
            Ok(latest) => {
                if let Some(job) = latest.as_ref() {
                    return Arc::clone(job);
                }
            }
            // The sender lives as long as this subscription.
            Err(_closed) => {}
        }
        std::future::pending().await
    }
}

impl Drop for JobSubscription {
    fn drop(&mut self) {
        self.hub.unsubscribe(self.job);
    }
}

/// A listener to the events of all jobs, in the order of their publication: events of one job may be out of order, the
/// greater revision is newer. Dropped events are replaced by [`JobEvent::Resync`].
pub struct JobEventListener(broadcast::Receiver<JobEvent>);

impl JobEventListener {
    /// Waits for the next event.
    pub async fn next(&mut self) -> JobEvent {
        match self.0.recv().await {
            Ok(event) => event,
            Err(RecvError::Lagged(_)) => JobEvent::Resync,
            Err(RecvError::Closed) => std::future::pending().await,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{Headline, JobState};

    fn job(id: JobId, revision: i64) -> JobRecord {
        JobRecord {
            id,
            kind: "mesh".into(),
            name: None,
            label: None,
            notes: None,
            state: JobState::Running,
            revision,
            attempt: 1,
            progress: 0.0,
            stage: None,
            input_hash: String::new(),
            solver_version: String::new(),
            submitted_at: jiff::Timestamp::UNIX_EPOCH,
            started_at: None,
            ended_at: None,
            cancel_requested_at: None,
            error: None,
            reused_from: None,
            request_id: None,
            traceparent: None,
            headline: Headline::default(),
        }
    }

    #[tokio::test]
    async fn subscribers_receive_the_newest_record_and_channels_are_dropped_with_the_last_of_them() {
        let hub = Arc::new(Hub::default());
        let id = JobId::new();
        hub.publish(&job(id, 1));
        assert_eq!(hub.len(), 0, "nobody listens");
        let mut first = hub.subscribe(id);
        let second = hub.subscribe(id);
        hub.publish(&job(id, 3));
        hub.publish(&job(id, 2));
        assert_eq!(first.after(1).await.revision, 3);
        assert_eq!(hub.len(), 1);
        drop(second);
        assert_eq!(hub.len(), 1);
        drop(first);
        assert_eq!(hub.len(), 0);
    }
    #[tokio::test]
    async fn listeners_receive_each_event_and_slow_ones_a_resync() {
        let hub = Hub::default();
        let id = JobId::new();
        hub.publish(&job(id, 1));
        let mut listener = hub.listen();
        hub.publish(&job(id, 2));
        hub.publish_progress(&job(id, 3));
        hub.publish_deletion(id);
        hub.publish_resync();
        assert_eq!(listener.next().await, JobEvent::Changed(Arc::new(job(id, 2))), "not what was before");
        assert_eq!(listener.next().await, JobEvent::Progress(Arc::new(job(id, 3))));
        assert_eq!(listener.next().await, JobEvent::Deleted(id));
        assert_eq!(listener.next().await, JobEvent::Resync);
        let many = i64::try_from(2 * BACKLOG).unwrap();
        (0..many).for_each(|revision| hub.publish_progress(&job(id, revision)));
        assert_eq!(listener.next().await, JobEvent::Resync);
        let JobEvent::Progress(oldest) = listener.next().await else { panic!("no progress") };
        assert_eq!(oldest.revision, many / 2, "as many are buffered as permitted");
    }
}
