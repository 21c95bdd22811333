//! `GET /api/v1/jobs/{id}/points`

use crate::api::config::{DEFAULT_ROWS, MAX_ROWS, MAX_SWEEP_ROWS};
use crate::api::csv::Decimal;
use crate::api::guarded_body::GuardedBody;
use crate::api::parquet;
use crate::api::points::{self, RowRange};
use crate::api::problem::{ApiError, ProblemCode};
use crate::api::request::{JobPath, QueryParameters, TableForm, negotiate_table_form};
use crate::api::state::AppState;
use crate::api::table::Table;
use crate::api::text_body::TextBody;
use crate::api::workbook::{self, MAX_WORKBOOK_ROWS, write_workbook};
use crate::store::JobRecord;
use axum::body::Body;
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

/// Read the points of a sweep, a page at a time or as a file: CSV, workbook, arrays.
#[utoipa::path(
    get, path = "/jobs/{id}/points", tag = "results",
    description = "The points of a sweep that runs, failed or was canceled can be read as far as they are solved; \
        there may then be gaps between\ntheir positions, which are filled later. Files have all of them unless `limit` \
        is given: CSV; `xlsx`, a workbook with the rows,\nthe input and the units; `npz` (NumPy) and `mat` (MATLAB, version 5), \
        an array for each column, with `columns` and `units`; \
        `parquet`, in programs built with that feature, with null where\na row has no value, and `units`, `meanings`, `job_id`, `solver_version` and `input` in its metadata.",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("from" = Option<u64>, Query, description = "First position; 0 when left out.", minimum = 0,
            maximum = 200_000),
        ("limit" = Option<u64>, Query, description = "Points per page, 1 to 10000; 1000 when left out (CSV: all).",
            minimum = 1, maximum = 10_000, example = 1000),
        ("format" = Option<String>, Query, pattern = "^(json|csv|xlsx|npz|mat|parquet)$", description = "`json` (the default), `csv`, `xlsx`, `npz`, \
            `mat` or, in programs built with it, `parquet`. The same as the media type in `Accept`."),
        ("decimal" = Option<Decimal>, Query, description = "Answer with CSV: `point` (fields between commas, the default of `text/csv`) or \
            `comma` (decimal commas, fields between semicolons, CR LF, byte order mark: for spreadsheets of such a locale). The \
            same as `Accept: text/csv; decimal=comma`."),
    ),
    responses(
        (status = 200, description = "The points.", content(
            (PointList = "application/json"),
            (String = "text/csv", example = "position,branch,/operation/pinion_speed_rpm\n0,,300.0\n"),
            (Vec<u8> = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"),
            (Vec<u8> = "application/x-npz"),
            (Vec<u8> = "application/x-matlab-data"),
            (Vec<u8> = "application/vnd.apache.parquet"))),
        (status = 400, description = "`invalid-parameter`."),
        (status = 404, description = "No such job, or it is not a sweep."),
        (status = 406, description = "None of these media types is accepted, the program was built without the one that is, or a sheet has no \
            room for the rows."),
        (status = 503, description = "`too-many-large-answers` or `storage-unavailable`; `Retry-After` says when to try again."),
    )
)]
pub(super) async fn list_points(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    mut query: QueryParameters,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let form = negotiate_table_form(&headers, &mut query)?;
    let from = query.integer("from", 0, MAX_SWEEP_ROWS, false).unwrap_or(0);
    let limit = query.integer("limit", 1, MAX_ROWS, false);
    query.finish()?;
    let input = super::sweep_input(&state, id).await?;
    let job = super::find_job(&state, id).await?;
    let shape = SweepShape::of_stored(&input).map_err(ApiError::internal)?;
    let store = state.jobs().store();
    let vary = (VARY, "accept");
    let of_file = RowRange { from, limit: limit.unwrap_or(u64::MAX), ..RowRange::ALL };
    match form {
        TableForm::Json => {
            let range = RowRange { limit: limit.unwrap_or(DEFAULT_ROWS), ..of_file };
            let n_points = super::row_count(&state, id, &shape).await?;
            let body = points::json_body(store.clone(), id, range, n_points).await?;
            Ok(([(CONTENT_TYPE, "application/json"), vary], body).into_response())
        }
        TableForm::Csv(decimal) => {
            let body = points::csv_body(store, id, of_file, shape, decimal).await?;
            Ok(([(CONTENT_TYPE, "text/csv; charset=utf-8"), vary], body).into_response())
        }
        TableForm::Workbook | TableForm::Arrays(_) | TableForm::Parquet => {
            // The whole table is in memory until it was sent.
            let place = state.large_body_place().await?;
            let permit = state.large_read_permit().await?;
            let pages = points::pages(store, id, of_file).await?;
            let table = Table::of_points(pages, &shape).await?;
            let bytes = tokio::task::spawn_blocking(move || encode(&table, form, &job, &input));
            let bytes = bytes.await.map_err(ApiError::internal)??;
            let (media_type, ending) = match form {
                TableForm::Arrays(form) => (form.media_type(), form.ending()),
                TableForm::Parquet => (parquet::MEDIA_TYPE, parquet::NAME),
                _ => (workbook::MEDIA_TYPE, "xlsx"),
            };
            let body = Body::new(GuardedBody::new(TextBody::new(bytes).into(), (place, permit)));
            Ok(super::file_response(body, media_type, &format!("{id}-points.{ending}")))
        }
    }
}

fn encode(table: &Table, form: TableForm, job: &JobRecord, input: &str) -> Result<Vec<u8>, ApiError> {
    match form {
        TableForm::Arrays(form) => table.to_arrays(form).map_err(ApiError::internal),
        TableForm::Parquet => parquet::table_bytes(table, job, input),
        _ if table.n_rows() > MAX_WORKBOOK_ROWS => {
            let detail =
                format!("A sheet has {MAX_WORKBOOK_ROWS} rows at most; take CSV, or pages with from and limit.");
            Err(ApiError::new(ProblemCode::NotAcceptable, detail))
        }
        _ => {
            let document = serde_json::from_str(input).map_err(ApiError::internal)?;
            write_workbook("points", table, &document).map_err(ApiError::internal)
        }
    }
}
