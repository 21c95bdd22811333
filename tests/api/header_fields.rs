//! Header fields that contradict each other, and entity tags of compressed answers.

use crate::support::*;

#[tokio::test]
async fn a_request_with_two_keys_makes_no_job() {
    let app = app().await;
    for (name, other) in [
        ("idempotency-key", "b"),
        ("content-type", "application/json; charset=utf-8"),
        ("origin", "http://localhost:1"),
        ("last-event-id", "2"),
    ] {
        let first = if name == "content-type" { "application/json" } else { "a" };
        let answer = app.submit_with(&document(), &[(name, first), (name, other)]).await;
        answer.assert_problem(400, "invalid-parameter");
        assert_eq!(answer.json["errors"][0]["code"], "conflict", "{name}: {answer:?}");
    }
    assert_eq!(app.get("/api/v1/jobs").await.json["total"], 0);
    let same = [("idempotency-key", "a"), ("idempotency-key", "a")];
    app.submit_with(&document(), &same).await.assert_status(202);
    let two_ids = [("x-request-id", "one"), ("x-request-id", "two")];
    let answer = app.get_with("/healthz", &two_ids).await;
    assert!(!["one", "two"].contains(&answer.header("x-request-id")), "{}", answer.header("x-request-id"));
}

#[tokio::test]
async fn entity_tags_on_several_lines_are_one_list() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    let etag = app.get(&format!("{path}/result")).await.header("etag").to_owned();
    let lines = [("if-none-match", "\"another\""), ("if-none-match", etag.as_str())];
    assert_eq!(app.get_with(&format!("{path}/result"), &lines).await.status, 304);
}

#[tokio::test]
async fn a_compressed_answer_has_an_entity_tag_of_its_own() {
    let app = app().await;
    let (path, _) = app.run(&document()).await;
    for path in [format!("{path}/result"), "/assets/common/style.css".to_owned()] {
        let plain = app.get(&path).await;
        let zipped = app.get_with(&path, &[("accept-encoding", "gzip")]).await;
        assert_eq!((zipped.status, zipped.header("content-encoding")), (200, "gzip"));
        assert!(plain.body != zipped.body && plain.header("etag").starts_with('"'), "{path}");
        assert_eq!(zipped.header("etag"), format!("W/{}", plain.header("etag")), "{path}");
        for answer in [&plain, &zipped] {
            assert!(answer.header("vary").contains("accept-encoding"), "{path}: {}", answer.header("vary"));
        }
        for known in [&plain, &zipped] {
            let headers = [("if-none-match", known.header("etag")), ("accept-encoding", "gzip")];
            let same = app.get_with(&path, &headers).await;
            assert_eq!((same.status, same.header("etag")), (304, known.header("etag")), "{path}");
            assert!(same.header("vary").contains("accept-encoding"), "{path}");
        }
    }
}
