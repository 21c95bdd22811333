//! `GET /api/v1/jobs/{id}/events`

use crate::api::config::KEEP_ALIVE;
use crate::api::problem::Refusal;
use crate::api::request::JobPath;
use crate::api::state::AppState;
use crate::api::telemetry::OpenStream;
use crate::api::view::Job;
use crate::store::{JobId, JobRecord};
use crate::work::Subscription;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::{Stream, StreamExt, unfold};
use std::convert::Infallible;
use std::sync::Arc;
use tokio_util::sync::CancellationToken;

/// Follow a job as server-sent events.
///
/// The job as it stands comes first. Then `progress`, `state` (started, requeued, cancel asked) and at last `done`, after
/// which the stream ends. The data of every event is the whole job, its `id` the revision; a client that reconnects
/// misses nothing that still matters. The stream also ends when the service shuts down.
#[utoipa::path(
    get, path = "/jobs/{id}/events", tag = "jobs",
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
pub async fn watch_job(
    State(state): State<AppState>,
    JobPath(id): JobPath,
    headers: HeaderMap,
) -> Result<Response, Refusal> {
    // Subscribed before the job is read: no change falls in between.
    let changes = state.jobs().subscribe(id);
    let job = super::existing(&state, id).await?;
    if job.state.is_ended() && last_event(&headers) == Some(job.revision) {
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let place = (state.follow().ok_or_else(super::too_many_followers)?, OpenStream::new());
    let events = events(id, Arc::new(job), changes, state.jobs().closing().clone()).map(move |event| {
        let _ = &place;
        event
    });
    Ok(Sse::new(events).keep_alive(KeepAlive::new().interval(KEEP_ALIVE)).into_response())
}

fn last_event(headers: &HeaderMap) -> Option<i64> {
    headers.get("last-event-id")?.to_str().ok()?.parse().ok()
}

/// What was told last, and what is still to be told.
enum Told {
    Nothing(Arc<JobRecord>),
    Up(Arc<JobRecord>),
}

fn events(
    id: JobId,
    job: Arc<JobRecord>,
    changes: Subscription,
    closing: CancellationToken,
) -> impl Stream<Item = Result<Event, Infallible>> {
    unfold((Told::Nothing(job), changes, closing), move |(told, mut changes, closing)| async move {
        let (name, job) = match told {
            Told::Nothing(job) => (if job.state.is_ended() { "done" } else { "state" }, job),
            Told::Up(last) if last.state.is_ended() => return None,
            Told::Up(last) => {
                let newer = tokio::select! {
                    newer = changes.after(last.revision) => newer,
                    () = closing.cancelled() => return None,
                };
                (name_of(&last, &newer), newer)
            }
        };
        let event = Event::default().event(name).id(job.revision.to_string()).json_data(Job::from(job.as_ref()));
        let event = event.unwrap_or_else(|error| {
            tracing::error!(job = %id, %error, "event not written");
            Event::default().comment("event not written")
        });
        Some((Ok(event), (Told::Up(job), changes, closing)))
    })
}

fn name_of(last: &JobRecord, newer: &JobRecord) -> &'static str {
    let of = |job: &JobRecord| (job.state, job.attempt, job.cancel_requested_at);
    match newer.state.is_ended() {
        true => "done",
        false if of(last) != of(newer) => "state",
        false => "progress",
    }
}
