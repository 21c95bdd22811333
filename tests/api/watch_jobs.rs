//! The events of all jobs.

use crate::support::*;
use herringbone::work::WorkConfig;
use serde_json::json;

const EVENTS: &str = "/api/v1/jobs/events";

/// Reads up to the first event that is as asked for; the names of all up to it.
async fn until(events: &mut EventStream, enough: impl Fn(&Event) -> bool) -> (Vec<String>, Event) {
    let mut names = Vec::new();
    loop {
        let event = events.next().await.expect("the stream goes on");
        names.push(event.name.clone());
        if enough(&event) {
            return (names, event);
        }
    }
}

async fn opened(app: &App, path: &str) -> EventStream {
    let mut events = app.stream(path, &[("accept", "text/event-stream")]).await;
    assert_eq!((events.status, events.media_type.as_str()), (200, "text/event-stream"));
    assert_eq!((events.header("x-accel-buffering"), events.header("cache-control")), ("no", "no-store"));
    let first = events.next().await.expect("an event");
    assert_eq!((first.name.as_str(), &first.data), ("reload", &json!({})), "read the list now");
    events
}

#[tokio::test]
async fn a_job_is_followed_from_its_submission_to_its_deletion() {
    let app = app().await;
    app.run(&document()).await;
    app.solver.breakpoints.hold("solve");
    let mut events = opened(&app, EVENTS).await;
    let path = app.submit(&document()).await;
    let (_, submitted) = until(&mut events, |event| event.name == "state").await;
    assert_eq!(submitted.data["state"], "queued", "nothing of what was before: {submitted:?}");
    let (_, started) = until(&mut events, |event| event.data["state"] == "running").await;
    assert_eq!(started.name, "state");
    assert_eq!(started.data["links"]["self"], path.as_str());
    app.solver.breakpoints.release("solve");
    let (_, done) = until(&mut events, |event| event.name == "done").await;
    assert_eq!(done.data, app.ended(&path).await, "the data is the whole job");
    app.delete(&path).await.assert_status(204);
    let (names, deleted) = until(&mut events, |event| event.name == "deleted").await;
    assert_eq!((names.len(), &deleted.data), (1, &json!({"id": done.data["id"]})));
}

#[tokio::test]
async fn progress_and_a_wish_to_cancel_are_told_apart() {
    let app = app().await;
    app.solver.breakpoints.hold("point 1");
    let mut events = opened(&app, EVENTS).await;
    let path = app.submit(&sweep("long", 3)).await;
    let (_, progress) = until(&mut events, |event| event.name == "progress").await;
    assert_eq!(progress.data["state"], "running");
    app.post(&format!("{path}/cancel")).await.assert_status(202);
    let (_, asked) = until(&mut events, |event| !event.data["cancel_requested_at"].is_null()).await;
    assert_eq!((asked.name.as_str(), asked.data["state"].as_str()), ("state", Some("running")));
    until(&mut events, |event| event.name == "done" && event.data["state"] == "canceled").await;
}

#[tokio::test]
async fn a_job_that_ends_at_its_submission_is_told() {
    let app = app().await;
    let document = document();
    app.run(&document).await;
    let mut events = opened(&app, EVENTS).await;
    app.run(&document).await;
    let (names, done) = until(&mut events, |event| event.name == "done").await;
    assert_eq!(names, ["done"]);
    assert!(done.data["reused_from"].is_string(), "{done:?}");
}

#[tokio::test]
async fn filters_leave_out_what_does_not_fit_but_no_deletion() {
    let app = app().await;
    let mut mesh = document();
    mesh["kind"] = json!("mesh");
    mesh["label"] = json!("batch 7");
    let mut kinds = opened(&app, &format!("{EVENTS}?kind=mesh")).await;
    let mut labels = opened(&app, &format!("{EVENTS}?label=batch%207")).await;
    let (other, job) = app.run(&scripted("fail")).await;
    app.delete(&other).await.assert_status(204);
    app.run(&mesh).await;
    for events in [&mut kinds, &mut labels] {
        let (names, done) = until(events, |event| event.name == "done").await;
        assert_eq!(names[0], "deleted", "the first that is told of the other job {job}");
        assert_eq!((&done.data["kind"], &done.data["label"]), (&json!("mesh"), &json!("batch 7")));
    }
}

#[tokio::test]
async fn what_is_not_a_parameter_is_refused() {
    let app = app().await;
    let answer = app.get(&format!("{EVENTS}?kind=x&state=failed")).await;
    answer.assert_problem(400, "invalid-parameter");
    assert_eq!(answer.json["errors"].as_array().unwrap().len(), 2);
    app.get_with(EVENTS, &[("accept", "application/json")]).await.assert_problem(406, "not-acceptable");
    app.delete(EVENTS).await.assert_problem(405, "method-not-allowed");
}

#[tokio::test]
async fn a_shutdown_ends_the_stream() {
    let app = app().await;
    let mut events = opened(&app, EVENTS).await;
    let (rest, closed) = tokio::join!(events.rest(), app.jobs.close());
    assert!(closed && rest.is_empty(), "{rest:?}");
}

/// A listener that reads nothing while hundreds of events come gets one `reload` for those it missed.
#[tokio::test]
async fn who_is_slow_is_told_to_read_the_list_again() {
    let app = app_with(WorkConfig { queue_capacity: 1000, ..small() }).await;
    app.solver.breakpoints.hold("solve");
    let mut events = opened(&app, EVENTS).await;
    let mut last = String::new();
    for _ in 0..300 {
        last = app.submit(&document()).await;
    }
    let (names, _) = until(&mut events, |event| event.data["links"]["self"] == last.as_str()).await;
    assert_eq!(names[0], "reload");
    assert!(names[1..].iter().all(|name| name != "reload") && names.len() <= 257, "{} events", names.len());
    app.solver.breakpoints.release("solve");
}
