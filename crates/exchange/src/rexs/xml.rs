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
        let event = reader
            .read_event()
            .map_err(|error| not_well_formed(text, reader.error_position() + reading.passed, &error))?;
        match event {
            Event::Start(start) => reading.start(&start)?,
            Event::End(_) => {
                reading.end();
                skip(&mut reader, &mut reading, text);
            }
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
    if !reading.open.is_empty() {
        // The reader remembers the names of the elements that are open; the last one says where.
        let detail = format!("ends inside of <{}>: it is not complete", last_open(text));
        return Err(Refusal::unreadable("not-readable", detail));
    }
    if !reading.has_root {
        return Err(Refusal::unreadable("not-readable", "has no XML element"));
    }
    Ok(reading.model)
}

/// Passes over the rest of an array of which nothing is kept, up to its end: that is most of a large file.
fn skip<'t>(reader: &mut Reader<&'t [u8]>, reading: &mut Reading, text: &'t str) {
    let is_array = matches!(reading.open.last(), Some(Element::Array | Element::Matrix));
    if !is_array || reading.attribute.as_ref().is_none_or(|attribute| attribute.array != Some(false)) {
        return;
    }
    // Looked at once for each array, so that the time stays in proportion to the text.
    let name = std::mem::take(&mut reading.array);
    let rest = *reader.get_ref();
    let Some(rest_text) = text.get(text.len() - rest.len()..).filter(|_| !name.is_empty()) else { return };
    let Some(end) = rest_text.find(&format!("</{name}")) else { return };
    // Comments, marked sections, and arrays in the array are read.
    let passed = &rest_text[..end];
    if ["<!", "<?"].iter().all(|mark| !passed.contains(mark)) && !passed.contains(&format!("<{name}")) {
        *reader.get_mut() = &rest[end..];
        reading.passed += end as u64;
    }
}

/// Name of the element that was opened last and is still open at the end of a text that is not complete.
fn last_open(text: &str) -> String {
    let mut reader = Reader::from_str(text);
    let mut open = Vec::new();
    while let Ok(event) = reader.read_event() {
        match event {
            Event::Start(start) => open.push(start.local_name().as_ref().to_owned()),
            Event::End(_) => drop(open.pop()),
            Event::Eof => break,
            _ => {}
        }
    }
    open.last().map(|name| short(name)).unwrap_or_default()
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

/// The elements of a model; others are read over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Element {
    Model,
    Relation,
    Ref,
    Component,
    Attribute,
    Array,
    Matrix,
    Cell,
    LoadCase,
    Accumulation,
    Other,
}

impl Element {
    fn of(name: &str) -> Element {
        match name {
            "c" => Element::Cell,
            "attribute" => Element::Attribute,
            "component" => Element::Component,
            "ref" => Element::Ref,
            "relation" => Element::Relation,
            "array" => Element::Array,
            "matrix" | "array_of_arrays" => Element::Matrix,
            "load_case" => Element::LoadCase,
            "accumulation" => Element::Accumulation,
            "model" => Element::Model,
            _ => Element::Other,
        }
    }

    /// Whether it has attributes that are read.
    fn is_read(self) -> bool {
        !matches!(self, Element::Cell | Element::Accumulation | Element::Other)
    }
}

#[derive(Default)]
struct Reading {
    model: RawModel,
    has_root: bool,
    open: Vec<Element>,
    elements: usize,
    component: Option<Component>,
    relation: Option<RawRelation>,
    case: Option<RawCase>,
    attribute: Option<OpenAttribute>,
    /// Name of the array that was opened last, as it is written.
    array: String,
    /// Bytes that were passed over.
    passed: u64,
}

/// The attributes of an element.
#[derive(Default)]
struct Given {
    id: Option<String>,
    kind: Option<String>,
    name: Option<String>,
    role: Option<String>,
    order: Option<String>,
    unit: Option<String>,
    origin: Option<String>,
    code: Option<String>,
    version: Option<String>,
    application: Option<String>,
    application_version: Option<String>,
}

impl Given {
    fn of(start: &BytesStart) -> Result<Given, Refusal> {
        let mut given = Given::default();
        // Of an attribute that is given twice, the first one counts.
        for attribute in start.attributes().with_checks(false) {
            let attribute = attribute.map_err(|error| refused(&error))?;
            let place = match attribute.key.local_name().as_ref() {
                "id" => &mut given.id,
                "type" => &mut given.kind,
                "name" => &mut given.name,
                "role" => &mut given.role,
                "order" => &mut given.order,
                "unit" => &mut given.unit,
                "origin" => &mut given.origin,
                "code" => &mut given.code,
                "version" => &mut given.version,
                "applicationId" => &mut given.application,
                "applicationVersion" => &mut given.application_version,
                _ => continue,
            };
            if place.is_none() {
                let text = quick_xml::escape::unescape(&attribute.value).map_err(|_| entities(&attribute.value))?;
                *place = Some(text.into_owned());
            }
        }
        Ok(given)
    }

    /// The id of a component or relation.
    fn number(&self) -> Option<i64> {
        self.id.as_deref().and_then(|text| text.trim().parse().ok())
    }
}

impl Reading {
    fn start(&mut self, start: &BytesStart) -> Result<(), Refusal> {
        let name = start.local_name();
        let element = Element::of(name.as_ref());
        if self.open.is_empty() && (self.has_root || element != Element::Model) {
            let name = short(name.as_ref());
            let detail = format!("is XML, but its root element is <{name}>, not <model>: no REXS model");
            return Err(Refusal::unreadable("not-rexs", detail));
        }
        if self.open.len() > 32 {
            return Err(Refusal::unreadable("not-rexs", "is XML nested deeper than a REXS model is"));
        }
        if matches!(element, Element::Component | Element::Attribute | Element::Relation | Element::Ref) {
            self.elements += 1;
            if self.elements > MAX_ELEMENTS {
                let detail = format!("has more than {MAX_ELEMENTS} components, attributes and relations");
                return Err(Refusal::unreadable("too-large", detail));
            }
        }
        if !element.is_read() {
            if let Some(attribute) = self.attribute.as_mut().filter(|_| element == Element::Cell) {
                attribute.text.clear();
            }
            self.open.push(element);
            return Ok(());
        }
        let given = Given::of(start)?;
        match element {
            Element::Model if self.open.is_empty() => {
                self.has_root = true;
                self.model.version = given.version.unwrap_or_default();
                self.model.application = given.application.unwrap_or_default();
                self.model.application_version = given.application_version.unwrap_or_default();
            }
            Element::Relation => {
                let order = given.order.as_deref().and_then(|text| text.trim().parse().ok());
                let id = given.number();
                let kind = given.kind.unwrap_or_default();
                self.relation = Some(RawRelation { id, kind, order, refs: Vec::new() });
            }
            Element::Ref => {
                if let (Some(relation), Some(id)) = (&mut self.relation, given.number()) {
                    relation.refs.push((given.role.unwrap_or_default(), id));
                }
            }
            Element::Component => {
                let id = given.number();
                let kind = given.kind.unwrap_or_default();
                let Some(id) = id else {
                    let detail = format!("has a component ({}) whose id is not a whole number", short(&kind));
                    return Err(Refusal::unreadable("not-rexs", detail));
                };
                self.component = Some(Component { id, kind, name: given.name, attributes: Vec::new() });
            }
            Element::Attribute => {
                self.attribute = Some(OpenAttribute {
                    id: given.id.unwrap_or_default(),
                    unit: given.unit,
                    is_user_defined: given.origin.as_deref() == Some("user_defined"),
                    ..OpenAttribute::default()
                });
            }
            Element::Array | Element::Matrix => {
                start.name().0.clone_into(&mut self.array);
                if let Some(attribute) = &mut self.attribute {
                    attribute.array = Some(element == Element::Array && attribute.array.is_none());
                    attribute.code = given.code;
                    attribute.text.clear();
                }
            }
            Element::LoadCase => {
                self.case = Some(RawCase { id: given.number().unwrap_or(0), components: Vec::new() });
            }
            Element::Model | Element::Cell | Element::Accumulation | Element::Other => {}
        }
        self.open.push(element);
        Ok(())
    }

    fn text(&mut self, content: &str) {
        let Some(attribute) = &mut self.attribute else { return };
        if attribute.array != Some(false) && attribute.text.len() + content.len() <= MAX_TEXT {
            attribute.text.push_str(content);
        }
    }

    fn end(&mut self) {
        let Some(element) = self.open.pop() else { return };
        match element {
            Element::Cell => {
                if let Some(attribute) = self.attribute.as_mut().filter(|attribute| attribute.array != Some(false)) {
                    match attribute.text.trim().parse::<f64>() {
                        Ok(number) if attribute.numbers.len() < MAX_ARRAY => attribute.numbers.push(number),
                        _ => attribute.array = Some(false),
                    }
                    attribute.text.clear();
                }
            }
            Element::Attribute => {
                if let (Some(attribute), Some(component)) = (self.attribute.take(), &mut self.component) {
                    component.attributes.extend(attribute.close());
                }
            }
            Element::Component => {
                if let Some(component) = self.component.take() {
                    match (&mut self.case, self.open.contains(&Element::Accumulation)) {
                        (_, true) => {}
                        (Some(case), false) => case.components.push(component),
                        (None, false) => self.model.components.push(component),
                    }
                }
            }
            Element::Relation => self.model.relations.extend(self.relation.take()),
            Element::LoadCase => self.model.cases.extend(self.case.take()),
            _ => {}
        }
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
