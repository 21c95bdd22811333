//! What is counted of jobs, and what every line of the log below a job carries.

use crate::store::JobRecord;
use herringbone_job::result::NumericsResult;
use tracing::Span;

/// Around everything that is done for one run of a job. Of the highest level, so that whatever is logged carries it.
pub(super) fn span(job: &JobRecord) -> Span {
    let (kind, attempt) = (job.kind.as_str(), job.attempt);
    let request_id = job.request_id.as_deref().unwrap_or_default();
    tracing::error_span!("job", job = %job.id, kind, attempt, request_id)
}

/// A job was claimed. What waits again after an interruption is not counted as waiting since its submission.
pub(super) fn started(job: &JobRecord) {
    if let (1, Some(started_at)) = (job.attempt, job.started_at) {
        let seconds = started_at.duration_since(job.submitted_at).as_secs_f64().max(0.0);
        metrics::histogram!("herringbone_queue_wait_seconds", "kind" => job.kind.clone()).record(seconds);
    }
}

/// A job was computed: time of the stages that ran, and which were taken from earlier jobs.
pub(super) fn computed(numerics: &NumericsResult) {
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

/// A whole result was taken from an earlier job.
pub(super) fn result_reused() {
    metrics::counter!("herringbone_stage_reuse_total", "stage" => "result").increment(1);
}

/// A calculation panicked.
pub(super) fn panicked() {
    metrics::counter!("herringbone_panics_total", "in" => "job").increment(1);
}

/// The next job could not be read and is asked for again.
pub(super) fn claim_retried() {
    metrics::counter!("herringbone_claims_retried_total").increment(1);
}
