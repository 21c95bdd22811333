//! `GET /api/v1/jobs/{id}/events`

use crate::api::problem::ApiError;
use crate::api::request::JobPath;
use crate::api::state::AppState;
use crate::api::telemetry::OpenStream;
use crate::api::view::Job;
use crate::store::{JobId, JobRecord};
use crate::work::JobSubscription;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::sse::Event;
use axum::response::{IntoResponse, Response};
use futures_util::stream::{Stream, StreamExt, unfold};
use std::convert::Infallible;
use std::sync::Arc;
use tokio_util::sync::CancellationToken;

/// Follow a job as server-sent events.
#[utoipa::path(
    get, path = "/jobs/{id}/events", tag = "jobs",
    description = "The job as it stands comes first. Then `progress`, `state` (started, requeued, cancel asked, \
        renamed) and at last `done`, after\nwhich the stream ends. The data of every event is the whole job, its `id` the \
        revision; a client that reconnects\nmisses nothing that still matters. The stream also ends when the service \
        shuts down.",
    params(
        ("id" = String, Path, format = "uuid", description = "Id of the job"),
        ("Last-Event-ID" = Option<String>, Header, description = "Revision last seen; sent by browsers that reconnect"),
    ),
    responses(
        (status = 200, description = "Events `state`, `progress` and `done`, each with the job as data.", body = Job,
            content_type = "text/event-stream"),
        (status = 204, description = "The client has seen the end of this job (`Last-Event-ID`): do not reconnect."),
        (status = 404, description = "No such job."),
        (status = 503, description = "`too-many-streams`; `Retry-After` says when to try again."),
    )
)]
pub(super) async fn watch_job(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    headers: HeaderMap,
) -> Result<Response, ApiError> {
    // Subscribed before the job is read, so that no change between the two is missed.
    let changes = state.jobs().subscribe(id);
    let job = super::find_job(&state, id).await?;
    if job.state.is_ended() && last_event(&headers) == Some(job.revision) {
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let guards = (state.follower_permit().ok_or_else(super::too_many_followers)?, OpenStream::new());
    let events = events(id, Arc::new(job), changes, state.jobs().closing().clone()).map(move |event| {
        let _ = &guards;
        event
    });
    Ok(super::event_stream(events))
}

fn last_event(headers: &HeaderMap) -> Option<i64> {
    headers.get("last-event-id")?.to_str().ok()?.parse().ok()
}

/// The position in the event stream of a job.
enum StreamPosition {
    /// Before the first event, which shows this record.
    Start(Arc<JobRecord>),
    /// After an event that showed this record.
    After(Arc<JobRecord>),
}

fn events(
    id: JobId,
    job: Arc<JobRecord>,
    changes: JobSubscription,
    closing: CancellationToken,
) -> impl Stream<Item = Result<Event, Infallible>> {
    unfold((StreamPosition::Start(job), changes, closing), move |(position, mut changes, closing)| async move {
        let (name, job) = match position {
            StreamPosition::Start(job) => (if job.state.is_ended() { "done" } else { "state" }, job),
            StreamPosition::After(last) if last.state.is_ended() => return None,
            StreamPosition::After(last) => {
                let newer = tokio::select! {
                    newer = changes.after(last.revision) => newer,
                    () = closing.cancelled() => return None,
                };
                (event_name(&last, &newer), newer)
            }
        };
        let event = Event::default().event(name).id(job.revision.to_string()).json_data(Job::from(job.as_ref()));
        let event = event.unwrap_or_else(|error| {
            tracing::error!(job = %id, %error, "event not written");
            Event::default().comment("event not written")
        });
        Some((Ok(event), (StreamPosition::After(job), changes, closing)))
    })
}

fn event_name(last: &JobRecord, newer: &JobRecord) -> &'static str {
    let transition = |job: &JobRecord| (job.state, job.attempt, job.cancel_requested_at);
    let texts = |job: &JobRecord| [&job.name, &job.label, &job.notes].map(Clone::clone);
    match newer.state.is_ended() {
        true => "done",
        false if transition(last) != transition(newer) || texts(last) != texts(newer) => "state",
        false => "progress",
    }
}
