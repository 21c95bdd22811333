//! `GET /healthz` and `GET /readyz`

use crate::api::config::RETRY_FULL_S;
use crate::api::problem::{ApiError, ProblemCode};
use crate::api::state::AppState;
use axum::Json;
use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

#[derive(Debug, Serialize, ToSchema)]
pub(super) struct Health {
    #[schema(example = "ok")]
    pub status: &'static str,
}

const OK: Json<Health> = Json(Health { status: "ok" });

/// Is the process alive?
#[utoipa::path(
    get, path = "/healthz", tag = "operation",
    responses((status = 200, description = "The process answers.", body = Health))
)]
pub(super) async fn read_liveness() -> Json<Health> {
    OK
}

/// Does the service take jobs?
#[utoipa::path(
    get, path = "/readyz", tag = "operation",
    responses(
        (status = 200, description = "The database answers and can be written: jobs are taken.", body = Health),
        (status = 503, description = "`shutting-down`, or `storage-unavailable`: the database is full, locked, moved or failing."),
    )
)]
pub(super) async fn read_readiness(State(state): State<AppState>) -> Result<Json<Health>, ApiError> {
    if state.jobs().is_closing() {
        let detail = "The service is shutting down.";
        return Err(ApiError::new(ProblemCode::ShuttingDown, detail).retry_after(RETRY_FULL_S));
    }
    state.jobs().store().ping().await?;
    state.jobs().store().writable().await?;
    Ok(OK)
}
