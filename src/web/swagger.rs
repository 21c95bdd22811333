//! The description of the HTTP interface in Swagger UI, inside the frame of the pages.

use super::assets::{Content, answer};
use super::pages::{HasLogin, rendered};
use askama::Template;
use axum::Extension;
use axum::extract::Path;
use axum::http::{HeaderMap, header};
use axum::response::{IntoResponse, Response};
use std::borrow::Cow;
use std::sync::{Arc, LazyLock};
use utoipa_swagger_ui::Config;

#[derive(Template)]
#[template(path = "docs.html")]
struct DocsPage {
    has_login: bool,
}

static CONFIG: LazyLock<Arc<Config<'static>>> = LazyLock::new(|| Arc::new(Config::from("/openapi.json")));

/// `/docs`: unlike the other pages without a content policy of its own, as the script inserts inline styles; the
/// interface has a policy for these paths.
pub(super) async fn page(Extension(HasLogin(has_login)): Extension<HasLogin>) -> Response {
    let html = rendered(&DocsPage { has_login });
    html.map(|html| ([(header::CACHE_CONTROL, "no-cache")], html)).into_response()
}

/// `/docs/{*file}`: the files of Swagger UI.
pub(super) async fn file(Path(name): Path<String>, headers: HeaderMap) -> Response {
    let file = utoipa_swagger_ui::serve(&name, Arc::clone(&CONFIG)).ok().flatten();
    match file.filter(|_| !name.ends_with(".html")) {
        Some(file) => answer(Content::from(Cow::from(file.bytes.into_owned())), &file.content_type, &headers),
        None => super::not_found().await,
    }
}
