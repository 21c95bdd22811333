//! Who waits for which job, or for any: the newest state of a job is told to its subscribers, every change to those who
//! listen to all, without touching the database.

use crate::store::{JobId, JobRecord};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::broadcast::error::RecvError;
use tokio::sync::{broadcast, watch};

type Latest = Option<Arc<JobRecord>>;

/// Changes that are kept for those who listen to all jobs and are slow; older ones they miss.
const BACKLOG: usize = 256;

/// One channel per job that somebody waits for, and one for all jobs.
pub(super) struct Hub {
    channels: Mutex<HashMap<JobId, watch::Sender<Latest>>>,
    all: broadcast::Sender<News>,
}

impl Default for Hub {
    fn default() -> Self {
        Self { channels: Mutex::default(), all: broadcast::channel(BACKLOG).0 }
    }
}

/// What happened to some job.
#[derive(Debug, Clone, PartialEq)]
pub enum News {
    /// It is further on.
    Progress(Arc<JobRecord>),
    /// Anything else about it changed; it may be new.
    State(Arc<JobRecord>),
    Deleted(JobId),
    /// Several jobs were deleted at once, or this listener was too slow: what it knows is no longer true.
    Several,
}

impl Hub {
    /// Tells the subscribers of a job its new state; older news than the last is dropped.
    pub fn publish(&self, job: &JobRecord) {
        self.tell(|| News::State(Arc::new(job.clone())));
        self.publish_to_subscribers(job);
    }

    /// The same when nothing but the progress changed.
    pub fn publish_progress(&self, job: &JobRecord) {
        self.tell(|| News::Progress(Arc::new(job.clone())));
        self.publish_to_subscribers(job);
    }

    /// Tells those who listen to all jobs that a job is gone.
    pub fn publish_deletion(&self, id: JobId) {
        self.tell(|| News::Deleted(id));
    }

    /// Tells them that what they know is no longer true.
    pub fn publish_upheaval(&self) {
        self.tell(|| News::Several);
    }

    /// Hears of every later change of any job. Listen first, then list the jobs: nothing is missed then.
    pub fn listen(&self) -> Listener {
        Listener(self.all.subscribe())
    }

    fn tell(&self, news: impl FnOnce() -> News) {
        if self.all.receiver_count() > 0 {
            // Whoever listened may have left in between.
            let _ = self.all.send(news());
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

/// Hears of every change of any job, in the order in which they were told: news of one job may overtake each other, the
/// greater revision counts. One that is too slow hears [`News::Several`] in place of what it missed.
pub struct Listener(broadcast::Receiver<News>);

impl Listener {
    /// The next change. Never ends while the hub lives.
    pub async fn next(&mut self) -> News {
        match self.0.recv().await {
            Ok(news) => news,
            Err(RecvError::Lagged(_)) => News::Several,
            Err(RecvError::Closed) => std::future::pending().await,
        }
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
    #[tokio::test]
    async fn who_listens_to_all_hears_each_change_and_one_that_is_slow_that_it_missed_some() {
        let hub = Hub::default();
        let id = JobId::new();
        hub.publish(&job(id, 1));
        let mut listener = hub.listen();
        hub.publish(&job(id, 2));
        hub.publish_progress(&job(id, 3));
        hub.publish_deletion(id);
        hub.publish_upheaval();
        assert_eq!(listener.next().await, News::State(Arc::new(job(id, 2))), "not what was before");
        assert_eq!(listener.next().await, News::Progress(Arc::new(job(id, 3))));
        assert_eq!(listener.next().await, News::Deleted(id));
        assert_eq!(listener.next().await, News::Several);
        let many = i64::try_from(2 * BACKLOG).unwrap();
        (0..many).for_each(|revision| hub.publish_progress(&job(id, revision)));
        assert_eq!(listener.next().await, News::Several);
        let News::Progress(oldest) = listener.next().await else { panic!("no progress") };
        assert_eq!(oldest.revision, many / 2, "as many are kept as permitted");
    }
}
