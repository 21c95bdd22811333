//! `GET /login`, `POST /login`, `POST /logout`: sessions for people with browsers.

use super::access::Access;
use super::cookie;
use super::credentials::wrong_token;
use crate::api::request::chosen;
use axum::extract::{DefaultBodyLimit, Query, State};
use axum::http::header::{CACHE_CONTROL, SET_COOKIE};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{Html, IntoResponse, Redirect, Response};
use axum::routing::{get, post};
use axum::{Form, Router};
use serde::Deserialize;
use std::fmt::Write;
use std::time::Instant;

/// A token and an address.
const MAX_FORM_BYTES: usize = 16 * 1024;
const MAX_ADDRESS_BYTES: usize = 2000;

/// What the login page shows.
#[derive(Debug)]
pub struct LoginNotice<'a> {
    pub status: StatusCode,
    /// Where the login leads: an address of this service.
    pub next: &'a str,
    /// Why the last attempt failed.
    pub trouble: Option<&'static str>,
}

/// Writes the login page: a form with the fields `token` and `next`.
#[derive(Clone, Copy)]
pub struct LoginPage(pub fn(&LoginNotice<'_>) -> Response);

impl Default for LoginPage {
    /// A bare form.
    fn default() -> Self {
        Self(|notice| {
            let form = "<!doctype html><title>Log in</title><form method=\"post\"><input name=\"token\"></form>";
            (notice.status, Html(form)).into_response()
        })
    }
}

#[derive(Deserialize)]
struct Entry {
    #[serde(default)]
    token: String,
    #[serde(default)]
    next: String,
}

#[derive(Deserialize)]
struct Target {
    #[serde(default)]
    next: String,
}

/// The routes of a service with a token; none without.
pub fn routes(access: &Access, page: LoginPage) -> Router {
    if access.lock().is_none() {
        return Router::new();
    }
    let form = async move |Query(target): Query<Target>| {
        let notice = LoginNotice { status: StatusCode::OK, next: local(&target.next), trouble: None };
        private((page.0)(&notice))
    };
    let enter = async move |State(access): State<Access>, headers: HeaderMap, Form(entry): Form<Entry>| {
        private(log_in(&access, page, &headers, &entry))
    };
    Router::new()
        .route("/login", get(form).post(enter))
        .route("/logout", post(log_out))
        .layer(DefaultBodyLimit::max(MAX_FORM_BYTES))
        .with_state(access.clone())
}

/// The login page's address, leading back to `target`.
pub fn login_address(target: &str) -> String {
    let mut address = "/login?next=".to_owned();
    for byte in local(target).bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => address.push(byte.into()),
            // Writing to a string cannot fail.
            _ => _ = write!(address, "%{byte:02X}"),
        }
    }
    address
}

/// A token without what comes along when it is copied: white space and a byte order mark.
fn pasted(token: &str) -> &str {
    token.trim_matches(|letter: char| letter.is_whitespace() || letter == '\u{feff}')
}

fn log_in(access: &Access, page: LoginPage, headers: &HeaderMap, entry: &Entry) -> Response {
    let Some(lock) = access.lock() else { return StatusCode::NOT_FOUND.into_response() };
    let (now, next) = (Instant::now(), local(&entry.next));
    if lock.token.is(pasted(&entry.token).as_bytes()) {
        let id = lock.sessions().open(now);
        return (cookie::set(&id, headers).map(|value| [(SET_COOKIE, value)]), Redirect::to(next)).into_response();
    }
    let refusal = wrong_token(lock, now);
    if !matches!(chosen(headers, &["application/problem+json", "text/html"]), Ok("text/html")) {
        return refusal;
    }
    let trouble = match refusal.status() {
        StatusCode::TOO_MANY_REQUESTS => "Too many wrong tokens were entered. Wait a moment.",
        _ => "This is not the token.",
    };
    let (mut shown, parts) =
        ((page.0)(&LoginNotice { status: refusal.status(), next, trouble: Some(trouble) }), refusal);
    // `WWW-Authenticate` and `Retry-After` stay.
    shown.headers_mut().extend(parts.into_parts().0.headers);
    shown
}

async fn log_out(State(access): State<Access>, headers: HeaderMap) -> Response {
    if let Some(lock) = access.lock() {
        cookie::sessions(&headers).for_each(|id| lock.sessions().end(id));
    }
    (cookie::clear(&headers).map(|value| [(SET_COOKIE, value)]), Redirect::to("/login")).into_response()
}

/// An address of this service as it is, anything else as `/`: no name of a host can be in it, in any spelling that
/// browsers understand.
fn local(address: &str) -> &str {
    let second = address.as_bytes().get(1);
    let is_local = address.starts_with('/')
        && !matches!(second, Some(b'/' | b'\\'))
        && address.len() <= MAX_ADDRESS_BYTES
        && address.bytes().all(|byte| byte.is_ascii_graphic() && byte != b'\\')
        && !["/login", "/logout"].contains(&address.split('?').next().unwrap_or_default());
    if is_local { address } else { "/" }
}

fn private(mut response: Response) -> Response {
    response.headers_mut().insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_back_stays_on_this_service() {
        for good in ["/", "/jobs", "/jobs/1?a=b&c=//x", "/?from=1", "/jobs#top"] {
            assert_eq!(local(good), good);
        }
        for bad in [
            "",
            "jobs",
            "//evil.example",
            "/\\evil.example",
            "\\\\evil.example",
            "https://evil.example",
            "/\t/evil.example",
            "/a\\b",
            " /jobs",
            "/jobs\n",
            "javascript:alert(1)",
            "/login",
            "/login?next=/",
            "/logout",
            "/ü",
        ] {
            assert_eq!(local(bad), "/", "{bad:?}");
        }
        assert_eq!(local(&format!("/{}", "x".repeat(2000))), "/");
    }

    #[test]
    fn the_way_back_is_one_parameter() {
        assert_eq!(
            login_address("/jobs?state=failed&label=a%20b"),
            "/login?next=/jobs%3Fstate%3Dfailed%26label%3Da%2520b"
        );
        assert_eq!(login_address("//evil.example"), "/login?next=/");
    }
}
