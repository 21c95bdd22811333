//! The check for the token or a session.

use super::access::{Access, Authenticator};
use super::cookie;
use super::login::login_url;
use crate::api::problem::{ApiError, ProblemCode};
use crate::api::request::negotiate;
use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, CACHE_CONTROL, CONTENT_TYPE, WWW_AUTHENTICATE};
use axum::http::{HeaderMap, HeaderValue, Method};
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};
use std::time::Instant;

/// Paths that need no credentials: probes, and the login page with its assets.
const PUBLIC_PATHS: [&str; 6] =
    ["/healthz", "/readyz", "/login", "/favicon.ico", "/assets/common/style.css", "/assets/icon.svg"];

/// Middleware: requires the token, or a session opened with it, except on [`PUBLIC_PATHS`].
pub(crate) async fn check_credentials(State(access): State<Access>, request: Request, next: Next) -> Response {
    let Some(authenticator) = access.authenticator() else { return next.run(request).await };
    if PUBLIC_PATHS.contains(&request.uri().path()) {
        return next.run(request).await;
    }
    let now = Instant::now();
    match credentials(request.headers()) {
        Credentials::Token(token) if authenticator.token.matches(token) => {}
        Credentials::Cookies if has_session(authenticator, request.headers(), now) => {}
        Credentials::Token(_) => return wrong_token(authenticator, now),
        Credentials::Other => return unauthenticated("The request has no valid credentials."),
        Credentials::Cookies => return request_login(&request),
    }
    let mut response = next.run(request).await;
    prevent_caching(&mut response);
    response
}

/// The credentials of a request.
enum Credentials<'a> {
    /// The token of `Authorization: Bearer`.
    Token(&'a [u8]),
    /// An `Authorization` header of another form.
    Other,
    /// No `Authorization` header; there may be a session cookie.
    Cookies,
}

fn credentials(headers: &HeaderMap) -> Credentials<'_> {
    let mut lines = headers.get_all(AUTHORIZATION).into_iter();
    let (line, more) = (lines.next(), lines.next());
    let Some(line) = line else { return Credentials::Cookies };
    let bytes = line.as_bytes();
    match bytes.split_at_checked(7) {
        Some((scheme, token)) if more.is_none() && scheme.eq_ignore_ascii_case(b"bearer ") => {
            Credentials::Token(token.trim_ascii())
        }
        _ => Credentials::Other,
    }
}

fn has_session(authenticator: &Authenticator, headers: &HeaderMap, now: Instant) -> bool {
    let sessions = authenticator.sessions();
    cookie::session_ids(headers).any(|id| sessions.is_open(id, now))
}

/// The response to a wrong token: 401, or 429 after too many.
pub(super) fn wrong_token(authenticator: &Authenticator, now: Instant) -> Response {
    match authenticator.failures().record(now) {
        Ok(()) => unauthenticated("The token is wrong."),
        Err(seconds) => {
            let detail = "Wrong tokens come too fast.";
            ApiError::new(ProblemCode::TooManyAttempts, detail).retry_after(seconds).into_response()
        }
    }
}

fn unauthenticated(detail: &str) -> Response {
    let mut response = ApiError::new(ProblemCode::Unauthenticated, detail).into_response();
    response.headers_mut().insert(WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
    response
}

/// The response without credentials: a redirect to the login page for browsers, 401 for programs.
fn request_login(request: &Request) -> Response {
    let is_page = matches!(negotiate(request.headers(), &["application/problem+json", "text/html"]), Ok("text/html"));
    let target = request.uri().path_and_query().map_or("/", |target| target.as_str());
    match *request.method() {
        Method::GET | Method::HEAD if is_page => Redirect::to(&login_url(target)).into_response(),
        // The session ended before the logout.
        Method::POST if is_page && target == "/logout" => Redirect::to("/login").into_response(),
        _ => unauthenticated("The request has no valid credentials."),
    }
}

/// Forbids caching of data and errors, unless the route set `Cache-Control` itself.
fn prevent_caching(response: &mut Response) {
    let media_type = response.headers().get(CONTENT_TYPE).and_then(|value| value.to_str().ok()).unwrap_or_default();
    let is_data = ["application/", "text/plain", "text/csv"].iter().any(|start| media_type.starts_with(start));
    if is_data || response.status().as_u16() >= 400 {
        response.headers_mut().entry(CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    }
}
