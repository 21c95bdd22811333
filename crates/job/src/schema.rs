//! The JSON Schema of the job document, from the same declarations that read it.

use super::document::{self, JobKind};
use super::reader::Reading;

pub use super::reader::{Condition, FieldDescription};
use serde_json::{Map, Value, json};

/// Every declared field of the job document, parents before children.
pub fn field_descriptions() -> Vec<FieldDescription> {
    let reading = Reading::describe();
    let nothing = Value::Object(Map::new());
    document::read(&reading, &nothing);
    reading.fields()
}

/// JSON Schema (draft 2020-12) of the job document with defaults, limits and units (`x-unit`).
pub fn job_document_schema() -> Value {
    let mut root = json!({
        "type": "object",
        "title": "JobDocument",
        "description": "One document describes one job. Fields left out, or null, take their default.",
        "properties": {},
        "additionalProperties": false,
    });
    for field in field_descriptions() {
        insert(&mut root, &field);
    }
    root
}

/// JSON Schema of the documents of one kind of job: `kind` is fixed, fields of other kinds only are left out.
pub fn job_document_schema_of(kind: JobKind) -> Value {
    let mut schema = job_document_schema();
    schema["title"] = json!(format!("JobDocument ({})", kind.as_str()));
    if let Some(properties) = schema["properties"].as_object_mut() {
        for field in field_descriptions() {
            let excluded = field.condition.is_some_and(|condition| {
                condition.on == "/kind" && !condition.values.split(' ').any(|word| word == kind.as_str())
            });
            if excluded {
                properties.remove(field.pointer.trim_start_matches('/'));
            }
        }
        let help = properties.get("kind").and_then(|field| field.get("description")).cloned();
        let mut field = json!({"const": kind.as_str(), "description": help});
        if kind == JobKind::Response {
            // The kind of a document without `kind`.
            field = json!({"enum": [kind.as_str(), null], "default": kind.as_str(), "description": help});
        }
        properties.insert("kind".to_owned(), field);
        for name in required(kind) {
            // Required members cannot be null.
            properties[*name]["type"] = json!("array");
        }
    }
    let kind_is_needed = (kind != JobKind::Response).then_some("kind");
    for name in kind_is_needed.into_iter().chain(required(kind).iter().copied()) {
        push_required(&mut schema, name);
    }
    schema
}

/// Lists that documents of a kind need.
fn required(kind: JobKind) -> &'static [&'static str] {
    match kind {
        JobKind::Mesh | JobKind::Response => &[],
        JobKind::Sweep => &["axes"],
        JobKind::Optimise => &["variables", "objectives"],
        JobKind::Tolerance => &["tolerances", "measures"],
    }
}

fn insert(root: &mut Value, field: &FieldDescription) {
    let mut names: Vec<&str> = field.pointer.split('/').skip(1).collect();
    let Some(name) = names.pop() else { return };
    let mut parent = root;
    for step in names {
        parent = if step == "*" { &mut parent["items"] } else { &mut parent["properties"][step] };
    }
    let mut schema = field.schema.clone();
    if !field.required {
        allow_null(&mut schema);
    } else {
        push_required(parent, name);
    }
    if schema["items"]["type"] == "object" {
        schema["items"]["properties"] = json!({});
        schema["items"]["additionalProperties"] = json!(false);
    }
    if schema["properties"].is_null() && is_object(&schema) {
        schema["properties"] = json!({});
        schema["additionalProperties"] = json!(false);
    }
    strip_nulls(&mut schema);
    parent["properties"][name] = schema;
}

fn is_object(schema: &Value) -> bool {
    match &schema["type"] {
        Value::String(word) => word == "object",
        Value::Array(words) => words.iter().any(|word| word == "object"),
        _ => false,
    }
}

fn allow_null(schema: &mut Value) {
    if let Value::String(word) = &schema["type"] {
        schema["type"] = json!([word, "null"]);
    }
    if let Value::Array(words) = &mut schema["enum"] {
        words.push(Value::Null);
    }
}

fn push_required(parent: &mut Value, name: &str) {
    match &mut parent["required"] {
        Value::Array(names) => names.push(json!(name)),
        slot => *slot = json!([name]),
    }
}

/// Indexing a `Value` mutably leaves nulls behind; a schema has none.
fn strip_nulls(schema: &mut Value) {
    if let Value::Object(map) = schema {
        map.retain(|_, value| !value.is_null());
        map.values_mut().for_each(|value| {
            if value.is_object() {
                strip_nulls(value);
            }
        });
    }
}
