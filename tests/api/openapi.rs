use crate::support::*;
use serde_json::Value;

#[test]
#[cfg_attr(feature = "parquet", ignore = "the checked-in document is that of a program without this feature")]
fn the_checked_in_description_is_current() {
    let checked_in = include_str!("../../openapi/openapi.json");
    assert!(
        checked_in == herringbone::api::openapi_json(),
        "openapi/openapi.json is out of date: run `cargo run -- openapi > openapi/openapi.json`"
    );
}

fn operations(document: &Value) -> Vec<(String, &Value)> {
    let paths = document["paths"].as_object().unwrap();
    let of = |(path, item): (&String, &'static str)| (path.clone(), item);
    let mut all = Vec::new();
    for (path, item) in paths {
        for method in ["get", "post", "put", "patch", "delete"] {
            if let Some(operation) = item.get(method) {
                let (path, method) = of((path, method));
                all.push((format!("{method} {path}"), operation));
            }
        }
    }
    all
}

#[test]
fn every_response_is_described_and_every_error_is_a_problem() {
    let document: Value = serde_json::from_str(&herringbone::api::openapi_json()).unwrap();
    for (name, operation) in operations(&document) {
        assert!(operation["summary"].as_str().is_some_and(|text| !text.is_empty()), "{name} has no summary");
        for (status, response) in operation["responses"].as_object().unwrap() {
            assert!(
                response["description"].as_str().is_some_and(|text| !text.is_empty()),
                "{name} {status} has no description"
            );
            if status.as_str() >= "400" {
                let schema = &response["content"]["application/problem+json"]["schema"]["$ref"];
                assert_eq!(schema, "#/components/schemas/Problem", "{name} {status}");
            }
        }
    }
}

#[test]
fn every_endpoint_is_described() {
    let document: Value = serde_json::from_str(&herringbone::api::openapi_json()).unwrap();
    let mut names: Vec<_> = operations(&document).into_iter().map(|(name, _)| name).collect();
    names.sort();
    let expected = [
        "delete /api/v1/jobs/{id}",
        "get /api/v1/jobs",
        "get /api/v1/jobs/events",
        "get /api/v1/jobs/{id}",
        "get /api/v1/jobs/{id}/bearing-forces",
        "get /api/v1/jobs/{id}/events",
        "get /api/v1/jobs/{id}/gear-data",
        "get /api/v1/jobs/{id}/input",
        "get /api/v1/jobs/{id}/points",
        "get /api/v1/jobs/{id}/points/columns",
        "get /api/v1/jobs/{id}/points/{position}/input",
        "get /api/v1/jobs/{id}/result",
        "get /api/v1/jobs/{id}/rexs",
        "get /api/v1/jobs/{id}/series",
        "get /api/v1/jobs/{id}/series/{channel}",
        "get /api/v1/jobs/{id}/series/{channel}.wav",
        "get /api/v1/jobs/{id}/tables",
        "get /api/v1/kinds",
        "get /api/v1/system",
        "get /api/v1/webhooks/deliveries",
        "get /healthz",
        "get /metrics",
        "get /problems/{code}",
        "get /readyz",
        "patch /api/v1/jobs/{id}",
        "post /api/v1/import",
        "post /api/v1/jobs",
        "post /api/v1/jobs/validate",
        "post /api/v1/jobs/{id}/cancel",
    ];
    assert_eq!(names, expected);
}

#[test]
fn every_reference_leads_somewhere() {
    let document: Value = serde_json::from_str(&herringbone::api::openapi_json()).unwrap();
    let mut open = vec![&document];
    while let Some(value) = open.pop() {
        match value {
            Value::Object(map) => {
                if let Some(Value::String(reference)) = map.get("$ref") {
                    let pointer = reference.trim_start_matches('#');
                    assert!(document.pointer(pointer).is_some(), "{reference} leads nowhere");
                }
                open.extend(map.values());
            }
            Value::Array(values) => open.extend(values),
            _ => {}
        }
    }
}

#[test]
fn every_link_leads_to_an_operation() {
    let document: Value = serde_json::from_str(&herringbone::api::openapi_json()).unwrap();
    let operations = operations(&document);
    let parameters = |id: &str| {
        let (_, operation) = operations.iter().find(|(_, operation)| operation["operationId"] == id)?;
        Some(operation["parameters"].as_array().unwrap().iter().map(|parameter| &parameter["name"]).collect::<Vec<_>>())
    };
    let mut seen = 0;
    for (name, operation) in &operations {
        for response in operation["responses"].as_object().unwrap().values() {
            for link in response["links"].as_object().into_iter().flat_map(|links| links.values()) {
                let known =
                    parameters(link["operationId"].as_str().unwrap()).unwrap_or_else(|| panic!("{name}: {link}"));
                for parameter in link["parameters"].as_object().unwrap().keys() {
                    assert!(known.iter().any(|known| *known == parameter), "{name}: {link}");
                }
                seen += 1;
            }
        }
    }
    assert!(seen > 0);
}

#[test]
fn documents_are_told_apart_by_their_kind() {
    let document: Value = serde_json::from_str(&herringbone::api::openapi_json()).unwrap();
    let validator = |name: &str| {
        let schema = serde_json::json!({
            "$ref": format!("#/components/schemas/{name}"), "components": document["components"],
        });
        jsonschema::validator_for(&schema).unwrap()
    };
    let kinds = ["mesh", "response", "sweep"];
    let names = ["MeshDocument", "ResponseDocument", "SweepDocument"];
    let examples = &document["paths"]["/api/v1/jobs"]["post"]["requestBody"]["content"]["application/json"]["examples"];
    for kind in kinds {
        let example = &examples[kind]["value"];
        assert!(validator("JobDocument").is_valid(example), "{kind}");
        let fitting: Vec<_> = names.iter().filter(|name| validator(name).is_valid(example)).collect();
        assert_eq!(fitting.len(), 1, "{kind}: {fitting:?}");
        assert!(fitting[0].to_lowercase().starts_with(kind));
    }
    let mut without = examples["response"]["value"].clone();
    without.as_object_mut().unwrap().remove("kind");
    assert!(validator("JobDocument").is_valid(&without));
    assert!(!validator("JobDocument").is_valid(&serde_json::json!({"kind": "mesh"})));
}

#[tokio::test]
async fn real_answers_fit_their_schemas() {
    let app = app().await;
    let document: Value = serde_json::from_str(&herringbone::api::openapi_json()).unwrap();
    let schema = |name: &str| {
        let schema = serde_json::json!({
            "$ref": format!("#/components/schemas/{name}"), "components": document["components"],
        });
        jsonschema::validator_for(&schema).unwrap()
    };
    let (path, _) = app.run(&crate::support::document()).await;
    let (failed, _) = app.run(&scripted("fail")).await;
    for (path, name) in [
        (path.clone(), "Job"),
        (failed, "Job"),
        ("/api/v1/jobs".to_owned(), "JobList"),
        (format!("{path}/input"), "JobDocument"),
        (format!("{path}/result"), "JobResult"),
        (format!("{path}/series"), "SeriesList"),
        (format!("{path}/series/a_x_left"), "SeriesData"),
        ("/api/v1/kinds".to_owned(), "KindList"),
        ("/api/v1/system".to_owned(), "System"),
        ("/api/v1/webhooks/deliveries".to_owned(), "DeliveryList"),
        ("/healthz".to_owned(), "Health"),
        ("/problems/internal".to_owned(), "ProblemExplanation"),
        ("/api/v1/jobs/x".to_owned(), "Problem"),
        ("/api/v1/jobs?limit=x".to_owned(), "Problem"),
    ] {
        let answer = app.get(&path).await;
        let errors: Vec<_> = schema(name)
            .iter_errors(&answer.json)
            .map(|error| format!("{error} at {}", error.instance_path()))
            .collect();
        assert!(errors.is_empty(), "{path} is no {name}: {errors:?}");
    }
}

#[tokio::test]
async fn the_description_and_its_pages_are_served_from_here() {
    let app = app().await;
    assert_eq!(app.get("/openapi.json").await.text(), herringbone::api::openapi_json());
    let page = app.get("/docs/").await;
    assert_eq!((page.status, page.header("content-type")), (200, "text/html; charset=utf-8"));
    assert!(page.text().contains("href=\"/jobs\""), "there is a way back");
    assert!(!page.text().contains("//cdn") && !page.text().contains("https://"), "{}", page.text());
    assert!(!page.text().contains("<script>"), "inline scripts are forbidden by the policy");
    let script = app.get("/docs/swagger-ui-bundle.js").await;
    assert_eq!(script.status, 200);
    let again = app.get_with("/docs/swagger-ui-bundle.js", &[("if-none-match", script.header("etag"))]).await;
    assert_eq!(again.status, 304);
    assert!(app.get("/docs/swagger-initializer.js").await.text().contains("/openapi.json"));
}
