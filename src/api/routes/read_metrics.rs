//! `GET /metrics`

use crate::api::problem::Refusal;
use crate::api::state::AppState;
use crate::api::telemetry;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use jiff::Timestamp;

/// Metrics in the Prometheus text format.
#[utoipa::path(
    get, path = "/metrics", tag = "operation",
    responses((status = 200, description = "Metrics in the Prometheus text format.", body = String,
        content_type = "text/plain"))
)]
pub async fn read_metrics(State(state): State<AppState>) -> Result<Response, Refusal> {
    let jobs = state.jobs();
    let counts = jobs.store().counts().await?;
    let by_state = [
        ("queued", counts.queued),
        ("running", counts.running),
        ("succeeded", counts.succeeded),
        ("failed", counts.failed),
        ("canceled", counts.canceled),
    ];
    for (word, n) in by_state {
        metrics::gauge!("herringbone_jobs", "state" => word).set(n as f64);
    }
    let workers = jobs.workers();
    metrics::gauge!("herringbone_queue_capacity").set(f64::from(jobs.capacity()));
    metrics::gauge!("herringbone_workers").set(workers.total as f64);
    metrics::gauge!("herringbone_workers_busy").set(workers.busy as f64);
    telemetry::measure_database(&jobs.store().usage().await?);
    telemetry::measure_process(state.started_at(), Timestamp::now(), jobs.solver_version());
    let handle = state.metrics();
    handle.run_upkeep();
    Ok(([(CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")], handle.render()).into_response())
}
