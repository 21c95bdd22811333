//! `GET /api/v1/jobs/{id}/input`

use crate::api::problem::ApiError;
use crate::api::request::JobPath;
use crate::api::state::AppState;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};

/// Read the document of a job as it was accepted, with every default filled in.
#[utoipa::path(
    get, path = "/jobs/{id}/input", tag = "jobs",
    params(("id" = String, Path, format = "uuid", description = "Id of the job")),
    responses(
        (status = 200, description = "The job document.", body = serde_json::Value, content_type = "application/json"),
        (status = 404, description = "No such job."),
    )
)]
pub(super) async fn read_input(State(state): State<AppState>, JobPath(id): JobPath) -> Result<Response, ApiError> {
    let input = state.jobs().store().input(id).await?.ok_or_else(super::job_not_found)?;
    Ok(([(CONTENT_TYPE, "application/json")], input).into_response())
}
