//! `GET /api/v1/jobs/{id}/points/columns`

use crate::api::columns::{self, ColumnName, ColumnTable};
use crate::api::config::{DEFAULT_ROWS, LARGE_BODY_BYTES, MAX_ROWS, MAX_SWEEP_ROWS};
use crate::api::guarded_body::GuardedBody;
use crate::api::points::{self, ListEnd, RowRange};
use crate::api::problem::ApiError;
use crate::api::request::{JobPath, QueryParameters};
use crate::api::state::AppState;
use crate::api::text_body::TextBody;
use axum::body::Body;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use futures_util::StreamExt;
use herringbone_job::SweepShape;
use herringbone_job::result::{CellKind, SweepPoint};
use serde::Serialize;
use std::collections::{HashMap, HashSet};
use utoipa::ToSchema;

/// Estimates of the text of a number or word, and of a list that `record` asks for.
const CELL_BYTES: u64 = 24;
const LIST_BYTES: u64 = 16 * 1024;

/// A value of a row: a number, a word or, of what `record` asks for, numbers.
#[derive(Serialize, ToSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only for the description")]
pub(super) enum PointValue {
    Number(f64),
    Word(String),
    Numbers(Vec<f64>),
}

/// Some rows of a sweep, a list for each column.
#[derive(ToSchema)]
#[expect(dead_code, reason = "only for the description")]
pub(super) struct PointColumns {
    /// Places of the rows in the result's `sweep.points`, ascending.
    pub positions: Vec<u64>,
    /// For each column the values of these rows; null where a row does not have one.
    pub columns: HashMap<String, Vec<Option<PointValue>>>,
    /// Position to go on from; null when nothing follows yet.
    pub next_position: Option<u64>,
    /// Points that are solved, and points that the sweep has; of an optimisation that has not ended, at most so many.
    pub n_solved: u64,
    pub n_points: u64,
}

/// Read columns of the points of a sweep: the compact form, for plots of large sweeps.
///
/// As `GET /jobs/{id}/points`, it reads as far as the sweep is solved, a page at a time.
#[utoipa::path(
    get, path = "/jobs/{id}/points/columns", tag = "results",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("names" = Option<Vec<ColumnName>>, Query, style = Form, explode = false, min_items = 1, description = "These columns, separated by commas; \
            every number and word when left out."),
        ("from" = Option<u64>, Query, description = "First position; 0 when left out.", minimum = 0, maximum = 200_000),
        ("to" = Option<u64>, Query, description = "Positions before this one; all when left out.", minimum = 0, maximum = 200_000),
        ("limit" = Option<u64>, Query, description = "Points per page, 1 to 10000; 1000 when left out.", minimum = 1,
            maximum = 10_000, example = 1000),
    ),
    responses(
        (status = 200, description = "The columns.", body = PointColumns),
        (status = 400, description = "`invalid-parameter`."),
        (status = 404, description = "No such job, or it is not a sweep."),
        (status = 503, description = "`too-many-large-answers` or `storage-unavailable`; `Retry-After` says when to try again."),
    )
)]
pub(super) async fn read_point_columns(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    mut query: QueryParameters,
) -> Result<Response, ApiError> {
    let mut columns = query.choices("names", &columns::all());
    let from = query.integer("from", 0, MAX_SWEEP_ROWS, false).unwrap_or(0);
    let to = query.integer("to", 0, MAX_SWEEP_ROWS, false).unwrap_or(u64::MAX);
    let limit = query.integer("limit", 1, MAX_ROWS, false).unwrap_or(DEFAULT_ROWS);
    query.finish()?;
    if columns.is_empty() {
        columns = columns::default_columns();
    }
    let mut seen = HashSet::new();
    columns.retain(|column| seen.insert(column.name));
    let input = super::sweep_input(&state, id).await?;
    let shape = SweepShape::of_stored(&input).map_err(ApiError::internal)?;
    let store = state.jobs().store();
    let cell_bytes = |kind| if kind == CellKind::Numbers { LIST_BYTES } else { CELL_BYTES };
    let row_bytes: u64 = columns.iter().map(|column| cell_bytes(column.kind)).sum();
    let n_rows = limit.min(to.saturating_sub(from)).min(store.point_count(id).await?);
    let is_large = n_rows * row_bytes > LARGE_BODY_BYTES;
    let place = if is_large { Some(state.large_body_place().await?) } else { None };
    let mut pages = points::pages(store, id, RowRange { from, to, limit }).await?;
    let (mut positions, mut table) = (Vec::new(), ColumnTable::new(columns));
    while let Some(rows) = pages.next().await.transpose()? {
        for row in rows {
            let point: SweepPoint = serde_json::from_str(&row.body).map_err(ApiError::internal)?;
            table.push(&point).map_err(ApiError::internal)?;
            positions.push(row.position);
        }
    }
    let next = positions.last().map_or(from, |position| position + 1);
    let n_points = super::row_count(&state, id, &shape).await?;
    let end = points::list_end(store, id, (next, to), n_points).await?;
    let text = to_json(&positions, table, &end).map_err(ApiError::internal)?;
    let body = Body::new(GuardedBody::new(TextBody::new(text).into(), place));
    Ok(([(CONTENT_TYPE, "application/json")], body).into_response())
}

fn to_json(positions: &[u64], table: ColumnTable, end: &ListEnd) -> serde_json::Result<Vec<u8>> {
    let mut text = b"{\"positions\":".to_vec();
    serde_json::to_writer(&mut text, positions)?;
    text.extend_from_slice(b",\"columns\":");
    text.append(&mut table.into_json()?);
    text.push(b',');
    text.extend_from_slice(serde_json::to_string(end)?.trim_start_matches('{').as_bytes());
    Ok(text)
}
