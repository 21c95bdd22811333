use crate::support::*;

#[tokio::test]
async fn a_client_that_has_the_job_gets_304() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let answer = app.get(&path).await;
    let etag = answer.header("etag").to_owned();
    assert_eq!(etag, format!("W/\"{}\"", answer.json["revision"]));
    let again = app.get_with(&path, &[("if-none-match", &etag)]).await;
    assert_eq!((again.status, again.body.len(), again.header("etag")), (304, 0, etag.as_str()));
    assert_eq!(app.get_with(&path, &[("if-none-match", "W/\"1\", \"x\"")]).await.status, 200);
    assert_eq!(app.get_with(&path, &[("if-none-match", "*")]).await.status, 304);
}

#[tokio::test]
async fn a_long_poll_answers_at_the_end() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 1).await;
    let poll = app.get_with(&path, &[("prefer", "wait=30")]);
    let end = async { app.solver.breakpoints.release("solve") };
    let (answer, ()) = tokio::join!(poll, end);
    assert_eq!((answer.status, answer.json["state"].as_str()), (200, Some("succeeded")));
    assert_eq!(answer.header("preference-applied"), "wait=30");
}

#[tokio::test]
async fn a_long_poll_with_an_entity_tag_answers_at_the_next_change() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    app.solver.breakpoints.hold("unnamed");
    let path = app.submit(&document()).await;
    let queued = "W/\"1\"";
    let answer = app.get_with(&path, &[("prefer", "wait=30"), ("if-none-match", queued)]).await;
    assert_eq!((answer.status, answer.json["state"].as_str()), (200, Some("running")));
    app.solver.breakpoints.release("solve");
    app.solver.breakpoints.release("unnamed");
}

#[tokio::test]
async fn waits_are_capped_and_odd_preferences_ignored() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    assert_eq!(app.get_with(&path, &[("prefer", "wait=3600")]).await.header("preference-applied"), "wait=30");
    for odd in ["wait=soon", "wait", "wait=-1", "handling=strict"] {
        let answer = app.get_with(&path, &[("prefer", odd)]).await;
        assert_eq!((answer.status, answer.header("preference-applied")), (200, ""));
    }
}
