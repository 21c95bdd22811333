//! `GET /api/v1/jobs`

use crate::api::config::{DEFAULT_PAGE, MAX_PAGE};
use crate::api::problem::{ApiError, ProblemCode};
use crate::api::request::{Cursor, QueryParameters};
use crate::api::state::AppState;
use crate::api::view::Job;
use crate::store::{JobFilter, JobState};
use axum::Json;
use axum::extract::State;
use herringbone_job::document::JobKind;
use serde::Serialize;
use utoipa::ToSchema;

/// Jobs, newest first.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct JobList {
    pub items: Vec<Job>,
    /// Leads to the next page; null on the last.
    pub next_cursor: Option<String>,
}

/// List jobs, newest first.
#[utoipa::path(
    get, path = "/jobs", tag = "jobs",
    params(
        ("state" = Option<Vec<JobState>>, Query, style = Form, explode = false, min_items = 1, description = "Any of these states, \
            separated by commas."),
        ("kind" = Option<JobKind>, Query, description = "Jobs of this kind."),
        ("label" = Option<String>, Query, description = "Exactly this label; an empty one counts as left out."),
        ("limit" = Option<u64>, Query, description = "Jobs per page, 1 to 200; more is taken for 200.", minimum = 1,
            example = 50),
        ("cursor" = Option<String>, Query, description = "`next_cursor` of the page before, with the same filters; an empty one counts as left out."),
    ),
    responses(
        (status = 200, description = "A page of jobs.", body = JobList),
        (status = 400, description = "`invalid-parameter` or `invalid-cursor`."),
    )
)]
pub(super) async fn list_jobs(
    State(state): State<AppState>,
    mut query: QueryParameters,
) -> Result<Json<JobList>, ApiError> {
    let filter = JobFilter {
        states: query.choices("state", &JobState::ALL.map(|state| (state.as_str(), state))),
        kind: query.choice("kind", &JobKind::ALL).map(|kind| kind.as_str().to_owned()),
        label: query.text("label"),
    };
    let limit = query.integer("limit", 1, MAX_PAGE.into(), true).map_or(DEFAULT_PAGE, |limit| limit as u32);
    let cursor = query.text("cursor");
    query.finish()?;
    let before = cursor.map(|text| decode_cursor(&text, &filter)).transpose()?;
    let page = state.jobs().store().list(&filter, before.map(|cursor| cursor.0), limit).await?;
    let last = page.jobs.last().filter(|_| page.more);
    let next_cursor = last.map(|job| Cursor(job.id).encode(&filter));
    Ok(Json(JobList { items: page.jobs.iter().map(Job::from).collect(), next_cursor }))
}

fn decode_cursor(text: &str, filter: &JobFilter) -> Result<Cursor, ApiError> {
    let detail = "The cursor was not made by this list with the same filters; an empty one counts as left out.";
    Cursor::decode(text, filter).ok_or_else(|| ApiError::new(ProblemCode::InvalidCursor, detail))
}
