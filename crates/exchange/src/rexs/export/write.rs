//! A model as text: XML or JSON of equal content.

use super::ExportOptions;
use super::model::{Component, Model, Typed, Written};
use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, BytesText, Event};
use serde_json::{Value, json};
use std::io::Error;

const VERSION: &str = "1.7";
const APPLICATION: &str = "herringbone";

fn origin(attribute: &Written) -> &'static str {
    if attribute.calculated { "calculated" } else { "user_defined" }
}

/// A number with a decimal point, or as a power of ten.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// XML.
///
/// # Errors
/// None in practice: writing into memory.
pub(super) fn xml(model: &Model, options: &ExportOptions) -> Result<String, Error> {
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 2);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let mut root = BytesStart::new("model");
    root.push_attribute(("version", VERSION));
    root.push_attribute(("applicationId", APPLICATION));
    root.push_attribute(("applicationVersion", options.application_version));
    root.push_attribute(("date", options.date));
    root.push_attribute(("applicationLanguage", "en"));
    writer.write_event(Event::Start(root))?;
    writer.write_event(Event::Start(BytesStart::new("relations")))?;
    for (index, relation) in model.relations.iter().enumerate() {
        let mut start = BytesStart::new("relation");
        start.push_attribute(("id", (index + 1).to_string().as_str()));
        start.push_attribute(("type", relation.kind));
        if let Some(order) = relation.order {
            start.push_attribute(("order", order.to_string().as_str()));
        }
        writer.write_event(Event::Start(start))?;
        for (role, id) in &relation.refs {
            let mut reference = BytesStart::new("ref");
            reference.push_attribute(("id", id.to_string().as_str()));
            reference.push_attribute(("role", *role));
            reference.push_attribute(("hint", model.kind(*id)));
            writer.write_event(Event::Empty(reference))?;
        }
        writer.write_event(Event::End(BytesEnd::new("relation")))?;
    }
    writer.write_event(Event::End(BytesEnd::new("relations")))?;
    writer.write_event(Event::Start(BytesStart::new("components")))?;
    for component in &model.components {
        component_xml(&mut writer, component)?;
    }
    writer.write_event(Event::End(BytesEnd::new("components")))?;
    writer.write_event(Event::End(BytesEnd::new("model")))?;
    let mut text = String::from_utf8(writer.into_inner()).map_err(Error::other)?;
    text.push('\n');
    Ok(text)
}

fn component_xml(writer: &mut Writer<Vec<u8>>, component: &Component) -> Result<(), Error> {
    let mut start = BytesStart::new("component");
    start.push_attribute(("id", component.id.to_string().as_str()));
    start.push_attribute(("type", component.kind));
    start.push_attribute(("name", component.name.as_str()));
    writer.write_event(Event::Start(start))?;
    for attribute in &component.attributes {
        let mut start = BytesStart::new("attribute");
        start.push_attribute(("id", attribute.id.as_str()));
        start.push_attribute(("unit", attribute.unit));
        start.push_attribute(("origin", origin(attribute)));
        writer.write_event(Event::Start(start))?;
        let text = match &attribute.value {
            Typed::Float(value) => number(*value),
            Typed::Integer(value) | Typed::Reference(value) => value.to_string(),
            Typed::Flag(flag) => flag.to_string(),
            Typed::Word(word) => (*word).to_owned(),
            Typed::Text(text) => text.clone(),
            Typed::Floats(values) => {
                writer.write_event(Event::Start(BytesStart::new("array")))?;
                for value in values {
                    writer.write_event(Event::Start(BytesStart::new("c")))?;
                    writer.write_event(Event::Text(BytesText::new(&number(*value))))?;
                    writer.write_event(Event::End(BytesEnd::new("c")))?;
                }
                writer.write_event(Event::End(BytesEnd::new("array")))?;
                String::new()
            }
        };
        if !text.is_empty() {
            writer.write_event(Event::Text(BytesText::new(&text)))?;
        }
        writer.write_event(Event::End(BytesEnd::new("attribute")))?;
    }
    writer.write_event(Event::End(BytesEnd::new("component")))
}

/// JSON.
pub(super) fn json(model: &Model, options: &ExportOptions) -> String {
    let relations: Vec<Value> = model
        .relations
        .iter()
        .enumerate()
        .map(|(index, relation)| {
            let refs: Vec<Value> = relation
                .refs
                .iter()
                .map(|(role, id)| json!({"id": id, "role": role, "hint": model.kind(*id)}))
                .collect();
            let mut written = json!({"id": index + 1, "type": relation.kind, "refs": refs});
            if let Some(order) = relation.order {
                written["order"] = order.into();
            }
            written
        })
        .collect();
    let components: Vec<Value> = model
        .components
        .iter()
        .map(|component| {
            let attributes: Vec<Value> = component.attributes.iter().map(attribute_json).collect();
            json!({"id": component.id, "type": component.kind, "name": component.name, "attributes": attributes})
        })
        .collect();
    let model = json!({"model": {
        "version": VERSION, "applicationId": APPLICATION, "applicationVersion": options.application_version,
        "date": options.date, "applicationLanguage": "en", "relations": relations, "components": components,
    }});
    let mut text = format!("{model:#}");
    text.push('\n');
    text
}

fn attribute_json(attribute: &Written) -> Value {
    let (kind, value): (&str, Value) = match &attribute.value {
        Typed::Float(value) => ("floating_point", (*value).into()),
        Typed::Integer(value) => ("integer", (*value).into()),
        Typed::Flag(flag) => ("boolean", (*flag).into()),
        Typed::Word(word) => ("enum", (*word).into()),
        Typed::Text(text) => ("string", text.as_str().into()),
        Typed::Reference(id) => ("reference_component", (*id).into()),
        Typed::Floats(values) => ("floating_point_array", values.clone().into()),
    };
    json!({"id": attribute.id, "unit": attribute.unit, "origin": origin(attribute), kind: value})
}
