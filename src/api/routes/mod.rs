//! The endpoints, one file each.

mod cancel_job;
mod delete_job;
mod explain_problem;
mod health;
mod import_file;
mod list_deliveries;
mod list_jobs;
mod list_kinds;
mod list_points;
mod list_series;
mod read_bearing_forces;
mod read_gear_data;
mod read_input;
mod read_job;
mod read_metrics;
mod read_openapi;
mod read_point_columns;
mod read_point_input;
mod read_result;
mod read_rexs;
mod read_series;
pub(super) mod read_sound;
mod read_system;
mod read_tables;
mod submit_job;
mod update_job;
mod validate_job;
mod watch_job;
mod watch_jobs;

pub(super) use list_jobs::{ListDirection, ListSort};

use super::config::{KEEP_ALIVE, RETRY_FOLLOW_S};
use super::problem::{ApiError, ProblemCode};
use super::request::{event_stream_only, json_only};
use super::state::AppState;
use crate::store::{JobId, JobRecord, JobState};
use axum::Router;
use axum::body::Body;
use axum::http::HeaderName;
use axum::http::header::{CACHE_CONTROL, CONTENT_DISPOSITION, CONTENT_TYPE, VARY};
use axum::middleware::from_fn;
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use futures_util::Stream;
use herringbone_job::SweepShape;
use std::convert::Infallible;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

const X_ACCEL_BUFFERING: HeaderName = HeaderName::from_static("x-accel-buffering");

/// The endpoints under `/api/v1`, with their OpenAPI descriptions.
pub(super) fn versioned() -> OpenApiRouter<AppState> {
    let json = OpenApiRouter::new()
        .routes(routes!(list_jobs::list_jobs, submit_job::submit_job))
        .routes(routes!(validate_job::validate_job))
        .routes(routes!(read_job::read_job, update_job::update_job, delete_job::delete_job))
        .routes(routes!(cancel_job::cancel_job))
        .routes(routes!(read_input::read_input))
        .routes(routes!(read_gear_data::read_gear_data))
        .routes(routes!(read_point_columns::read_point_columns))
        .routes(routes!(read_point_input::read_point_input))
        .routes(routes!(list_kinds::list_kinds))
        .routes(routes!(list_deliveries::list_deliveries))
        .routes(routes!(read_system::read_system))
        .route_layer(from_fn(json_only));
    let stream = OpenApiRouter::new()
        .routes(routes!(watch_jobs::watch_jobs))
        .routes(routes!(watch_job::watch_job))
        .route_layer(from_fn(event_stream_only));
    let negotiated = OpenApiRouter::new()
        .routes(routes!(list_series::list_series))
        .routes(routes!(read_series::read_series))
        .routes(routes!(list_points::list_points))
        .routes(routes!(read_result::read_result));
    let files = OpenApiRouter::new()
        .routes(routes!(read_bearing_forces::read_bearing_forces))
        .routes(routes!(read_rexs::read_rexs))
        .routes(routes!(read_tables::read_tables));
    json.merge(stream).merge(negotiated).merge(files)
}

/// The endpoint that takes files, with its OpenAPI description.
pub(super) fn imports() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(import_file::import_file)).route_layer(from_fn(json_only))
}

/// The other endpoints, with their OpenAPI descriptions.
pub(super) fn operational() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(health::read_liveness))
        .routes(routes!(health::read_readiness))
        .routes(routes!(read_metrics::read_metrics))
        .routes(routes!(explain_problem::explain_problem))
}

/// The routes of the OpenAPI document, which does not describe itself.
pub(super) fn undocumented() -> Router<AppState> {
    Router::new()
        .route("/openapi.json", get(read_openapi::read_openapi))
        .route("/openapi-generators.json", get(read_openapi::read_openapi_for_generators))
}

/// Reads a job.
///
/// # Errors
/// 404 when it does not exist.
async fn find_job(state: &AppState, id: JobId) -> Result<JobRecord, ApiError> {
    state.jobs().store().job(id).await?.ok_or_else(job_not_found)
}

/// Reads a job that succeeded.
///
/// # Errors
/// 404 when it does not exist, 409 when it has no result.
async fn find_succeeded_job(state: &AppState, id: JobId) -> Result<JobRecord, ApiError> {
    let job = find_job(state, id).await?;
    match job.state {
        JobState::Succeeded => Ok(job),
        JobState::Queued | JobState::Running => {
            Err(ApiError::new(ProblemCode::ResultNotReady, format!("The job is {}.", job.state.as_str())))
        }
        JobState::Failed | JobState::Canceled => {
            Err(ApiError::new(ProblemCode::JobNotSucceeded, format!("The job is {}.", job.state.as_str())))
        }
    }
}

/// The answer that is a file.
fn file_response(body: Body, media_type: &'static str, name: &str) -> Response {
    let disposition = format!("attachment; filename=\"herringbone-{name}\"");
    let headers = [(CONTENT_TYPE, media_type.to_owned()), (CONTENT_DISPOSITION, disposition)];
    ([(VARY, "accept")], headers, body).into_response()
}

/// The response with events: kept alive by comments, neither cached nor, by proxies that heed the header (nginx),
/// buffered.
fn event_stream(events: impl Stream<Item = Result<Event, Infallible>> + Send + 'static) -> Response {
    let headers = [(CACHE_CONTROL, "no-store"), (X_ACCEL_BUFFERING, "no")];
    (headers, Sse::new(events).keep_alive(KeepAlive::new().interval(KEEP_ALIVE))).into_response()
}

fn too_many_followers() -> ApiError {
    let detail = "As many clients follow jobs as the service allows.";
    ApiError::new(ProblemCode::TooManyStreams, detail).retry_after(RETRY_FOLLOW_S)
}

/// Reads the stored document of a job with rows: a sweep, an optimisation or a tolerance study.
///
/// # Errors
/// 404 when the job does not exist or has no rows.
async fn sweep_input(state: &AppState, id: JobId) -> Result<String, ApiError> {
    let job = find_job(state, id).await?;
    if !super::view::has_rows(&job.kind) {
        return Err(ApiError::not_found("The job is not a sweep, an optimisation or a tolerance study."));
    }
    state.jobs().store().input(id).await?.ok_or_else(job_not_found)
}

/// Rows that a job has or will have; of an optimisation that has not ended, at most so many.
///
/// # Errors
/// The database cannot be read, or the job is gone.
async fn row_count(state: &AppState, id: JobId, shape: &SweepShape) -> Result<u64, ApiError> {
    if !shape.further().is_empty() && find_job(state, id).await?.state == JobState::Succeeded {
        return Ok(state.jobs().store().point_count(id).await?);
    }
    Ok(shape.rows() as u64)
}

pub(super) fn job_not_found() -> ApiError {
    ApiError::not_found("There is no such job.")
}
