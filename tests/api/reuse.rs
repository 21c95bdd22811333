use crate::support::*;
use serde_json::json;

#[tokio::test]
async fn the_same_input_again_is_answered_from_the_store_and_says_so() {
    let app = app().await;
    let mut document = document();
    let (first, _) = app.run(&document).await;
    // Name and label decide nothing.
    document["name"] = json!("another name");
    let answer = app.submit_with(&document, &[("prefer", "wait=20")]).await;
    assert_eq!((answer.status, answer.json["state"].as_str()), (200, Some("succeeded")));
    assert_eq!(answer.json["reused_from"], first.rsplit('/').next().unwrap());
    let second = answer.header("location");
    let result = app.get(&format!("{second}/result")).await.json;
    assert_eq!(result["numerics"]["reused"], json!(["result"]));
    assert_eq!(app.get(&format!("{first}/result")).await.json["numerics"]["reused"], json!([]));
    let series = app.get(&format!("{second}/series/a_x_left?method=none")).await.json;
    assert_eq!(series["n_returned"], 10_000);
    assert_eq!(app.solver.breakpoints.count("solve"), 1);
}

#[tokio::test]
async fn a_reused_result_needs_no_place_in_a_full_queue() {
    let app = app_with(herringbone::work::WorkConfig { workers: Some(1), queue_capacity: 1, ..small() }).await;
    let known = document();
    app.run(&known).await;
    app.solver.breakpoints.hold("solve");
    app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 2).await;
    app.submit(&document()).await;
    app.submit_with(&document(), &[]).await.assert_problem(503, "queue-full");
    let answer = app.submit_with(&known, &[]).await;
    assert_eq!((answer.status, answer.json["state"].as_str()), (202, Some("succeeded")));
    assert_eq!(answer.header("retry-after"), "0");
    app.solver.breakpoints.release("solve");
}

#[tokio::test]
async fn two_of_the_same_waiting_together_are_computed_once() {
    let app = app_with(herringbone::work::WorkConfig { workers: Some(1), ..small() }).await;
    app.solver.breakpoints.hold("solve");
    let document = document();
    let first = app.submit(&document).await;
    let second = app.submit(&document).await;
    app.solver.breakpoints.release("solve");
    app.ended(&first).await;
    assert_eq!(app.ended(&second).await["reused_from"], first.rsplit('/').next().unwrap());
    assert_eq!(app.solver.breakpoints.count("solve"), 1);
}

#[tokio::test]
async fn stages_are_kept_between_jobs() {
    let app = app().await;
    let (first, _) = app.run(&scripted("stage")).await;
    let (second, _) = app.run(&scripted("stage")).await;
    assert_eq!(app.get(&format!("{first}/result")).await.json["numerics"]["reused"], json!([]));
    assert_eq!(app.get(&format!("{second}/result")).await.json["numerics"]["reused"], json!(["mesh"]));
}

#[tokio::test]
async fn failures_are_not_reused() {
    let app = app().await;
    let document = scripted("fail");
    app.run(&document).await;
    app.run(&document).await;
    assert_eq!(app.solver.breakpoints.count("fail"), 2);
}
