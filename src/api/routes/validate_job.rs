//! `POST /api/v1/jobs/validate`

use crate::api::problem::ApiError;
use crate::api::request::{DocumentBody, QueryParameters};
use crate::api::state::AppState;
use axum::Json;
use axum::extract::State;
use herringbone_job::drawing::Drawing;
use herringbone_job::study::CheckReport;
use serde::Serialize;
use utoipa::ToSchema;

/// What a check found, and the drawing where it was asked for.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Checked)]
pub(super) struct ValidationResponse {
    #[serde(flatten)]
    pub report: CheckReport,
    /// The pair to scale; only with `drawing=true`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawing: Option<Drawing>,
}

/// Check a job document without queueing it.
#[utoipa::path(
    post, path = "/jobs/validate", tag = "jobs",
    description = "Geometry and warnings in milliseconds, or every violation at once. With `drawing=true` also what a \
        drawing of the pair\nneeds (outlines of the teeth, path of contact, lines of contact) and its margins.",
    params(("drawing" = Option<bool>, Query, description = "Whether the answer has the drawing; false when left out.")),
    request_body(content = serde_json::Value, content_type = "application/json"),
    responses(
        (status = 200, description = "The gear can exist and be solved.", body = ValidationResponse),
        (status = 400, description = "The body is not JSON, or `invalid-parameter`."),
        (status = 413, description = "The body is larger than 1 MiB."),
        (status = 415, description = "The body is not `application/json`."),
        (status = 422, description = "`invalid-design` or `unsupported-design`."),
    )
)]
pub(super) async fn validate_job(
    State(state): State<AppState>,
    mut query: QueryParameters,
    DocumentBody(document): DocumentBody,
) -> Result<Json<ValidationResponse>, ApiError> {
    let with_drawing = query.choice("drawing", &[("true", true), ("false", false)]).unwrap_or(false);
    query.finish()?;
    let job = state.jobs().check(document).await?;
    let report = job.report();
    let drawing = if with_drawing { Some(state.jobs().drawing(job).await?) } else { None };
    Ok(Json(ValidationResponse { report, drawing }))
}
