//! `GET /api/v1/jobs/{id}`

use crate::api::problem::Refusal;
use crate::api::request::{IfNoneMatch, JobPath, Prefer};
use crate::api::state::AppState;
use crate::api::view::{Job, job_etag, job_response, not_modified};
use crate::store::JobRecord;
use axum::extract::State;
use axum::http::{HeaderName, HeaderValue, StatusCode};
use axum::response::Response;

/// Read a job, or wait for it.
///
/// With `Prefer: wait=N` the answer comes when the job has ended, after N seconds at the latest; together with
/// `If-None-Match` it comes as soon as the job is no longer what the client has. When as many clients follow jobs as the
/// service allows, it comes at once, without `Preference-Applied`.
#[utoipa::path(
    get, path = "/jobs/{id}", tag = "jobs",
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
pub async fn read_job(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    prefer: Prefer,
    known: IfNoneMatch,
) -> Result<Response, Refusal> {
    let is_news = |job: &JobRecord| !known.has(&job_etag(job));
    let enough = |job: &JobRecord| job.state.is_ended() || (known.is_given() && is_news(job));
    let wait = prefer.wait.and_then(|wait| Some((wait, state.follow()?)));
    let job = match wait {
        Some((wait, _)) => state.jobs().wait(id, wait, enough).await?.ok_or_else(super::no_job)?,
        None => super::existing(&state, id).await?,
    };
    let mut response = if is_news(&job) { job_response(StatusCode::OK, &job) } else { not_modified(job_etag(&job)) };
    if let Some((wait, _)) = wait {
        let applied = HeaderValue::try_from(format!("wait={}", wait.as_secs())).map_err(Refusal::internal)?;
        response.headers_mut().insert(HeaderName::from_static("preference-applied"), applied);
    }
    Ok(response)
}
