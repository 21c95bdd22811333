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

#[tokio::test]
async fn values_that_the_rest_of_the_document_gives() {
    let app = app().await;
    let json = [("content-type", "application/json")];
    let mut document = document();
    let pointer = "/design/gear/inertia_kg_m2";
    let derived = async |document: &serde_json::Value| {
        let answer = app.send(Method::POST, "/api/v1/jobs/validate", &json, document.to_string()).await;
        let list = answer.json["derived"].as_array().unwrap_or_else(|| panic!("{answer:?}")).clone();
        list.into_iter().find(|one| one["pointer"] == pointer).unwrap()
    };
    document["design"]["gear"]["inertia_kg_m2"] = 0.5.into();
    let before = derived(&document).await;
    assert_eq!((&before["unit"], &before["is_default"]), (&"kg m2".into(), &true.into()), "{before}");
    document["design"]["gear"]["inertia_kg_m2"] = 0.7.into();
    assert_eq!(derived(&document).await, before, "does not depend on what the field says");
    let width = document["design"]["face_width_mm"].as_f64().unwrap();
    document["design"]["face_width_mm"] = (2.0 * width).into();
    let doubled = derived(&document).await["value"].as_f64().unwrap() / before["value"].as_f64().unwrap();
    assert!((doubled - 2.0).abs() < 1e-9, "{doubled}");
}

#[tokio::test]
async fn the_time_that_similar_jobs_took() {
    let app = app().await;
    let json = [("content-type", "application/json")];
    let estimate = async |document: &serde_json::Value| {
        let answer = app.send(Method::POST, "/api/v1/jobs/validate", &json, document.to_string()).await;
        answer.json["estimate"].clone()
    };
    let document = document();
    let none = estimate(&document).await;
    assert_eq!((&none["wall_time_s"], &none["jobs"]), (&serde_json::Value::Null, &0.into()), "{none}");
    app.run(&document).await;
    let one = estimate(&document).await;
    assert_eq!((&one["jobs"], &one["points"], &one["kind"]), (&1.into(), &1.into(), &"response".into()), "{one}");
    let single_s = one["wall_time_s"].as_f64().unwrap();
    assert!(single_s > 0.0, "{one}");
    // Another calculation has no measurement yet; a sweep is estimated by single points.
    let mut other = document.clone();
    other["analysis"]["method"] = "integrate".into();
    assert_eq!(estimate(&other).await["jobs"], 0);
    let mut sweep = document.clone();
    sweep["kind"] = "sweep".into();
    sweep["axes"] =
        serde_json::json!([{"pointer": "/operation/pinion_speed_rpm", "from": 1000, "to": 2000, "points": 7}]);
    let of_sweep = estimate(&sweep).await;
    assert_eq!((&of_sweep["points"], &of_sweep["kind"]), (&7.into(), &"response".into()), "{of_sweep}");
    assert!((of_sweep["wall_time_s"].as_f64().unwrap() / single_s - 7.0).abs() < 1e-9, "{of_sweep}");
}
