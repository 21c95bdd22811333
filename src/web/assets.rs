//! Stylesheets, script modules and the icon, built into the binary, and the module that is made from the declarations
//! of results.

use super::quantities;
use axum::extract::Path;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use headers::{HeaderMapExt, IfNoneMatch};
use rust_embed::{EmbeddedFile, RustEmbed};
use sha2::{Digest, Sha256};
use std::borrow::Cow;

#[derive(RustEmbed)]
#[folder = "src/web/assets/"]
struct Files;

/// The text of a module made by [`quantities`].
fn made(name: &str) -> Option<&'static str> {
    match name {
        "common/quantities.js" => Some(quantities::module()),
        "common/units.js" => Some(quantities::units_module()),
        _ => None,
    }
}

/// `/assets/{*file}`: revalidated by entity tag, so that a new version is used at once.
pub(super) async fn file(Path(name): Path<String>, headers: HeaderMap) -> Response {
    let Some((content, media_type)) = find(&name) else {
        return super::not_found().await;
    };
    answer(content, media_type, &headers)
}

/// A file in response to a request, revalidated by its entity tag.
pub(super) fn answer(content: Content, media_type: &str, headers: &HeaderMap) -> Response {
    let tag = entity_tag(&content);
    let known: Option<IfNoneMatch> = headers.typed_get();
    let is_known = known.zip(tag.parse().ok()).is_some_and(|(known, tag)| !known.precondition_passes(&tag));
    let caching = [(header::ETAG, tag), (header::CACHE_CONTROL, "no-cache".to_owned())];
    if is_known {
        return (StatusCode::NOT_MODIFIED, caching).into_response();
    }
    let kind = [(header::CONTENT_TYPE, media_type), (header::X_CONTENT_TYPE_OPTIONS, "nosniff")];
    (caching, kind, content.data.into_owned()).into_response()
}

/// `/favicon.ico`
pub(super) async fn favicon(headers: HeaderMap) -> Response {
    file(Path("favicon.ico".to_owned()), headers).await
}

/// The text of a file.
pub(super) fn text(name: &str) -> Option<String> {
    String::from_utf8(find(name)?.0.data.into_owned()).ok()
}

/// The bytes of a file, and the digest of which its entity tag is made.
pub(super) struct Content {
    data: Cow<'static, [u8]>,
    sha256: [u8; 32],
}

impl From<Cow<'static, [u8]>> for Content {
    fn from(data: Cow<'static, [u8]>) -> Self {
        Self { sha256: Sha256::digest(&data).into(), data }
    }
}

impl From<EmbeddedFile> for Content {
    fn from(file: EmbeddedFile) -> Self {
        Self { sha256: file.metadata.sha256_hash(), data: file.data }
    }
}

fn find(name: &str) -> Option<(Content, &'static str)> {
    let media_type = match name.rsplit_once('.')?.1 {
        "css" => "text/css; charset=utf-8",
        "js" => "text/javascript; charset=utf-8",
        "svg" => "image/svg+xml",
        "ico" => "image/vnd.microsoft.icon",
        _ => return None,
    };
    let content = match made(name) {
        Some(text) => Content::from(Cow::from(text.as_bytes())),
        None => Files::get(name)?.into(),
    };
    Some((content, media_type))
}

fn entity_tag(content: &Content) -> String {
    format!("\"{}\"", hex::encode(&content.sha256[..12]))
}
