//! Clients that follow jobs cannot use up all connections.

use super::*;

#[tokio::test]
async fn event_streams_are_bounded_and_waits_give_way() {
    let connections = ConnectionConfig { max_connections: 4, ..ConnectionConfig::default() };
    let app = app_with_http(HttpConfig { connections, ..HttpConfig::default() }).await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 1).await;
    let mut streams = [app.events(&path, &[]).await, app.events(&path, &[]).await];
    assert!(streams[0].next().await.is_some() && streams[1].next().await.is_some());
    let refused = app.get(&format!("{path}/events")).await;
    refused.assert_problem(503, "too-many-streams");
    assert_eq!(refused.header("retry-after"), "5");
    let asked = app.get_with(&path, &[("prefer", "wait=30")]).await;
    assert_eq!((asked.status, asked.header("preference-applied")), (200, ""), "answered at once");
    assert_eq!(asked.json["state"], "running");
    let other = app.submit_with(&document(), &[("prefer", "wait=30")]).await;
    assert_eq!((other.status, other.header("preference-applied")), (202, ""));

    let [first, _second] = streams;
    drop(first);
    assert_eq!(app.events(&path, &[]).await.status, 200, "who leaves makes room");
    app.solver.breakpoints.release("solve");
}
