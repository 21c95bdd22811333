//! The study's documents: the repository's examples, and what is made from them by changing single fields.

use crate::ask::Outcome;
use serde_json::Value;

/// A document of the repository, by its path from the root.
pub fn load(path: &str) -> Outcome<Value> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
    Ok(serde_json::from_str(&text)?)
}

/// The source's own pair.
pub fn table1() -> Outcome<Value> {
    load("examples/table1.json")
}

/// The document with fields changed; members that do not exist yet are added.
pub fn with(document: &Value, changes: &[(&str, Value)]) -> Value {
    let mut document = document.clone();
    for (pointer, value) in changes {
        let mut place = &mut document;
        for name in pointer.trim_start_matches('/').split('/') {
            place = &mut place[name];
        }
        *place = value.clone();
    }
    document
}

/// Without a mesh-in impact.
pub fn without_impact(document: &Value) -> Value {
    with(document, &[("/model/impact", serde_json::json!({"source": "none"}))])
}
