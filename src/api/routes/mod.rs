//! One file per endpoint.

mod cancel_job;
mod delete_job;
mod explain_problem;
mod health;
mod list_jobs;
mod list_kinds;
mod list_points;
mod list_series;
mod read_gear_data;
mod read_input;
mod read_job;
mod read_metrics;
mod read_openapi;
mod read_point_columns;
mod read_point_input;
mod read_result;
mod read_series;
mod read_system;
mod submit_job;
mod validate_job;
mod watch_job;
mod watch_jobs;

use super::config::RETRY_FOLLOW_S;
use super::problem::{ProblemCode, Refusal};
use super::request::{event_stream_only, json_only};
use super::state::AppState;
use crate::store::{JobId, JobRecord, State};
use axum::Router;
use axum::middleware::from_fn;
use axum::routing::get;
use herringbone_job::document::JobKind;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

/// The endpoints under `/api/v1`, with their descriptions.
pub fn versioned() -> OpenApiRouter<AppState> {
    let json = OpenApiRouter::new()
        .routes(routes!(list_jobs::list_jobs, submit_job::submit_job))
        .routes(routes!(validate_job::validate_job))
        .routes(routes!(read_job::read_job, delete_job::delete_job))
        .routes(routes!(cancel_job::cancel_job))
        .routes(routes!(read_input::read_input))
        .routes(routes!(read_gear_data::read_gear_data))
        .routes(routes!(read_result::read_result))
        .routes(routes!(read_point_columns::read_point_columns))
        .routes(routes!(read_point_input::read_point_input))
        .routes(routes!(list_series::list_series))
        .routes(routes!(list_kinds::list_kinds))
        .routes(routes!(read_system::read_system))
        .route_layer(from_fn(json_only));
    let stream = OpenApiRouter::new()
        .routes(routes!(watch_jobs::watch_jobs))
        .routes(routes!(watch_job::watch_job))
        .route_layer(from_fn(event_stream_only));
    let chosen =
        OpenApiRouter::new().routes(routes!(read_series::read_series)).routes(routes!(list_points::list_points));
    json.merge(stream).merge(chosen)
}

/// The endpoints beside `/api/v1`, with their descriptions.
pub fn operational() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(health::read_liveness))
        .routes(routes!(health::read_readiness))
        .routes(routes!(read_metrics::read_metrics))
        .routes(routes!(explain_problem::explain_problem))
}

/// The description itself.
pub fn undescribed() -> Router<AppState> {
    Router::new().route("/openapi.json", get(read_openapi::read_openapi))
}

/// The job, or 404.
async fn existing(state: &AppState, id: JobId) -> Result<JobRecord, Refusal> {
    state.jobs().store().job(id).await?.ok_or_else(no_job)
}

/// The job if it succeeded, else 404 or the 409 that says why there is no result.
async fn succeeded(state: &AppState, id: JobId) -> Result<JobRecord, Refusal> {
    let job = existing(state, id).await?;
    match job.state {
        State::Succeeded => Ok(job),
        State::Queued | State::Running => {
            Err(Refusal::new(ProblemCode::ResultNotReady, format!("The job is {}.", job.state.word())))
        }
        State::Failed | State::Canceled => {
            Err(Refusal::new(ProblemCode::JobNotSucceeded, format!("The job is {}.", job.state.word())))
        }
    }
}

fn too_many_followers() -> Refusal {
    let detail = "As many clients follow jobs as the service allows.";
    Refusal::new(ProblemCode::TooManyStreams, detail).retry_after(RETRY_FOLLOW_S)
}

/// The stored document of a sweep, or 404.
async fn sweep_input(state: &AppState, id: JobId) -> Result<String, Refusal> {
    let job = existing(state, id).await?;
    if job.kind != JobKind::Sweep.as_str() {
        return Err(Refusal::not_found("The job is not a sweep."));
    }
    state.jobs().store().input(id).await?.ok_or_else(no_job)
}

fn no_job() -> Refusal {
    Refusal::not_found("There is no such job.")
}
