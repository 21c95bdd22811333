//! One test per status, for refusals of the framework and our own alike.

use crate::support::*;
use axum::body::{Body, Bytes};
use axum::http::Method;

const JSON: (&str, &str) = ("content-type", "application/json");

#[tokio::test]
async fn status_400_malformed_json() {
    let app = app().await;
    let answer = app.send(Method::POST, "/api/v1/jobs", &[JSON], "{\"kind\":\n oops}").await;
    answer.assert_problem(400, "malformed-json");
    assert!(answer.violation("")["detail"].as_str().unwrap().contains("line 2"), "{answer:?}");
}

#[tokio::test]
async fn status_400_for_bytes_that_are_no_text() {
    let app = app().await;
    let body = vec![b'"', 0xff, 0xfe, b'"'];
    app.send(Method::POST, "/api/v1/jobs", &[JSON], body).await.assert_problem(400, "malformed-json");
}

#[tokio::test]
async fn status_404_everywhere() {
    let app = app().await;
    let missing = "/api/v1/jobs/0199f3c4-6f0b-7c41-9d5e-2f1f0f6f3c11";
    for path in ["/nothing", "/api/v1", "/api/v1/nothing", "/api/v1/jobs/", "/api/v1/jobs/1", "/api/v1/jobs/%FF"] {
        app.get(path).await.assert_problem(404, "not-found");
    }
    for rest in ["", "/events", "/input", "/result", "/series", "/series/a_x_left"] {
        app.get(&format!("{missing}{rest}")).await.assert_problem(404, "not-found");
    }
    app.delete(missing).await.assert_problem(404, "not-found");
    app.post(&format!("{missing}/cancel")).await.assert_problem(404, "not-found");
}

#[tokio::test]
async fn browsers_are_shown_a_page_where_there_is_nothing() {
    let app = app().await;
    let browser = [("accept", "text/html,application/xhtml+xml,*/*;q=0.8")];
    let page = app.get_with("/nothing", &browser).await;
    assert_eq!((page.status, page.text().as_str()), (404, "no page"));
    app.get_with("/api/v1/nothing", &browser).await.assert_problem(404, "not-found");
}

#[tokio::test]
async fn status_405_names_the_methods() {
    let app = app().await;
    let answer = app.send(Method::PUT, "/api/v1/jobs", &[JSON], "{}").await;
    answer.assert_problem(405, "method-not-allowed");
    assert_eq!(answer.header("allow"), "GET,HEAD,POST");
    app.send(Method::PATCH, "/healthz", &[], "").await.assert_problem(405, "method-not-allowed");
}

#[tokio::test]
async fn status_406() {
    let app = app().await;
    for path in ["/api/v1/jobs", "/api/v1/kinds", "/api/v1/system"] {
        app.get_with(path, &[("accept", "application/xml")]).await.assert_problem(406, "not-acceptable");
        assert_eq!(app.get_with(path, &[("accept", "application/*")]).await.status, 200);
    }
    let (path, _) = app.run(&document()).await;
    let answer = app.get_with(&format!("{path}/events"), &[("accept", "application/json")]).await;
    answer.assert_problem(406, "not-acceptable");
}

#[tokio::test]
async fn status_408_for_a_body_that_never_comes() {
    let app = impatient_app().await;
    let body = Body::from_stream(futures_util::stream::pending::<Result<Bytes, std::io::Error>>());
    let answer = app.send(Method::POST, "/api/v1/jobs", &[JSON], body).await;
    answer.assert_problem(408, "request-timeout");
}

#[tokio::test]
async fn status_413() {
    let app = app().await;
    let large = format!("{{\"name\": \"{}\"}}", "x".repeat(1 << 20));
    let answer = app.send(Method::POST, "/api/v1/jobs", &[JSON], large).await;
    answer.assert_problem(413, "payload-too-large");
    let padded = format!("{}{}", document(), " ".repeat((1 << 20) - document().to_string().len()));
    assert_eq!(app.send(Method::POST, "/api/v1/jobs", &[JSON], padded).await.status, 202);
}

#[tokio::test]
async fn status_415() {
    let app = app().await;
    let text = document().to_string();
    for headers in [
        vec![],
        vec![("content-type", "text/plain")],
        vec![("content-type", "application/x-www-form-urlencoded")],
        vec![("content-type", "application/json"), ("content-encoding", "gzip")],
    ] {
        let answer = app.send(Method::POST, "/api/v1/jobs", &headers, text.clone()).await;
        answer.assert_problem(415, "unsupported-media-type");
    }
    let charset = [("content-type", "application/json; charset=utf-8")];
    assert_eq!(app.send(Method::POST, "/api/v1/jobs", &charset, text).await.status, 202);
}

/// No torque and negative torque are operating points, not something unsupported.
#[tokio::test]
async fn torque_of_any_sign_is_taken() {
    let app = app().await;
    for torque_nm in [0, -300] {
        let mut document = document();
        document["operation"]["pinion_torque_nm"] = torque_nm.into();
        assert_eq!(app.submit_with(&document, &[]).await.status, 202, "{torque_nm}");
    }
}

#[tokio::test]
async fn status_500_tells_nothing_but_the_request() {
    let app = app().await;
    let answer = app.get_with("/panics", &[("x-request-id", "my-request.1")]).await;
    answer.assert_problem(500, "internal");
    assert_eq!(answer.json["request_id"], "my-request.1");
    assert!(!answer.text().contains("secret"));
    assert_eq!(app.get("/healthz").await.status, 200);
}

#[tokio::test]
async fn status_500_when_the_database_is_gone() {
    let app = app().await;
    app.jobs.store().close().await;
    for path in ["/api/v1/jobs", "/readyz"] {
        let answer = app.get(path).await;
        answer.assert_problem(500, "internal");
        assert!(!answer.text().contains("pool"), "{answer:?}");
    }
    assert_eq!(app.get("/healthz").await.status, 200);
    assert_eq!(app.get("/metrics").await.status, 200, "whoever watches the service has to see it");
}

#[tokio::test]
async fn a_request_id_that_does_not_belong_in_a_log_is_replaced() {
    let app = app().await;
    for odd in ["", "a b", "<script>", &"x".repeat(200)] {
        let answer = app.get_with("/healthz", &[("x-request-id", odd)]).await;
        assert_eq!(answer.header("x-request-id").len(), 36, "{odd}");
    }
}

#[tokio::test]
async fn every_answer_carries_the_security_headers() {
    let app = app().await;
    for path in ["/healthz", "/nothing", "/docs/", "/api/v1/jobs"] {
        let answer = app.get(path).await;
        assert_eq!(answer.header("x-content-type-options"), "nosniff");
        assert!(answer.header("content-security-policy").contains("default-src 'self'"));
        assert_eq!(answer.header("referrer-policy"), "no-referrer");
    }
}

#[tokio::test]
async fn answers_are_compressed_on_request_and_streams_are_not() {
    let app = app().await;
    let gzip = ("accept-encoding", "gzip");
    assert_eq!(app.get_with("/api/v1/kinds", &[gzip]).await.header("content-encoding"), "gzip");
    let (path, _) = app.run(&document()).await;
    assert_eq!(app.get_with(&format!("{path}/events"), &[gzip]).await.header("content-encoding"), "");
}
