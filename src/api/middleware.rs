//! The outermost middleware: request id, log line, metrics, security headers, and the uniform form of errors.

use super::config::MAX_REQUEST_ID_CHARS;
use super::problem::{ApiError, Problem, ProblemCode};
use super::request::RequestId;
use axum::body::Body;
use axum::extract::{MatchedPath, Request};
use axum::http::header::{
    CONTENT_ENCODING, CONTENT_LENGTH, CONTENT_SECURITY_POLICY, CONTENT_TYPE, ETAG, IF_NONE_MATCH, REFERRER_POLICY,
    VARY, X_CONTENT_TYPE_OPTIONS, X_FRAME_OPTIONS,
};
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use std::any::Any;
use std::time::Instant;
use tracing::Instrument;
use uuid::Uuid;

const X_REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");

/// The content security policy of pages: no inline scripts or styles, no other origin.
const CONTENT_POLICY: &str =
    "default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

/// The content security policy of swagger-ui under `/docs`, whose script inserts inline styles.
const DOCS_CONTENT_POLICY: &str = "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; object-src 'none'; \
                           base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

/// Security headers of every response: no content sniffing, no framing, no access from other origins, no access to
/// devices.
const SECURITY_HEADERS: [(HeaderName, &str); 5] = [
    (X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (X_FRAME_OPTIONS, "DENY"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (
        HeaderName::from_static("permissions-policy"),
        "camera=(), display-capture=(), geolocation=(), microphone=(), payment=(), usb=()",
    ),
];

/// Middleware around all routes and all other layers but compression.
pub(super) async fn request_middleware(mut request: Request, next: Next) -> Response {
    let started = Instant::now();
    let id = request_id(request.headers());
    request.extensions_mut().insert(RequestId(id.clone()));
    let method = request.method().clone();
    let policy = if request.uri().path().starts_with("/docs") { DOCS_CONTENT_POLICY } else { CONTENT_POLICY };
    let route = request.extensions().get::<MatchedPath>().map_or("unmatched", MatchedPath::as_str).to_owned();

    let span = tracing::error_span!("request", request_id = id, %method, route);
    let response = next.run(request).instrument(span.clone()).await;
    let _entered = span.entered();
    let mut response = with_problem_body(response, &id);

    let status = response.status().as_u16();
    let duration = started.elapsed();
    tracing::info!(status, duration_ms = duration.as_secs_f64() * 1e3, "request");
    let labels = [("method", method_label(&method).to_owned()), ("route", route), ("status", status.to_string())];
    metrics::counter!("herringbone_http_requests_total", &labels).increment(1);
    metrics::histogram!("herringbone_http_request_duration_seconds", &labels[..2]).record(duration.as_secs_f64());
    add_headers(response.headers_mut(), &id, policy);
    response
}

/// Middleware around compression: makes the strong entity tag of a representation weak where it was compressed, as the
/// bytes are no longer the same (RFC 9110, 8.8.3).
pub(super) async fn distinguish_encodings(request: Request, next: Next) -> Response {
    let known: Vec<HeaderValue> = request.headers().get_all(IF_NONE_MATCH).into_iter().cloned().collect();
    let mut response = next.run(request).await;
    let is_not_modified = response.status() == StatusCode::NOT_MODIFIED;
    if is_not_modified {
        // As the response with the representation would.
        response.headers_mut().append(VARY, HeaderValue::from_static("accept-encoding"));
    }
    let Some(etag) = response.headers().get(ETAG).filter(|etag| etag.as_bytes().starts_with(b"\"")) else {
        return response;
    };
    let Ok(weak) = HeaderValue::try_from([b"W/", etag.as_bytes()].concat()) else { return response };
    // The client of a 304 knows the representation that its own tag names.
    let is_known_weak = || known.iter().any(|value| contains(value.as_bytes(), weak.as_bytes()));
    if response.headers().contains_key(CONTENT_ENCODING) || (is_not_modified && is_known_weak()) {
        response.headers_mut().insert(ETAG, weak);
    }
    response
}

fn contains(text: &[u8], part: &[u8]) -> bool {
    text.windows(part.len()).any(|window| window == part)
}

/// The response to a panic in a handler: a fixed text; the message of the panic is logged.
pub(super) fn panic_response(panic: Box<dyn Any + Send + 'static>) -> Response {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    let text = text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_default();
    metrics::counter!("herringbone_panics_total", "in" => "request").increment(1);
    ApiError::internal(format!("panic: {text}")).into_response()
}

/// The label of a method in metrics; unknown methods share one, as clients may invent any number.
fn method_label(method: &Method) -> &str {
    let known = [Method::GET, Method::HEAD, Method::POST, Method::PUT, Method::PATCH, Method::DELETE, Method::OPTIONS];
    if known.contains(method) { method.as_str() } else { "other" }
}

/// The request id sent by the client if it is one, short and printable, else a new one.
fn request_id(headers: &HeaderMap) -> String {
    let mut values = headers.get_all(X_REQUEST_ID).into_iter();
    let only = values.next().filter(|_| values.next().is_none());
    let given = only.and_then(|value| value.to_str().ok());
    let usable = given.filter(|id| (1..=MAX_REQUEST_ID_CHARS).contains(&id.len()) && id.chars().all(is_id_character));
    usable.map_or_else(|| Uuid::now_v7().to_string(), str::to_owned)
}

fn is_id_character(character: char) -> bool {
    character.is_ascii_alphanumeric() || "-_.:".contains(character)
}

/// Writes the body of an error response as `application/problem+json`, unless the handler wrote its own.
fn with_problem_body(mut response: Response, id: &str) -> Response {
    let status = response.status();
    if !status.is_client_error() && !status.is_server_error() {
        return response;
    }
    let (problem, cause) = match response.extensions_mut().remove::<ApiError>() {
        Some(error) => error.into_parts(),
        None if has_error_body(&response) => return response,
        None => {
            let code = ProblemCode::of_status(status);
            (Problem { status: status.as_u16(), ..Problem::new(code, code.entry().title) }, None)
        }
    };
    if let Some(cause) = cause {
        tracing::error!(cause, "request failed");
    }
    let problem = Problem { request_id: Some(id.to_owned()), ..problem };
    let body = serde_json::to_vec(&problem).unwrap_or_default();
    let (mut parts, _) = response.into_parts();
    parts.headers.remove(CONTENT_LENGTH);
    parts.headers.insert(CONTENT_TYPE, HeaderValue::from_static("application/problem+json"));
    Response::from_parts(parts, Body::from(body))
}

/// Whether a page or a handler wrote its own error body.
fn has_error_body(response: &Response) -> bool {
    let media_type = response.headers().get(CONTENT_TYPE).and_then(|value| value.to_str().ok()).unwrap_or_default();
    media_type.starts_with("text/html") || media_type.starts_with("application/problem+json")
}

fn add_headers(headers: &mut HeaderMap, id: &str, policy: &'static str) {
    if let Ok(value) = HeaderValue::from_str(id) {
        headers.insert(X_REQUEST_ID, value);
    }
    for (name, value) in SECURITY_HEADERS {
        headers.insert(name, HeaderValue::from_static(value));
    }
    // Pages may set their own.
    for (name, value) in [(REFERRER_POLICY, "no-referrer"), (CONTENT_SECURITY_POLICY, policy)] {
        headers.entry(name).or_insert(HeaderValue::from_static(value));
    }
}
