//! `GET /api/v1/jobs/{id}/points/columns`

use crate::api::columns::{self, ColumnName, ColumnTable};
use crate::api::config::{DEFAULT_ROWS, MAX_ROWS, MAX_SWEEP_ROWS};
use crate::api::points;
use crate::api::problem::ApiError;
use crate::api::request::{JobPath, QueryParameters};
use crate::api::state::AppState;
use crate::store::PointRow;
use axum::extract::State;
use axum::http::header::CONTENT_TYPE;
use axum::response::{IntoResponse, Response};
use herringbone_job::SweepShape;
use herringbone_job::result::{Column, SweepPoint};
use serde::Serialize;
use std::collections::HashSet;
use utoipa::ToSchema;

/// A value of a row: a number, a word or, of what `record` asks for, numbers.
#[derive(Serialize, ToSchema)]
#[serde(untagged)]
#[expect(dead_code, reason = "only for the description")]
enum PointValue {
    Number(f64),
    Word(String),
    Numbers(Vec<f64>),
}

/// Some rows of a sweep, a list for each column.
#[derive(Serialize, ToSchema)]
pub(super) struct PointColumns<'a> {
    /// Places of the rows in the result's `sweep.points`, ascending.
    pub positions: Vec<u64>,
    /// For each column the values of these rows; null where a row does not have one.
    #[schema(value_type = HashMap<String, Vec<Option<PointValue>>>)]
    pub columns: ColumnTable<'a>,
    /// Position to go on from; null when nothing follows yet.
    pub next_position: Option<u64>,
    /// Points that are solved, and points that the sweep has.
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
    let limit = query.integer("limit", 1, MAX_ROWS.into(), false).map_or(DEFAULT_ROWS, |limit| limit as u32);
    query.finish()?;
    if columns.is_empty() {
        columns = columns::default_columns();
    }
    let mut seen = HashSet::new();
    columns.retain(|column| seen.insert(column.name));
    let input = super::sweep_input(&state, id).await?;
    let shape = SweepShape::of_stored(&input).map_err(ApiError::internal)?;
    let store = state.jobs().store();
    let (rows, next_position) = points::read_page(store, id, from, to, limit).await?;
    let n_solved = store.point_count(id).await?;
    let counts = (n_solved, shape.rows() as u64);
    // Converting a page of large rows would block the async thread for too long.
    let body = tokio::task::spawn_blocking(move || to_json(&rows, &columns, next_position, counts)).await;
    let body = body.map_err(ApiError::internal)?.map_err(ApiError::internal)?;
    Ok(([(CONTENT_TYPE, "application/json")], body).into_response())
}

fn to_json(
    rows: &[PointRow],
    columns: &[&'static Column],
    next_position: Option<u64>,
    (n_solved, n_points): (u64, u64),
) -> Result<Vec<u8>, serde_json::Error> {
    let positions = rows.iter().map(|row| row.position).collect();
    let rows: Vec<SweepPoint> = rows.iter().map(|row| serde_json::from_str(&row.body)).collect::<Result<_, _>>()?;
    let columns = ColumnTable { columns, rows: &rows };
    serde_json::to_vec(&PointColumns { positions, columns, next_position, n_solved, n_points })
}
