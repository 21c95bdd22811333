use crate::support::*;
use serde_json::json;

fn ids(answer: &Answer) -> Vec<String> {
    answer.json["items"].as_array().unwrap().iter().map(|job| job["id"].as_str().unwrap().to_owned()).collect()
}

#[tokio::test]
async fn pages_newest_first() {
    let app = app().await;
    let mut all = Vec::new();
    for _ in 0..5 {
        all.push(app.run(&document()).await.1["id"].as_str().unwrap().to_owned());
    }
    all.reverse();
    let first = app.get("/api/v1/jobs?limit=2").await;
    assert_eq!(ids(&first), all[..2]);
    // A job submitted meanwhile shifts nothing.
    app.run(&document()).await;
    let cursor = first.json["next_cursor"].as_str().unwrap();
    let second = app.get(&format!("/api/v1/jobs?limit=3&cursor={cursor}")).await;
    assert_eq!(ids(&second), all[2..]);
    assert!(second.json["next_cursor"].is_null());
}

#[tokio::test]
async fn filters_combine() {
    let app = app().await;
    let mut labeled = scripted("fail");
    labeled["label"] = json!("batch 7");
    app.run(&labeled).await;
    let mut mesh = document();
    mesh["kind"] = json!("mesh");
    app.run(&mesh).await;
    let count = async |query: &str| ids(&app.get(&format!("/api/v1/jobs?{query}")).await).len();
    assert_eq!(count("").await, 2);
    assert_eq!(count("state=failed").await, 1);
    assert_eq!(count("state=failed,succeeded").await, 2);
    assert_eq!(count("state=canceled").await, 0);
    assert_eq!(count("kind=mesh&state=succeeded").await, 1);
    assert_eq!(count("label=batch%207").await, 1);
    assert_eq!(count("label=batch").await, 0);
    assert_eq!(count("limit=100000").await, 2);
}

#[tokio::test]
async fn what_is_not_a_parameter_is_refused_all_at_once() {
    let app = app().await;
    let answer = app.get("/api/v1/jobs?state=done&kind=x&limit=-1&page=2&label=a&label=b").await;
    answer.assert_problem(400, "invalid-parameter");
    assert_eq!(answer.json["errors"].as_array().unwrap().len(), 5);
    assert_eq!(answer.violation("/state")["code"], "not-one-of");
    assert_eq!(answer.violation("/limit")["maximum"], 200.0);
    assert_eq!(answer.violation("/page")["code"], "unknown-field");
    assert_eq!(answer.violation("/label")["code"], "conflict");
}

#[tokio::test]
async fn a_cursor_is_bound_to_its_filters() {
    let app = app().await;
    for _ in 0..3 {
        app.run(&document()).await;
    }
    let first = app.get("/api/v1/jobs?limit=1&state=succeeded").await;
    let cursor = first.json["next_cursor"].as_str().unwrap();
    let same = app.get(&format!("/api/v1/jobs?state=succeeded&limit=2&cursor={cursor}")).await;
    assert_eq!(same.json["items"].as_array().unwrap().len(), 2);
    for query in [
        format!("cursor={cursor}"),
        format!("state=failed&cursor={cursor}"),
        format!("state=succeeded&cursor={cursor}0"),
        format!("state=succeeded&cursor=02{}", &cursor[2..]),
        "state=succeeded&cursor=%F0%9F%92%A9".to_owned(),
    ] {
        app.get(&format!("/api/v1/jobs?{query}")).await.assert_problem(400, "invalid-cursor");
    }
}
