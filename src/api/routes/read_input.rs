//! `GET /api/v1/jobs/{id}/input`

use crate::api::config::LARGE_BODY_BYTES;
use crate::api::guarded_body::GuardedBody;
use crate::api::problem::ApiError;
use crate::api::request::JobPath;
use crate::api::state::AppState;
use crate::api::text_body::TextBody;
use axum::body::Body;
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
        (status = 503, description = "`too-many-large-answers` or `storage-unavailable`; `Retry-After` says when to try again."),
    )
)]
pub(super) async fn read_input(State(state): State<AppState>, JobPath(id): JobPath) -> Result<Response, ApiError> {
    let store = state.jobs().store();
    let mut input = store.input(id).await?.ok_or_else(super::job_not_found)?;
    let mut place = None;
    if input.len() as u64 > LARGE_BODY_BYTES {
        // Dropped while it waits.
        drop(input);
        place = Some(state.large_body_place().await?);
        input = store.input(id).await?.ok_or_else(super::job_not_found)?;
    }
    let body = Body::new(GuardedBody::new(TextBody::new(input).into(), place));
    Ok(([(CONTENT_TYPE, "application/json")], body).into_response())
}
