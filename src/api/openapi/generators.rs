//! The OpenAPI document for generators of clients, which cannot read all that JSON Schema can say: in what is sent to
//! the service (but changes of a job, where null removes a text) nothing is null, and every list says what it holds.

use serde_json::{Map, Value, json};
use std::collections::BTreeSet;

/// The schema whose nulls have a meaning.
const KEPT: &str = "JobPatch";

/// The media types of which a body keeps the first one that it has.
const PREFERRED: [&str; 2] = ["application/octet-stream", "application/json"];

/// Applies the rules to request bodies and their schemas.
pub(super) fn simplify(document: &mut Value) {
    let mut names = BTreeSet::new();
    if let Some(paths) = document["paths"].as_object() {
        let operations = paths.values().filter_map(Value::as_object).flat_map(Map::values);
        operations.for_each(|operation| collect(document, &operation["requestBody"], &mut names));
    }
    if let Some(paths) = document["paths"].as_object_mut() {
        let operations = paths.values_mut().filter_map(Value::as_object_mut).flat_map(Map::values_mut);
        operations.filter_map(|operation| operation.get_mut("requestBody")).for_each(keep_one_media_type);
    }
    names.remove(KEPT);
    for name in names {
        without_null(&mut document["components"]["schemas"][&name]);
    }
}

fn keep_one_media_type(body: &mut Value) {
    let Some(content) = body["content"].as_object_mut().filter(|content| content.len() > 1) else { return };
    let Some(kept) = PREFERRED.into_iter().find(|name| content.contains_key(*name)) else { return };
    content.retain(|name, _| name == kept);
    if kept == PREFERRED[0] {
        content[kept]["schema"] = json!({"type": "string", "format": "binary"});
    }
}

/// The names of the schemas that a description refers to, directly or not.
fn collect(document: &Value, value: &Value, names: &mut BTreeSet<String>) {
    match value {
        Value::Object(members) => {
            let name = members.get("$ref").and_then(Value::as_str).and_then(|path| path.rsplit('/').next());
            if let Some(name) = name
                && names.insert(name.to_owned())
            {
                collect(document, &document["components"]["schemas"][name], names);
            }
            members.values().for_each(|value| collect(document, value, names));
        }
        Value::Array(values) => values.iter().for_each(|value| collect(document, value, names)),
        _ => {}
    }
}

fn without_null(value: &mut Value) {
    match value {
        Value::Object(members) => {
            if let Some(Value::Object(properties)) = members.get_mut("properties") {
                properties.retain(|_, schema| schema["type"] != "null");
            }
            if let Some(Value::Array(types)) = members.get_mut("type") {
                types.retain(|name| name != "null");
                if let [one] = types.as_slice() {
                    let one = one.clone();
                    members.insert("type".to_owned(), one);
                }
            }
            if let Some(Value::Array(values)) = members.get_mut("enum") {
                values.retain(|value| !value.is_null());
            }
            if members.get("default").is_some_and(Value::is_null) {
                members.remove("default");
            }
            if members.get("type").is_some_and(|name| name == "array") && !members.contains_key("items") {
                members.insert("items".to_owned(), json!({}));
            }
            let described =
                members.iter_mut().filter(|(key, _)| !["default", "example", "examples"].contains(&key.as_str()));
            described.for_each(|(_, value)| without_null(value));
        }
        Value::Array(values) => values.iter_mut().for_each(without_null),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_have_no_null_and_no_list_of_nothing_and_the_rest_is_the_same() {
        let plain: Value = serde_json::from_str(&crate::api::openapi_json()).unwrap();
        let simple: Value = serde_json::from_str(&crate::api::openapi_for_generators()).unwrap();
        let mut names = BTreeSet::new();
        for operation in
            plain["paths"].as_object().unwrap().values().flat_map(|path| path.as_object().unwrap().values())
        {
            collect(&plain, &operation["requestBody"], &mut names);
        }
        assert!(names.contains("JobDesign") && names.contains(KEPT), "{names:?}");
        let mut seen = 0;
        for (name, schema) in simple["components"]["schemas"].as_object().unwrap() {
            if !names.contains(name) || name == KEPT {
                assert_eq!(*schema, plain["components"]["schemas"][name], "{name}");
                continue;
            }
            let mut open = vec![schema];
            while let Some(value) = open.pop() {
                seen += 1;
                match value {
                    Value::Object(members) => {
                        let kind = members.get("type");
                        assert!(kind.is_none_or(|kind| !kind.to_string().contains("null")), "{name}: {value}");
                        assert!(kind != Some(&json!("array")) || members.contains_key("items"), "{name}: {value}");
                        open.extend(members.iter().filter(|(key, _)| *key != "examples").map(|(_, value)| value));
                    }
                    Value::Array(values) => open.extend(values),
                    _ => {}
                }
            }
        }
        assert!(seen > 1000, "{seen}");
        let mut bodies = 0;
        for (path, operations) in simple["paths"].as_object().unwrap() {
            for (method, operation) in operations.as_object().unwrap() {
                let (mut simple, mut plain) = (operation.clone(), plain["paths"][path][method].clone());
                if let Some(content) = simple["requestBody"]["content"].as_object() {
                    assert_eq!(content.len(), 1, "{method} {path}");
                    bodies += 1;
                }
                simple["requestBody"] = Value::Null;
                plain["requestBody"] = Value::Null;
                assert_eq!(simple, plain, "{method} {path}");
            }
        }
        assert!(bodies >= 4, "{bodies}");
    }
}
