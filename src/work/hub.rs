//! Who waits for which job: the newest state of a job is told to its subscribers, without touching the database.

use crate::store::{JobId, JobRecord};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::watch;

type Latest = Option<Arc<JobRecord>>;

/// One channel per job that somebody waits for.
#[derive(Default)]
pub(super) struct Hub {
    channels: Mutex<HashMap<JobId, watch::Sender<Latest>>>,
}

impl Hub {
    /// Tells the subscribers of a job its new state; older news than the last is dropped.
    pub fn publish(&self, job: &JobRecord) {
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

    /// Hears of every later change. Subscribe first, then read the job from the store: nothing is missed then.
    pub fn subscribe(self: &Arc<Self>, job: JobId) -> Subscription {
        let mut channels = self.channels.lock().unwrap_or_else(PoisonError::into_inner);
        let receiver = channels.entry(job).or_insert_with(|| watch::channel(None).0).subscribe();
        Subscription { job, receiver, hub: Arc::clone(self) }
    }

    fn leave(&self, job: JobId) {
        let mut channels = self.channels.lock().unwrap_or_else(PoisonError::into_inner);
        // The leaving subscription's own receiver still counts.
        if channels.get(&job).is_some_and(|channel| channel.receiver_count() <= 1) {
            channels.remove(&job);
        }
    }

    #[cfg(test)]
    fn len(&self) -> usize {
        self.channels.lock().unwrap_or_else(PoisonError::into_inner).len()
    }
}

/// Hears of a job's changes; a slow listener hears only of the newest.
pub struct Subscription {
    job: JobId,
    receiver: watch::Receiver<Latest>,
    hub: Arc<Hub>,
}

impl Subscription {
    /// The next change after `revision`. Never ends for a job that never changes.
    pub async fn after(&mut self, revision: i64) -> Arc<JobRecord> {
        let newer = |latest: &Latest| latest.as_ref().is_some_and(|job| job.revision > revision);
        match self.receiver.wait_for(newer).await {
            Ok(latest) => {
                if let Some(job) = latest.as_ref() {
                    return Arc::clone(job);
                }
            }
            // The sender lives in the hub as long as this subscription does.
            Err(_closed) => {}
        }
        std::future::pending().await
    }
}

impl Drop for Subscription {
    fn drop(&mut self) {
        self.hub.leave(self.job);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::State;

    fn job(id: JobId, revision: i64) -> JobRecord {
        JobRecord {
            id,
            kind: "mesh".into(),
            name: None,
            label: None,
            state: State::Running,
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
        }
    }

    #[tokio::test]
    async fn subscribers_hear_the_newest_and_channels_go_with_the_last_of_them() {
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
}
