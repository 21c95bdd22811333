//! One handler per page.

use super::form::{self, Control, Group};
use super::{page_headers, plotly};
use askama::Template;
use axum::extract::Path;
use axum::http::StatusCode;
use axum::response::{Html, IntoResponse, Response};

#[derive(Template)]
#[template(path = "design.html")]
struct DesignPage {
    groups: &'static [Group],
    sweepable: &'static [String],
}

#[derive(Template)]
#[template(path = "jobs.html")]
struct JobsPage;

#[derive(Template)]
#[template(path = "job.html")]
struct JobPage {
    id: String,
    plotly_script: String,
}

#[derive(Template)]
#[template(path = "not_found.html")]
struct NotFoundPage;

/// `/`: the form for a new job, filled with the source paper's example.
pub async fn design() -> Response {
    page(StatusCode::OK, &DesignPage { groups: form::groups(), sweepable: form::sweepable_pointers() })
}

/// `/jobs`: the list of jobs.
pub async fn jobs() -> Response {
    page(StatusCode::OK, &JobsPage)
}

/// `/jobs/{id}`: one job. Whether it exists is for the API to say, which the page asks.
pub async fn job(Path(id): Path<String>) -> Response {
    page(StatusCode::OK, &JobPage { id, plotly_script: plotly::script_url() })
}

/// The page for addresses that lead nowhere (status 404); for the router's fallback.
pub async fn not_found() -> Response {
    page(StatusCode::NOT_FOUND, &NotFoundPage)
}

fn page(status: StatusCode, template: &impl Template) -> Response {
    match template.render() {
        Ok(html) => (status, page_headers(), Html(html)).into_response(),
        Err(error) => {
            tracing::error!(%error, "a page could not be rendered");
            StatusCode::INTERNAL_SERVER_ERROR.into_response()
        }
    }
}
