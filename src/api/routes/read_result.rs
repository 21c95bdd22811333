//! `GET /api/v1/jobs/{id}/result`

use crate::api::points;
use crate::api::problem::Refusal;
use crate::api::request::{IfNoneMatch, JobPath, Parameters};
use crate::api::state::AppState;
use crate::api::view::not_modified;
use axum::body::Body;
use axum::extract::State;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, ETAG};
use axum::response::{IntoResponse, Response};
use herringbone_job::result::JobResult;

/// Read the result of a job: geometry, mesh, impact and response. It never changes.
///
/// The points of a sweep are part of it; `GET /jobs/{id}/points` has them a page at a time or as CSV, and `rows=false` leaves
/// them out here.
#[utoipa::path(
    get, path = "/jobs/{id}/result", tag = "results",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("rows" = Option<bool>, Query, description = "`false`: `sweep.points` is empty; true when left out. Other jobs have no rows."),
        ("If-None-Match" = Option<String>, Header, description = "Entity tag of the result as the client has it"),
    ),
    responses(
        (status = 200, description = "The result; stages that did not run are null.", body = JobResult,
            headers(("ETag" = String, description = "Strong entity tag"))),
        (status = 400, description = "`invalid-parameter`."),
        (status = 304, description = "The result is as the client has it."),
        (status = 404, description = "No such job."),
        (status = 409, description = "`result-not-ready` while the job waits or runs; `job-not-succeeded` when it failed \
            or was canceled."),
    )
)]
pub async fn read_result(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    known: IfNoneMatch,
    mut query: Parameters,
) -> Result<Response, Refusal> {
    let rows = query.choice("rows", &[("true", true), ("false", false)]).unwrap_or(true);
    query.finish()?;
    super::succeeded(&state, id).await?;
    let result = state.jobs().store().result(id).await?.ok_or_else(super::no_job)?;
    let etag = if rows { format!("\"{}\"", result.etag) } else { format!("\"{}-without-rows\"", result.etag) };
    if known.has(&etag) {
        return Ok(not_modified(etag));
    }
    let headers = [(CONTENT_TYPE, "application/json".to_owned()), (ETAG, etag), (CACHE_CONTROL, "no-cache".to_owned())];
    let body = match result.points {
        None => Body::from(result.body),
        Some(_) if !rows => Body::from(result.body),
        Some(place) => points::within(state.jobs().store().clone(), id, result.body, &place),
    };
    Ok((headers, body).into_response())
}
