//! `POST /api/v1/jobs/validate`

use crate::api::problem::Refusal;
use crate::api::request::DocumentBody;
use crate::api::state::AppState;
use crate::study::CheckReport;
use axum::Json;
use axum::extract::State;

/// Check a job document without queueing it.
///
/// Geometry and warnings in milliseconds, or every violation at once.
#[utoipa::path(
    post, path = "/jobs/validate", tag = "jobs",
    request_body(content = serde_json::Value, content_type = "application/json"),
    responses(
        (status = 200, description = "The gear can exist and be solved.", body = CheckReport),
        (status = 400, description = "The body is not JSON."),
        (status = 413, description = "The body is larger than 1 MiB."),
        (status = 415, description = "The body is not `application/json`."),
        (status = 422, description = "`invalid-design` or `unsupported-design`."),
    )
)]
pub async fn validate_job(
    State(state): State<AppState>,
    DocumentBody(document): DocumentBody,
) -> Result<Json<CheckReport>, Refusal> {
    Ok(Json(state.jobs().check(document).await?))
}
