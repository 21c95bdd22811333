//! Metrics of jobs, and the tracing span of their log lines.

use crate::store::JobRecord;
use herringbone_job::result::NumericsResult;
use tracing::Span;

/// The span around one run of a job. It has the highest level, so that no filter removes it from log lines.
pub(super) fn span(job: &JobRecord) -> Span {
    let (kind, attempt) = (job.kind.as_str(), job.attempt);
    let request_id = job.request_id.as_deref().unwrap_or_default();
    let traceparent = job.traceparent.as_deref();
    tracing::error_span!("job", job = %job.id, kind, attempt, request_id, traceparent)
}

/// Records the queue wait of a job that was claimed for the first time.
pub(super) fn record_start(job: &JobRecord) {
    if let (1, Some(started_at)) = (job.attempt, job.started_at) {
        let seconds = started_at.duration_since(job.submitted_at).as_secs_f64().max(0.0);
        metrics::histogram!("herringbone_queue_wait_seconds", "kind" => job.kind.clone()).record(seconds);
    }
}

/// Records the durations of the stages of a solved job, and the stages that were reused.
pub(super) fn record_stages(numerics: &NumericsResult) {
    let wall_ms = &numerics.wall_ms;
    let stages = [
        ("geometry", wall_ms.geometry),
        ("mesh", wall_ms.mesh),
        ("impact", wall_ms.impact),
        ("response", wall_ms.response),
    ];
    for (stage, milliseconds) in stages {
        if !numerics.reused.iter().any(|reused| reused.as_str() == stage) {
            metrics::histogram!("herringbone_stage_duration_seconds", "stage" => stage).record(milliseconds / 1e3);
        }
    }
    for stage in &numerics.reused {
        metrics::counter!("herringbone_stage_reuse_total", "stage" => stage.as_str()).increment(1);
    }
}

/// Counts a reused result.
pub(super) fn record_result_reuse() {
    metrics::counter!("herringbone_stage_reuse_total", "stage" => "result").increment(1);
}

/// Counts a panic of a calculation.
pub(super) fn record_panic() {
    metrics::counter!("herringbone_panics_total", "in" => "job").increment(1);
}

/// Counts a failed attempt to claim the next job.
pub(super) fn record_claim_retry() {
    metrics::counter!("herringbone_claims_retried_total").increment(1);
}
