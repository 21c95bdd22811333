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

#[tokio::test]
async fn a_job_that_would_take_too_much_memory_is_refused_where_it_asks_for_it() {
    let app = app_with(herringbone::work::WorkConfig { job_memory_mib: 100, ..small() }).await;
    let json = [("content-type", "application/json")];
    let mut document = document();
    let ordinary = app.send(Method::POST, "/api/v1/jobs/validate", &json, document.to_string()).await;
    assert!(ordinary.json["memory_mib"].as_f64().is_some_and(|mib| mib < 100.0), "{ordinary:?}");
    document["analysis"] = serde_json::json!({"method": "integrate", "mesh_periods": 1000, "record_mesh_periods": 1000,
        "samples_per_mesh_period": 400});
    for path in ["/api/v1/jobs", "/api/v1/jobs/validate"] {
        let answer = app.send(Method::POST, path, &json, document.to_string()).await;
        answer.assert_problem(422, "invalid-design");
        let detail = answer.violation("/analysis/samples_per_mesh_period")["detail"].as_str().unwrap();
        assert!(detail.contains("permits 100 MiB"), "{detail}");
    }
    document["analysis"]["channels"] = serde_json::json!(["x_left"]);
    app.run(&document).await;
}

#[tokio::test]
async fn a_drawing_where_it_is_asked_for() {
    let app = app().await;
    let document = document();
    let json = [("content-type", "application/json")];
    let plain = app.send(Method::POST, "/api/v1/jobs/validate?drawing=false", &json, document.to_string()).await;
    assert!(plain.json.get("drawing").is_none(), "{plain:?}");
    let answer = app.send(Method::POST, "/api/v1/jobs/validate?drawing=true", &json, document.to_string()).await;
    assert_eq!(answer.status, 200, "{answer:?}");
    assert_eq!(answer.json["geometry"], plain.json["geometry"]);
    assert_eq!(answer.json["drawing"]["margins"].as_array().map(Vec::len), Some(8));
    let section = &answer.json["drawing"]["section"];
    assert_eq!(section["pinion"]["teeth"], document["design"]["pinion"]["teeth"]);
    assert!(section["pinion"]["tooth_mm"].as_array().is_some_and(|points| points.len() > 40), "{section}");
    let refused = app.send(Method::POST, "/api/v1/jobs/validate?drawing=yes", &json, document.to_string()).await;
    refused.assert_problem(400, "invalid-parameter");
    let unknown = app.send(Method::POST, "/api/v1/jobs/validate?draw=true", &json, document.to_string()).await;
    unknown.assert_problem(400, "invalid-parameter");
}
