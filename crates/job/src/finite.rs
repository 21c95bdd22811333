//! Numbers that are not finite. JSON cannot represent them: they are serialized as null, and `numerics.not_finite` of
//! the result lists their pointers and reasons.

use super::result::{JobResult, NotFinite};
use ciborium::Value;
use serde::Serialize;

/// JSON pointer and value (NaN, infinity) of every number of `value` that is not finite and so null in JSON.
pub fn not_finite(value: &impl Serialize) -> Vec<NotFinite> {
    let mut found = Vec::new();
    // Results are always serializable; a value that is not contains no numbers.
    if let Ok(value) = Value::serialized(value) {
        walk(&value, &mut String::new(), &mut found);
    }
    found
}

fn walk(value: &Value, pointer: &mut String, found: &mut Vec<NotFinite>) {
    let length = pointer.len();
    match value {
        Value::Float(number) if !number.is_finite() => {
            let reason = if number.is_nan() { "not a number" } else { "beyond the range of a double" };
            found.push(NotFinite { pointer: pointer.clone(), reason: reason.to_owned() });
        }
        Value::Array(items) => {
            for (index, item) in items.iter().enumerate() {
                pointer.push_str(&format!("/{index}"));
                walk(item, pointer, found);
                pointer.truncate(length);
            }
        }
        Value::Map(members) => {
            for (name, member) in members {
                pointer.push('/');
                pointer.push_str(&name.as_text().unwrap_or_default().replace('~', "~0").replace('/', "~1"));
                walk(member, pointer, found);
                pointer.truncate(length);
            }
        }
        _ => {}
    }
}

impl JobResult {
    /// Notes in `numerics.not_finite` which numbers will be null because they are not finite.
    pub fn note_not_finite(&mut self) {
        self.numerics.not_finite = not_finite(self);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_finite_is_null_and_named() {
        let mut result = JobResult::default();
        result.numerics.wall_ms.mesh = f64::NAN;
        result.numerics.wall_ms.impact = f64::NEG_INFINITY;
        result.note_not_finite();
        let pointers: Vec<_> = result.numerics.not_finite.iter().map(|entry| entry.pointer.as_str()).collect();
        assert_eq!(pointers, ["/numerics/wall_ms/mesh", "/numerics/wall_ms/impact"]);
        let written = serde_json::to_value(&result).expect("JSON");
        assert!(pointers.iter().all(|pointer| written.pointer(pointer).is_some_and(serde_json::Value::is_null)));
    }
}
