//! The web pages: server-rendered templates and the files they load. Stateless: all data come from `/api/v1`, fetched
//! by the pages' own scripts.
//!
//! Invariant: no page loads anything from another host, and none has an inline script or style, so that
//! [`CONTENT_SECURITY_POLICY`] holds without exceptions for scripts.

mod assets;
mod form;
mod help;
mod modules;
mod pages;
mod plotly;
mod presets;
mod quantities;
mod swagger;

pub use pages::{login, not_found};

use axum::http::{HeaderName, HeaderValue, header};
use axum::routing::get;
use axum::{Extension, Router};

/// Content security policy of every page.
///
/// `img-src data: blob:` serves plotly.js: heat maps (a canvas turned into an image) and plots saved as images. Its
/// style rules come as a linked stylesheet, so inline style elements stay forbidden (the policy does not concern
/// styles that a script sets on elements).
pub const CONTENT_SECURITY_POLICY: &str = "default-src 'self'; img-src 'self' data: blob:; object-src 'none'; \
                                           base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

/// The pages `/`, `/jobs`, `/jobs/{id}`, `/jobs/{id}/report`, `/compare`, `/compare/report`, `/system`, `/docs`,
/// `/help` and below, and the files under `/assets/`. `has_login`: the service has a token, so that the pages offer to
/// log out.
pub fn routes(has_login: bool) -> Router {
    Router::new()
        .route("/", get(pages::design))
        .route("/jobs", get(pages::jobs))
        .route("/jobs/{id}", get(pages::job))
        .route("/jobs/{id}/report", get(pages::report))
        .route("/compare", get(pages::compare))
        .route("/compare/report", get(pages::compare_report))
        .route("/system", get(pages::system))
        .route("/docs", get(swagger::page))
        .route("/docs/", get(swagger::page))
        .route("/docs/{*file}", get(swagger::file))
        .route("/help", get(help::start))
        .route("/help/{*address}", get(help::topic))
        .route("/assets/plotly.js", get(plotly::script))
        .route("/assets/plotly.css", get(plotly::stylesheet))
        .route("/assets/presets.json", get(presets::presets))
        .route("/assets/{*file}", get(assets::file))
        // Asked for by browsers where a page links no icon.
        .route("/favicon.ico", get(assets::favicon))
        .layer(Extension(pages::HasLogin(has_login)))
}

/// Headers of every page. The login form needs `Referrer-Policy: same-origin`: under `no-referrer` browsers send forms
/// with `Origin: null`, which is refused as another site's.
fn page_headers() -> [(HeaderName, HeaderValue); 4] {
    [
        (header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(CONTENT_SECURITY_POLICY)),
        (header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff")),
        (header::REFERRER_POLICY, HeaderValue::from_static("same-origin")),
        (header::CACHE_CONTROL, HeaderValue::from_static("no-cache")),
    ]
}

#[cfg(test)]
mod tests;
