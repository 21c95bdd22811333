//! Errors show no internals.

use super::*;
use axum::body::Body;
use axum::http::Method;

/// Texts that would reveal a path of this machine, the database, or the message of a panic.
const INSIDE: [&str; 14] = [
    "/home", "/root", "/tmp", "/usr", "/var", ".cargo", "src/", ".rs:", "panicked", "secret", "sqlx", "SQLITE",
    "sqlite", "jobs.db",
];

#[track_caller]
fn assert_tells_nothing(answer: &Answer, app: &App) {
    assert!(answer.status >= 400, "{answer:?}");
    let directory = app.database().parent().expect("a directory").display().to_string();
    let headers: Vec<_> = answer.headers.iter().map(|(name, value)| format!("{name}: {value:?}")).collect();
    let text = format!("{}\n{}", headers.join("\n"), answer.text());
    for inside in INSIDE.into_iter().chain([directory.as_str(), TOKEN]) {
        assert!(!text.contains(inside), "{inside:?} in {text}");
    }
}

#[tokio::test]
async fn no_refusal_shows_the_inside() {
    let app = app().await;
    let json = ("content-type", "application/json");
    let missing = "/api/v1/jobs/0199f3c4-6f0b-7c41-9d5e-2f1f0f6f3c11";
    for (method, path, headers, body) in [
        (Method::GET, "/nothing", vec![], String::new()),
        (Method::GET, "/../../etc/passwd", vec![], String::new()),
        (Method::GET, "/assets/..%2f..%2fCargo.toml", vec![], String::new()),
        (Method::GET, "/docs/..%2f..%2fCargo.toml", vec![], String::new()),
        (Method::GET, "/docs/nothing", vec![], String::new()),
        (Method::GET, "/panics", vec![], String::new()),
        (Method::GET, missing, vec![], String::new()),
        (Method::GET, "/api/v1/jobs?limit=x&cursor=y&unknown=z", vec![], String::new()),
        (Method::GET, "/api/v1/jobs?cursor=00", vec![], String::new()),
        (Method::GET, "/api/v1/jobs?%FF=%FE", vec![], String::new()),
        (Method::GET, "/api/v1/jobs", vec![("accept", "image/png")], String::new()),
        (Method::GET, "/api/v1/jobs", vec![("host", "evil.example")], String::new()),
        (Method::POST, "/api/v1/jobs", vec![("sec-fetch-site", "cross-site")], String::new()),
        (Method::PUT, "/api/v1/jobs", vec![], String::new()),
        (Method::POST, "/api/v1/jobs", vec![], "{}".to_owned()),
        (Method::POST, "/api/v1/jobs", vec![json], "{".to_owned()),
        (Method::POST, "/api/v1/jobs", vec![json], "{}".to_owned()),
        (Method::POST, "/api/v1/jobs", vec![json], "x".repeat(2 << 20)),
        (Method::POST, "/api/v1/jobs", vec![json, ("idempotency-key", "")], document().to_string()),
    ] {
        let answer = app.send(method, path, &headers, body).await;
        assert_tells_nothing(&answer, &app);
    }
}

#[tokio::test]
async fn no_failed_job_shows_the_inside() {
    let app = app().await;
    for script in ["panic", "fail", "fail oddly"] {
        let (path, job) = app.run(&scripted(script)).await;
        assert_eq!(job["state"], "failed");
        assert_tells_nothing(&app.get(&format!("{path}/result")).await, &app);
        let text = job.to_string();
        for inside in INSIDE {
            assert!(!text.contains(inside), "{inside:?} in {text}");
        }
    }
}

#[tokio::test]
async fn a_lost_database_shows_nothing_of_itself() {
    let app = app().await;
    let path = app.submit(&document()).await;
    app.jobs.store().close().await;
    let series = format!("{path}/series/a_x_left");
    for path in ["/api/v1/jobs", "/readyz", &path, &series] {
        let answer = app.get(path).await;
        assert_tells_nothing(&answer, &app);
        assert!(!answer.text().contains("pool"), "{answer:?}");
    }
    assert_tells_nothing(&app.submit_with(&document(), &[]).await, &app);
    assert_tells_nothing(&app.delete(&path).await, &app);
}

#[tokio::test]
async fn no_refused_credentials_are_shown() {
    let app = guarded().await;
    for headers in
        [vec![], vec![("authorization", "Bearer wrong-wrong-wrong-wrong")], vec![("authorization", "Basic eDp5")]]
    {
        let answer = app.get_with("/api/v1/jobs", &headers).await;
        assert_tells_nothing(&answer, &app);
        assert!(!answer.text().contains("wrong-wrong") && !answer.text().contains("eDp5"), "{answer:?}");
    }
    let slow = impatient_app().await;
    let body = Body::from_stream(futures_util::stream::pending::<Result<axum::body::Bytes, std::io::Error>>());
    let answer = slow.send(Method::POST, "/api/v1/jobs", &[("content-type", "application/json")], body).await;
    assert_tells_nothing(&answer, &slow);
}
