//! `DELETE /api/v1/jobs/{id}`

use crate::api::problem::{ApiError, ProblemCode};
use crate::api::request::JobPath;
use crate::api::state::AppState;
use crate::store::Deletion;
use axum::extract::State;
use axum::http::StatusCode;

/// Delete an ended job with its result and series.
#[utoipa::path(
    delete, path = "/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, format = "uuid", description = "Id of the job")),
    responses(
        (status = 204, description = "Deleted."),
        (status = 404, description = "No such job."),
        (status = 409, description = "The job has not ended (`job-not-ended`): cancel it first."),
    )
)]
pub(super) async fn delete_job(State(state): State<AppState>, JobPath(id): JobPath) -> Result<StatusCode, ApiError> {
    match state.jobs().delete(id).await? {
        Deletion::Deleted => Ok(StatusCode::NO_CONTENT),
        Deletion::NotEnded => Err(ApiError::new(ProblemCode::JobNotEnded, "The job has not ended; cancel it first.")),
        Deletion::NotFound => Err(super::job_not_found()),
    }
}
