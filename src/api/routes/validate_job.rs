//! `POST /api/v1/jobs/validate`

use crate::api::problem::ApiError;
use crate::api::request::{DocumentBody, QueryParameters};
use crate::api::state::AppState;
use crate::work::Estimate;
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
    /// The time that the job will take, by jobs of the same kind and calculation that this service has solved.
    pub estimate: EstimateView,
    /// The pair to scale; only with `drawing=true`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drawing: Option<Drawing>,
}

/// Duration of a job by measured durations of similar ones, without the time in the queue.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Estimate)]
pub(super) struct EstimateView {
    /// Median of the similar jobs, scaled to the points of this one; null without such jobs.
    pub wall_time_s: Option<f64>,
    /// Shortest of them.
    pub shortest_s: Option<f64>,
    /// Longest of them.
    pub longest_s: Option<f64>,
    /// Number of similar jobs.
    pub jobs: usize,
    /// Their kind: that of this job, or `response` for a sweep without similar sweeps.
    pub kind: &'static str,
    /// Points of this job.
    pub points: usize,
}

impl From<Estimate> for EstimateView {
    fn from(Estimate { wall_s, jobs, kind, points }: Estimate) -> Self {
        let [wall_time_s, shortest_s, longest_s] = [0, 1, 2].map(|index| wall_s.map(|times: [f64; 3]| times[index]));
        Self { wall_time_s, shortest_s, longest_s, jobs, kind, points }
    }
}

/// Check a job document without queueing it.
#[utoipa::path(
    post, path = "/jobs/validate", tag = "jobs",
    description = "Geometry, derived values, warnings and the time that similar jobs took, in milliseconds, or every violation at once. With `drawing=true` also what a \
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
    let estimate = state.jobs().estimate(job.document()).await?.into();
    let drawing = if with_drawing { Some(state.jobs().drawing(job).await?) } else { None };
    Ok(Json(ValidationResponse { report, estimate, drawing }))
}
