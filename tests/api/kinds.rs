use crate::support::*;
use serde_json::Value;

#[tokio::test]
async fn each_kind_with_schema_defaults_and_limits() {
    let app = app().await;
    let answer = app.get("/api/v1/kinds").await.json;
    let items = answer["items"].as_array().unwrap();
    let kinds: Vec<_> = items.iter().map(|item| item["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["mesh", "response", "sweep", "optimise", "tolerance"]);
    for item in items {
        assert!(jsonschema::meta::is_valid(&item["schema"]));
        assert_eq!(item["limits"]["max_body_bytes"], 1 << 20);
        assert_eq!(item["defaults"]["design"]["material"]["density_kg_m3"], 7850.0);
        assert_eq!(item["defaults"]["kind"], item["kind"]);
        assert_eq!(item["schema"]["properties"].get("axes").is_some(), item["kind"] == "sweep");
        let has_measures = item["kind"] == "optimise" || item["kind"] == "tolerance";
        assert_eq!(item["measures"].as_array().is_some_and(|measures| measures.len() > 50), has_measures);
    }
}

#[tokio::test]
async fn the_examples_fit_the_schema_of_their_kind() {
    let app = app().await;
    let answer = app.get("/api/v1/kinds").await.json;
    let mut seen = 0;
    for entry in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/examples")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let document: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        for item in answer["items"].as_array().unwrap() {
            let validator = jsonschema::validator_for(&item["schema"]).unwrap();
            let errors: Vec<_> = validator.iter_errors(&document).map(|error| error.to_string()).collect();
            assert_eq!(errors.is_empty(), item["kind"] == document["kind"], "{} {errors:?}", path.display());
        }
        seen += 1;
    }
    assert!(seen > 0);
}
