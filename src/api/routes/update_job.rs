//! `PATCH /api/v1/jobs/{id}`

use crate::api::problem::ApiError;
use crate::api::request::{JobPatch, JobPath, PatchBody};
use crate::api::state::AppState;
use crate::api::view::{Job, job_response};
use crate::store::Described;
use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;

/// Rename a job, or change its label or notes.
#[utoipa::path(
    patch, path = "/jobs/{id}", tag = "jobs",
    description = "A merge patch (RFC 7396): members that are left out stay as they are, null removes a text. Nothing else of a job can \
        be\nchanged; its document, and so its results and what is submitted from them, keep name and label as they were submitted.",
    params(("id" = String, Path, format = "uuid", description = "Id of the job")),
    request_body(content(
        (JobPatch = "application/merge-patch+json", example = json!({"label": "variant B", "notes": null})),
        (JobPatch = "application/json", example = json!({"name": "Pinion 17, tip relief 20 µm"})))),
    responses(
        (status = 200, description = "The job, changed or as it was.", body = Job,
            headers(("ETag" = String, description = "Weak entity tag: the revision"))),
        (status = 400, description = "The body is not JSON (`malformed-json`)."),
        (status = 404, description = "No such job."),
        (status = 415, description = "The body is neither `application/merge-patch+json` nor `application/json`."),
        (status = 422, description = "`invalid-patch`: a text is too long, or something else is to be changed."),
    )
)]
pub(super) async fn update_job(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    PatchBody(description): PatchBody,
) -> Result<Response, ApiError> {
    match state.jobs().describe(id, &description).await? {
        Described::Changed(job) | Described::Unchanged(job) => job_response(StatusCode::OK, &job),
        Described::NotFound => Err(super::job_not_found()),
    }
}
