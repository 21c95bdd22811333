//! The state shared by handlers.

use super::config::MAX_SERIES_IN_MEMORY;
use super::telemetry;
use crate::work::Jobs;
use jiff::Timestamp;
use metrics_exporter_prometheus::PrometheusHandle;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Jobs, metrics and the time of the start. Cheap to clone.
#[derive(Clone)]
pub struct AppState {
    shared: Arc<AppShared>,
    follower_permits: Arc<Semaphore>,
    series_permits: Arc<Semaphore>,
}

struct AppShared {
    jobs: Jobs,
    metrics: PrometheusHandle,
    started_at: Timestamp,
}

impl AppState {
    /// The state of a service with these jobs, started at `started_at`.
    pub fn new(jobs: Jobs, started_at: Timestamp) -> Self {
        let shared = Arc::new(AppShared { jobs, metrics: telemetry::recorder(), started_at });
        let semaphore = |permits| Arc::new(Semaphore::new(permits));
        Self {
            shared,
            follower_permits: semaphore(Semaphore::MAX_PERMITS),
            series_permits: semaphore(MAX_SERIES_IN_MEMORY),
        }
    }

    /// Returns this state with a bound on the clients that follow jobs.
    pub(super) fn with_max_followers(self, limit: usize) -> Self {
        Self { follower_permits: Arc::new(Semaphore::new(limit)), ..self }
    }

    pub fn jobs(&self) -> &Jobs {
        &self.shared.jobs
    }

    pub(super) fn metrics(&self) -> &PrometheusHandle {
        &self.shared.metrics
    }

    pub(super) fn started_at(&self) -> Timestamp {
        self.shared.started_at
    }

    /// The permit of a client that follows a job (an event stream, a wait for its end); `None` when all are taken. The
    /// bound keeps connections free for other requests.
    pub(super) fn follower_permit(&self) -> Option<OwnedSemaphorePermit> {
        self.follower_permits.clone().try_acquire_owned().ok()
    }

    /// Waits for the permit to hold a series in memory; to be kept until the response was sent.
    pub(super) async fn series_permit(&self) -> Option<OwnedSemaphorePermit> {
        self.series_permits.clone().acquire_owned().await.ok()
    }
}
