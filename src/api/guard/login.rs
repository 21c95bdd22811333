//! `GET /login`, `POST /login`, `POST /logout`: sessions of browsers.

use super::access::Access;
use super::cookie;
use super::credentials::wrong_token;
use crate::api::request::negotiate;
use axum::extract::{DefaultBodyLimit, Query, State};
use axum::http::header::{CACHE_CONTROL, SET_COOKIE};
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::{Html, IntoResponse, Redirect, Response};
use axum::routing::{get, post};
use axum::{Form, Router};
use serde::Deserialize;
use std::fmt::Write;
use std::time::Instant;

/// Largest body of the login form: a token and a path.
const MAX_FORM_BYTES: usize = 16 * 1024;
/// Longest path to which a login leads.
const MAX_PATH_BYTES: usize = 2000;

/// The variable content of the login page.
#[derive(Debug)]
pub struct LoginNotice<'a> {
    pub status: StatusCode,
    /// Path on this service to which the login leads.
    pub next: &'a str,
    /// Message about the failure of the last attempt.
    pub error: Option<&'static str>,
}

/// The function that renders the login page: a form with the fields `token` and `next`.
#[derive(Clone, Copy)]
pub struct LoginRenderer(pub fn(&LoginNotice<'_>) -> Response);

impl Default for LoginRenderer {
    /// A bare form.
    fn default() -> Self {
        Self(|notice| {
            let form = "<!doctype html><title>Log in</title><form method=\"post\"><input name=\"token\"></form>";
            (notice.status, Html(form)).into_response()
        })
    }
}

#[derive(Deserialize)]
struct LoginForm {
    #[serde(default)]
    token: String,
    #[serde(default)]
    next: String,
}

#[derive(Deserialize)]
struct LoginQuery {
    #[serde(default)]
    next: String,
}

/// The routes for login and logout; none for a service without a token.
pub(crate) fn routes(access: &Access, renderer: LoginRenderer) -> Router {
    if access.authenticator().is_none() {
        return Router::new();
    }
    let show = async move |Query(query): Query<LoginQuery>| {
        let notice = LoginNotice { status: StatusCode::OK, next: local_path(&query.next), error: None };
        without_caching((renderer.0)(&notice))
    };
    let submit = async move |State(access): State<Access>, headers: HeaderMap, Form(form): Form<LoginForm>| {
        without_caching(log_in(&access, renderer, &headers, &form))
    };
    Router::new()
        .route("/login", get(show).post(submit))
        .route("/logout", post(log_out))
        .layer(DefaultBodyLimit::max(MAX_FORM_BYTES))
        .with_state(access.clone())
}

/// The URL of the login page with `target` as the path to return to.
pub(super) fn login_url(target: &str) -> String {
    let mut url = "/login?next=".to_owned();
    for byte in local_path(target).bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => url.push(byte.into()),
            // Writing to a string cannot fail.
            _ => _ = write!(url, "%{byte:02X}"),
        }
    }
    url
}

/// Removes white space and a byte order mark around a token that was pasted.
fn trim_pasted(token: &str) -> &str {
    token.trim_matches(|letter: char| letter.is_whitespace() || letter == '\u{feff}')
}

fn log_in(access: &Access, renderer: LoginRenderer, headers: &HeaderMap, form: &LoginForm) -> Response {
    let Some(authenticator) = access.authenticator() else { return StatusCode::NOT_FOUND.into_response() };
    let (now, next) = (Instant::now(), local_path(&form.next));
    if authenticator.token.matches(trim_pasted(&form.token).as_bytes()) {
        let id = authenticator.sessions().open(now);
        return (cookie::set(&id, headers).map(|value| [(SET_COOKIE, value)]), Redirect::to(next)).into_response();
    }
    let error = wrong_token(authenticator, now);
    if !matches!(negotiate(headers, &["application/problem+json", "text/html"]), Ok("text/html")) {
        return error;
    }
    let message = match error.status() {
        StatusCode::TOO_MANY_REQUESTS => "Too many wrong tokens were entered. Wait a moment.",
        _ => "This is not the token.",
    };
    let mut page = (renderer.0)(&LoginNotice { status: error.status(), next, error: Some(message) });
    // `WWW-Authenticate` and `Retry-After` stay.
    page.headers_mut().extend(error.into_parts().0.headers);
    page
}

async fn log_out(State(access): State<Access>, headers: HeaderMap) -> Response {
    if let Some(authenticator) = access.authenticator() {
        cookie::session_ids(&headers).for_each(|id| authenticator.sessions().end(id));
    }
    (cookie::clear(&headers).map(|value| [(SET_COOKIE, value)]), Redirect::to("/login")).into_response()
}

/// Returns a path on this service unchanged and anything else as `/`, so that a redirect never leads to another host in
/// any spelling that browsers understand.
fn local_path(path: &str) -> &str {
    let second = path.as_bytes().get(1);
    let is_local = path.starts_with('/')
        && !matches!(second, Some(b'/' | b'\\'))
        && path.len() <= MAX_PATH_BYTES
        && path.bytes().all(|byte| byte.is_ascii_graphic() && byte != b'\\')
        && !["/login", "/logout"].contains(&path.split('?').next().unwrap_or_default());
    if is_local { path } else { "/" }
}

fn without_caching(mut response: Response) -> Response {
    response.headers_mut().insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_path_to_return_to_is_on_this_service() {
        for good in ["/", "/jobs", "/jobs/1?a=b&c=//x", "/?from=1", "/jobs#top"] {
            assert_eq!(local_path(good), good);
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
            assert_eq!(local_path(bad), "/", "{bad:?}");
        }
        assert_eq!(local_path(&format!("/{}", "x".repeat(2000))), "/");
    }

    #[test]
    fn the_path_to_return_to_is_one_parameter() {
        assert_eq!(login_url("/jobs?state=failed&label=a%20b"), "/login?next=/jobs%3Fstate%3Dfailed%26label%3Da%2520b");
        assert_eq!(login_url("//evil.example"), "/login?next=/");
    }
}
