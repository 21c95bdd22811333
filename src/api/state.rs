//! What handlers are given.

use super::telemetry;
use crate::work::Jobs;
use jiff::Timestamp;
use metrics_exporter_prometheus::PrometheusHandle;
use std::sync::Arc;

/// Jobs, metrics and the time of the start. Cheap to clone.
#[derive(Clone)]
pub struct AppState(Arc<Inner>);

struct Inner {
    jobs: Jobs,
    metrics: PrometheusHandle,
    started_at: Timestamp,
}

impl AppState {
    /// The state of a service over these jobs, started now.
    pub fn new(jobs: Jobs, started_at: Timestamp) -> Self {
        Self(Arc::new(Inner { jobs, metrics: telemetry::recorder(), started_at }))
    }

    pub fn jobs(&self) -> &Jobs {
        &self.0.jobs
    }

    pub(super) fn metrics(&self) -> &PrometheusHandle {
        &self.0.metrics
    }

    pub(super) fn started_at(&self) -> Timestamp {
        self.0.started_at
    }
}
