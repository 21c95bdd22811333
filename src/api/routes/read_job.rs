//! `GET /api/v1/jobs/{id}`

use crate::api::problem::ApiError;
use crate::api::request::{IfNoneMatch, JobPath, Prefer};
use crate::api::state::AppState;
use crate::api::view::{Job, job_etag, job_response, not_modified};
use crate::store::JobRecord;
use axum::extract::State;
use axum::http::{HeaderName, HeaderValue, StatusCode};
use axum::response::Response;

/// Read a job, or wait for it.
#[utoipa::path(
    get, path = "/jobs/{id}", tag = "jobs",
    description = "With `Prefer: wait=N` the answer comes when the job has ended, after N seconds at the latest; \
        together with\n`If-None-Match` it comes as soon as the job is no longer what the client has. When as many \
        clients follow jobs as the\nservice allows, it comes at once, without `Preference-Applied`.",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("Prefer" = Option<String>, Header, description = "`wait=N` (N up to 30 s)"),
        ("If-None-Match" = Option<String>, Header, description = "Entity tag of the job as the client has it"),
    ),
    responses(
        (status = 200, description = "The job.", body = Job, headers(
            ("ETag" = String, description = "Weak entity tag: the revision"),
            ("Retry-After" = Option<u64>, description = "Seconds after which to look again, while the job lives"),
            ("Preference-Applied" = Option<String>, description = "`wait=N`"))),
        (status = 304, description = "The job is as the client has it."),
        (status = 404, description = "No such job."),
    )
)]
pub(super) async fn read_job(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    prefer: Prefer,
    if_none_match: IfNoneMatch,
) -> Result<Response, ApiError> {
    let is_known = |job: &JobRecord| job_etag(job).is_ok_and(|etag| if_none_match.matches(&etag));
    let is_awaited = |job: &JobRecord| job.state.is_ended() || (if_none_match.is_given() && !is_known(job));
    let wait = prefer.wait.and_then(|wait| Some((wait, state.follower_permit()?)));
    let job = match wait {
        Some((wait, _)) => state.jobs().wait(id, wait, is_awaited).await?.ok_or_else(super::job_not_found)?,
        None => super::find_job(&state, id).await?,
    };
    let mut response = if is_known(&job) { not_modified(job_etag(&job)?) } else { job_response(StatusCode::OK, &job)? };
    if let Some((wait, _)) = wait {
        let applied = HeaderValue::try_from(format!("wait={}", wait.as_secs())).map_err(ApiError::internal)?;
        response.headers_mut().insert(HeaderName::from_static("preference-applied"), applied);
    }
    Ok(response)
}
