//! `GET /api/v1/jobs/{id}/points`

use crate::api::config::{DEFAULT_ROWS, MAX_ROWS, MAX_SWEEP_ROWS};
use crate::api::csv::Decimal;
use crate::api::points::{self, RowRange};
use crate::api::problem::ApiError;
use crate::api::request::{JobPath, QueryParameters, negotiate_table};
use crate::api::state::AppState;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::http::header::{CONTENT_TYPE, VARY};
use axum::response::{IntoResponse, Response};
use herringbone_job::SweepShape;
use herringbone_job::result::SweepPoint;
use utoipa::ToSchema;

/// Some points of a sweep, in the order of their positions.
#[derive(ToSchema)]
#[expect(dead_code, reason = "only for the description: the answer is written by `points::json_body`")]
pub(super) struct PointList {
    pub items: Vec<PointItem>,
    /// Position to go on from; null when nothing follows yet.
    pub next_position: Option<u64>,
    /// Points that are solved, and points that the sweep has; of an optimisation that has not ended, at most so many.
    pub n_solved: u64,
    pub n_points: u64,
}

#[derive(ToSchema)]
#[expect(dead_code, reason = "only for the description")]
pub(super) struct PointItem {
    /// Place in the result's `sweep.points`.
    pub position: u64,
    pub point: SweepPoint,
}

/// Read the points of a sweep, a page at a time or as CSV.
#[utoipa::path(
    get, path = "/jobs/{id}/points", tag = "results",
    description = "The points of a sweep that runs, failed or was canceled can be read as far as they are solved; \
        there may then be gaps between\ntheir positions, which are filled later. CSV has all of them unless `limit` \
        is given.",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("from" = Option<u64>, Query, description = "First position; 0 when left out.", minimum = 0,
            maximum = 200_000),
        ("limit" = Option<u64>, Query, description = "Points per page, 1 to 10000; 1000 when left out (CSV: all).",
            minimum = 1, maximum = 10_000, example = 1000),
        ("decimal" = Option<Decimal>, Query, description = "Answer with CSV: `point` (fields between commas, the default of `text/csv`) or \
            `comma` (decimal commas, fields between semicolons, CR LF, byte order mark: for spreadsheets of such a locale). The \
            same as `Accept: text/csv; decimal=comma`."),
    ),
    responses(
        (status = 200, description = "The points.", content(
            (PointList = "application/json"),
            (String = "text/csv", example = "position,branch,/operation/pinion_speed_rpm\n0,,300.0\n"))),
        (status = 400, description = "`invalid-parameter`."),
        (status = 404, description = "No such job, or it is not a sweep."),
        (status = 406, description = "Neither JSON nor CSV is accepted."),
    )
)]
pub(super) async fn list_points(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    mut query: QueryParameters,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let csv_decimal = negotiate_table(&headers, &mut query)?;
    let from = query.integer("from", 0, MAX_SWEEP_ROWS, false).unwrap_or(0);
    let limit = query.integer("limit", 1, MAX_ROWS, false);
    query.finish()?;
    let input = super::sweep_input(&state, id).await?;
    let shape = SweepShape::of_stored(&input).map_err(ApiError::internal)?;
    let store = state.jobs().store();
    let vary = (VARY, "accept");
    if let Some(decimal) = csv_decimal {
        let range = RowRange { from, limit: limit.unwrap_or(u64::MAX), ..RowRange::ALL };
        let body = points::csv_body(store, id, range, shape, decimal).await?;
        return Ok(([(CONTENT_TYPE, "text/csv; charset=utf-8"), vary], body).into_response());
    }
    let range = RowRange { from, limit: limit.unwrap_or(DEFAULT_ROWS), ..RowRange::ALL };
    let n_points = super::row_count(&state, id, &shape).await?;
    let body = points::json_body(store.clone(), id, range, n_points).await?;
    Ok(([(CONTENT_TYPE, "application/json"), vary], body).into_response())
}
