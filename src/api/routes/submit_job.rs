//! `POST /api/v1/jobs`

use crate::api::problem::ApiError;
use crate::api::request::{DocumentBody, IdempotencyKey, Prefer, RequestId, TraceParent};
use crate::api::state::AppState;
use crate::api::view::{Job, job_path, job_response};
use crate::work::SubmitRequest;
use axum::extract::State;
use axum::http::header::{LOCATION, RETRY_AFTER};
use axum::http::{HeaderMap, HeaderName, HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};

/// Submit a job.
///
/// The document is checked before it is accepted; every violation is answered at once. A job whose result is stored for
/// the same input ends at once and says so in `numerics.reused`.
#[utoipa::path(
    post, path = "/jobs", tag = "jobs", request_body(content = serde_json::Value, content_type = "application/json"),
    params(
        ("Idempotency-Key" = Option<String>, Header, description = "Names this submission (1 to 255 printable \
            ASCII characters): repeating it answers the first job.", min_length = 1, max_length = 255,
            pattern = r"^[!-~]([ -~]*[!-~])?$"),
        ("Prefer" = Option<String>, Header, description = "`wait=N`: answer when the job has ended, after N seconds at \
            the latest (N up to 30)."),
    ),
    responses(
        (status = 202, description = "Accepted; `Location` names the job.", body = Job, headers(
            ("Location" = String, description = "Path of the job"),
            ("Retry-After" = u64, description = "Seconds after which to look again; 0 when the job has ended"),
            ("Idempotent-Replayed" = Option<String>, description = "`true` when the submission was made before"))),
        (status = 200, description = "The job ended within the wait asked for.", body = Job, headers(
            ("Location" = String, description = "Path of the job"),
            ("Preference-Applied" = String, description = "`wait=N`"))),
        (status = 400, description = "The body is not JSON (`malformed-json`), or a header is invalid (`invalid-parameter`)."),
        (status = 413, description = "The body is larger than 1 MiB."),
        (status = 415, description = "The body is not `application/json`."),
        (status = 422, description = "`invalid-design`, `unsupported-design` or `idempotency-key-reused`."),
        (status = 503, description = "`queue-full`, `shutting-down` or `storage-unavailable`; `Retry-After` says when to try again."),
    )
)]
pub(super) async fn submit_job(
    State(state): State<AppState>,
    RequestId(request_id): RequestId,
    TraceParent(traceparent): TraceParent,
    IdempotencyKey(idempotency_key): IdempotencyKey,
    prefer: Prefer,
    DocumentBody(document): DocumentBody,
) -> Result<Response, ApiError> {
    let request = SubmitRequest { document, idempotency_key, request_id: Some(request_id), traceparent };
    let submitted = state.jobs().submit(request).await?;
    let mut job = submitted.job;
    let mut headers = HeaderMap::new();
    let wait = prefer.wait.and_then(|wait| Some((wait, state.follower_permit()?)));
    if let Some((wait, _)) = wait {
        job = state.jobs().wait(job.id, wait, |job| job.state.is_ended()).await?.ok_or_else(super::job_not_found)?;
        let applied = HeaderValue::try_from(format!("wait={}", wait.as_secs())).map_err(ApiError::internal)?;
        headers.insert(HeaderName::from_static("preference-applied"), applied);
    }
    headers.insert(LOCATION, HeaderValue::try_from(job_path(&job)).map_err(ApiError::internal)?);
    if submitted.replayed {
        headers.insert(HeaderName::from_static("idempotent-replayed"), HeaderValue::from_static("true"));
    }
    let ended_in_time = wait.is_some() && job.state.is_ended();
    let status = if ended_in_time { StatusCode::OK } else { StatusCode::ACCEPTED };
    if status == StatusCode::ACCEPTED && job.state.is_ended() {
        headers.insert(RETRY_AFTER, HeaderValue::from(0));
    }
    Ok((headers, job_response(status, &job)?).into_response())
}
