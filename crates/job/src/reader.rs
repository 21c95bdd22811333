//! Reading a JSON document field by field, so that every violation is found in one pass and the same declarations
//! yield the JSON Schema, the defaults and the limits that the service publishes.
//!
//! A field is declared once, where it is read. Run over an empty document with [`Reading::describe`], the same code
//! lists all fields instead of reading them.

use super::hints::{self, Unknown};
use super::violation::Violation;
use serde_json::{Map, Value, json};
use std::cell::RefCell;

/// What [`char::is_control`] finds is not in a text.
const NO_CONTROLS: &str = r"^[^\u0000-\u001f\u007f-\u009f]*$";

/// Declaration of a number: permitted range, unit, default, and a line of help. No default: required.
#[derive(Debug, Clone, Copy)]
pub struct Number {
    pub min: f64,
    pub max: f64,
    pub unit: &'static str,
    pub default: Option<f64>,
    pub help: &'static str,
}

/// A declared field, as published in the schema.
#[derive(Debug, Clone)]
pub struct FieldDescription {
    pub pointer: String,
    pub schema: Value,
    pub required: bool,
}

/// Violations listed at most; further ones are counted. A megabyte can hold a hundred thousand.
pub const MAX_VIOLATIONS: usize = 1000;

#[derive(Default)]
struct Collected {
    violations: Vec<Violation>,
    further: usize,
    fields: Vec<FieldDescription>,
}

/// One pass over a document: what was found wrong, and (when describing) what was declared.
pub struct Reading {
    collected: RefCell<Collected>,
    describing: bool,
}

impl Reading {
    /// A pass that reads.
    pub fn read() -> Self {
        Self { collected: RefCell::default(), describing: false }
    }

    /// A pass that lists the declared fields; nothing is missing or invalid in it.
    pub fn describe() -> Self {
        Self { collected: RefCell::default(), describing: true }
    }

    pub fn is_describing(&self) -> bool {
        self.describing
    }

    /// The document's root object.
    pub fn root<'a>(&'a self, value: &'a Value) -> Object<'a> {
        let map = match value {
            Value::Object(map) => Some(map),
            other => {
                self.violate(wrong_type("", "an object", other));
                None
            }
        };
        Object {
            reading: self,
            document: value,
            map,
            present: map.is_some(),
            pointer: String::new(),
            seen: RefCell::default(),
        }
    }

    pub fn violate(&self, violation: Violation) {
        if self.describing {
            return;
        }
        let mut collected = self.collected.borrow_mut();
        match collected.violations.len() < MAX_VIOLATIONS {
            true => collected.violations.push(violation),
            false => collected.further += 1,
        }
    }

    /// Whether further violations are only counted.
    fn is_full(&self) -> bool {
        self.collected.borrow().violations.len() >= MAX_VIOLATIONS
    }

    /// What was found wrong; the last entry says how many more there are than [`MAX_VIOLATIONS`].
    pub fn violations(self) -> Vec<Violation> {
        let Collected { mut violations, further, .. } = self.collected.into_inner();
        if further > 0 {
            violations.push(Violation::new(
                "",
                "further",
                format!("has {further} further violations, not listed here"),
            ));
        }
        violations
    }

    pub fn fields(self) -> Vec<FieldDescription> {
        self.collected.into_inner().fields
    }
}

/// An object of the document (or its absence, in which case every field takes its default or is missing).
pub struct Object<'a> {
    reading: &'a Reading,
    /// The whole document.
    document: &'a Value,
    map: Option<&'a Map<String, Value>>,
    present: bool,
    pointer: String,
    seen: RefCell<Vec<&'static str>>,
}

impl<'a> Object<'a> {
    pub fn reading(&self) -> &'a Reading {
        self.reading
    }

    pub fn pointer_to(&self, name: &str) -> String {
        format!("{}/{}", self.pointer, name)
    }

    fn declare(&self, name: &'static str, required: bool, schema: impl FnOnce() -> Value) {
        self.seen.borrow_mut().push(name);
        if self.reading.describing {
            let mut collected = self.reading.collected.borrow_mut();
            collected.fields.push(FieldDescription { pointer: self.pointer_to(name), schema: schema(), required });
        }
    }

    /// The field's value; `null` counts as left out.
    fn value(&self, name: &str) -> Option<&'a Value> {
        self.map.and_then(|map| map.get(name)).filter(|value| !value.is_null())
    }

    fn missing(&self, name: &str, expected: &str) {
        // A missing object is reported once, at the object, not again for each of its fields.
        if self.present {
            self.reading.violate(Violation::new(self.pointer_to(name), "missing", format!("is required: {expected}")));
        }
    }

    /// A nested object. Left out, it is an object with every field left out; `required` makes that a violation.
    pub fn object(&self, name: &'static str, required: bool, help: &'static str) -> Object<'a> {
        self.declare(name, required, || json!({"type": "object", "description": help}));
        let value = self.value(name);
        let map = match value {
            Some(Value::Object(map)) => Some(map),
            Some(other) => {
                self.reading.violate(wrong_type(&self.pointer_to(name), "an object", other));
                None
            }
            None => {
                if required {
                    self.missing(name, "an object");
                }
                None
            }
        };
        // Left out but optional: required fields inside it are still missing.
        let present = map.is_some() || (value.is_none() && !required && self.present);
        Object {
            reading: self.reading,
            document: self.document,
            map,
            present,
            pointer: self.pointer_to(name),
            seen: RefCell::default(),
        }
    }

    /// A nested object that stays absent when left out: `None` unless given (or describing).
    pub fn optional_object(&self, name: &'static str, help: &'static str) -> Option<Object<'a>> {
        let given = self.value(name).is_some();
        let object = self.object(name, false, help);
        (given && object.map.is_some() || self.reading.describing).then_some(object)
    }

    /// A number with its range; the default when left out.
    pub fn number(&self, name: &'static str, declaration: Number) -> f64 {
        self.optional_or(name, declaration, declaration.default.is_none()).unwrap_or_else(|| {
            if declaration.default.is_none() {
                self.missing(name, &range_text(&declaration));
            }
            declaration.default.unwrap_or(declaration.min)
        })
    }

    /// A number that may be left out or null, meaning "derive it".
    pub fn optional_number(&self, name: &'static str, declaration: Number) -> Option<f64> {
        self.optional_or(name, declaration, false)
    }

    fn optional_or(&self, name: &'static str, declaration: Number, required: bool) -> Option<f64> {
        self.declare(name, required, || {
            let mut schema = json!({"type": "number", "minimum": declaration.min, "maximum": declaration.max,
                "description": declaration.help, "x-unit": declaration.unit});
            if let Some(default) = declaration.default {
                schema["default"] = json!(default);
            }
            schema
        });
        let value = self.value(name)?;
        Some(self.check_number(&self.pointer_to(name), value, &declaration))
    }

    fn check_number(&self, pointer: &str, value: &Value, declaration: &Number) -> f64 {
        let fallback = declaration.default.unwrap_or(declaration.min);
        let Some(number) = value.as_f64() else {
            let mut violation = wrong_type(pointer, &format!("a number, {}", range_text(declaration)), value);
            bound(&mut violation, declaration);
            self.reading.violate(violation);
            return fallback;
        };
        if number.is_finite() && (declaration.min..=declaration.max).contains(&number) {
            return number;
        }
        let mut violation = Violation::new(
            pointer,
            "out-of-range",
            format!("is {}; permitted: {}", shown(number), range_text(declaration)),
        );
        bound(&mut violation, declaration);
        self.reading.violate(violation);
        fallback
    }

    /// A whole number within `min..=max`.
    pub fn integer(&self, name: &'static str, min: u64, max: u64, default: Option<u64>, help: &'static str) -> u64 {
        self.integer_or(name, min, max, default, default.is_none(), help).unwrap_or_else(|| {
            if default.is_none() {
                self.missing(name, &format!("a whole number, {min} to {max}"));
            }
            default.unwrap_or(min)
        })
    }

    /// A whole number that may be left out or null, meaning "derive it".
    pub fn optional_integer(&self, name: &'static str, min: u64, max: u64, help: &'static str) -> Option<u64> {
        self.integer_or(name, min, max, None, false, help)
    }

    fn integer_or(
        &self,
        name: &'static str,
        min: u64,
        max: u64,
        default: Option<u64>,
        required: bool,
        help: &'static str,
    ) -> Option<u64> {
        let declaration =
            Number { min: min as f64, max: max as f64, unit: "1", default: default.map(|value| value as f64), help };
        self.declare(name, required, || {
            let mut schema = json!({"type": "integer", "minimum": min, "maximum": max, "description": help});
            if let Some(default) = default {
                schema["default"] = json!(default);
            }
            schema
        });
        let fallback = default.unwrap_or(min);
        let value = self.value(name)?;
        let whole = value.as_f64().filter(|number| number.fract() == 0.0);
        Some(match (value, whole) {
            (Value::Number(_), None) => {
                let mut violation = Violation::new(
                    self.pointer_to(name),
                    "wrong-type",
                    format!("is {value}; a whole number is needed, {}", range_text(&declaration)),
                );
                bound(&mut violation, &declaration);
                self.reading.violate(violation);
                fallback
            }
            _ => self.check_number(&self.pointer_to(name), value, &declaration) as u64,
        })
    }

    pub fn boolean(&self, name: &'static str, default: bool, help: &'static str) -> bool {
        self.declare(name, false, || json!({"type": "boolean", "default": default, "description": help}));
        match self.value(name) {
            None => default,
            Some(Value::Bool(value)) => *value,
            Some(other) => {
                self.reading.violate(wrong_type(&self.pointer_to(name), "true or false", other));
                default
            }
        }
    }

    /// One of a closed list of words.
    pub fn choice<T: Copy>(
        &self,
        name: &'static str,
        choices: &[(&'static str, T)],
        default: T,
        default_word: &'static str,
        help: &'static str,
    ) -> T {
        let words = || choices.iter().map(|(word, _)| *word).collect::<Vec<_>>();
        self.declare(
            name,
            false,
            || json!({"type": "string", "enum": words(), "default": default_word, "description": help}),
        );
        match self.value(name) {
            None => default,
            Some(Value::String(word)) => match choices.iter().find(|(known, _)| known == word) {
                Some((_, value)) => *value,
                None => {
                    self.reading.violate(Violation::new(
                        self.pointer_to(name),
                        "not-one-of",
                        format!("is \"{}\"; permitted: {}", clip(word), words().join(", ")),
                    ));
                    default
                }
            },
            Some(other) => {
                let expected = format!("one of the words {}", words().join(", "));
                self.reading.violate(wrong_type(&self.pointer_to(name), &expected, other));
                default
            }
        }
    }

    /// A text of at most `max_chars` characters without control characters; `None` when left out.
    pub fn text(&self, name: &'static str, max_chars: usize, help: &'static str) -> Option<String> {
        self.text_or(name, max_chars, false, help)
    }

    /// A text that has to be given.
    pub fn required_text(&self, name: &'static str, max_chars: usize, help: &'static str) -> String {
        self.text_or(name, max_chars, true, help).unwrap_or_else(|| {
            if !self.has(name) {
                self.missing(name, "a string");
            }
            String::new()
        })
    }

    fn text_or(&self, name: &'static str, max_chars: usize, required: bool, help: &'static str) -> Option<String> {
        self.declare(
            name,
            required,
            || json!({"type": "string", "maxLength": max_chars, "pattern": NO_CONTROLS, "description": help}),
        );
        match self.value(name)? {
            Value::String(text) if text.chars().count() > max_chars => {
                let length = text.chars().count();
                let mut violation = Violation::new(
                    self.pointer_to(name),
                    "too-long",
                    format!("has {length} characters; permitted: at most {max_chars}"),
                );
                violation.maximum = Some(max_chars as f64);
                self.reading.violate(violation);
                None
            }
            Value::String(text) if text.chars().any(char::is_control) => {
                self.reading.violate(Violation::new(
                    self.pointer_to(name),
                    "out-of-range",
                    "has control characters; permitted: printable characters",
                ));
                None
            }
            Value::String(text) => Some(text.clone()),
            other => {
                self.reading.violate(wrong_type(&self.pointer_to(name), "a string", other));
                None
            }
        }
    }

    /// A list of numbers, each within the declared range; `None` when left out.
    pub fn numbers(&self, name: &'static str, min_items: usize, max_items: usize, item: Number) -> Option<Vec<f64>> {
        self.declare(name, false, || {
            json!({"type": "array", "minItems": min_items, "maxItems": max_items, "description": item.help,
                "items": {"type": "number", "minimum": item.min, "maximum": item.max, "x-unit": item.unit}})
        });
        let values = self.array(name, min_items, max_items)?;
        let pointer = self.pointer_to(name);
        Some(
            values
                .iter()
                .enumerate()
                .map(|(index, value)| self.check_number(&format!("{pointer}/{index}"), value, &item))
                .collect(),
        )
    }

    /// A list of words; `None` when left out. The declaration names the permitted words where the caller knows them; whether
    /// each word is one of them is the caller's to check.
    pub fn texts(
        &self,
        name: &'static str,
        max_items: usize,
        permitted: Option<&[&str]>,
        help: &'static str,
    ) -> Option<Vec<String>> {
        self.declare(name, false, || {
            let mut items = json!({"type": "string"});
            if let Some(words) = permitted {
                items["enum"] = json!(words);
            }
            json!({"type": "array", "maxItems": max_items, "items": items, "description": help})
        });
        let values = self.array(name, 0, max_items)?;
        let pointer = self.pointer_to(name);
        let mut texts = Vec::with_capacity(values.len());
        for (index, value) in values.iter().enumerate() {
            match value {
                Value::String(text) => texts.push(text.clone()),
                other => self.reading.violate(wrong_type(&format!("{pointer}/{index}"), "a string", other)),
            }
        }
        Some(texts)
    }

    /// A list of objects; `None` when left out. When describing: one object that stands for all.
    pub fn objects(
        &self,
        name: &'static str,
        min_items: usize,
        max_items: usize,
        help: &'static str,
    ) -> Option<Vec<Object<'a>>> {
        self.declare(name, false, || {
            json!({"type": "array", "minItems": min_items, "maxItems": max_items, "items": {"type": "object"},
                "description": help})
        });
        let pointer = self.pointer_to(name);
        if self.reading.describing {
            let item = Object {
                reading: self.reading,
                document: self.document,
                map: None,
                present: true,
                pointer: format!("{pointer}/*"),
                seen: RefCell::default(),
            };
            return Some(vec![item]);
        }
        let values = self.array(name, min_items, max_items)?;
        let mut objects = Vec::with_capacity(values.len());
        for (index, value) in values.iter().enumerate() {
            let pointer = format!("{pointer}/{index}");
            match value {
                Value::Object(map) => objects.push(Object {
                    reading: self.reading,
                    document: self.document,
                    map: Some(map),
                    present: true,
                    pointer,
                    seen: RefCell::default(),
                }),
                other => self.reading.violate(wrong_type(&pointer, "an object", other)),
            }
        }
        Some(objects)
    }

    fn array(&self, name: &str, min_items: usize, max_items: usize) -> Option<&'a Vec<Value>> {
        match self.value(name)? {
            Value::Array(values) if (min_items..=max_items).contains(&values.len()) => Some(values),
            Value::Array(values) => {
                let mut violation = Violation::new(
                    self.pointer_to(name),
                    "out-of-range",
                    format!("has {} items; permitted: {min_items} to {max_items}", values.len()),
                );
                violation.minimum = Some(min_items as f64);
                violation.maximum = Some(max_items as f64);
                self.reading.violate(violation);
                None
            }
            other => {
                self.reading.violate(wrong_type(&self.pointer_to(name), "an array", other));
                None
            }
        }
    }

    /// Whether the document gives this field (and not null).
    pub fn has(&self, name: &str) -> bool {
        self.value(name).is_some()
    }

    /// Reports every field of the object that was not declared. Call last.
    pub fn finish(self) {
        let Some(map) = self.map else { return };
        let seen = self.seen.borrow();
        for (name, value) in map {
            if !seen.contains(&name.as_str()) {
                let hint = if self.reading.is_full() { None } else { self.hint(name, value, &seen) };
                let hint = hint.map(|hint| format!("; {hint}")).unwrap_or_default();
                self.reading.violate(Violation::new(
                    format!("{}/{}", self.pointer, escape(name)),
                    "unknown-field",
                    format!("is not a field of this object{hint}"),
                ));
            }
        }
    }

    /// What is meant by an unknown name: what it stands for, else the field that is spelt alike.
    fn hint(&self, name: &str, value: &Value, known: &[&'static str]) -> Option<String> {
        let unknown = Unknown { document: self.document, object: &self.pointer, name, value, known };
        hints::hint(&unknown).or_else(|| nearest(name, known).map(|known| format!("did you mean \"{known}\"?")))
    }
}

fn bound(violation: &mut Violation, declaration: &Number) {
    violation.minimum = Some(declaration.min);
    violation.maximum = Some(declaration.max);
    violation.unit = Some(declaration.unit.to_owned());
}

fn range_text(declaration: &Number) -> String {
    let unit = if declaration.unit == "1" { String::new() } else { format!(" {}", declaration.unit) };
    format!("{} to {}{unit}", shown(declaration.min), shown(declaration.max))
}

/// A number as a person writes it: very large and very small ones with a power of ten.
fn shown(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-4..1e7).contains(&size) { format!("{number:e}") } else { format!("{number}") }
}

fn wrong_type(pointer: &str, expected: &str, found: &Value) -> Violation {
    let found = match found {
        Value::Null => "null",
        Value::Bool(_) => "a boolean",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    };
    Violation::new(pointer, "wrong-type", format!("is {found}; needed: {expected}"))
}

/// Escapes a member name for a JSON pointer (RFC 6901) and bounds its length.
fn escape(name: &str) -> String {
    clip(name).replace('~', "~0").replace('/', "~1")
}

fn clip(text: &str) -> String {
    if text.chars().count() <= 60 { text.to_owned() } else { text.chars().take(60).chain(['…']).collect() }
}

/// The declared name that differs least from an unknown one, if it differs little.
fn nearest<'n>(name: &str, known: &[&'n str]) -> Option<&'n str> {
    if name.len() > 60 {
        return None;
    }
    known
        .iter()
        .map(|candidate| (strsim::levenshtein(name, candidate), *candidate))
        .filter(|(distance, candidate)| *distance <= 2.max(candidate.len() / 3))
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}
