//! The check of header fields that a request may have once (RFC 9110, 5.3), and of the presence of `Host` (RFC 9112,
//! 3.2).

use crate::api::problem::{ApiError, Problem, ProblemCode};
use axum::extract::Request;
use axum::http::header::{CONTENT_TYPE, HOST, ORIGIN};
use axum::http::{HeaderMap, HeaderName, Version};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use herringbone_job::Violation;

/// Fields with one value each, as their names are written. With two different ones, proxies and the service could act
/// on one each.
const SINGLE: [(HeaderName, &str); 5] = [
    (CONTENT_TYPE, "Content-Type"),
    (HeaderName::from_static("idempotency-key"), "Idempotency-Key"),
    (HeaderName::from_static("last-event-id"), "Last-Event-ID"),
    (ORIGIN, "Origin"),
    (HeaderName::from_static("sec-fetch-site"), "Sec-Fetch-Site"),
];

/// Middleware: refuses requests whose header fields contradict each other, and requests without or with several hosts.
pub(crate) async fn check_header_fields(request: Request, next: Next) -> Response {
    let needs_host = request.version() == Version::HTTP_11;
    match check(request.headers(), needs_host) {
        Ok(()) => next.run(request).await,
        Err(error) => error.into_response(),
    }
}

fn check(headers: &HeaderMap, needs_host: bool) -> Result<(), ApiError> {
    match headers.get_all(HOST).into_iter().count() {
        0 if needs_host => return Err(refusal("Host", "missing", "is missing; HTTP/1.1 requires it")),
        0 | 1 => {}
        _ => return Err(refusal("Host", "conflict", "is given more than once")),
    }
    for (field, name) in SINGLE {
        let mut values = headers.get_all(field).into_iter();
        let first = values.next();
        if values.any(|value| Some(value) != first) {
            return Err(refusal(name, "conflict", "is given more than once, with different values"));
        }
    }
    Ok(())
}

fn refusal(name: &str, code: &str, detail: &str) -> ApiError {
    let violation = Violation::new(format!("/{name}"), code, detail);
    Problem::new(ProblemCode::InvalidParameter, format!("The header {name} {detail}"))
        .with_errors(vec![violation])
        .into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_with_one_value_is_not_given_twice() {
        for (name, text) in SINGLE {
            let mut headers = HeaderMap::new();
            headers.insert(HOST, "localhost".parse().unwrap());
            for (value, is_accepted) in [("a", true), ("a", true), ("b", false)] {
                headers.append(name.clone(), value.parse().unwrap());
                assert_eq!(check(&headers, true).is_ok(), is_accepted, "{text}: {headers:?}");
            }
            assert!(text.eq_ignore_ascii_case(name.as_str()));
        }
    }

    #[test]
    fn one_host_and_in_http_1_0_perhaps_none() {
        let mut headers = HeaderMap::new();
        assert!(check(&headers, true).is_err() && check(&headers, false).is_ok());
        headers.append(HOST, "localhost".parse().unwrap());
        assert!(check(&headers, true).is_ok() && check(&headers, false).is_ok());
        headers.append(HOST, "localhost".parse().unwrap());
        assert!(check(&headers, true).is_err() && check(&headers, false).is_err());
    }
}
