//! The headers of each kind of answer, as a whole.

use super::*;

/// Every header but those that differ from run to run.
fn shown(answer: &Answer) -> Vec<String> {
    let varying = ["x-request-id", "etag", "content-length", "date"];
    let headers = answer.headers.iter().filter(|(name, _)| !varying.contains(&name.as_str()));
    let mut lines: Vec<_> = headers.map(|(name, value)| format!("{name}: {}", value.to_str().unwrap())).collect();
    lines.sort_unstable();
    lines
}

const COMMON: [&str; 5] = [
    "cross-origin-opener-policy: same-origin",
    "cross-origin-resource-policy: same-origin",
    "permissions-policy: camera=(), display-capture=(), geolocation=(), microphone=(), payment=(), usb=()",
    "x-content-type-options: nosniff",
    "x-frame-options: DENY",
];

fn with_common(own: &[&str]) -> Vec<String> {
    let mut lines: Vec<_> = COMMON.iter().chain(own).map(|line| (*line).to_owned()).collect();
    lines.sort_unstable();
    lines
}

const POLICY: &str = "content-security-policy: default-src 'self'; object-src 'none'; base-uri 'none'; form-action 'self'; \
                      frame-ancestors 'none'";
const PAGE_POLICY: &str = "content-security-policy: default-src 'self'; img-src 'self' data: blob:; object-src 'none'; \
                           base-uri 'none'; form-action 'self'; frame-ancestors 'none'";

#[tokio::test]
async fn of_a_page() {
    let app = app().await;
    let own = [
        PAGE_POLICY,
        "cache-control: no-cache",
        "content-type: text/html; charset=utf-8",
        "referrer-policy: same-origin",
        "vary: accept-encoding",
    ];
    assert_eq!(shown(&app.get("/").await), with_common(&own));
}

#[tokio::test]
async fn of_data() {
    let app = app().await;
    let own = [POLICY, "content-type: application/json", "referrer-policy: no-referrer", "vary: accept-encoding"];
    assert_eq!(shown(&app.get("/api/v1/system").await), with_common(&own));
    let app = guarded().await;
    let (name, value) = bearer();
    let own = [&own[..], &["cache-control: no-store"]].concat();
    assert_eq!(shown(&app.get_with("/api/v1/system", &[(name, &value)]).await), with_common(&own));
}

#[tokio::test]
async fn of_a_problem() {
    let app = guarded().await;
    let own = [
        POLICY,
        "content-type: application/problem+json",
        "referrer-policy: no-referrer",
        "vary: accept-encoding",
        "www-authenticate: Bearer",
    ];
    assert_eq!(shown(&app.get("/api/v1/jobs").await), with_common(&own));
}

#[tokio::test]
async fn of_a_file() {
    let app = app().await;
    let own = [
        POLICY,
        "cache-control: no-cache",
        "content-type: text/javascript; charset=utf-8",
        "referrer-policy: no-referrer",
        "vary: accept-encoding",
    ];
    assert_eq!(shown(&app.get("/assets/job/page.js").await), with_common(&own));
}

#[tokio::test]
async fn inline_styles_are_for_the_documentation_page_only() {
    let app = app().await;
    for path in ["/", "/jobs", "/api/v1/jobs", "/assets/common/style.css", "/nothing", "/problems/internal", "/docs/"] {
        let policy = app.get(path).await.header("content-security-policy").to_owned();
        assert_eq!(policy.contains("unsafe"), path == "/docs/", "{path}: {policy}");
        assert!(policy.contains("default-src 'self'") && policy.contains("frame-ancestors 'none'"), "{path}: {policy}");
    }
}
