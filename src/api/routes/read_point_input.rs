//! `GET /api/v1/jobs/{id}/points/{position}/input`

use crate::api::problem::ApiError;
use crate::api::request::PointPath;
use crate::api::state::AppState;
use axum::Json;
use axum::extract::State;
use herringbone_job::document::JobDocument;
use herringbone_job::parse;

/// Read the document of one point of a sweep, to submit it as a job of its own.
#[utoipa::path(
    get, path = "/jobs/{id}/points/{position}/input", tag = "results",
    description = "It is the sweep's document as a `response`, with the values of the axes put in; the point need not \
        be solved. A point that the\nsweep reached by continuation is then solved from rest: where two motions exist \
        it may be the other one.",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("position" = u64, Path, description = "Place of the point in the result's `sweep.points`", minimum = 0, example = 0),
    ),
    responses(
        (status = 200, description = "The job document.", body = serde_json::Value, content_type = "application/json"),
        (status = 404, description = "No such job, it is not a sweep, or it has no such point."),
    )
)]
pub(super) async fn read_point_input(
    State(state): State<AppState>,
    PointPath(id, position): PointPath,
) -> Result<Json<JobDocument>, ApiError> {
    let input = super::sweep_input(&state, id).await?;
    let sweep = parse(input.as_bytes()).map_err(ApiError::internal)?;
    sweep.of_row(position).map(Json).ok_or_else(|| ApiError::not_found("The sweep has no such point."))
}
