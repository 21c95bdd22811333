//! The token or a session, asked for on every path but a few.

use super::access::{Access, Lock};
use super::cookie;
use super::login::login_address;
use crate::api::problem::{ProblemCode, Refusal};
use crate::api::request::chosen;
use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, CACHE_CONTROL, CONTENT_TYPE, WWW_AUTHENTICATE};
use axum::http::{HeaderMap, HeaderValue, Method};
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};
use std::time::Instant;

/// What needs no credentials: probes, and the login page with what it shows.
const OPEN: [&str; 5] = ["/healthz", "/readyz", "/login", "/assets/common/style.css", "/assets/icon.svg"];

/// Middleware: lets those in who have the token, or a session opened with it.
pub async fn check_credentials(State(access): State<Access>, request: Request, next: Next) -> Response {
    let Some(lock) = access.lock() else { return next.run(request).await };
    if OPEN.contains(&request.uri().path()) {
        return next.run(request).await;
    }
    let now = Instant::now();
    match shown(request.headers()) {
        Shown::Token(token) if lock.token.is(token) => {}
        Shown::Session if has_session(lock, request.headers(), now) => {}
        Shown::Token(_) => return wrong_token(lock, now),
        Shown::Other => return unauthenticated("The request has no valid credentials."),
        Shown::Session => return ask(&request),
    }
    let mut response = next.run(request).await;
    keep_private(&mut response);
    response
}

/// What a request shows.
enum Shown<'a> {
    /// `Authorization: Bearer`.
    Token(&'a [u8]),
    /// `Authorization` in another form.
    Other,
    /// At best a cookie.
    Session,
}

fn shown(headers: &HeaderMap) -> Shown<'_> {
    let mut lines = headers.get_all(AUTHORIZATION).into_iter();
    let (line, more) = (lines.next(), lines.next());
    let Some(line) = line else { return Shown::Session };
    let bytes = line.as_bytes();
    match bytes.split_at_checked(7) {
        Some((scheme, token)) if more.is_none() && scheme.eq_ignore_ascii_case(b"bearer ") => {
            Shown::Token(token.trim_ascii())
        }
        _ => Shown::Other,
    }
}

fn has_session(lock: &Lock, headers: &HeaderMap, now: Instant) -> bool {
    let sessions = lock.sessions();
    cookie::sessions(headers).any(|id| sessions.is_open(id, now))
}

/// 401; after too many wrong tokens 429.
pub fn wrong_token(lock: &Lock, now: Instant) -> Response {
    match lock.failures().note(now) {
        Ok(()) => unauthenticated("The token is wrong."),
        Err(seconds) => {
            let detail = "Wrong tokens come too fast.";
            Refusal::new(ProblemCode::TooManyAttempts, detail).retry_after(seconds).into_response()
        }
    }
}

fn unauthenticated(detail: &str) -> Response {
    let mut response = Refusal::new(ProblemCode::Unauthenticated, detail).into_response();
    response.headers_mut().insert(WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
    response
}

/// The login page for people, 401 for programs.
fn ask(request: &Request) -> Response {
    let is_page = matches!(chosen(request.headers(), &["application/problem+json", "text/html"]), Ok("text/html"));
    let target = request.uri().path_and_query().map_or("/", |target| target.as_str());
    match *request.method() {
        Method::GET | Method::HEAD if is_page => Redirect::to(&login_address(target)).into_response(),
        // Whose session has ended meanwhile is where the button leads.
        Method::POST if is_page && target == "/logout" => Redirect::to("/login").into_response(),
        _ => unauthenticated("The request has no valid credentials."),
    }
}

/// Answers to those who showed credentials are for them only, unless a route has said how long they may be kept.
fn keep_private(response: &mut Response) {
    let media_type = response.headers().get(CONTENT_TYPE).and_then(|value| value.to_str().ok()).unwrap_or_default();
    let is_data = ["application/", "text/plain", "text/csv"].iter().any(|start| media_type.starts_with(start));
    if is_data || response.status().as_u16() >= 400 {
        response.headers_mut().entry(CACHE_CONTROL).or_insert(HeaderValue::from_static("no-store"));
    }
}
