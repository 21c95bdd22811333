//! `GET /api/v1/jobs/events`

use crate::api::config::KEEP_ALIVE;
use crate::api::problem::Refusal;
use crate::api::request::Parameters;
use crate::api::state::AppState;
use crate::api::telemetry::OpenStream;
use crate::api::view::Job;
use crate::store::JobRecord;
use crate::work::{Listener, News};
use axum::extract::State;
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::{Stream, StreamExt, unfold};
use herringbone_job::document::JobKind;
use serde_json::json;
use std::convert::Infallible;
use tokio_util::sync::CancellationToken;

/// Follow all jobs as server-sent events.
///
/// The first event is `reload`: read the list now, whatever changes afterwards is told. Then `state` (submitted, started,
/// requeued, cancel asked), `progress` and `done`, each with the whole job as data, and `deleted` with its `id`. Another
/// `reload` comes when the client was too slow to be told everything, or when many jobs were deleted at once: read the list
/// again. Events of one job may overtake each other; the greater `revision` counts. There is no filter by state: a job that
/// no longer fits one would have to be told as well. A client that reconnects gets `reload` again; events have no `id`. The
/// stream ends when the service shuts down.
#[utoipa::path(
    get, path = "/jobs/events", tag = "jobs",
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
pub async fn watch_jobs(State(state): State<AppState>, mut query: Parameters) -> Result<Response, Refusal> {
    let filter = Filter { kind: query.choice("kind", &JobKind::ALL).map(JobKind::as_str), label: query.text("label") };
    query.finish()?;
    let place = (state.follow().ok_or_else(super::too_many_followers)?, OpenStream::new());
    // Listens from here on: what the client reads after the first event holds everything before.
    let events = events(state.jobs().listen(), filter, state.jobs().closing().clone()).map(move |event| {
        let _ = &place;
        event
    });
    Ok(Sse::new(events).keep_alive(KeepAlive::new().interval(KEEP_ALIVE)).into_response())
}

/// Which jobs are told.
struct Filter {
    kind: Option<&'static str>,
    label: Option<String>,
}

impl Filter {
    fn permits(&self, news: &News) -> bool {
        match news {
            News::Progress(job) | News::State(job) => {
                self.kind.is_none_or(|kind| job.kind == kind) && (self.label.is_none() || self.label == job.label)
            }
            News::Deleted(_) | News::Several => true,
        }
    }
}

fn events(
    listener: Listener,
    filter: Filter,
    closing: CancellationToken,
) -> impl Stream<Item = Result<Event, Infallible>> {
    unfold((Some(News::Several), listener, filter, closing), |(first, mut listener, filter, closing)| async move {
        let mut news = first;
        while news.as_ref().is_none_or(|news| !filter.permits(news)) {
            tokio::select! {
                next = listener.next() => news = Some(next),
                () = closing.cancelled() => return None,
            }
        }
        Some((Ok(event(&news?)), (None, listener, filter, closing)))
    })
}

fn event(news: &News) -> Event {
    match news {
        News::Progress(job) => about("progress", job),
        News::State(job) if job.state.is_ended() => about("done", job),
        News::State(job) => about("state", job),
        News::Deleted(id) => Event::default().event("deleted").data(json!({"id": id.to_string()}).to_string()),
        News::Several => Event::default().event("reload").data("{}"),
    }
}

fn about(name: &str, job: &JobRecord) -> Event {
    Event::default().event(name).json_data(Job::from(job)).unwrap_or_else(|error| {
        tracing::error!(job = %job.id, %error, "event not written");
        Event::default().comment("event not written")
    })
}
