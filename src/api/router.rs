//! Paths and the layers around them.

use super::config::{HttpConfig, MAX_BODY_BYTES};
use super::envelope::{answer_panic, envelope};
use super::openapi;
use super::problem::Refusal;
use super::routes;
use super::state::AppState;
use axum::Router;
use axum::extract::DefaultBodyLimit;
use axum::http::StatusCode;
use axum::middleware::from_fn;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::timeout::TimeoutLayer;
use utoipa_swagger_ui::{Config, SwaggerUi};

/// The whole service; `pages` are merged into it and get the same layers.
pub fn router(state: AppState, config: &HttpConfig, pages: Router) -> Router {
    let (api, _document) = openapi::described_routes().split_for_parts();
    api.merge(routes::undescribed())
        .with_state(state)
        .merge(SwaggerUi::new("/docs").config(Config::from("/openapi.json")))
        .merge(pages)
        .fallback(async || Refusal::not_found("There is nothing at this path."))
        .layer(DefaultBodyLimit::max(MAX_BODY_BYTES))
        .layer(TimeoutLayer::with_status_code(StatusCode::REQUEST_TIMEOUT, config.request_timeout()))
        .layer(CatchPanicLayer::custom(answer_panic))
        .layer(from_fn(envelope))
        .layer(CompressionLayer::new())
}
