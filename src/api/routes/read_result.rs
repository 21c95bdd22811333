//! `GET /api/v1/jobs/{id}/result`

use crate::api::config::LARGE_BODY_BYTES;
use crate::api::guarded_body::GuardedBody;
use crate::api::problem::ApiError;
use crate::api::request::{IfNoneMatch, JobPath, QueryParameters};
use crate::api::result_body::result_body;
use crate::api::state::AppState;
use crate::api::text_body::TextBody;
use crate::api::view::not_modified;
use axum::body::Body;
use axum::extract::State;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use headers::{ETag, HeaderMapExt};
use herringbone_job::result::JobResult;

/// Read the result of a job: geometry, mesh, impact and response. It never changes.
#[utoipa::path(
    get, path = "/jobs/{id}/result", tag = "results",
    description = "The points of a sweep are part of it; `GET /jobs/{id}/points` has them a page at a time or as CSV, \
        and `rows=false` leaves\nthem out here.",
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
        (status = 503, description = "`too-many-large-answers` or `storage-unavailable`; `Retry-After` says when to try again."),
    )
)]
pub(super) async fn read_result(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    if_none_match: IfNoneMatch,
    mut query: QueryParameters,
) -> Result<Response, ApiError> {
    let rows = query.choice("rows", &[("true", true), ("false", false)]).unwrap_or(true);
    query.finish()?;
    super::find_succeeded_job(&state, id).await?;
    let store = state.jobs().store();
    let summary = store.result_summary(id).await?.ok_or_else(super::job_not_found)?;
    let suffix = if rows { "" } else { "-without-rows" };
    let etag: ETag = format!("\"{}{suffix}\"", summary.etag).parse().map_err(ApiError::internal)?;
    if if_none_match.matches(&etag) {
        return Ok(not_modified(etag));
    }
    let is_large = summary.bytes > LARGE_BODY_BYTES;
    let place = if is_large { Some(state.large_body_place().await?) } else { None };
    let permit = if is_large { Some(state.large_read_permit().await?) } else { None };
    let result = store.result(id).await?.ok_or_else(super::job_not_found)?;
    let body = match result.rows {
        Some(summary) if rows => result_body(store, id, &result.body, summary.count).await?,
        _ => TextBody::new(result.body).into(),
    };
    drop(permit);
    let body = Body::new(GuardedBody::new(body, place));
    let headers = [(CONTENT_TYPE, "application/json"), (CACHE_CONTROL, "no-cache")];
    let mut response = (headers, body).into_response();
    response.headers_mut().typed_insert(etag);
    Ok(response)
}
