//! `GET /metrics`

use crate::api::state::AppState;
use crate::api::telemetry;
use crate::store::{Store, StoreError};
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
pub(super) async fn read_metrics(State(state): State<AppState>) -> Response {
    let jobs = state.jobs();
    // Metrics are served without the database too.
    let measured = measure_store(jobs.store()).await;
    if let Err(error) = &measured {
        tracing::error!(%error, "the database was not measured");
    }
    metrics::gauge!("herringbone_database_up").set(if measured.is_ok() { 1.0 } else { 0.0 });
    let workers = jobs.workers();
    metrics::gauge!("herringbone_queue_capacity").set(f64::from(jobs.capacity()));
    metrics::gauge!("herringbone_workers").set(workers.total as f64);
    metrics::gauge!("herringbone_workers_busy").set(workers.busy as f64);
    telemetry::measure_process(state.started_at(), Timestamp::now(), jobs.solver_version());
    let handle = state.metrics();
    handle.run_upkeep();
    ([(CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")], handle.render()).into_response()
}

async fn measure_store(store: &Store) -> Result<(), StoreError> {
    let counts = store.counts().await?;
    let by_state = [
        ("queued", counts.queued),
        ("running", counts.running),
        ("succeeded", counts.succeeded),
        ("failed", counts.failed),
        ("canceled", counts.canceled),
    ];
    for (state, n) in by_state {
        metrics::gauge!("herringbone_jobs", "state" => state).set(n as f64);
    }
    telemetry::measure_database(&store.usage().await?);
    Ok(())
}
