//! Metrics of the process.

use crate::store::DatabaseUsage;
use jiff::Timestamp;
use metrics_exporter_prometheus::{PrometheusBuilder, PrometheusHandle};
use std::sync::OnceLock;

/// Upper bounds of the duration histograms, in seconds.
const SECONDS: [f64; 14] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0, 3600.0];

/// The recorder of this process, installed on first use.
pub(super) fn recorder() -> PrometheusHandle {
    static HANDLE: OnceLock<PrometheusHandle> = OnceLock::new();
    HANDLE
        .get_or_init(|| {
            let builder = PrometheusBuilder::new();
            let recorder = builder.set_buckets(&SECONDS).unwrap_or_default().build_recorder();
            let handle = recorder.handle();
            // The recorder installed first stays in use.
            if metrics::set_global_recorder(recorder).is_err() {
                tracing::warn!("metrics are recorded elsewhere");
            }
            describe();
            handle
        })
        .clone()
}

/// Counts an event stream as open until it is dropped.
pub(super) struct OpenStream(());

impl OpenStream {
    pub(super) fn new() -> Self {
        metrics::gauge!("herringbone_event_streams").increment(1.0);
        Self(())
    }
}

impl Drop for OpenStream {
    fn drop(&mut self) {
        metrics::gauge!("herringbone_event_streams").decrement(1.0);
    }
}

/// Counts a connection as open until it is dropped.
pub(super) struct OpenConnection(());

impl OpenConnection {
    pub(super) fn new() -> Self {
        metrics::gauge!("herringbone_connections").increment(1.0);
        Self(())
    }
}

impl Drop for OpenConnection {
    fn drop(&mut self) {
        metrics::gauge!("herringbone_connections").decrement(1.0);
    }
}

/// Updates the gauges of the process: uptime, versions, memory.
pub(super) fn measure_process(started_at: Timestamp, now: Timestamp, solver_version: &'static str) {
    let uptime_s = now.duration_since(started_at).as_secs_f64().max(0.0);
    metrics::gauge!("herringbone_uptime_seconds").set(uptime_s);
    let labels = [("version", env!("CARGO_PKG_VERSION")), ("solver_version", solver_version)];
    metrics::gauge!("herringbone_build_info", &labels).set(1.0);
    if let Some(bytes) = resident_bytes() {
        metrics::gauge!("herringbone_resident_memory_bytes").set(bytes as f64);
    }
}

/// Updates the gauges of the size of the database.
pub(super) fn measure_database(usage: &DatabaseUsage) {
    let parts = [("used", usage.used_bytes), ("file", usage.file_bytes), ("log", usage.log_bytes)];
    for (part, bytes) in parts {
        metrics::gauge!("herringbone_database_bytes", "part" => part).set(bytes as f64);
    }
}

/// Resident memory of this process; `None` except on Linux.
fn resident_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim_end().parse().ok()?;
    Some(kibibytes << 10)
}

fn describe() {
    metrics::describe_counter!("herringbone_http_requests_total", "Requests by method, route and status.");
    metrics::describe_histogram!("herringbone_http_request_duration_seconds", "Time until an answer began.");
    metrics::describe_counter!("herringbone_jobs_submitted_total", "Accepted jobs by kind.");
    metrics::describe_counter!("herringbone_jobs_ended_total", "Ended jobs by kind and state.");
    metrics::describe_histogram!("herringbone_job_duration_seconds", "Time from start to end of a job.");
    metrics::describe_histogram!("herringbone_queue_wait_seconds", "Time from submission to first start, by kind.");
    metrics::describe_histogram!("herringbone_stage_duration_seconds", "Computing time of a stage of a job.");
    metrics::describe_counter!(
        "herringbone_stage_reuse_total",
        "Stages taken from earlier jobs instead of computed; `result`: everything."
    );
    metrics::describe_counter!("herringbone_panics_total", "Panics that were caught, in a job or in a request.");
    metrics::describe_counter!("herringbone_claims_retried_total", "Times that the next job could not be read.");
    metrics::describe_counter!(
        "herringbone_retention_deleted_jobs_total",
        "Ended jobs deleted because of their age or to make room."
    );
    metrics::describe_gauge!("herringbone_connections", "Open connections.");
    metrics::describe_gauge!("herringbone_event_streams", "Open event streams.");
    metrics::describe_gauge!(
        "herringbone_database_bytes",
        "Size of the database: pages in use, the file, the write-ahead log."
    );
    metrics::describe_gauge!("herringbone_uptime_seconds", "Time since the start.");
    metrics::describe_gauge!("herringbone_resident_memory_bytes", "Memory of the process (Linux).");
    metrics::describe_gauge!("herringbone_build_info", "Always 1; the labels are the versions.");
    // Counters exist from the start: an alert on their growth needs a first value.
    for place in ["job", "request"] {
        metrics::counter!("herringbone_panics_total", "in" => place).absolute(0);
    }
    for reason in ["age", "size"] {
        metrics::counter!("herringbone_retention_deleted_jobs_total", "reason" => reason).absolute(0);
    }
    metrics::counter!("herringbone_claims_retried_total").absolute(0);
    metrics::gauge!("herringbone_event_streams").increment(0.0);
    metrics::gauge!("herringbone_connections").increment(0.0);
    metrics::describe_gauge!(
        "herringbone_database_up",
        "Whether the database answered; 0: its values are the last known."
    );
    metrics::describe_gauge!("herringbone_jobs", "Stored jobs by state.");
    metrics::describe_gauge!("herringbone_queue_capacity", "Jobs that may wait.");
    metrics::describe_gauge!("herringbone_workers", "Jobs that can run at once.");
    metrics::describe_gauge!("herringbone_workers_busy", "Jobs that run.");
}
