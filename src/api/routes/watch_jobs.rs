//! `GET /api/v1/jobs/events`

use crate::api::problem::ApiError;
use crate::api::request::QueryParameters;
use crate::api::state::AppState;
use crate::api::telemetry::OpenStream;
use crate::api::view::Job;
use crate::store::JobRecord;
use crate::work::{JobEvent, JobEventListener};
use axum::extract::State;
use axum::response::Response;
use axum::response::sse::Event;
use futures_util::stream::{Stream, StreamExt, unfold};
use herringbone_job::document::JobKind;
use serde_json::json;
use std::convert::Infallible;
use tokio_util::sync::CancellationToken;

/// Follow all jobs as server-sent events.
#[utoipa::path(
    get, path = "/jobs/events", tag = "jobs",
    description = "The first event is `reload`: read the list now, whatever changes afterwards is told. Then `state` \
        (submitted, started,\nrequeued, cancel asked, renamed), `progress` and `done`, each with the whole job as data, and \
        `deleted` with its `id`. Another\n`reload` comes when the client was too slow to be told everything, or when \
        many jobs were deleted at once: read the list\nagain. Events of one job may overtake each other; the greater \
        `revision` counts. There is no filter by state: a job that\nno longer fits one would have to be told as well. \
        A client that reconnects gets `reload` again; events have no `id`. The\nstream ends when the service shuts \
        down.",
    params(
        ("kind" = Option<JobKind>, Query, description = "Jobs of this kind; deletions are told of all."),
        ("label" = Option<String>, Query, description = "Exactly this label; an empty one counts as left out. Deletions \
            are told of all."),
    ),
    responses(
        (status = 200, description = "Events `reload`, `state`, `progress`, `done` and `deleted`.", body = Job,
            content_type = "text/event-stream"),
        (status = 400, description = "`invalid-parameter`."),
        (status = 503, description = "`too-many-streams`; `Retry-After` says when to try again."),
    )
)]
pub(super) async fn watch_jobs(
    State(state): State<AppState>,
    mut query: QueryParameters,
) -> Result<Response, ApiError> {
    let filter =
        EventFilter { kind: query.choice("kind", &JobKind::ALL).map(JobKind::as_str), label: query.text("label") };
    query.finish()?;
    let guards = (state.follower_permit().ok_or_else(super::too_many_followers)?, OpenStream::new());
    // Subscribed before the first event, which makes the client read the list: no change between the two is missed.
    let events = events(state.jobs().listen(), filter, state.jobs().closing().clone()).map(move |event| {
        let _ = &guards;
        event
    });
    Ok(super::event_stream(events))
}

/// Selects the jobs whose events are sent.
struct EventFilter {
    kind: Option<&'static str>,
    label: Option<String>,
}

impl EventFilter {
    fn permits(&self, event: &JobEvent) -> bool {
        match event {
            JobEvent::Progress(job) | JobEvent::Changed(job) => {
                self.kind.is_none_or(|kind| job.kind == kind) && (self.label.is_none() || self.label == job.label)
            }
            JobEvent::Deleted(_) | JobEvent::Resync => true,
        }
    }
}

fn events(
    listener: JobEventListener,
    filter: EventFilter,
    closing: CancellationToken,
) -> impl Stream<Item = Result<Event, Infallible>> {
    unfold((Some(JobEvent::Resync), listener, filter, closing), |(first, mut listener, filter, closing)| async move {
        let mut event = first;
        while event.as_ref().is_none_or(|event| !filter.permits(event)) {
            tokio::select! {
                next = listener.next() => event = Some(next),
                () = closing.cancelled() => return None,
            }
        }
        Some((Ok(to_sse(&event?)), (None, listener, filter, closing)))
    })
}

fn to_sse(event: &JobEvent) -> Event {
    match event {
        JobEvent::Progress(job) => job_event("progress", job),
        JobEvent::Changed(job) if job.state.is_ended() => job_event("done", job),
        JobEvent::Changed(job) => job_event("state", job),
        JobEvent::Deleted(id) => Event::default().event("deleted").data(json!({"id": id.to_string()}).to_string()),
        JobEvent::Resync => Event::default().event("reload").data("{}"),
    }
}

fn job_event(name: &str, job: &JobRecord) -> Event {
    Event::default().event(name).json_data(Job::from(job)).unwrap_or_else(|error| {
        tracing::error!(job = %job.id, %error, "event not written");
        Event::default().comment("event not written")
    })
}
