//! The session cookie.

use super::session::SESSION_LIFETIME;
use axum::http::header::{COOKIE, ORIGIN};
use axum::http::{HeaderMap, HeaderName, HeaderValue};

const COOKIE_NAME: &str = "herringbone_session";
const X_FORWARDED_PROTO: HeaderName = HeaderName::from_static("x-forwarded-proto");

/// The session ids in the cookies of a request; there may be several cookies of the name, set for different paths.
pub(super) fn session_ids(headers: &HeaderMap) -> impl Iterator<Item = &str> {
    let lines = headers.get_all(COOKIE).into_iter().filter_map(|value| value.to_str().ok());
    let pairs = lines.flat_map(|line| line.split(';')).filter_map(|pair| pair.trim().split_once('='));
    pairs.filter(|(name, _)| *name == COOKIE_NAME).map(|(_, value)| value)
}

/// The `Set-Cookie` header of a new session.
pub(super) fn set(id: &str, request: &HeaderMap) -> Option<HeaderValue> {
    set_cookie(id, SESSION_LIFETIME.as_secs(), request)
}

/// The `Set-Cookie` header that removes the session cookie.
pub(super) fn clear(request: &HeaderMap) -> Option<HeaderValue> {
    set_cookie("", 0, request)
}

fn set_cookie(id: &str, max_age_s: u64, request: &HeaderMap) -> Option<HeaderValue> {
    let secure = if is_https(request) { "; Secure" } else { "" };
    let cookie = format!("{COOKIE_NAME}={id}; HttpOnly; SameSite=Strict; Path=/; Max-Age={max_age_s}{secure}");
    let mut value = HeaderValue::try_from(cookie).ok()?;
    value.set_sensitive(true);
    Some(value)
}

/// Whether the browser uses TLS (to a reverse proxy), by the header `Origin` or `X-Forwarded-Proto`. False in doubt:
/// browsers drop a cookie marked `Secure` on plain HTTP.
fn is_https(request: &HeaderMap) -> bool {
    let text = |name| request.get(name).and_then(|value: &HeaderValue| value.to_str().ok()).unwrap_or_default();
    let origin = text(ORIGIN);
    match origin.is_empty() || origin == "null" {
        true => text(X_FORWARDED_PROTO).trim().eq_ignore_ascii_case("https"),
        false => origin.starts_with("https://"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(&'static str, &'static str)]) -> HeaderMap {
        let pairs = pairs.iter().map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_static(value)));
        pairs.collect()
    }

    #[test]
    fn session_ids_are_found_among_other_cookies() {
        let ids = |line| session_ids(&headers(&[("cookie", line)])).map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(ids("a=b; herringbone_session=1;herringbone_session=2"), ["1", "2"]);
        assert!(ids("xherringbone_session=1; herringbone_sessio=2; herringbone_session").is_empty());
    }

    #[test]
    fn secure_only_where_tls_is_certain() {
        let secure = |pairs| set("1", &headers(pairs)).unwrap().to_str().unwrap().ends_with("; Secure");
        assert!(secure(&[("origin", "https://gears.example")]));
        assert!(secure(&[("x-forwarded-proto", "https")]));
        assert!(secure(&[("origin", "null"), ("x-forwarded-proto", "https")]));
        assert!(!secure(&[]));
        assert!(!secure(&[("origin", "null")]));
        assert!(!secure(&[("x-forwarded-proto", "https, http")]));
        assert!(!secure(&[("origin", "http://gears.example"), ("x-forwarded-proto", "https")]));
    }
}
