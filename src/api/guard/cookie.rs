//! The cookie that names a browser's session.

use super::session::LIFETIME;
use axum::http::header::{COOKIE, ORIGIN};
use axum::http::{HeaderMap, HeaderName, HeaderValue};

const NAME: &str = "herringbone_session";
const FORWARDED_PROTOCOL: HeaderName = HeaderName::from_static("x-forwarded-proto");

/// The session ids that a request carries (more than one where cookies of several paths meet).
pub fn sessions(headers: &HeaderMap) -> impl Iterator<Item = &str> {
    let lines = headers.get_all(COOKIE).into_iter().filter_map(|value| value.to_str().ok());
    let pairs = lines.flat_map(|line| line.split(';')).filter_map(|pair| pair.trim().split_once('='));
    pairs.filter(|(name, _)| *name == NAME).map(|(_, value)| value)
}

/// `Set-Cookie` of a new session.
pub fn set(id: &str, request: &HeaderMap) -> Option<HeaderValue> {
    written(id, LIFETIME.as_secs(), request)
}

/// `Set-Cookie` that makes the browser forget the session.
pub fn clear(request: &HeaderMap) -> Option<HeaderValue> {
    written("", 0, request)
}

fn written(id: &str, seconds: u64, request: &HeaderMap) -> Option<HeaderValue> {
    let secure = if came_by_https(request) { "; Secure" } else { "" };
    let cookie = format!("{NAME}={id}; HttpOnly; SameSite=Strict; Path=/; Max-Age={seconds}{secure}");
    let mut value = HeaderValue::try_from(cookie).ok()?;
    value.set_sensitive(true);
    Some(value)
}

/// Whether the browser speaks TLS, to a proxy in front: its page's origin says so, or the proxy. With doubts it does not;
/// a cookie marked `Secure` would be lost on plain HTTP.
fn came_by_https(request: &HeaderMap) -> bool {
    let text = |name| request.get(name).and_then(|value: &HeaderValue| value.to_str().ok()).unwrap_or_default();
    let origin = text(ORIGIN);
    match origin.is_empty() || origin == "null" {
        true => text(FORWARDED_PROTOCOL).trim().eq_ignore_ascii_case("https"),
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
    fn found_among_other_cookies() {
        let found = |line| sessions(&headers(&[("cookie", line)])).map(str::to_owned).collect::<Vec<_>>();
        assert_eq!(found("a=b; herringbone_session=1;herringbone_session=2"), ["1", "2"]);
        assert!(found("xherringbone_session=1; herringbone_sessio=2; herringbone_session").is_empty());
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
