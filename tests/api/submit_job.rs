use crate::support::*;
use axum::http::Method;

#[tokio::test]
async fn accepted_at_once() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let answer = app.submit_with(&document(), &[]).await;
    assert_eq!(answer.status, 202);
    assert_eq!(answer.json["state"], "queued");
    assert_eq!(answer.header("location"), format!("/api/v1/jobs/{}", answer.json["id"].as_str().unwrap()));
    assert_eq!(answer.header("retry-after"), "1");
    assert_eq!(answer.header("preference-applied"), "");
    assert_eq!(answer.json["error"], serde_json::Value::Null);
    app.solver.breakpoints.release("solve");
}

#[tokio::test]
async fn the_answer_waits_for_the_end_when_asked_to() {
    let app = app().await;
    let answer = app.submit_with(&document(), &[("prefer", "respond-async, wait=20")]).await;
    assert_eq!((answer.status, answer.json["state"].as_str()), (200, Some("succeeded")), "{answer:?}");
    assert_eq!(answer.header("preference-applied"), "wait=20");
    assert_eq!(answer.header("retry-after"), "");
    assert!(answer.header("location").starts_with("/api/v1/jobs/"));
}

#[tokio::test]
async fn a_wait_that_is_too_short_ends_with_202() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let answer = app.submit_with(&document(), &[("prefer", "wait=1")]).await;
    assert_eq!((answer.status, answer.json["state"].as_str()), (202, Some("running")));
    assert_eq!(answer.header("retry-after"), "1");
    app.solver.breakpoints.release("solve");
}

#[tokio::test]
async fn a_wait_holds_no_database_connection() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    // Far more waiters than reader connections: all others still answer.
    let waiters = (0..50).map(|_| app.get_with(&path, &[("prefer", "wait=30")]));
    let others = async {
        app.solver.breakpoints.reached("solve", 1).await;
        for _ in 0..5 {
            assert_eq!(app.get("/api/v1/jobs").await.status, 200);
        }
        app.solver.breakpoints.release("solve");
    };
    let (answers, ()) = tokio::join!(futures_util::future::join_all(waiters), others);
    assert!(answers.iter().all(|answer| answer.json["state"] == "succeeded"));
}

#[tokio::test]
async fn a_full_queue_refuses_and_says_when_to_come_back() {
    let app = app_with(herringbone::work::WorkConfig { workers: Some(1), queue_capacity: 2, ..small() }).await;
    app.solver.breakpoints.hold("solve");
    app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 1).await;
    app.submit(&document()).await;
    app.submit(&document()).await;
    let answer = app.submit_with(&document(), &[]).await;
    answer.assert_problem(503, "queue-full");
    assert_eq!(answer.header("retry-after"), "5");
    app.solver.breakpoints.release("solve");
}

#[tokio::test]
async fn what_is_accepted_is_kept_with_every_default() {
    let app = app().await;
    let mut sent = document();
    sent["label"] = "a label".into();
    let path = app.submit(&sent).await;
    let input = app.get(&format!("{path}/input")).await.json;
    assert_eq!(input["design"]["pinion"]["teeth"], 17);
    assert_eq!(input["label"], "a label");
    assert_eq!(input["design"]["material"]["youngs_modulus_gpa"], 206.0);
    assert_eq!(input["model"]["mesh_stiffness"]["source"], "ltca");
    // The document as kept is itself a valid document that means the same.
    let again = app.submit_with(&input, &[]).await;
    assert_eq!(again.status, 202, "{again:?}");
    assert_eq!(again.json["input_hash"], app.get(&path).await.json["input_hash"]);
}

#[tokio::test]
async fn every_example_is_accepted_and_its_kept_form_means_the_same() {
    let app = app().await;
    let mut seen = 0;
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/examples")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let json = [("content-type", "application/json")];
        let sent = app.send(Method::POST, "/api/v1/jobs", &json, text).await;
        assert_eq!(sent.status, 202, "{} {sent:?}", path.display());
        let kept = app.get(&format!("{}/input", sent.header("location"))).await.json;
        let again = app.submit_with(&kept, &[]).await;
        assert_eq!(again.json["input_hash"], sent.json["input_hash"], "{} {again:?}", path.display());
        app.ended(sent.header("location")).await;
        app.ended(again.header("location")).await;
        seen += 1;
    }
    assert!(seen > 0);
}
