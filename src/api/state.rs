//! What handlers are given.

use super::config::SERIES_AT_ONCE;
use super::telemetry;
use crate::work::Jobs;
use jiff::Timestamp;
use metrics_exporter_prometheus::PrometheusHandle;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Jobs, metrics and the time of the start. Cheap to clone.
#[derive(Clone)]
pub struct AppState {
    inner: Arc<Inner>,
    followers: Arc<Semaphore>,
    series: Arc<Semaphore>,
}

struct Inner {
    jobs: Jobs,
    metrics: PrometheusHandle,
    started_at: Timestamp,
}

impl AppState {
    /// The state of a service over these jobs, started now.
    pub fn new(jobs: Jobs, started_at: Timestamp) -> Self {
        let inner = Arc::new(Inner { jobs, metrics: telemetry::recorder(), started_at });
        let semaphore = |permits| Arc::new(Semaphore::new(permits));
        Self { inner, followers: semaphore(Semaphore::MAX_PERMITS), series: semaphore(SERIES_AT_ONCE) }
    }

    /// The same with a bound on clients that follow jobs.
    pub(super) fn with_followers(self, limit: usize) -> Self {
        Self { followers: Arc::new(Semaphore::new(limit)), ..self }
    }

    pub fn jobs(&self) -> &Jobs {
        &self.inner.jobs
    }

    pub(super) fn metrics(&self) -> &PrometheusHandle {
        &self.inner.metrics
    }

    pub(super) fn started_at(&self) -> Timestamp {
        self.inner.started_at
    }

    /// A place among the clients that follow a job (an event stream, a wait for its end), so that they cannot use up all
    /// connections; `None` when all are taken.
    pub(super) fn follow(&self) -> Option<OwnedSemaphorePermit> {
        self.followers.clone().try_acquire_owned().ok()
    }

    /// A place among the series in memory; waits for one. To be held until the answer was sent.
    pub(super) async fn series_place(&self) -> Option<OwnedSemaphorePermit> {
        self.series.clone().acquire_owned().await.ok()
    }
}
