//! One handler per page.

use super::form::{self, Control, Group, Layout};
use super::presets::{self, PresetGroup};
use super::{page_headers, plotly};
use askama::Template;
use axum::Extension;
use axum::extract::Path;
use axum::http::StatusCode;
use axum::response::{Html, IntoResponse, Response};

#[derive(Template)]
#[template(path = "design.html")]
struct DesignPage {
    has_login: bool,
    groups: &'static [Group],
    sweepable: &'static [String],
    presets: &'static [PresetGroup],
}

#[derive(Template)]
#[template(path = "jobs.html")]
struct JobsPage {
    has_login: bool,
}

#[derive(Template)]
#[template(path = "job.html")]
struct JobPage {
    has_login: bool,
    id: String,
    plotly_script: String,
}

#[derive(Template)]
#[template(path = "compare.html")]
struct ComparePage {
    has_login: bool,
    plotly_script: String,
}

#[derive(Template)]
#[template(path = "report.html")]
struct ReportPage {
    has_login: bool,
    id: String,
    plotly_script: String,
}

#[derive(Template)]
#[template(path = "compare_report.html")]
struct CompareReportPage {
    has_login: bool,
    plotly_script: String,
}

#[derive(Template)]
#[template(path = "system.html")]
struct SystemPage {
    has_login: bool,
}

#[derive(Template)]
#[template(path = "not_found.html")]
struct NotFoundPage {
    has_login: bool,
}

#[derive(Template)]
#[template(path = "login.html")]
struct LoginPage<'a> {
    next: &'a str,
    error: &'a str,
}

/// Whether the service has a login, so that the pages offer to log out.
#[derive(Debug, Clone, Copy)]
pub(super) struct HasLogin(pub bool);

type Site = Extension<HasLogin>;

/// `/`: the form for a new job, filled with the source paper's example.
pub(super) async fn design(Extension(HasLogin(has_login)): Site) -> Response {
    let (groups, sweepable) = (form::groups(), form::sweepable_pointers());
    page(StatusCode::OK, &DesignPage { has_login, groups, sweepable, presets: presets::GROUPS })
}

/// `/jobs`: the list of jobs.
pub(super) async fn jobs(Extension(HasLogin(has_login)): Site) -> Response {
    page(StatusCode::OK, &JobsPage { has_login })
}

/// `/jobs/{id}`: one job. The page's script requests it from the API, also to find out whether it exists.
pub(super) async fn job(Extension(HasLogin(has_login)): Site, Path(id): Path<String>) -> Response {
    page(StatusCode::OK, &JobPage { has_login, id, plotly_script: plotly::script_url() })
}

/// `/compare`: jobs side by side. The page's script reads their ids from the query.
pub(super) async fn compare(Extension(HasLogin(has_login)): Site) -> Response {
    page(StatusCode::OK, &ComparePage { has_login, plotly_script: plotly::script_url() })
}

/// `/compare/report`: jobs side by side on paper.
pub(super) async fn compare_report(Extension(HasLogin(has_login)): Site) -> Response {
    page(StatusCode::OK, &CompareReportPage { has_login, plotly_script: plotly::script_url() })
}

/// `/jobs/{id}/report`: one job on paper.
pub(super) async fn report(Extension(HasLogin(has_login)): Site, Path(id): Path<String>) -> Response {
    page(StatusCode::OK, &ReportPage { has_login, id, plotly_script: plotly::script_url() })
}

/// `/system`: the service, its workers and what waits.
pub(super) async fn system(Extension(HasLogin(has_login)): Site) -> Response {
    page(StatusCode::OK, &SystemPage { has_login })
}

/// The page for unknown addresses (status 404); for the router's fallback.
pub async fn not_found() -> Response {
    page(StatusCode::NOT_FOUND, &NotFoundPage { has_login: false })
}

/// The login page, with an input for the token. It works without scripts and shows no data of the service.
pub fn login(status: StatusCode, next: &str, error: Option<&str>) -> Response {
    page(status, &LoginPage { next, error: error.unwrap_or_default() })
}

/// A page as a response; status 500 when it cannot be rendered.
pub(super) fn page(status: StatusCode, template: &impl Template) -> Response {
    rendered(template).map_or_else(IntoResponse::into_response, |html| (status, page_headers(), html).into_response())
}

/// The HTML of a page; status 500 when it cannot be rendered.
pub(super) fn rendered(template: &impl Template) -> Result<Html<String>, StatusCode> {
    template.render().map(Html).map_err(|error| {
        tracing::error!(%error, "a page could not be rendered");
        StatusCode::INTERNAL_SERVER_ERROR
    })
}
