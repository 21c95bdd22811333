//! `GET /api/v1/jobs/{id}/result`

use crate::api::config::LARGE_BODY_BYTES;
use crate::api::guarded_body::GuardedBody;
use crate::api::problem::ApiError;
use crate::api::request::{IfNoneMatch, JobPath, QueryParameters, negotiate_form};
use crate::api::result_body::result_body;
use crate::api::state::AppState;
use crate::api::text_body::TextBody;
use crate::api::view::not_modified;
use crate::api::workbook::{self, quantities_of, write_workbook};
use axum::body::Body;
use axum::extract::State;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE, VARY};
use axum::http::{HeaderMap, HeaderValue};
use axum::response::{IntoResponse, Response};
use headers::{ETag, HeaderMapExt};
use herringbone_job::result::JobResult;

/// What the answer depends on.
const VARIES: &str = "accept, accept-encoding";

/// Read the result of a job: geometry, mesh, impact and response. It never changes.
#[utoipa::path(
    get, path = "/jobs/{id}/result", tag = "results",
    description = "The points of a sweep are part of it; `GET /jobs/{id}/points` has them a page at a time or as CSV, \
        and `rows=false` leaves\nthem out here.",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("rows" = Option<bool>, Query, description = "`false`: `sweep.points` is empty; true when left out. Other jobs have no rows."),
        ("format" = Option<String>, Query, pattern = "^(json|xlsx)$", description = "`json` (the default) or `xlsx`: a workbook with the \
            numbers of the result, the input and the units, without rows. The same as the media type in `Accept`."),
        ("If-None-Match" = Option<String>, Header, description = "Entity tag of the result as the client has it"),
    ),
    responses(
        (status = 200, description = "The result; stages that did not run are null.", content(
            (JobResult = "application/json"),
            (Vec<u8> = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet")),
            headers(("ETag" = String, description = "Strong entity tag"))),
        (status = 400, description = "`invalid-parameter`."),
        (status = 304, description = "The result is as the client has it."),
        (status = 404, description = "No such job."),
        (status = 406, description = "Neither JSON nor a workbook is accepted."),
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
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    let forms = [("json", "application/json", false), ("xlsx", workbook::MEDIA_TYPE, true)];
    let is_workbook = negotiate_form(&headers, &mut query, &forms)?;
    let rows = query.choice("rows", &[("true", true), ("false", false)]).unwrap_or(true);
    query.finish()?;
    super::find_succeeded_job(&state, id).await?;
    let store = state.jobs().store();
    let summary = store.result_summary(id).await?.ok_or_else(super::job_not_found)?;
    let suffix = match (is_workbook, rows) {
        (true, _) => "-xlsx",
        (false, true) => "",
        (false, false) => "-without-rows",
    };
    let etag: ETag = format!("\"{}{suffix}\"", summary.etag).parse().map_err(ApiError::internal)?;
    if if_none_match.matches(&etag) {
        let mut response = not_modified(etag);
        response.headers_mut().insert(VARY, HeaderValue::from_static(VARIES));
        return Ok(response);
    }
    let is_large = summary.bytes > LARGE_BODY_BYTES;
    let place = if is_large { Some(state.large_body_place().await?) } else { None };
    let permit = if is_large { Some(state.large_read_permit().await?) } else { None };
    let result = store.result(id).await?.ok_or_else(super::job_not_found)?;
    if is_workbook {
        let input = store.input(id).await?.ok_or_else(super::job_not_found)?;
        let bytes = tokio::task::spawn_blocking(move || workbook_of(&result.body, &input));
        let bytes = bytes.await.map_err(ApiError::internal)??;
        drop(permit);
        let body = Body::new(GuardedBody::new(TextBody::new(bytes).into(), place));
        let mut response = super::file_response(body, workbook::MEDIA_TYPE, &format!("{id}.xlsx"));
        response.headers_mut().typed_insert(etag);
        return Ok(response);
    }
    let body = match result.rows {
        Some(summary) if rows => result_body(store, id, &result.body, summary.count).await?,
        _ => TextBody::new(result.body).into(),
    };
    drop(permit);
    let body = Body::new(GuardedBody::new(body, place));
    let headers = [(CONTENT_TYPE, "application/json"), (CACHE_CONTROL, "no-cache"), (VARY, VARIES)];
    let mut response = (headers, body).into_response();
    response.headers_mut().typed_insert(etag);
    Ok(response)
}

fn workbook_of(result: &str, input: &str) -> Result<Vec<u8>, ApiError> {
    let result = serde_json::from_str(result).map_err(ApiError::internal)?;
    let input = serde_json::from_str(input).map_err(ApiError::internal)?;
    write_workbook("result", &quantities_of(&result), &input).map_err(ApiError::internal)
}
