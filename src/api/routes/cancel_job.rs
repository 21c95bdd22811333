//! `POST /api/v1/jobs/{id}/cancel`

use crate::api::problem::ApiError;
use crate::api::request::JobPath;
use crate::api::state::AppState;
use crate::api::view::{Job, job_response};
use crate::store::Cancellation;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;

/// Cancel a job.
#[utoipa::path(
    post, path = "/jobs/{id}/cancel", tag = "jobs",
    description = "A job that waits is canceled at once, one that runs is asked to stop, one that ended stays as it \
        is. May be repeated.",
    params(("id" = String, Path, format = "uuid", description = "Id of the job")),
    responses(
        (status = 200, description = "The job has ended.", body = Job),
        (status = 202, description = "The job was asked to stop.", body = Job),
        (status = 404, description = "No such job."),
    )
)]
pub(super) async fn cancel_job(State(state): State<AppState>, JobPath(id): JobPath) -> Result<Response, ApiError> {
    match state.jobs().cancel(id).await? {
        Cancellation::Canceled(job) | Cancellation::Ended(job) => job_response(StatusCode::OK, &job),
        Cancellation::Requested(job) => job_response(StatusCode::ACCEPTED, &job),
        Cancellation::NotFound => Err(super::job_not_found()),
    }
}
