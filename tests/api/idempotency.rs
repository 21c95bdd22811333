use crate::support::*;

#[tokio::test]
async fn the_same_key_and_document_answer_the_same_job() {
    let app = app().await;
    let document = document();
    let key = [("idempotency-key", "4711")];
    let first = app.submit_with(&document, &key).await;
    let mut reordered = serde_json::Map::new();
    for (name, value) in document.as_object().unwrap().iter().rev() {
        reordered.insert(name.clone(), value.clone());
    }
    let second = app.submit_with(&reordered.into(), &key).await;
    assert_eq!((first.status, second.status), (202, 202));
    assert_eq!(first.json["id"], second.json["id"]);
    assert_eq!((first.header("idempotent-replayed"), second.header("idempotent-replayed")), ("", "true"));
    assert_eq!(app.get("/api/v1/jobs").await.json["items"].as_array().unwrap().len(), 1);
}

#[tokio::test]
async fn the_same_key_with_another_document_is_refused() {
    let app = app().await;
    let key = [("idempotency-key", "4711")];
    app.submit_with(&document(), &key).await;
    app.submit_with(&document(), &key).await.assert_problem(422, "idempotency-key-reused");
}

#[tokio::test]
async fn many_at_once_make_one_job() {
    let app = app().await;
    let document = document();
    let submissions = (0..8).map(|_| app.submit_with(&document, &[("idempotency-key", "k")]));
    let answers = futures_util::future::join_all(submissions).await;
    assert!(answers.iter().all(|answer| answer.json["id"] == answers[0].json["id"]));
    assert_eq!(answers.iter().filter(|answer| answer.header("idempotent-replayed").is_empty()).count(), 1);
}

#[tokio::test]
async fn a_key_is_bounded() {
    let app = app().await;
    let long = "k".repeat(256);
    let answer = app.submit_with(&document(), &[("idempotency-key", &long)]).await;
    answer.assert_problem(400, "invalid-parameter");
    assert_eq!(answer.violation("/Idempotency-Key")["maximum"], 255.0);
    app.submit_with(&document(), &[("idempotency-key", "")]).await.assert_problem(400, "invalid-parameter");
}
