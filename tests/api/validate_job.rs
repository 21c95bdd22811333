use crate::support::*;
use axum::http::Method;

#[tokio::test]
async fn geometry_and_warnings_without_a_job() {
    let app = app().await;
    let json = [("content-type", "application/json")];
    let answer = app.send(Method::POST, "/api/v1/jobs/validate", &json, document().to_string()).await;
    assert_eq!(answer.status, 200, "{answer:?}");
    assert!(answer.json["geometry"]["transverse_contact_ratio"].as_f64().is_some_and(|ratio| ratio > 1.0));
    assert!(answer.json["warnings"].is_array());
    assert_eq!(app.get("/api/v1/jobs").await.json["items"].as_array().unwrap().len(), 0);
}

#[tokio::test]
async fn a_gear_that_cannot_exist() {
    let app = app().await;
    let mut pointed = document();
    pointed["design"]["pinion"]["profile_shift"] = 1.9.into();
    let json = [("content-type", "application/json")];
    let answer = app.send(Method::POST, "/api/v1/jobs/validate", &json, pointed.to_string()).await;
    answer.assert_problem(422, "invalid-design");
}
