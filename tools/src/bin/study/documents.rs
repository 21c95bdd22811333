//! The study's documents: the repository's examples, and what is made from them by changing single fields.

use crate::ask::Outcome;
use serde_json::{Value, json};

/// A document of the repository, by its path from the root.
pub(crate) fn load(path: &str) -> Outcome<Value> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
    Ok(serde_json::from_str(&text)?)
}

/// The source's own pair by the source's model: stiffness and impact in the equations, halves that turn freely against
/// each other.
pub(crate) fn table1() -> Outcome<Value> {
    load("examples/table1.json")
}

/// The same pair with the contact in the equations: halves of one body, supports by the size of the pair.
pub(crate) fn contact() -> Outcome<Value> {
    load("examples/contact.json")
}

/// The document with the force of the loaded contact in the equations, halves and supports as it has them.
pub(crate) fn with_contact(document: &Value) -> Value {
    with(document, &[("/model/mesh_force", json!("contact"))])
}

/// The document with the contact in the equations, on halves of one body: of the supports only their damping is given.
pub(crate) fn on_one_body(document: &Value) -> Value {
    let damping = document["design"]["supports"]["damping_ratio"].clone();
    with(&with_contact(document), &[("/design/supports", json!({"damping_ratio": damping}))])
}

/// The document with tip corners that do not touch beyond the path of contact.
pub(crate) fn without_corner_contact(document: &Value) -> Value {
    with(document, &[("/model/mesh_stiffness/corner_contact", json!(false))])
}

/// The document with fields changed; members that do not exist yet are added.
pub(crate) fn with(document: &Value, changes: &[(&str, Value)]) -> Value {
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
pub(crate) fn without_impact(document: &Value) -> Value {
    with(document, &[("/model/impact", json!({"source": "none"}))])
}
