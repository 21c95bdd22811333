use crate::support::*;

#[tokio::test]
async fn alive_and_ready() {
    let app = app().await;
    for path in ["/healthz", "/readyz"] {
        assert_eq!(app.get(path).await.json, serde_json::json!({"status": "ok"}));
    }
}

#[tokio::test]
async fn metrics_in_prometheus_text() {
    let app = app().await;
    app.run(&document()).await;
    let answer = app.get("/metrics").await;
    assert!(answer.header("content-type").starts_with("text/plain"));
    let text = answer.text();
    for line in [
        "herringbone_jobs{state=\"succeeded\"}",
        "herringbone_queue_capacity",
        "herringbone_workers_busy",
        "herringbone_jobs_submitted_total{kind=\"response\"}",
        "herringbone_jobs_ended_total{kind=\"response\",state=\"succeeded\"}",
        "herringbone_job_duration_seconds_bucket",
        "herringbone_http_requests_total{method=\"POST\",route=\"/api/v1/jobs\",status=\"202\"}",
    ] {
        assert!(text.contains(line), "{line} is missing in\n{text}");
    }
}

#[tokio::test]
async fn every_code_is_explained() {
    let app = app().await;
    let answer = app.get("/problems/invalid-design").await;
    assert_eq!((answer.json["code"].as_str(), answer.json["status"].as_u64()), (Some("invalid-design"), Some(422)));
    let page = app.get_with("/problems/queue-full", &[("accept", "text/html,*/*;q=0.8")]).await;
    assert!(page.header("content-type").starts_with("text/html") && page.text().contains("Too many jobs wait"));
    app.get("/problems/unheard-of").await.assert_problem(404, "not-found");
}

#[tokio::test]
async fn the_system_tells_its_limits() {
    let app = app().await;
    let system = app.get("/api/v1/system").await.json;
    assert_eq!(system["version"], env!("CARGO_PKG_VERSION"));
    let queue = &system["queue"];
    assert_eq!((queue["depth"].as_u64(), queue["capacity"].as_u64()), (Some(0), Some(10)));
    assert_eq!((queue["transport"].as_str(), queue["connected"].as_bool()), (Some("local"), None));
    assert_eq!(system["limits"]["page_max"], 200);
}
