//! `PATCH /api/v1/jobs/{id}`: name, label and notes.

use crate::support::*;
use axum::http::Method;
use serde_json::{Value, json};

const MERGE_PATCH: &str = "application/merge-patch+json";

async fn patch(app: &App, path: &str, media_type: &str, body: impl Into<axum::body::Body>) -> Answer {
    app.send(Method::PATCH, path, &[("content-type", media_type)], body).await
}

#[tokio::test]
async fn texts_are_set_left_and_removed() {
    let app = app().await;
    let mut document = scripted("first");
    document["label"] = json!("a");
    let (path, job) = app.run(&document).await;
    let changed = patch(&app, &path, MERGE_PATCH, json!({"name": "second", "notes": "line\nµm"}).to_string()).await;
    assert_eq!(changed.status, 200, "{changed:?}");
    let texts = |job: &Value| ["name", "label", "notes"].map(|name| job[name].clone());
    assert_eq!(texts(&changed.json), [json!("second"), json!("a"), json!("line\nµm")]);
    assert_eq!(changed.json["revision"].as_i64(), job["revision"].as_i64().map(|revision| revision + 1));
    assert_eq!(app.get(&path).await.json, changed.json);
    // What is known of the job before is out of date.
    let etag = format!("W/\"{}\"", job["revision"]);
    assert_eq!(app.get_with(&path, &[("if-none-match", &etag)]).await.status, 200);
    let mark = [b"\xef\xbb\xbf".as_slice(), b"{\"label\": null, \"notes\": null}"].concat();
    let removed = patch(&app, &path, "application/json", mark).await;
    assert_eq!(texts(&removed.json), [json!("second"), json!(null), json!(null)]);
    let same = patch(&app, &path, MERGE_PATCH, "{\"name\": \"second\"}").await;
    assert_eq!((same.status, &same.json["revision"]), (200, &removed.json["revision"]));
    let input = app.get(&format!("{path}/input")).await.json;
    assert_eq!((&input["name"], &input["label"]), (&json!("first"), &json!("a")), "the document stays as accepted");
    assert_eq!(app.get("/api/v1/jobs?search=second").await.json["total"], 1);
    assert_eq!(app.get("/api/v1/jobs?search=first").await.json["total"], 0);
}

#[tokio::test]
async fn nothing_else_is_changed() {
    let app = app().await;
    let (path, job) = app.run(&scripted("first")).await;
    for (body, pointer, code) in [
        (json!({"name": "x", "state": "queued"}), "/state", "unknown-field"),
        (json!({"design": {}}), "/design", "unknown-field"),
        (json!({"name": "a".repeat(201)}), "/name", "too-long"),
        (json!({"label": "a".repeat(101)}), "/label", "too-long"),
        (json!({"notes": "a".repeat(5001)}), "/notes", "too-long"),
        (json!({"notes": ["a"]}), "/notes", "wrong-type"),
        (json!({"name": "a\nb"}), "/name", "out-of-range"),
        (json!(["name"]), "", "wrong-type"),
    ] {
        let answer = patch(&app, &path, MERGE_PATCH, body.to_string()).await;
        answer.assert_problem(422, "invalid-patch");
        assert_eq!(answer.violation(pointer)["code"], code, "{body}");
    }
    patch(&app, &path, MERGE_PATCH, "{\"name\": \"a\"").await.assert_problem(400, "malformed-json");
    patch(&app, &path, MERGE_PATCH, "{\"name\": \"a\", \"name\": \"b\"}").await.assert_problem(400, "malformed-json");
    patch(&app, &path, "text/plain", "{}").await.assert_problem(415, "unsupported-media-type");
    let nowhere = "/api/v1/jobs/0199f3c4-6f0b-7c41-9d5e-2f1f0f6f3c11";
    patch(&app, nowhere, MERGE_PATCH, "{\"name\": \"a\"}").await.assert_problem(404, "not-found");
    assert_eq!(app.get(&path).await.json, job);
}

#[tokio::test]
async fn those_who_watch_are_told() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 1).await;
    let mut list = app.stream("/api/v1/jobs/events", &[]).await;
    let mut one = app.events(&path, &[]).await;
    assert_eq!(one.next().await.unwrap().name, "state");
    let changed = patch(&app, &path, MERGE_PATCH, "{\"name\": \"renamed\", \"label\": \"b\"}").await;
    let told = async |events: &mut EventStream| loop {
        let event = events.next().await.expect("the stream goes on");
        if event.data["name"] == "renamed" {
            return event.name;
        }
    };
    assert_eq!((told(&mut list).await, told(&mut one).await), ("state".to_owned(), "state".to_owned()));
    // Whoever lists another label has to look again.
    assert_eq!(list.next().await.unwrap().name, "reload");
    assert_eq!(changed.json["state"], "running");
    app.solver.breakpoints.release("solve");
    let job = app.ended(&path).await;
    assert_eq!((job["state"].as_str(), job["label"].as_str()), (Some("succeeded"), Some("b")));
}
