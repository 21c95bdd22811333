//! Paths and the layers around them.

use super::config::{HttpConfig, MAX_BODY_BYTES};
use super::envelope::{answer_panic, envelope};
use super::guard::{Access, LoginPage, check_credentials, check_host, check_origin, login_routes};
use super::openapi;
use super::problem::Refusal;
use super::request::chosen;
use super::routes;
use super::state::AppState;
use axum::Router;
use axum::extract::{DefaultBodyLimit, Request};
use axum::http::StatusCode;
use axum::http::header::{AUTHORIZATION, COOKIE, SET_COOKIE};
use axum::middleware::{from_fn, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::MethodRouter;
use tower::ServiceExt;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::limit::RequestBodyLimitLayer;
use tower_http::sensitive_headers::{SetSensitiveRequestHeadersLayer, SetSensitiveResponseHeadersLayer};
use tower_http::timeout::TimeoutLayer;
use utoipa_swagger_ui::{Config, SwaggerUi};

/// The web pages, which the service carries without knowing them.
#[derive(Default)]
pub struct Pages {
    pub routes: Router,
    /// What browsers are shown at addresses that lead nowhere.
    pub not_found: MethodRouter,
    /// The page at `/login`, of a service with a token.
    pub login: LoginPage,
}

/// The whole service; the pages are merged into it and get the same layers.
pub fn router(state: AppState, config: &HttpConfig, access: &Access, pages: Pages) -> Router {
    let not_found = pages.not_found;
    let state = state.with_followers(config.connections.max_followers());
    let (api, _document) = openapi::described_routes().split_for_parts();
    api.merge(routes::undescribed())
        .with_state(state)
        .merge(SwaggerUi::new("/docs").config(Config::from("/openapi.json")))
        .merge(pages.routes)
        .merge(login_routes(access, pages.login))
        .fallback(async move |request: Request| nothing_here(request, not_found).await)
        .layer(DefaultBodyLimit::max(MAX_BODY_BYTES))
        // The same bound for what a request announces, before any of it is asked for.
        .layer(RequestBodyLimitLayer::new(MAX_BODY_BYTES))
        .layer(TimeoutLayer::with_status_code(StatusCode::REQUEST_TIMEOUT, config.request_timeout()))
        .layer(from_fn_with_state(access.clone(), check_credentials))
        .layer(check_origin())
        .layer(from_fn_with_state(access.clone(), check_host))
        .layer(CatchPanicLayer::custom(answer_panic))
        .layer(from_fn(envelope))
        // Whatever prints headers below here prints no secrets.
        .layer(SetSensitiveResponseHeadersLayer::new([SET_COOKIE]))
        .layer(SetSensitiveRequestHeadersLayer::new([AUTHORIZATION, COOKIE]))
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
