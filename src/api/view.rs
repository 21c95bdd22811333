//! The representation of jobs in responses.

use super::config::RETRY_LIVE_S;
use super::problem::{ApiError, Problem};
use crate::store::{Headline, JobRecord, JobState};
use axum::Json;
use axum::http::header::{CACHE_CONTROL, RETRY_AFTER};
use axum::http::{HeaderValue, StatusCode};
use axum::response::{IntoResponse, Response};
use headers::{ETag, HeaderMapExt};
use herringbone_job::document::JobKind;
use serde::Serialize;
use utoipa::ToSchema;

/// A job as it stands. Times are RFC 3339 in UTC.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(super) struct Job {
    #[schema(example = "0199f3c4-6f0b-7c41-9d5e-2f1f0f6f3c11", format = "uuid")]
    pub id: String,
    /// `mesh`, `response` or `sweep`.
    pub kind: String,
    pub name: Option<String>,
    pub label: Option<String>,
    /// What people noted on the job; `PATCH` changes name, label and notes.
    pub notes: Option<String>,
    pub state: JobState,
    /// Grows with every change; the `id` of the events and the entity tag of this answer.
    pub revision: i64,
    /// How often the job was started.
    pub attempt: i64,
    /// Fraction of the whole job, 0 to 1.
    pub progress: f64,
    /// Stage reported last; null once the job has ended (the `error` of a failed one names its stage).
    pub stage: Option<String>,
    #[schema(format = DateTime)]
    pub submitted_at: String,
    #[schema(format = DateTime)]
    pub started_at: Option<String>,
    #[schema(format = DateTime)]
    pub ended_at: Option<String>,
    /// Set while a cancel is under way, and after it.
    #[schema(format = DateTime)]
    pub cancel_requested_at: Option<String>,
    /// Content hash of everything that decides the result.
    pub input_hash: String,
    pub solver_version: String,
    /// Job whose result was taken because the input was the same.
    #[schema(format = "uuid")]
    pub reused_from: Option<String>,
    /// Why the job failed; null in every other state.
    pub error: Option<Problem>,
    /// Numbers of the result; null where a job has none of them.
    pub headline: Option<JobHeadline>,
    pub links: JobLinks,
}

/// Numbers of the result of a job, by which lists can be sorted. Null where the result does not have one.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub(super) struct JobHeadline {
    /// Root mean square of the circumferential acceleration of the mesh, the larger one of both halves.
    pub mesh_circumferential_acceleration_rms_m_s2: Option<f64>,
    pub dynamic_factor: Option<f64>,
    /// Transmission error, peak to peak.
    pub transmission_error_pp_um: Option<f64>,
}

/// Paths of what belongs to a job.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub(super) struct JobLinks {
    #[serde(rename = "self")]
    pub itself: String,
    pub events: String,
    pub input: String,
    pub result: String,
    pub series: String,
    /// Of a sweep.
    pub points: Option<String>,
}

impl From<&JobRecord> for Job {
    fn from(job: &JobRecord) -> Self {
        let path = job_path(job);
        Self {
            id: job.id.to_string(),
            kind: job.kind.clone(),
            name: job.name.clone(),
            label: job.label.clone(),
            notes: job.notes.clone(),
            state: job.state,
            revision: job.revision,
            attempt: job.attempt,
            progress: job.progress,
            stage: if job.state.is_ended() { None } else { job.stage.clone() },
            submitted_at: job.submitted_at.to_string(),
            started_at: job.started_at.map(|time| time.to_string()),
            ended_at: job.ended_at.map(|time| time.to_string()),
            cancel_requested_at: job.cancel_requested_at.map(|time| time.to_string()),
            input_hash: job.input_hash.clone(),
            solver_version: job.solver_version.clone(),
            reused_from: job.reused_from.map(|id| id.to_string()),
            error: Problem::of_job(job),
            headline: JobHeadline::of(job.headline),
            links: JobLinks {
                events: format!("{path}/events"),
                input: format!("{path}/input"),
                result: format!("{path}/result"),
                series: format!("{path}/series"),
                points: has_rows(&job.kind).then(|| format!("{path}/points")),
                itself: path,
            },
        }
    }
}

impl JobHeadline {
    fn of(headline: Headline) -> Option<Self> {
        (headline != Headline::default()).then_some(Self {
            mesh_circumferential_acceleration_rms_m_s2: headline.mesh_acceleration_rms_m_s2,
            dynamic_factor: headline.dynamic_factor,
            transmission_error_pp_um: headline.transmission_error_pp_um,
        })
    }
}

/// Whether jobs of a kind have rows.
pub(super) fn has_rows(kind: &str) -> bool {
    [JobKind::Sweep, JobKind::Optimise, JobKind::Tolerance].iter().any(|with_rows| with_rows.as_str() == kind)
}

/// The path of a job.
pub(super) fn job_path(job: &JobRecord) -> String {
    format!("/api/v1/jobs/{}", job.id)
}

/// The weak entity tag of a job: its revision.
pub(super) fn job_etag(job: &JobRecord) -> Result<ETag, ApiError> {
    format!("W/\"{}\"", job.revision).parse().map_err(ApiError::internal)
}

/// The response with a job: its entity tag, and `Retry-After` until it has ended.
pub(super) fn job_response(status: StatusCode, job: &JobRecord) -> Result<Response, ApiError> {
    let mut response = (status, Json(Job::from(job))).into_response();
    response.headers_mut().typed_insert(job_etag(job)?);
    response.headers_mut().insert(CACHE_CONTROL, HeaderValue::from_static("no-cache"));
    if !job.state.is_ended() {
        response.headers_mut().insert(RETRY_AFTER, HeaderValue::from(RETRY_LIVE_S));
    }
    Ok(response)
}

/// The response 304 with the entity tag.
pub(super) fn not_modified(etag: ETag) -> Response {
    let mut response = StatusCode::NOT_MODIFIED.into_response();
    response.headers_mut().typed_insert(etag);
    response
}
