//! The routes: pages, files, headers.

use super::*;
use axum::http::StatusCode;
use axum_test::TestServer;

const PAGES: [&str; 12] = [
    "/",
    "/jobs",
    "/jobs/0190",
    "/jobs/0190/report",
    "/compare",
    "/compare/report",
    "/system",
    "/help",
    "/help/results",
    "/help/inputs",
    "/help/theory/vibration",
    "/help/validation/tables/contact",
];

fn server() -> TestServer {
    TestServer::new(routes(true).fallback(not_found))
}

#[tokio::test]
async fn pages_are_html_under_the_policy() {
    for path in PAGES {
        let answer = server().get(path).await;
        answer.assert_status_ok();
        assert_eq!(answer.header(header::CONTENT_TYPE), "text/html; charset=utf-8", "{path}");
        assert_eq!(answer.header(header::CONTENT_SECURITY_POLICY), CONTENT_SECURITY_POLICY, "{path}");
    }
}

#[tokio::test]
async fn unknown_addresses_get_a_page_that_says_so() {
    for path in [
        "/nowhere",
        "/assets/nothing.js",
        "/assets/example.json",
        "/help/nothing",
        "/help/..%2FCargo.toml",
        "/docs/nothing.js",
    ] {
        let answer = server().get(path).await;
        answer.assert_status_not_found();
        assert!(answer.text().contains("Nothing here"), "{path}");
    }
}

#[tokio::test]
async fn no_page_has_inline_code_or_outside_addresses() {
    for path in PAGES.into_iter().chain(["/docs", "/nowhere"]) {
        let text = server().get(path).await.text();
        for forbidden in ["http://", "https://", "style=", "<style", "onclick=", "javascript:"] {
            assert!(!text.contains(forbidden), "{forbidden} in {path}");
        }
        for script in text.split("<script").skip(1) {
            let is_ours = script.contains(" src=\"/assets/") || script.contains(" src=\"/docs/");
            assert!(is_ours, "{path}: {script:.60}");
            assert!(script.split_once('>').is_some_and(|(_, rest)| rest.starts_with("</script>")), "{path}");
        }
    }
}

#[tokio::test]
async fn everything_a_page_links_to_exists() {
    let server = server();
    for path in PAGES.into_iter().chain(["/docs", "/nowhere"]) {
        let text = server.get(path).await.text();
        let linked = ["\"/assets/", "\"/docs/", "\"/help"].into_iter().flat_map(|start| text.match_indices(start));
        for (start, _) in linked {
            let address = text[start + 1..].split(['"', '#']).next().unwrap_or_default();
            server.get(address).await.assert_status_ok();
        }
    }
}

#[tokio::test]
async fn browsers_find_the_icon_where_they_look_for_it() {
    let answer = server().get("/favicon.ico").await;
    answer.assert_status_ok();
    assert_eq!(answer.header(header::CONTENT_TYPE), "image/vnd.microsoft.icon");
    // The head of an icon file: reserved, type 1, number of images.
    assert_eq!(answer.as_bytes()[..6], [0, 0, 1, 0, 3, 0]);
}

#[tokio::test]
async fn an_identifier_is_escaped() {
    let text = server().get("/jobs/%22%3E%3Cscript%3Ealert(1)%3C%2Fscript%3E").await.text();
    assert!(!text.contains("<script>alert"), "{text}");
}

#[tokio::test]
async fn assets_are_revalidated_by_entity_tag() {
    let server = server();
    for path in ["/assets/common/style.css", "/assets/common/quantities.js"] {
        let first = server.get(path).await;
        first.assert_status_ok();
        let again = server.get(path).add_header(header::IF_NONE_MATCH, first.header(header::ETAG)).await;
        assert_eq!(again.status_code(), StatusCode::NOT_MODIFIED, "{path}");
        assert!(again.text().is_empty());
    }
}

#[tokio::test]
async fn every_label_names_an_input_of_the_form() {
    let text = server().get("/").await.text();
    let mut labels = 0;
    for (start, _) in text.match_indices(" for=\"") {
        let id = text[start + 6..].split('"').next().unwrap_or_default();
        assert_eq!(text.matches(&format!("id=\"{id}\"")).count(), 1, "{id}");
        labels += 1;
    }
    assert!(labels > 80, "{labels} labels");
}

#[tokio::test]
async fn the_login_page_works_without_scripts_and_escapes_what_it_is_given() {
    let shown = login(StatusCode::UNAUTHORIZED, "/jobs?label=\"><script>alert(1)</script>", Some("wrong"));
    assert_eq!(shown.status(), StatusCode::UNAUTHORIZED);
    let body = axum::body::to_bytes(shown.into_body(), 1 << 20).await.unwrap();
    let text = String::from_utf8(body.to_vec()).unwrap();
    assert!(!text.contains("<script") && !text.contains("<noscript") && !text.contains("/logout"), "{text}");
    assert!(text.contains("method=\"post\"") && text.contains("name=\"token\"") && text.contains("wrong"), "{text}");
    let mut files: Vec<_> = text.split("\"/assets/").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    files.sort_unstable();
    files.dedup();
    assert_eq!(files, ["common/style.css", "icon.svg"], "what is served without credentials");
}

#[tokio::test]
async fn people_can_log_out_where_they_can_log_in() {
    for has_login in [true, false] {
        let text = TestServer::new(routes(has_login)).get("/jobs").await.text();
        assert_eq!(text.contains("action=\"/logout\""), has_login);
    }
}

#[tokio::test]
async fn the_version_is_for_those_who_are_let_in() {
    let version = env!("CARGO_PKG_VERSION");
    assert!(server().get("/jobs").await.text().contains(version));
    let shown = login(StatusCode::UNAUTHORIZED, "/", None);
    let body = axum::body::to_bytes(shown.into_body(), 1 << 20).await.unwrap();
    assert!(!String::from_utf8(body.to_vec()).unwrap().contains(version));
}
