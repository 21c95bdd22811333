//! REXS as XML.

use super::model::{Attribute, Component, MAX_ARRAY, MAX_ELEMENTS, RawCase, RawModel, RawRelation, Value};
use crate::refusal::{Refusal, short};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

/// Longest text of a value that is kept, bytes.
const MAX_TEXT: usize = 4096;

/// Reads a model.
///
/// # Errors
/// [`Refusal`] for text that is not well-formed XML, has a document type or entities, or another root element.
pub(super) fn read(text: &str) -> Result<RawModel, Refusal> {
    let mut reader = Reader::from_str(text);
    reader.config_mut().expand_empty_elements = true;
    let mut reading = Reading::default();
    loop {
        let event = reader.read_event().map_err(|error| not_well_formed(text, reader.error_position(), &error))?;
        match event {
            Event::Start(start) => reading.start(&start)?,
            Event::End(end) => reading.end(end.local_name().as_ref())?,
            Event::Text(content) => reading.text(&content),
            Event::CData(content) => reading.text(&content),
            Event::GeneralRef(entity) => {
                let letter = entity.resolve_char_ref().map_err(|error| refused(&error))?;
                match letter.map(String::from).or_else(|| predefined(&entity).map(str::to_owned)) {
                    Some(letter) => reading.text(&letter),
                    None => return Err(entities(&entity)),
                }
            }
            Event::DocType(_) => {
                return Err(Refusal::unreadable("document-type", "has a document type (DOCTYPE), which is not read"));
            }
            Event::Eof => break,
            Event::Empty(_) | Event::Comment(_) | Event::Decl(_) | Event::PI(_) => {}
        }
    }
    if let Some(open) = reading.open.last() {
        let detail = format!("ends inside of <{}>: it is not complete", short(open));
        return Err(Refusal::unreadable("not-readable", detail));
    }
    if !reading.has_root {
        return Err(Refusal::unreadable("not-readable", "has no XML element"));
    }
    Ok(reading.model)
}

fn predefined(name: &str) -> Option<&'static str> {
    match name {
        "lt" => Some("<"),
        "gt" => Some(">"),
        "amp" => Some("&"),
        "apos" => Some("'"),
        "quot" => Some("\""),
        _ => None,
    }
}

fn entities(name: &str) -> Refusal {
    Refusal::unreadable("entity", format!("uses the entity &{};, and entities are not read", short(name)))
}

fn refused(error: &dyn std::fmt::Display) -> Refusal {
    Refusal::unreadable("not-readable", format!("is not well-formed XML: {}", short(&error.to_string())))
}

fn not_well_formed(text: &str, position: u64, error: &dyn std::fmt::Display) -> Refusal {
    let before = text.as_bytes().iter().take(usize::try_from(position).unwrap_or(usize::MAX));
    let line = 1 + before.filter(|byte| **byte == b'\n').count();
    let detail = format!("is not well-formed XML (line {line}): {}", short(&error.to_string()));
    Refusal::unreadable("not-readable", detail)
}

/// An attribute while its element is open.
#[derive(Default)]
struct OpenAttribute {
    id: String,
    unit: Option<String>,
    is_user_defined: bool,
    text: String,
    /// Numbers of an array.
    numbers: Vec<f64>,
    /// Whether it is an array, and one that is kept.
    array: Option<bool>,
    /// Coding of the text of an array.
    code: Option<String>,
}

#[derive(Default)]
struct Reading {
    model: RawModel,
    has_root: bool,
    /// Names of the open elements.
    open: Vec<String>,
    elements: usize,
    component: Option<Component>,
    relation: Option<RawRelation>,
    case: Option<RawCase>,
    attribute: Option<OpenAttribute>,
}

/// The value of an XML attribute.
fn value_of(start: &BytesStart, name: &str) -> Result<Option<String>, Refusal> {
    for attribute in start.attributes() {
        let attribute = attribute.map_err(|error| refused(&error))?;
        if attribute.key.local_name().as_ref() == name {
            let raw = &attribute.value;
            let text = quick_xml::escape::unescape(raw).map_err(|_| entities(raw))?;
            return Ok(Some(text.into_owned()));
        }
    }
    Ok(None)
}

/// The id of a component or relation.
fn id_of(start: &BytesStart) -> Result<Option<i64>, Refusal> {
    Ok(value_of(start, "id")?.and_then(|text| text.trim().parse().ok()))
}

impl Reading {
    fn start(&mut self, start: &BytesStart) -> Result<(), Refusal> {
        let name = start.local_name().as_ref().to_owned();
        let parent = self.open.last().cloned().unwrap_or_default();
        if self.open.is_empty() {
            if self.has_root || name != "model" {
                let detail = format!("is XML, but its root element is <{}>, not <model>: no REXS model", short(&name));
                return Err(Refusal::unreadable("not-rexs", detail));
            }
            self.has_root = true;
            self.model.version = value_of(start, "version")?.unwrap_or_default();
            self.model.application = value_of(start, "applicationId")?.unwrap_or_default();
            self.model.application_version = value_of(start, "applicationVersion")?.unwrap_or_default();
        }
        if self.open.len() > 32 {
            return Err(Refusal::unreadable("not-rexs", "is XML nested deeper than a REXS model is"));
        }
        if matches!(name.as_str(), "component" | "attribute" | "relation" | "ref") {
            self.elements += 1;
            if self.elements > MAX_ELEMENTS {
                let detail = format!("has more than {MAX_ELEMENTS} components, attributes and relations");
                return Err(Refusal::unreadable("too-large", detail));
            }
        }
        match name.as_str() {
            "relation" => {
                let order = value_of(start, "order")?.and_then(|text| text.trim().parse().ok());
                let kind = value_of(start, "type")?.unwrap_or_default();
                self.relation = Some(RawRelation { id: id_of(start)?, kind, order, refs: Vec::new() });
            }
            "ref" => {
                if let (Some(relation), Some(id)) = (&mut self.relation, id_of(start)?) {
                    relation.refs.push((value_of(start, "role")?.unwrap_or_default(), id));
                }
            }
            "component" => {
                let Some(id) = id_of(start)? else {
                    let kind = value_of(start, "type")?.unwrap_or_default();
                    let detail = format!("has a component ({}) whose id is not a whole number", short(&kind));
                    return Err(Refusal::unreadable("not-rexs", detail));
                };
                let kind = value_of(start, "type")?.unwrap_or_default();
                let name = value_of(start, "name")?;
                self.component = Some(Component { id, kind, name, attributes: Vec::new() });
            }
            "attribute" => {
                self.attribute = Some(OpenAttribute {
                    id: value_of(start, "id")?.unwrap_or_default(),
                    unit: value_of(start, "unit")?,
                    is_user_defined: value_of(start, "origin")?.as_deref() == Some("user_defined"),
                    ..OpenAttribute::default()
                });
            }
            "array" | "matrix" | "array_of_arrays" => {
                if let Some(attribute) = &mut self.attribute {
                    attribute.array = Some(name == "array" && attribute.array.is_none());
                    attribute.code = value_of(start, "code")?;
                    attribute.text.clear();
                }
            }
            "c" if parent == "array" || parent == "r" => {
                if let Some(attribute) = &mut self.attribute {
                    attribute.text.clear();
                }
            }
            "load_case" => self.case = Some(RawCase { id: id_of(start)?.unwrap_or(0), components: Vec::new() }),
            _ => {}
        }
        self.open.push(name);
        Ok(())
    }

    fn text(&mut self, content: &str) {
        let Some(attribute) = &mut self.attribute else { return };
        if attribute.array != Some(false) && attribute.text.len() + content.len() <= MAX_TEXT {
            attribute.text.push_str(content);
        }
    }

    fn end(&mut self, name: &str) -> Result<(), Refusal> {
        self.open.pop();
        match name {
            "c" => {
                if let Some(attribute) = &mut self.attribute {
                    match attribute.text.trim().parse::<f64>() {
                        Ok(number) if attribute.numbers.len() < MAX_ARRAY => attribute.numbers.push(number),
                        _ => attribute.array = Some(false),
                    }
                    attribute.text.clear();
                }
            }
            "attribute" => {
                let inside = self.component.is_some();
                if let (Some(attribute), true) = (self.attribute.take(), inside) {
                    let attribute = attribute.close();
                    if let Some(component) = &mut self.component {
                        component.attributes.extend(attribute);
                    }
                }
            }
            "component" => {
                if let Some(component) = self.component.take() {
                    match (&mut self.case, self.open.iter().any(|name| name == "accumulation")) {
                        (_, true) => {}
                        (Some(case), false) => case.components.push(component),
                        (None, false) => self.model.components.push(component),
                    }
                }
            }
            "relation" => self.model.relations.extend(self.relation.take()),
            "load_case" => self.model.cases.extend(self.case.take()),
            _ => {}
        }
        Ok(())
    }
}

impl OpenAttribute {
    /// The attribute; `None` where it has no value.
    fn close(self) -> Option<Attribute> {
        let Self { id, unit, is_user_defined, text, numbers, array, code } = self;
        let value = match array {
            None if text.trim().is_empty() => return None,
            None => Value::Text(text.trim().to_owned()),
            Some(false) => Value::Other,
            Some(true) => match code {
                Some(code) => decoded(&code, text.trim()).map_or(Value::Other, Value::Numbers),
                None => Value::Numbers(numbers),
            },
        };
        Some(Attribute { id, unit, value, is_user_defined })
    }
}

/// The numbers of a coded array, little-endian in base64; `None` for a long or an unreadable one.
pub(super) fn decoded(code: &str, text: &str) -> Option<Vec<f64>> {
    if text.len() > MAX_TEXT {
        return None;
    }
    let plain: String = text.chars().filter(|letter| !letter.is_whitespace()).collect();
    let bytes = STANDARD.decode(plain).ok()?;
    let numbers: Vec<f64> = match code {
        "float64" => bytes.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect(),
        "float32" => bytes.as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes).into()).collect(),
        "int32" => bytes.as_chunks::<4>().0.iter().map(|bytes| i32::from_le_bytes(*bytes).into()).collect(),
        _ => return None,
    };
    (numbers.len() <= MAX_ARRAY).then_some(numbers)
}
