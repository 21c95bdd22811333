//! The headers with which browsers name the origin of a request.

use super::*;
use axum::http::Method;

/// Headers, and whether a change is taken.
const CASES: [(&[(&str, &str)], bool); 14] = [
    // Programs.
    (&[], true),
    (&[("host", "localhost:8080")], true),
    // Browsers of today.
    (&[("sec-fetch-site", "same-origin"), ("origin", "http://localhost:8080"), ("host", "localhost:8080")], true),
    (&[("sec-fetch-site", "none")], true),
    (&[("sec-fetch-site", "same-site"), ("origin", "http://localhost:9999"), ("host", "localhost:8080")], false),
    (&[("sec-fetch-site", "cross-site"), ("origin", "https://evil.example"), ("host", "localhost:8080")], false),
    (&[("sec-fetch-site", "cross-site")], false),
    (&[("sec-fetch-site", "nonsense")], false),
    // Browsers of old, and plain HTTP in a network.
    (&[("origin", "http://localhost:8080"), ("host", "localhost:8080")], true),
    (&[("origin", "http://localhost:8081"), ("host", "localhost:8080")], false),
    (&[("origin", "http://localhost"), ("host", "localhost:8080")], false),
    (&[("origin", "https://evil.example"), ("host", "localhost:8080")], false),
    (&[("origin", "null"), ("host", "localhost:8080")], false),
    (&[("origin", "http://localhost:8080.evil.example"), ("host", "localhost:8080")], false),
];

#[tokio::test]
async fn changes_come_from_own_pages_or_no_page() {
    let app = app().await;
    for (headers, allowed) in CASES {
        for method in [Method::POST, Method::PUT, Method::PATCH, Method::DELETE] {
            let answer = app.send(method.clone(), "/api/v1/jobs", headers, "").await;
            match allowed {
                true => assert_ne!(answer.status, 403, "{method} {headers:?}"),
                false => answer.assert_problem(403, "cross-origin"),
            }
        }
        for method in [Method::GET, Method::HEAD] {
            assert_eq!(app.send(method.clone(), "/api/v1/jobs", headers, "").await.status, 200, "{method} {headers:?}");
        }
    }
    assert_eq!(app.get("/api/v1/jobs").await.json["items"], serde_json::json!([]), "nothing was submitted");
}

#[tokio::test]
async fn a_forged_submission_is_refused_and_an_honest_one_taken() {
    let app = app().await;
    let forged = [("host", "localhost:8080"), ("origin", "https://evil.example"), ("sec-fetch-site", "cross-site")];
    app.submit_with(&document(), &forged).await.assert_problem(403, "cross-origin");
    let honest = [("host", "localhost:8080"), ("origin", "http://localhost:8080"), ("sec-fetch-site", "same-origin")];
    assert_eq!(app.submit_with(&document(), &honest).await.status, 202);
}

#[tokio::test]
async fn the_token_does_not_make_up_for_the_wrong_site() {
    let app = guarded().await;
    let (name, value) = bearer();
    let forged = [(name, value.as_str()), ("sec-fetch-site", "cross-site")];
    app.submit_with(&document(), &forged).await.assert_problem(403, "cross-origin");
}

#[tokio::test]
async fn no_other_site_is_permitted_to_read() {
    let app = app().await;
    let asked = [("host", "localhost"), ("origin", "https://evil.example"), ("access-control-request-method", "POST")];
    for method in [Method::OPTIONS, Method::GET] {
        let answer = app.send(method, "/api/v1/jobs", &asked, "").await;
        assert!(
            !answer.headers.keys().any(|name| name.as_str().starts_with("access-control-")),
            "{:?}",
            answer.headers
        );
    }
}
