//! The router and its layers.

use super::config::{HttpConfig, MAX_BODY_BYTES, MAX_IMPORT_BYTES};
use super::guard::{
    Access, LoginRenderer, check_credentials, check_header_fields, check_host, check_origin, login_routes,
};
use super::middleware::{distinguish_encodings, panic_response, request_middleware};
use super::openapi;
use super::problem::ApiError;
use super::request::negotiate;
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

/// The web pages, passed in by the program: the HTTP interface does not depend on them.
#[derive(Default)]
pub struct Pages {
    pub routes: Router,
    /// The page for browsers at unknown paths.
    pub not_found: MethodRouter,
    /// The renderer of the page at `/login`, for a service with a token.
    pub login: LoginRenderer,
}

/// The router of the whole service; the pages get the same layers as the interface.
pub fn router(state: AppState, config: &HttpConfig, access: &Access, pages: Pages) -> Router {
    let not_found = pages.not_found;
    let state = state.with_limits(config);
    let (api, _document) = openapi::document_routes().split_for_parts();
    let (imports, _document) = openapi::import_routes().split_for_parts();
    let imports = imports
        .with_state(state.clone())
        .layer(DefaultBodyLimit::max(MAX_IMPORT_BYTES))
        .layer(RequestBodyLimitLayer::new(MAX_IMPORT_BYTES));
    api.merge(routes::undocumented())
        .with_state(state)
        .merge(pages.routes)
        .merge(login_routes(access, pages.login))
        .fallback(async move |request: Request| fallback(request, not_found).await)
        .layer(DefaultBodyLimit::max(MAX_BODY_BYTES))
        // The same bound on `Content-Length`, before any of the body is requested.
        .layer(RequestBodyLimitLayer::new(MAX_BODY_BYTES))
        // Files are larger than documents.
        .merge(imports)
        .layer(TimeoutLayer::with_status_code(StatusCode::REQUEST_TIMEOUT, config.request_timeout()))
        .layer(from_fn_with_state(access.clone(), check_credentials))
        .layer(check_origin())
        .layer(from_fn_with_state(access.clone(), check_host))
        .layer(from_fn(check_header_fields))
        .layer(CatchPanicLayer::custom(panic_response))
        .layer(from_fn(request_middleware))
        // Keeps secrets out of headers that inner layers log.
        .layer(SetSensitiveResponseHeadersLayer::new([SET_COOKIE]))
        .layer(SetSensitiveRequestHeadersLayer::new([AUTHORIZATION, COOKIE]))
        .layer(CompressionLayer::new())
        .layer(from_fn(distinguish_encodings))
}

/// The response at unknown paths: a page for browsers, a problem for programs.
async fn fallback(request: Request, page: MethodRouter) -> Response {
    let media_type = negotiate(request.headers(), &["application/problem+json", "text/html"]);
    if matches!(media_type, Ok("text/html")) && !request.uri().path().starts_with("/api/") {
        return page.oneshot(request).await.into_response();
    }
    ApiError::not_found("There is nothing at this path.").into_response()
}
