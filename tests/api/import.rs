use crate::support::*;
use axum::http::Method;
use std::path::Path;

const PATH: &str = "/api/v1/import";
const XML: (&str, &str) = ("content-type", "application/xml");

fn model(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/exchange/tests/data").join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[tokio::test]
async fn a_file_becomes_a_document_that_can_be_submitted() {
    let app = app().await;
    let answer = app.send(Method::POST, PATH, &[XML], model("herringbone_pair_1_7.rexs")).await;
    assert_eq!(answer.status, 200, "{answer:?}");
    assert_eq!(answer.json["source"]["version"], "1.7");
    let line =
        answer.json["taken"].as_array().unwrap().iter().find(|line| line["pointer"] == "/design/normal_module_mm");
    assert_eq!(
        line.unwrap()["from"].as_str().map(|from| from.starts_with("cylindrical_gear[40].normal_module")),
        Some(true)
    );
    app.run(&answer.json["document"]).await;
    // Nothing was submitted by the import itself.
    assert_eq!(app.get("/api/v1/jobs").await.json["items"].as_array().unwrap().len(), 1);
    let json = app
        .send(Method::POST, PATH, &[("content-type", "application/json")], model("herringbone_pair_1_7.rexsj"))
        .await;
    assert_eq!(json.json["document"], answer.json["document"]);
    let bytes = [("content-type", "application/octet-stream")];
    let any = app.send(Method::POST, &format!("{PATH}?format=auto"), &bytes, model("herringbone_pair_1_7.rexs")).await;
    assert_eq!(any.json["document"], answer.json["document"]);
}

#[tokio::test]
async fn what_is_answered_is_what_the_description_says() {
    let app = app().await;
    let description: serde_json::Value = serde_json::from_str(&herringbone::api::openapi_json()).unwrap();
    let schema = serde_json::json!({"$ref": "#/components/schemas/Import", "components": description["components"]});
    let schema = jsonschema::validator_for(&schema).unwrap();
    for (name, query) in
        [("herringbone_pair_1_7.rexs", ""), ("FVA-Industriegetriebe_2stufig_1-4.rexs", "?pair=1&mirror=true")]
    {
        let answer = app.send(Method::POST, &format!("{PATH}{query}"), &[XML], model(name)).await;
        assert_eq!(answer.status, 200, "{answer:?}");
        let errors: Vec<_> =
            schema.iter_errors(&answer.json).map(|error| format!("{error} at {}", error.instance_path())).collect();
        assert!(errors.is_empty(), "{errors:?}");
    }
}

#[tokio::test]
async fn the_choices_of_the_query() {
    let app = app().await;
    let industrial = || model("FVA-Industriegetriebe_2_stufig_1-6.rexs");
    let refused = app.send(Method::POST, PATH, &[XML], industrial()).await;
    refused.assert_problem(422, "unsupported-design");
    assert!(refused.violation("/pair/2")["detail"].as_str().unwrap().contains("z 23/34"));
    let query = "?pair=2&mirror=true&torque_nm=1500&point=heaviest&gap_mm=12.5";
    let answer = app.send(Method::POST, &format!("{PATH}{query}"), &[XML], industrial()).await;
    assert_eq!(answer.status, 200, "{answer:?}");
    assert_eq!(answer.json["document"]["operation"]["pinion_torque_nm"], 1500.0);
    assert_eq!(answer.json["document"]["design"]["gap_width_mm"], 12.5);
    assert_eq!(answer.json["operating_points"][3]["chosen"], true);
    for query in [
        "pair=0",
        "mirror=yes",
        "torque_nm=x",
        "point=last",
        "gap_mm=-1",
        "format=step",
        "face_width_is=both",
        "what=1",
    ] {
        let answer = app.send(Method::POST, &format!("{PATH}?{query}"), &[XML], industrial()).await;
        answer.assert_problem(400, "invalid-parameter");
    }
}

#[tokio::test]
async fn files_that_are_none_and_bodies_that_are_too_large() {
    let app = app().await;
    let unreadable = app.send(Method::POST, PATH, &[XML], "<model>").await;
    unreadable.assert_problem(422, "invalid-design");
    assert_eq!(unreadable.json["title"], "The file cannot be imported");
    let form = [("content-type", "application/x-www-form-urlencoded")];
    app.send(Method::POST, PATH, &form, "a=b").await.assert_problem(415, "unsupported-media-type");
    let packed = [XML, ("content-encoding", "gzip")];
    app.send(Method::POST, PATH, &packed, "x").await.assert_problem(415, "unsupported-media-type");
    // Larger than a document may be, and larger than any file may be.
    let padded = [model("herringbone_pair_1_7.rexs"), vec![b' '; 2 << 20]].concat();
    assert_eq!(app.send(Method::POST, PATH, &[XML], padded).await.status, 200);
    let large = app.send(Method::POST, PATH, &[XML], vec![b' '; (32 << 20) + 1]).await;
    large.assert_problem(413, "payload-too-large");
    let accept = [XML, ("accept", "text/html")];
    app.send(Method::POST, PATH, &accept, model("herringbone_pair_1_7.rexs"))
        .await
        .assert_problem(406, "not-acceptable");
}

#[tokio::test]
async fn a_job_as_a_model_for_other_programs() {
    let app = app().await;
    let (job, _) = app.run(&document()).await;
    let xml = app.get(&format!("{job}/rexs")).await;
    assert_eq!((xml.status, xml.header("content-type")), (200, "application/xml"));
    assert!(xml.header("content-disposition").ends_with(".rexs\""), "{xml:?}");
    let back = app.send(Method::POST, PATH, &[XML], xml.text()).await;
    assert_eq!(back.status, 200, "{back:?}");
    assert_eq!(back.json["document"]["design"]["pinion"]["teeth"], document()["design"]["pinion"]["teeth"]);
    assert_eq!(back.json["source"]["application"].as_str().map(|name| name.starts_with("herringbone")), Some(true));
    let json = app.get(&format!("{job}/rexs?format=json&version=1.7")).await;
    assert_eq!((json.status, &json.json["model"]["version"]), (200, &"1.7".into()));
    app.get(&format!("{job}/rexs?version=2.0")).await.assert_problem(400, "invalid-parameter");
    app.get("/api/v1/jobs/0199f3c4-6f0b-7c41-9d5e-2f1f0f6f3c11/rexs").await.assert_problem(404, "not-found");
}
