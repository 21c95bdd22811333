//! The process's metrics.

use metrics_exporter_prometheus::{PrometheusBuilder, PrometheusHandle};
use std::sync::OnceLock;

/// Upper bounds of the duration histograms: requests take milliseconds, jobs minutes.
const SECONDS: [f64; 14] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3600.0];

/// The recorder of this process, installed on first use.
pub fn recorder() -> PrometheusHandle {
    static HANDLE: OnceLock<PrometheusHandle> = OnceLock::new();
    HANDLE
        .get_or_init(|| {
            let builder = PrometheusBuilder::new();
            let recorder = builder.set_buckets(&SECONDS).unwrap_or_default().build_recorder();
            let handle = recorder.handle();
            // Someone else's recorder stays; ours is then empty.
            if metrics::set_global_recorder(recorder).is_err() {
                tracing::warn!("metrics are recorded elsewhere");
            }
            describe();
            handle
        })
        .clone()
}

fn describe() {
    metrics::describe_counter!("herringbone_http_requests_total", "Requests by method, route and status.");
    metrics::describe_histogram!("herringbone_http_request_duration_seconds", "Time until an answer began.");
    metrics::describe_counter!("herringbone_jobs_submitted_total", "Accepted jobs by kind.");
    metrics::describe_counter!("herringbone_jobs_ended_total", "Ended jobs by kind and state.");
    metrics::describe_histogram!("herringbone_job_duration_seconds", "Time from start to end of a job.");
    metrics::describe_gauge!("herringbone_jobs", "Stored jobs by state.");
    metrics::describe_gauge!("herringbone_queue_capacity", "Jobs that may wait.");
    metrics::describe_gauge!("herringbone_workers", "Jobs that can run at once.");
    metrics::describe_gauge!("herringbone_workers_busy", "Jobs that run.");
}
