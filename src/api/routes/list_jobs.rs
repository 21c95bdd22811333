//! `GET /api/v1/jobs`

use crate::api::config::{DEFAULT_PAGE, MAX_PAGE, MAX_SEARCH_CHARS};
use crate::api::problem::{ApiError, ProblemCode};
use crate::api::request::{Cursor, QueryParameters};
use crate::api::state::AppState;
use crate::api::view::Job;
use crate::store::{JobFilter, JobOrder, JobSort, JobState};
use axum::Json;
use axum::extract::State;
use herringbone_job::document::JobKind;
use serde::Serialize;
use utoipa::ToSchema;

/// Some of the jobs that the filters permit, in the order asked for.
#[derive(Debug, Serialize, ToSchema)]
pub(super) struct JobList {
    pub items: Vec<Job>,
    /// Leads to the next page; null on the last.
    pub next_cursor: Option<String>,
    /// Number of all jobs that the filters permit.
    pub total: u64,
}

/// What a list is sorted by. Equal ones by submission, in the same direction; jobs without a value come last.
#[derive(Debug, Clone, Copy, ToSchema)]
#[schema(rename_all = "snake_case")]
#[expect(dead_code, reason = "only for the description: the names are in SORTS")]
pub(in crate::api) enum ListSort {
    Submitted,
    Ended,
    Name,
    Label,
    MeshCircumferentialAccelerationRms,
    DynamicFactor,
    TransmissionErrorPp,
}

/// Direction of a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ToSchema)]
#[schema(rename_all = "lowercase")]
pub(in crate::api) enum ListDirection {
    Asc,
    Desc,
}

const SORTS: [(&str, JobSort); 7] = [
    ("submitted", JobSort::Submitted),
    ("ended", JobSort::Ended),
    ("name", JobSort::Name),
    ("label", JobSort::Label),
    ("mesh_circumferential_acceleration_rms", JobSort::MeshAcceleration),
    ("dynamic_factor", JobSort::DynamicFactor),
    ("transmission_error_pp", JobSort::TransmissionError),
];

/// List jobs, newest first or in another order.
#[utoipa::path(
    get, path = "/jobs", tag = "jobs",
    params(
        ("state" = Option<Vec<JobState>>, Query, style = Form, explode = false, min_items = 1, description = "Any of these states, \
            separated by commas."),
        ("kind" = Option<JobKind>, Query, description = "Jobs of this kind."),
        ("label" = Option<String>, Query, description = "Exactly this label; an empty one counts as left out."),
        ("search" = Option<String>, Query, max_length = 200, description = "Part of the name, the label or the notes, in upper or lower \
            case; an empty one counts as left out."),
        ("from" = Option<String>, Query, format = DateTime, description = "Submitted at this time or later. A date alone stands for its \
            start in UTC.", example = "2026-01-31T08:00:00+01:00"),
        ("to" = Option<String>, Query, format = DateTime, description = "Submitted before this time. A date alone stands for its start in \
            UTC.", example = "2026-02-01T00:00:00Z"),
        ("sort" = Option<ListSort>, Query, description = "What the jobs are sorted by; `submitted` when left out. Names and labels regardless \
            of the case of ASCII letters. Jobs without a value come last in either direction."),
        ("order" = Option<ListDirection>, Query, description = "`asc` or `desc`; `asc` when left out for `name` and `label`, else `desc`: newest, \
            latest or largest first."),
        ("limit" = Option<u64>, Query, description = "Jobs per page, 1 to 200; more is taken for 200.", minimum = 1,
            example = 50),
        ("cursor" = Option<String>, Query, description = "`next_cursor` of the page before, with the same filters and order; an empty one \
            counts as left out."),
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
        search: query.short_text("search", MAX_SEARCH_CHARS),
        from: query.time("from"),
        to: query.time("to"),
    };
    let sort = query.choice("sort", &SORTS).unwrap_or_default();
    let direction = query.choice("order", &[("asc", ListDirection::Asc), ("desc", ListDirection::Desc)]);
    let descending = match direction {
        Some(direction) => direction == ListDirection::Desc,
        None => !matches!(sort, JobSort::Name | JobSort::Label),
    };
    let order = JobOrder { sort, descending };
    let limit = query.integer("limit", 1, MAX_PAGE.into(), true).map_or(DEFAULT_PAGE, |limit| limit as u32);
    let cursor = query.text("cursor");
    query.finish()?;
    let after = cursor.map(|text| decode_cursor(&text, &filter, order)).transpose()?;
    let store = state.jobs().store();
    let page = store.list(&filter, order, after.as_ref().map(|cursor| &cursor.0), limit).await?;
    let total = store.count(&filter).await?;
    let next_cursor = page.next.map(|place| Cursor(place).encode(&filter, order));
    Ok(Json(JobList { items: page.jobs.iter().map(Job::from).collect(), next_cursor, total }))
}

fn decode_cursor(text: &str, filter: &JobFilter, order: JobOrder) -> Result<Cursor, ApiError> {
    let detail =
        "The cursor was not made by this list with the same filters and order; an empty one counts as left out.";
    Cursor::decode(text, filter, order).ok_or_else(|| ApiError::new(ProblemCode::InvalidCursor, detail))
}
