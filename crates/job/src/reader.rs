//! Reading a JSON document field by field, so that every violation is found in one pass and the same declarations
//! yield the JSON Schema, the defaults and the limits that the service publishes.
//!
//! A field is declared once, on a struct (`#[derive(Input)]`, see [`super::field`]). Run over an empty document with
//! [`Reading::describe`], the same code lists all fields instead of reading them.

use super::field::{Declared, Words};
use super::hints::{self, Unknown};
use super::path::Path;
use super::violation::Violation;
use serde_json::{Map, Value, json};
use std::cell::RefCell;

/// Texts hold no control characters ([`char::is_control`]).
const NO_CONTROLS: &str = r"^[^\u0000-\u001f\u007f-\u009f]*$";

/// A declared field, as published in the schema and shown in the form.
#[derive(Debug, Clone)]
pub struct FieldDescription {
    pub pointer: String,
    pub schema: Value,
    pub required: bool,
    /// Words of a choice with the labels shown for them, if these differ from the words.
    pub labels: &'static [(&'static str, &'static str)],
    /// Section of the form.
    pub group: &'static str,
    /// Rank among the fields of a block, ascending; fields of equal rank keep the order of declaration.
    pub order: i32,
    /// Symbol of the quantity (letter and subscript), or empty.
    pub symbol: (&'static str, &'static str),
    /// Description of a default that depends on other fields.
    pub derived: Option<&'static str>,
    pub condition: Option<Condition>,
}

/// Condition for a field to be in use: another field has one of the listed values.
#[derive(Debug, Clone)]
pub struct Condition {
    /// Pointer of the other field.
    pub on: String,
    /// Its values, separated by spaces.
    pub values: &'static str,
}

/// Largest number of violations listed; further ones are only counted. A document of 1 MB can have 100 000.
pub(crate) const MAX_VIOLATIONS: usize = 1000;

#[derive(Default)]
struct Collected {
    violations: Vec<Violation>,
    further: usize,
    fields: Vec<FieldDescription>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purpose {
    Read,
    /// Lists the declared fields; nothing is missing or invalid.
    Describe,
    /// Fills in defaults; nothing is missing or invalid.
    Fill,
}

/// One pass over a document: the violations that were found, and (when describing) the fields that are declared.
pub(crate) struct Reading {
    collected: RefCell<Collected>,
    purpose: Purpose,
}

impl Reading {
    /// A pass that reads.
    pub(crate) fn read() -> Self {
        Self { collected: RefCell::default(), purpose: Purpose::Read }
    }

    /// A pass that lists the declared fields; nothing is missing or invalid in it.
    pub(crate) fn describe() -> Self {
        Self { collected: RefCell::default(), purpose: Purpose::Describe }
    }

    /// A pass over no document, for the defaults.
    pub(crate) fn fill() -> Self {
        Self { collected: RefCell::default(), purpose: Purpose::Fill }
    }

    fn is_describing(&self) -> bool {
        self.purpose == Purpose::Describe
    }

    /// The document's root object.
    pub(crate) fn root<'a>(&'a self, value: &'a Value) -> Object<'a> {
        let map = match value {
            Value::Object(map) => Some(map),
            other => {
                self.violate(wrong_type(String::new(), "an object", other));
                None
            }
        };
        Object {
            reading: self,
            document: value,
            map,
            present: map.is_some(),
            path: Path::ROOT,
            seen: RefCell::default(),
            inherited: Inherited::default(),
        }
    }

    pub(crate) fn violate(&self, violation: Violation) {
        if self.purpose != Purpose::Read {
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

    /// The violations found; beyond [`MAX_VIOLATIONS`] the last entry states the number of further ones.
    pub(crate) fn violations(self) -> Vec<Violation> {
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

    pub(crate) fn fields(self) -> Vec<FieldDescription> {
        self.collected.into_inner().fields
    }
}

/// Properties that the fields of an object inherit from the declaration of the object, unless they declare their own.
#[derive(Default, Clone)]
struct Inherited {
    group: &'static str,
    order: i32,
    derived: Option<&'static str>,
    /// Descriptions of the defaults of single fields of the object.
    derived_in: &'static [(&'static str, &'static str)],
    condition: Option<Condition>,
}

/// An object of the document (or its absence, in which case every field takes its default or is missing).
pub(crate) struct Object<'a> {
    reading: &'a Reading,
    /// The whole document.
    document: &'a Value,
    map: Option<&'a Map<String, Value>>,
    present: bool,
    path: Path<'a>,
    seen: RefCell<Vec<&'static str>>,
    inherited: Inherited,
}

impl<'a> Object<'a> {
    /// This object as the rules between its fields see it.
    pub(crate) fn place(&self) -> ObjectPlace<'_> {
        ObjectPlace { reading: self.reading, path: self.path, object: Some(self) }
    }

    fn pointer_to(&self, name: &str) -> String {
        self.path.member(name).to_string()
    }

    fn declare(&self, declared: &Declared, required: bool, schema: impl FnOnce() -> Value) {
        self.declare_words(declared, required, &[], schema);
    }

    fn declare_words(
        &self,
        declared: &Declared,
        required: bool,
        labels: &'static [(&'static str, &'static str)],
        schema: impl FnOnce() -> Value,
    ) {
        self.seen.borrow_mut().push(declared.name);
        if self.reading.is_describing() {
            let Inherited { group, order, derived, condition, .. } = self.inherited(declared);
            self.reading.collected.borrow_mut().fields.push(FieldDescription {
                pointer: self.pointer_to(declared.name),
                schema: schema(),
                required,
                labels,
                group,
                order,
                symbol: declared.form.symbol,
                derived,
                condition,
            });
        }
    }

    /// The properties of a field and of the fields in it: from its own declaration, else from this object.
    fn inherited(&self, declared: &Declared) -> Inherited {
        if !self.reading.is_describing() {
            return Inherited::default();
        }
        let (form, outer) = (&declared.form, &self.inherited);
        let here = outer.derived_in.iter().find(|(name, _)| *name == declared.name).map(|(_, words)| *words);
        let condition = form.when.map(|(sibling, values)| Condition { on: self.pointer_to(sibling), values });
        Inherited {
            group: if form.group.is_empty() { outer.group } else { form.group },
            order: if form.order == 0 { outer.order } else { form.order },
            derived: here.or(form.derived).or(outer.derived),
            derived_in: form.derived_in,
            condition: condition.or_else(|| outer.condition.clone()),
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

    fn wrong_type(&self, name: &str, expected: &str, value: &Value) {
        self.reading.violate(wrong_type(self.pointer_to(name), expected, value));
    }

    /// A nested object. Left out, it is an object with every field left out; `required` makes that a violation.
    pub(crate) fn object<'b>(&'b self, declared: &'static Declared) -> Object<'b> {
        let Declared { name, required, help, .. } = *declared;
        self.declare(declared, required, || json!({"type": "object", "description": help}));
        let value = self.value(name);
        let map = match value {
            Some(Value::Object(map)) => Some(map),
            Some(other) => {
                self.wrong_type(name, "an object", other);
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
            path: self.path.member(name),
            seen: RefCell::default(),
            inherited: self.inherited(declared),
        }
    }

    /// An optional nested object: `None` unless it is given (or the fields are described).
    pub(crate) fn optional_object<'b>(&'b self, declared: &'static Declared) -> Option<Object<'b>> {
        let given = self.has(declared.name);
        let object = self.object(declared);
        (given && object.map.is_some() || self.reading.is_describing()).then_some(object)
    }

    /// A number with its range; the default when left out, required without one.
    pub(crate) fn number(&self, declared: &Declared, default: Option<f64>) -> f64 {
        self.number_or(declared, default, default.is_none()).unwrap_or_else(|| {
            if default.is_none() {
                self.missing(declared.name, &range_text(declared));
            }
            default.unwrap_or(declared.min)
        })
    }

    /// A number that may be left out or null; the default is only published.
    pub(crate) fn optional_number(&self, declared: &Declared, default: Option<f64>) -> Option<f64> {
        self.number_or(declared, default, false)
    }

    fn number_or(&self, declared: &Declared, default: Option<f64>, required: bool) -> Option<f64> {
        self.declare(declared, required, || {
            let mut schema = json!({"type": "number", "minimum": declared.min, "maximum": declared.max,
                "description": declared.help, "x-unit": declared.unit.text});
            if let Some(default) = default {
                schema["default"] = json!(default);
            }
            schema
        });
        let value = self.value(declared.name)?;
        Some(
            self.in_range(&self.path.member(declared.name), value, declared).unwrap_or(default.unwrap_or(declared.min)),
        )
    }

    /// The number at `path`; `None`, and a violation, if the value is not a number or out of range.
    fn in_range(&self, path: &Path, value: &Value, declared: &Declared) -> Option<f64> {
        let violation = match value.as_f64() {
            Some(number) => match out_of_range(number, declared) {
                None => return Some(number),
                Some(violation) => violation,
            },
            None => {
                let expected = format!("a number, {}", range_text(declared));
                bounded(wrong_type(String::new(), &expected, value), declared)
            }
        };
        self.reading.violate(Violation { pointer: path.to_string(), ..violation });
        None
    }

    /// A whole number; the default when left out, required without one.
    pub(crate) fn integer(&self, declared: &Declared, default: Option<u32>) -> u32 {
        self.integer_or(declared, default, default.is_none()).unwrap_or_else(|| {
            if default.is_none() {
                self.missing(declared.name, &format!("a whole number, {} to {}", declared.min, declared.max));
            }
            default.unwrap_or(declared.min as u32)
        })
    }

    /// A whole number that may be left out or null; the default is only published.
    pub(crate) fn optional_integer(&self, declared: &Declared, default: Option<u32>) -> Option<u32> {
        self.integer_or(declared, default, false)
    }

    fn integer_or(&self, declared: &Declared, default: Option<u32>, required: bool) -> Option<u32> {
        self.declare(declared, required, || {
            let mut schema = json!({"type": "integer", "minimum": declared.min as u64, "maximum": declared.max as u64,
                "description": declared.help});
            if let Some(default) = default {
                schema["default"] = json!(default);
            }
            schema
        });
        let value = self.value(declared.name)?;
        let fallback = default.unwrap_or(declared.min as u32);
        if let (Value::Number(number), Some(float)) = (value, value.as_f64())
            && float.fract() != 0.0
        {
            let violation = not_whole(number, declared);
            self.reading.violate(Violation { pointer: self.pointer_to(declared.name), ..violation });
            return Some(fallback);
        }
        let number = self.in_range(&self.path.member(declared.name), value, declared);
        Some(number.map_or(fallback, |number| number as u32))
    }

    pub(crate) fn boolean(&self, declared: &Declared, default: bool) -> bool {
        let Declared { name, help, .. } = *declared;
        self.declare(declared, false, || json!({"type": "boolean", "default": default, "description": help}));
        match self.value(name) {
            None => default,
            Some(Value::Bool(value)) => *value,
            Some(other) => {
                self.wrong_type(name, "true or false", other);
                default
            }
        }
    }

    /// One of a closed list of words; `None` when left out.
    pub(crate) fn choice<W: Words>(&self, declared: &Declared, default: Option<W>, required: bool) -> Option<W> {
        let Declared { name, help, .. } = *declared;
        self.declare_words(declared, required, W::LABELS, || {
            let mut schema = json!({"type": "string", "enum": W::words()});
            if let Some(default) = default {
                schema["default"] = json!(default.as_word());
            }
            schema["description"] = json!(help);
            schema
        });
        let permitted = || W::words().join(", ");
        match self.value(name) {
            None => {
                if required {
                    self.missing(name, &format!("one of the words {}", permitted()));
                }
                None
            }
            Some(Value::String(word)) => {
                let known = W::of_word(word);
                if known.is_none() {
                    let detail = format!("is \"{}\"; permitted: {}", clip(word), permitted());
                    self.reading.violate(Violation::new(self.pointer_to(name), "not-one-of", detail));
                }
                known
            }
            Some(other) => {
                self.wrong_type(name, &format!("one of the words {}", permitted()), other);
                None
            }
        }
    }

    /// A list of words of a closed list, each once; empty when left out.
    pub(crate) fn choices<W: Words>(&self, declared: &Declared) -> Vec<W> {
        let most = W::WORDS.len();
        self.declare_words(declared, false, W::LABELS, || {
            json!({"type": "array", "maxItems": most, "items": {"type": "string", "enum": W::words()}, "description": declared.help})
        });
        let mut choices = Vec::new();
        for (index, word) in self.strings(declared.name, most).into_iter().flatten() {
            match W::of_word(word) {
                Some(choice) if !choices.contains(&choice) => choices.push(choice),
                Some(_) => {}
                None => {
                    let detail = format!("is \"{}\"; permitted: {}", clip(word), W::words().join(", "));
                    let pointer = self.path.item(declared.name, Some(index)).to_string();
                    self.reading.violate(Violation::new(pointer, "not-one-of", detail));
                }
            }
        }
        choices
    }

    /// A text of at most `max_chars` characters without control characters; `None` when left out.
    pub(crate) fn text(&self, declared: &Declared) -> Option<String> {
        self.text_or(declared, false)
    }

    /// A required text.
    pub(crate) fn required_text(&self, declared: &Declared) -> String {
        self.text_or(declared, true).unwrap_or_else(|| {
            if !self.has(declared.name) {
                self.missing(declared.name, "a string");
            }
            String::new()
        })
    }

    fn text_or(&self, declared: &Declared, required: bool) -> Option<String> {
        let Declared { name, max_chars, help, .. } = *declared;
        self.declare(
            declared,
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
                self.wrong_type(name, "a string", other);
                None
            }
        }
    }

    /// A list of numbers, each within the declared range; `None` when left out.
    pub(crate) fn numbers(&self, declared: &Declared) -> Option<Vec<f64>> {
        let Declared { name, min_items, max_items, .. } = *declared;
        self.declare(declared, false, || {
            json!({"type": "array", "minItems": min_items, "maxItems": max_items, "description": declared.help,
                "items": {"type": "number", "minimum": declared.min, "maximum": declared.max, "x-unit": declared.unit.text}})
        });
        let values = self.array(name, min_items, max_items)?.iter().enumerate();
        let number =
            |(index, value)| self.in_range(&self.path.item(name, Some(index)), value, declared).unwrap_or(declared.min);
        Some(values.map(number).collect())
    }

    /// A list of texts; `None` when left out.
    pub(crate) fn texts(&self, declared: &Declared) -> Option<Vec<String>> {
        let Declared { name, max_items, .. } = *declared;
        self.declare(declared, false, || {
            json!({"type": "array", "maxItems": max_items, "items": {"type": "string"}, "description": declared.help})
        });
        let strings = self.strings(name, max_items)?;
        Some(strings.into_iter().map(|(_, text)| text.to_owned()).collect())
    }

    /// The texts of a list with their paths.
    fn strings(&self, name: &str, max_items: usize) -> Option<Vec<(usize, &'a str)>> {
        let values = self.array(name, 0, max_items)?;
        let mut strings = Vec::with_capacity(values.len());
        for (index, value) in values.iter().enumerate() {
            match value {
                Value::String(text) => strings.push((index, text.as_str())),
                other => {
                    let pointer = self.path.item(name, Some(index)).to_string();
                    self.reading.violate(wrong_type(pointer, "a string", other));
                }
            }
        }
        Some(strings)
    }

    /// A list of objects; `None` when left out. When the fields are described: one object that represents all items.
    pub(crate) fn objects<'b>(&'b self, declared: &'static Declared) -> Option<Vec<Object<'b>>> {
        let Declared { name, min_items, max_items, help, required, .. } = *declared;
        self.declare(declared, required, || {
            json!({"type": "array", "minItems": min_items, "maxItems": max_items, "items": {"type": "object"},
                "description": help})
        });
        let object = |index: Option<usize>, map: Option<&'a Map<String, Value>>| Object {
            reading: self.reading,
            document: self.document,
            map,
            present: true,
            path: self.path.item(name, index),
            seen: RefCell::default(),
            inherited: self.inherited(declared),
        };
        if self.reading.is_describing() {
            return Some(vec![object(None, None)]);
        }
        if required && !self.has(name) {
            self.missing(name, &format!("a list of {min_items} to {max_items} objects"));
        }
        let values = self.array(name, min_items, max_items)?;
        let mut objects = Vec::with_capacity(values.len());
        for (index, value) in values.iter().enumerate() {
            match value {
                Value::Object(map) => objects.push(object(Some(index), Some(map))),
                other => {
                    let pointer = self.path.item(name, Some(index)).to_string();
                    self.reading.violate(wrong_type(pointer, "an object", other));
                }
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
                self.wrong_type(name, "an array", other);
                None
            }
        }
    }

    /// Whether the document gives this field (and not null).
    fn has(&self, name: &str) -> bool {
        self.value(name).is_some()
    }

    /// Reports every field of the object that was not declared. Call last.
    pub(crate) fn finish(self) {
        let Some(map) = self.map else { return };
        let seen = self.seen.borrow();
        for (name, value) in map {
            if !seen.contains(&name.as_str()) {
                let hint = if self.reading.is_full() { None } else { self.hint(name, value, &seen) };
                let hint = hint.map(|hint| format!("; {hint}")).unwrap_or_default();
                self.reading.violate(Violation::new(
                    format!("{}/{}", self.path, escape(name)),
                    "unknown-field",
                    format!("is not a field of this object{hint}"),
                ));
            }
        }
    }

    /// Hint for an unknown name: the quantity it denotes, else the field with a similar spelling.
    fn hint(&self, name: &str, value: &Value, known: &[&'static str]) -> Option<String> {
        let object = self.path.to_string();
        let unknown = Unknown { document: self.document, object: &object, name, value, known };
        hints::hint(&unknown).or_else(|| nearest(name, known).map(|known| format!("did you mean \"{known}\"?")))
    }
}

/// Object at which the rules between its fields are checked: states which fields are given, and collects violations.
pub(crate) struct ObjectPlace<'a> {
    reading: &'a Reading,
    path: Path<'a>,
    /// `None` for an object that was read before: all of its fields then count as given.
    object: Option<&'a Object<'a>>,
}

impl<'a> ObjectPlace<'a> {
    /// The root of a document that is not read.
    pub(crate) fn root(reading: &'a Reading) -> Self {
        Self { reading, path: Path::ROOT, object: None }
    }

    /// The nested object `name`.
    pub(crate) fn member<'b>(&'b self, name: &'b str) -> ObjectPlace<'b> {
        ObjectPlace { reading: self.reading, path: self.path.member(name), object: None }
    }

    /// An item of the list `name`.
    pub(crate) fn item<'b>(&'b self, name: &'b str, index: usize) -> ObjectPlace<'b> {
        ObjectPlace { reading: self.reading, path: self.path.item(name, Some(index)), object: None }
    }

    /// Whether the document gives this field (and not null), validly or not.
    pub(crate) fn gives(&self, name: &str) -> bool {
        self.object.is_none_or(|object| object.has(name))
    }

    /// Whether the object is being read from a document, not checked once more.
    pub(crate) fn is_reading_object(&self) -> bool {
        self.object.is_some()
    }

    /// Whether a document is read, so that rules can be violated.
    pub(crate) fn is_read(&self) -> bool {
        self.reading.purpose == Purpose::Read
    }

    /// Whether the field `name`, or a field in it, has a violation already: rules that need its value have nothing to
    /// say.
    pub(crate) fn is_refused(&self, name: &str) -> bool {
        let pointer = self.path.member(name).to_string();
        let is_in =
            |other: &str| other.strip_prefix(&pointer).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'));
        self.reading.collected.borrow().violations.iter().any(|violation| is_in(&violation.pointer))
    }

    /// Reports that the field `name` contradicts other fields.
    pub(crate) fn conflict(&self, name: &str, detail: impl Into<String>) {
        self.violate(name, "conflict", detail);
    }

    /// Reports that the number `name` contradicts other fields, with the range in its declared unit that they permit.
    pub(crate) fn outside(&self, name: &str, unit: &str, [minimum, maximum]: [f64; 2], detail: impl Into<String>) {
        if self.is_read() {
            let violation = Violation::new(self.path.member(name).to_string(), "conflict", detail);
            let (minimum, maximum) = (finite(minimum), finite(maximum));
            self.reading.violate(Violation { minimum, maximum, unit: Some(unit.to_owned()), ..violation });
        }
    }

    /// Reports that the field `name` is required by other fields.
    pub(crate) fn missing(&self, name: &str, detail: impl Into<String>) {
        self.violate(name, "missing", detail);
    }

    fn violate(&self, name: &str, code: &str, detail: impl Into<String>) {
        if self.is_read() {
            self.reading.violate(Violation::new(self.path.member(name).to_string(), code, detail));
        }
    }
}

fn finite(number: f64) -> Option<f64> {
    number.is_finite().then_some(number)
}

/// The violation of a number that is out of its range, without its pointer.
pub(crate) fn out_of_range(number: f64, declared: &Declared) -> Option<Violation> {
    if number.is_finite() && (declared.min..=declared.max).contains(&number) {
        return None;
    }
    let detail = format!("is {}; permitted: {}", shown(number), range_text(declared));
    Some(bounded(Violation::new("", "out-of-range", detail), declared))
}

/// The violation of a number that is not whole where it has to be, without its pointer.
pub(crate) fn not_whole(number: &serde_json::Number, declared: &Declared) -> Violation {
    let detail = format!("is {number}; a whole number is needed, {}", range_text(declared));
    bounded(Violation::new("", "wrong-type", detail), declared)
}

fn bounded(violation: Violation, declared: &Declared) -> Violation {
    let (minimum, maximum) = (Some(declared.min), Some(declared.max));
    Violation { minimum, maximum, unit: Some(declared.unit.text.to_owned()), ..violation }
}

fn range_text(declared: &Declared) -> String {
    format!("{} to {}", shown(declared.min), declared.unit.after(shown(declared.max)))
}

/// A number as text for messages: very large and very small ones with a power of ten.
fn shown(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && !(1e-4..1e7).contains(&size) { format!("{number:e}") } else { format!("{number}") }
}

fn wrong_type(pointer: String, expected: &str, value: &Value) -> Violation {
    let given = match value {
        Value::Null => "null",
        Value::Bool(_) => "a boolean",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    };
    Violation::new(pointer, "wrong-type", format!("is {given}; needed: {expected}"))
}

/// Escapes a member name for a JSON pointer (RFC 6901) and bounds its length.
fn escape(name: &str) -> String {
    clip(name).replace('~', "~0").replace('/', "~1")
}

fn clip(text: &str) -> String {
    if text.chars().count() <= 60 { text.to_owned() } else { text.chars().take(60).chain(['…']).collect() }
}

/// The declared name with the smallest edit distance from an unknown one, if the distance is small.
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
