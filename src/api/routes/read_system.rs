//! `GET /api/v1/system`

use crate::api::config::{
    DEFAULT_PAGE, DEFAULT_POINTS, MAX_BODY_BYTES, MAX_PAGE, MAX_POINTS, MAX_RAW_POINTS, MAX_WAIT_S,
};
use crate::api::problem::ApiError;
use crate::api::state::AppState;
use axum::Json;
use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

/// The service and what it does now.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = System)]
pub(super) struct SystemView {
    pub name: &'static str,
    pub version: &'static str,
    /// Results stored under another version are not reused.
    pub solver_version: &'static str,
    pub started_at: String,
    pub shutting_down: bool,
    pub queue: QueueView,
    pub workers: WorkersView,
    pub limits: RequestLimits,
}

#[derive(Debug, Serialize, ToSchema)]
pub(super) struct QueueView {
    /// Jobs that wait.
    pub depth: u64,
    /// Jobs that may wait; further ones are answered with 503.
    pub capacity: u32,
}

#[derive(Debug, Serialize, ToSchema)]
pub(super) struct WorkersView {
    /// Jobs of one operating point that can run at once.
    pub total: usize,
    /// Those that run.
    pub busy: usize,
    /// Sweeps that can run at once, beside the others.
    pub sweeps_total: usize,
    /// Those that run.
    pub sweeps_busy: usize,
}

/// Limits of requests.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Limits)]
pub(super) struct RequestLimits {
    pub max_body_bytes: usize,
    pub max_wait_s: u64,
    pub page_default: u32,
    pub page_max: u32,
    pub series_points_default: u64,
    pub series_points_max: u64,
    /// Samples per request with `method=none`.
    pub series_samples_max: u64,
}

/// Read version, queue, workers and limits.
#[utoipa::path(
    get, path = "/system", tag = "service",
    responses((status = 200, description = "The service and what it does now.", body = SystemView))
)]
pub(super) async fn read_system(State(state): State<AppState>) -> Result<Json<SystemView>, ApiError> {
    let jobs = state.jobs();
    let workers = jobs.workers();
    Ok(Json(SystemView {
        name: env!("CARGO_PKG_NAME"),
        version: env!("CARGO_PKG_VERSION"),
        solver_version: jobs.solver_version(),
        started_at: state.started_at().to_string(),
        shutting_down: jobs.is_closing(),
        queue: QueueView { depth: jobs.store().queued_count(), capacity: jobs.capacity() },
        workers: WorkersView {
            total: workers.total,
            busy: workers.busy,
            sweeps_total: workers.sweeps_total,
            sweeps_busy: workers.sweeps_busy,
        },
        limits: RequestLimits {
            max_body_bytes: MAX_BODY_BYTES,
            max_wait_s: MAX_WAIT_S,
            page_default: DEFAULT_PAGE,
            page_max: MAX_PAGE,
            series_points_default: DEFAULT_POINTS,
            series_points_max: MAX_POINTS,
            series_samples_max: MAX_RAW_POINTS,
        },
    }))
}
