//! Schemas of the job document: one for each kind, with shared blocks.

use herringbone_job::document::JobKind;
use herringbone_job::schema::job_document_schema_of;
use serde_json::{Value, json};

/// The blocks that documents of every kind have, with the names of their schemas.
const SHARED: [(&str, &str); 4] =
    [("design", "JobDesign"), ("operation", "JobOperation"), ("model", "JobModel"), ("analysis", "JobAnalysis")];

/// The name of the schema of the documents of a kind.
fn schema_name(kind: JobKind) -> &'static str {
    match kind {
        JobKind::Mesh => "MeshDocument",
        JobKind::Response => "ResponseDocument",
        JobKind::Sweep => "SweepDocument",
        JobKind::Optimise => "OptimiseDocument",
        JobKind::Tolerance => "ToleranceDocument",
    }
}

/// A valid document of a kind.
fn example(kind: JobKind) -> Value {
    let text = match kind {
        JobKind::Mesh | JobKind::Response => include_str!("../../../examples/table1.json"),
        JobKind::Sweep => include_str!("../../../examples/speed_sweep.json"),
        JobKind::Optimise => include_str!("../../../examples/optimise_relief.json"),
        JobKind::Tolerance => include_str!("../../../examples/tolerance_relief.json"),
    };
    let mut example: Value = serde_json::from_str(text).unwrap_or_default();
    example["kind"] = json!(kind.as_str());
    example
}

/// Adds the schemas of the document to the components.
pub(super) fn add_schemas(description: &mut Value) {
    let schemas = &mut description["components"]["schemas"];
    let mut kinds = Vec::new();
    for (_, kind) in JobKind::ALL {
        let mut schema = job_document_schema_of(kind);
        for (field, name) in SHARED {
            let reference = reference(name);
            schemas[name] = std::mem::replace(&mut schema["properties"][field], reference);
        }
        if kind != JobKind::Sweep {
            // Null counts as absent here too.
            schema["properties"]["axes"] = json!({"type": "null"});
            schema["properties"]["continuation"] = json!({"type": "null"});
            schema["properties"]["record"] = json!({"type": ["array", "null"], "maxItems": 0});
        }
        let name = schema_name(kind);
        kinds.push(reference(name));
        schemas[name] = schema;
    }
    schemas["JobDocument"] = json!({
        "oneOf": kinds,
        "description": "One document describes one job. Fields left out, or null, take their default. The schema has what can be \
            said of single fields; rules between fields, and whether such a gear can exist, are answered with 422.",
    });
}

fn reference(name: &str) -> Value {
    json!({"$ref": format!("#/components/schemas/{name}")})
}

/// Sets the schema of the document in the request and response bodies that are documents.
pub(super) fn set_schemas(path: &str, operation: &mut Value) {
    if path == "/api/v1/import" {
        // What is imported is another program's.
        return;
    }
    let is_document =
        |body: &&mut Value| body["schema"]["$ref"].as_str().is_none_or(|name| name.ends_with("/JobDocument"));
    if let Some(body) = operation.pointer_mut("/requestBody/content/application~1json").filter(is_document) {
        body["schema"] = reference("JobDocument");
        for (name, kind) in JobKind::ALL {
            body["examples"][name] = json!({"value": example(kind)});
        }
    }
    if path.ends_with("/input") {
        operation["responses"]["200"]["content"]["application/json"]["schema"] = reference("JobDocument");
    }
}
