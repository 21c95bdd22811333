//! `GET /api/v1/jobs/{id}/points/{position}/input`

use crate::api::problem::ApiError;
use crate::api::request::PointPath;
use crate::api::state::AppState;
use crate::store::JobId;
use axum::Json;
use axum::extract::State;
use herringbone_job::document::{JobDocument, JobKind};
use herringbone_job::parse;
use herringbone_job::result::{RegimeResult, SweepPoint};
use herringbone_job::study::{PointStart, continued_from, document_at, document_of_input, point_document};

/// Read the document of one point of a sweep, to submit it as a job of its own.
#[utoipa::path(
    get, path = "/jobs/{id}/points/{position}/input", tag = "results",
    description = "It is the sweep's document as a `response`, with the values of the axes put in; the point need not \
        be solved.\nA point that the sweep reached by continuation starts from the state from which the sweep solved \
        it\n(`analysis.initial_state`), so that the job has the same motion where several exist. `sweep_point` names the \
        point and\nits RMS values: a job that comes to another motion all the same has the warning \
        `differs-from-sweep-point`; where the\nstate is not stored (a sweep of an earlier version, a neighbour not yet \
        solved) and there is nothing to compare with,\n`may-differ-from-sweep-point`; where inputs are changed and the \
        initial state is left in,\n`initial-state-of-other-inputs`. Of an optimisation or a tolerance study it is the \
        document of the row at the first operating point.",
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
    let row = point(&state, id, position).await?;
    if sweep.kind != JobKind::Sweep {
        // The first row is the document itself, whatever its inputs have in common.
        let values = row.filter(|row| !row.values.is_empty()).map(|row| row.values);
        let document = if position == 0 { document_of_input(&sweep) } else { None };
        let document = document.or_else(|| document_at(&sweep, &values?));
        return document.map(Json).ok_or_else(|| ApiError::not_found("There is no such row, or not yet."));
    }
    let start = match continued_from(&sweep, position) {
        None => PointStart::OfDocument,
        Some(before) => start_after(&state, id, before).await?,
    };
    let document = point_document(&sweep, &id.to_string(), position, start, row.as_ref());
    document.map(Json).ok_or_else(|| ApiError::not_found("The sweep has no such point."))
}

/// The start of a point that continues from the point at `before`.
async fn start_after(state: &AppState, id: JobId, before: usize) -> Result<PointStart, ApiError> {
    if let Some(end_state) = state.jobs().store().point_end_state(id, before as u64).await? {
        return Ok(PointStart::Continued(end_state));
    }
    // Nothing continues from a point that failed or grows without bound.
    let without_motion = |row: SweepPoint| row.error.is_some() || row.regime == Some(RegimeResult::Unstable);
    let ended_there = point(state, id, before).await?.is_some_and(without_motion);
    Ok(if ended_there { PointStart::OfDocument } else { PointStart::Unknown })
}

/// A solved point of a sweep.
async fn point(state: &AppState, id: JobId, position: usize) -> Result<Option<SweepPoint>, ApiError> {
    let position = position as u64;
    let rows = state.jobs().store().points(id, position, position.saturating_add(1), 1).await?;
    rows.first().map(|row| serde_json::from_str(&row.body)).transpose().map_err(ApiError::internal)
}
