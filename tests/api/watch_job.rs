use crate::support::*;

#[tokio::test]
async fn snapshot_changes_and_end() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 1).await;
    let mut events = app.events(&path, &[("accept", "text/event-stream")]).await;
    assert_eq!((events.status, events.media_type.as_str()), (200, "text/event-stream"));
    // A proxy that buffers would hold the events back.
    assert_eq!((events.header("x-accel-buffering"), events.header("cache-control")), ("no", "no-store"));
    let snapshot = events.next().await.unwrap();
    assert_eq!((snapshot.name.as_str(), snapshot.data["state"].as_str()), ("state", Some("running")));
    assert_eq!(Some(snapshot.id), snapshot.data["revision"].as_i64());
    app.post(&format!("{path}/cancel")).await;
    let rest = events.rest().await;
    let last = rest.last().unwrap();
    assert_eq!((last.name.as_str(), last.data["state"].as_str()), ("done", Some("canceled")));
    let ids: Vec<_> = std::iter::once(&snapshot).chain(&rest).map(|event| event.id).collect();
    assert!(ids.windows(2).all(|pair| pair[0] < pair[1]), "{ids:?}");
}

#[tokio::test]
async fn every_listener_hears_the_end() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 1).await;
    let mut first = app.events(&path, &[]).await;
    let mut second = app.events(&path, &[]).await;
    app.solver.breakpoints.release("solve");
    let (first, second) = tokio::join!(first.rest(), second.rest());
    assert_eq!(first.last().unwrap(), second.last().unwrap());
    assert_eq!(first.last().unwrap().data["state"], "succeeded");
}

#[tokio::test]
async fn an_ended_job_is_told_once() {
    let app = app().await;
    let (path, job) = app.run(&document()).await;
    let events = app.events(&path, &[]).await.rest().await;
    assert_eq!(events.len(), 1);
    assert_eq!((events[0].name.as_str(), &events[0].data), ("done", &job));
}

#[tokio::test]
async fn a_client_that_reconnects_misses_nothing_and_is_stopped_at_the_end() {
    let app = app().await;
    let (path, job) = app.run(&document()).await;
    let revision = job["revision"].as_i64().unwrap();
    let mut behind = app.events(&path, &[("last-event-id", &(revision - 1).to_string())]).await;
    assert_eq!(behind.rest().await.len(), 1);
    assert_eq!(app.events(&path, &[("last-event-id", &revision.to_string())]).await.status, 204);
    assert_eq!(app.events(&path, &[("last-event-id", "nonsense")]).await.status, 200);
}

#[tokio::test]
async fn a_shutdown_ends_the_stream() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    let mut events = app.events(&path, &[]).await;
    assert!(events.next().await.is_some());
    let (rest, closed) = tokio::join!(events.rest(), app.jobs.close());
    assert!(closed);
    assert!(rest.iter().all(|event| event.name != "done"));
}
