//! The state shared by handlers.

use super::config::{HttpConfig, MAX_IMPORTS, MAX_LARGE_BODIES, MAX_LARGE_READS, RETRY_LARGE_S};
use super::problem::{ApiError, ProblemCode};
use super::telemetry;
use crate::work::Jobs;
use jiff::Timestamp;
use metrics_exporter_prometheus::PrometheusHandle;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Jobs, metrics and the time of the start. Cheap to clone.
#[derive(Clone)]
pub struct AppState {
    shared: Arc<AppShared>,
    follower_permits: Arc<Semaphore>,
    large_bodies: Arc<Semaphore>,
    large_reads: Arc<Semaphore>,
    imports: Arc<Semaphore>,
    large_body_wait: Duration,
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
            large_bodies: semaphore(MAX_LARGE_BODIES),
            large_reads: semaphore(MAX_LARGE_READS),
            imports: semaphore(MAX_IMPORTS),
            large_body_wait: HttpConfig::default().large_body_wait(),
        }
    }

    /// Returns this state with the limits of `config`.
    pub(super) fn with_limits(self, config: &HttpConfig) -> Self {
        let followers = Semaphore::new(config.connections.max_followers());
        Self { follower_permits: Arc::new(followers), large_body_wait: config.large_body_wait(), ..self }
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

    /// Waits for the place of a large body; to be kept until it was sent.
    ///
    /// # Errors
    /// 503 when all places stay taken.
    pub(super) async fn large_body_place(&self) -> Result<OwnedSemaphorePermit, ApiError> {
        self.permit_in_time(&self.large_bodies).await
    }

    /// Waits for the permit to read a series or a large text; to be kept while it is unpacked or copied.
    ///
    /// # Errors
    /// 503 when it takes too long.
    pub(super) async fn large_read_permit(&self) -> Result<OwnedSemaphorePermit, ApiError> {
        self.permit_in_time(&self.large_reads).await
    }

    /// Waits for the permit to import a file; to be kept while the file is in memory.
    ///
    /// # Errors
    /// 503 when it takes too long.
    pub(super) async fn import_permit(&self) -> Result<OwnedSemaphorePermit, ApiError> {
        self.acquired_in_time(&self.imports).await.ok_or_else(|| {
            let detail = "As many files are being imported as the service allows.";
            ApiError::new(ProblemCode::TooManyImports, detail).retry_after(RETRY_LARGE_S)
        })
    }

    async fn permit_in_time(&self, semaphore: &Arc<Semaphore>) -> Result<OwnedSemaphorePermit, ApiError> {
        self.acquired_in_time(semaphore).await.ok_or_else(|| {
            let detail = "As many large answers are being sent as the service allows.";
            ApiError::new(ProblemCode::TooManyLargeAnswers, detail).retry_after(RETRY_LARGE_S)
        })
    }

    async fn acquired_in_time(&self, semaphore: &Arc<Semaphore>) -> Option<OwnedSemaphorePermit> {
        let acquired = tokio::time::timeout(self.large_body_wait, semaphore.clone().acquire_owned()).await;
        acquired.ok().and_then(Result::ok)
    }
}
