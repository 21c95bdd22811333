//! Paths and the layers around them.

use super::config::{HttpConfig, MAX_BODY_BYTES};
use super::envelope::{answer_panic, envelope};
use super::openapi;
use super::problem::Refusal;
use super::request::chosen;
use super::routes;
use super::state::AppState;
use axum::Router;
use axum::extract::{DefaultBodyLimit, Request};
use axum::http::StatusCode;
use axum::middleware::from_fn;
use axum::response::{IntoResponse, Response};
use axum::routing::MethodRouter;
use tower::ServiceExt;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::timeout::TimeoutLayer;
use utoipa_swagger_ui::{Config, SwaggerUi};

/// The web pages, which the service carries without knowing them.
#[derive(Default)]
pub struct Pages {
    pub routes: Router,
    /// What browsers are shown at addresses that lead nowhere.
    pub not_found: MethodRouter,
}

/// The whole service; the pages are merged into it and get the same layers.
pub fn router(state: AppState, config: &HttpConfig, pages: Pages) -> Router {
    let not_found = pages.not_found;
    let (api, _document) = openapi::described_routes().split_for_parts();
    api.merge(routes::undescribed())
        .with_state(state)
        .merge(SwaggerUi::new("/docs").config(Config::from("/openapi.json")))
        .merge(pages.routes)
        .fallback(async move |request: Request| nothing_here(request, not_found).await)
        .layer(DefaultBodyLimit::max(MAX_BODY_BYTES))
        .layer(TimeoutLayer::with_status_code(StatusCode::REQUEST_TIMEOUT, config.request_timeout()))
        .layer(CatchPanicLayer::custom(answer_panic))
        .layer(from_fn(envelope))
        .layer(CompressionLayer::new())
}

/// A page for browsers, a problem for programs.
async fn nothing_here(request: Request, page: MethodRouter) -> Response {
    let liked = chosen(request.headers(), &["application/problem+json", "text/html"]);
    if matches!(liked, Ok("text/html")) && !request.uri().path().starts_with("/api/") {
        return page.oneshot(request).await.into_response();
    }
    Refusal::not_found("There is nothing at this path.").into_response()
}
