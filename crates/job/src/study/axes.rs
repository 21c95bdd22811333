//! The inputs of a sweep: what may vary, and the documents it varies.

use crate::document::{Axis, JobDocument};
use crate::{DocumentError, Violation, parse_value};
use serde_json::Value;

/// Refuses axes that point at nothing, at something that is not a number, or at values out of range.
///
/// # Errors
/// [`DocumentError::Invalid`] with pointers into `/axes`.
pub fn check_axes(document: &JobDocument) -> Result<(), DocumentError> {
    let base = base(document);
    let mut violations = Vec::new();
    let mut taken: Vec<(&str, usize)> = Vec::new();
    for (index, axis) in document.axes.iter().enumerate() {
        let before = violations.len();
        for (place, pointer) in axis.pointers().enumerate() {
            let here = match place {
                0 => format!("/axes/{index}/pointer"),
                _ => format!("/axes/{index}/also/{}", place - 1),
            };
            if let Some((_, other)) = taken.iter().find(|(known, _)| *known == pointer) {
                let whose = if *other == index { "this axis varies already" } else { "the first axis varies already" };
                violations.push(Violation::new(here, "conflict", format!("is the same input that {whose}")));
                continue;
            }
            taken.push((pointer, index));
            if let Some(why) = unfit(&base, pointer) {
                violations.push(Violation::new(here, "conflict", format!("\"{pointer}\" {why}")));
            }
        }
        if violations.len() > before {
            continue;
        }
        // Ranges are intervals, so the extremes stand for all values; of whole numbers every value has to be one.
        let whole = axis.pointers().any(is_whole_number_field);
        let values = || (0..axis.len()).map(|position| axis.value(position));
        let least = values().fold(f64::INFINITY, f64::min);
        let greatest = values().fold(f64::NEG_INFINITY, f64::max);
        let fractional = values().find(|number| whole && number.fract() != 0.0);
        for number in [Some(least), Some(greatest), fractional].into_iter().flatten() {
            let mut value = base.clone();
            axis.pointers().for_each(|pointer| set(&mut value, pointer, number));
            if let Err(DocumentError::Invalid(found)) = parse_value(&value) {
                violations.extend(found.into_iter().map(|violation| Violation {
                    detail: format!("at {} = {number}: {}", place(axis, &violation.pointer), violation.detail),
                    pointer: format!("/axes/{index}"),
                    ..violation
                }));
                break;
            }
        }
    }
    if violations.is_empty() { Ok(()) } else { Err(DocumentError::Invalid(violations)) }
}

/// Why nothing at `pointer` can vary.
fn unfit(base: &Value, pointer: &str) -> Option<&'static str> {
    match base.pointer(pointer) {
        Some(Value::Number(_)) => None,
        Some(Value::Null) if is_number_field(pointer) => None,
        Some(_) => Some("is not a number; a sweep varies one number"),
        None => Some("is not a field of the document"),
    }
}

/// Which of the inputs of an axis a violation at `pointer` is about: the first, where none of them.
fn place<'a>(axis: &'a Axis, pointer: &str) -> &'a str {
    axis.pointers().find(|own| *own == pointer).unwrap_or(&axis.pointer)
}

fn is_number_field(pointer: &str) -> bool {
    field_type(pointer).is_some_and(|word| word == "number" || word == "integer")
}

fn is_whole_number_field(pointer: &str) -> bool {
    field_type(pointer).is_some_and(|word| word == "integer")
}

fn field_type(pointer: &str) -> Option<String> {
    let fields = crate::schema::field_descriptions();
    let field = fields.into_iter().find(|field| field.pointer == pointer)?;
    field.schema["type"].as_str().map(str::to_owned)
}

/// The document of one point, before the swept values are put in.
pub fn base(document: &JobDocument) -> Value {
    // A document holds finite numbers and strings only, so writing it cannot fail.
    let mut value = serde_json::to_value(document.without_sweep()).unwrap_or_default();
    // Series are not kept for the points of a sweep.
    value["analysis"]["channels"] = Value::Array(Vec::new());
    value
}

/// Puts one swept value in.
pub fn set(value: &mut Value, pointer: &str, number: f64) {
    if let Some(slot) = value.pointer_mut(pointer) {
        *slot = serde_json::json!(number);
    }
}
