//! Large answers: as many at once as fit.

use super::*;

#[tokio::test]
async fn series_in_memory_are_bounded_and_the_next_one_waits() {
    let served = served(HttpConfig { request_timeout_s: 1, ..HttpConfig::default() }).await;
    let (path, _) = served.app.run(&document()).await;
    let series = format!("{path}/series/a_x_left?method=none");
    let mut unread = Vec::new();
    for _ in 0..16 {
        let request = axum::http::Request::get(&series).body(axum::body::Body::empty()).expect("a request");
        let answer = tower::ServiceExt::oneshot(served.app.router.clone(), request).await.expect("an answer");
        assert_eq!(answer.status(), 200);
        unread.push(answer);
    }
    served.app.get(&series).await.assert_problem(408, "request-timeout");
    unread.pop();
    let answer = served.get(&series).await;
    assert_eq!(answer.status(), 200);
    assert!(answer.text.to_lowercase().contains("content-length: "), "its length is told");
    drop(unread);
}
