//! JSON parser that refuses repeated members of an object, whose meaning RFC 8259 leaves open.

use super::encoding::{EncodingError, utf8_text};
use serde::de::{DeserializeSeed, Deserializer, Error, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Value};
use std::fmt;

/// Syntax error in a JSON text, with its line and column (counted from 1).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct NotJson {
    pub detail: String,
    pub line: usize,
    pub column: usize,
}

/// Reads JSON text in UTF-8, with or without a byte order mark.
///
/// # Errors
/// [`NotJson`] if the text is not JSON in UTF-8, is nested deeper than 127 levels, contains a number out of the range
/// of 64-bit floats, or repeats a member.
pub(crate) fn read(bytes: &[u8]) -> Result<Value, NotJson> {
    let text = utf8_text(bytes).map_err(|error| {
        let (line, column) = match error {
            EncodingError::Other(_) => (1, 1),
            EncodingError::Invalid { offset, .. } => place(&bytes[..offset]),
        };
        NotJson { detail: error.to_string(), line, column }
    })?;
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = Unambiguous.deserialize(&mut deserializer).and_then(|value| deserializer.end().map(|()| value));
    value.map_err(|error| NotJson { detail: without_place(&error), line: error.line(), column: error.column() })
}

/// Line and column (counted from 1) of the end of a text, the column in bytes as the parser counts it.
fn place(before: &[u8]) -> (usize, usize) {
    let start = before.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let mark = if start == 0 && before.starts_with("\u{feff}".as_bytes()) { 3 } else { 0 };
    (1 + before.iter().filter(|byte| **byte == b'\n').count(), 1 + before.len() - start - mark)
}

fn without_place(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text.rfind(" at line ") {
        Some(end) => text[..end].to_owned(),
        None => text,
    }
}

/// Deserializes a value and checks the names of its members.
struct Unambiguous;

impl<'de> DeserializeSeed<'de> for Unambiguous {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Unambiguous {
    type Value = Value;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, text: &str) -> Result<Value, E> {
        Ok(text.into())
    }

    fn visit_string<E>(self, text: String) -> Result<Value, E> {
        Ok(text.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(value) = items.next_element_seed(Unambiguous)? {
            values.push(value);
        }
        Ok(Value::Array(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut members: A) -> Result<Value, A::Error> {
        let mut map = Map::new();
        while let Some(name) = members.next_key::<String>()? {
            if map.contains_key(&name) {
                let shown: String = name.chars().take(60).collect();
                return Err(A::Error::custom(format_args!("the member {shown:?} is given twice")));
            }
            map.insert(name, members.next_value_seed(Unambiguous)?);
        }
        Ok(Value::Object(map))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_what_serde_json_reads() {
        for text in [
            "null",
            "true",
            "-0.0",
            "-1",
            "18446744073709551615",
            "-9223372036854775808",
            "1e-400",
            "0.1",
            "123456789012345678901",
            r#""\ud83d\ude00 \u0000""#,
            "[]",
            "[[1], {}]",
            r#"{"b": 1, "a": [{"b": null}], "": 2}"#,
            " 1 ",
        ] {
            let expected: Value = serde_json::from_str(text).expect("JSON");
            assert_eq!(read(text.as_bytes()).expect("JSON"), expected, "{text}");
        }
        for text in ["", "1 2", "{", "[1,]", "1e400", "1\u{feff}", r#""\ud800""#, "nul", "{1: 2}"] {
            assert!(read(text.as_bytes()).is_err(), "{text}");
            assert!(serde_json::from_str::<Value>(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_member_given_twice_is_refused_with_its_place() {
        let error = read(b"{\"a\": 1,\n \"b\": {\"a\": 2, \"a\": 2}}").expect_err("repeated");
        assert_eq!((error.line, error.detail.contains("\"a\" is given twice")), (2, true), "{error:?}");
    }

    #[test]
    fn f07_a_byte_order_mark_moves_no_place_and_other_encodings_are_named() {
        assert_eq!(read("\u{feff}{\"a\": 1}".as_bytes()), read(b"{\"a\": 1}"));
        assert_eq!(read("\u{feff}{,".as_bytes()), read(b"{,"));
        assert_eq!(read("\u{feff}".as_bytes()), read(b""));
        let error = read(b"\xff\xfe{\0}\0").unwrap_err();
        assert_eq!((error.line, error.column, error.detail.contains("UTF-16")), (1, 1, true), "{error:?}");
        let error = read(b"{\n \"name\": \"Gr\xf6\xdfe\"}").unwrap_err();
        assert_eq!((error.line, error.column, error.detail.contains("UTF-8")), (2, 13, true), "{error:?}");
        let error = read(b"\xef\xbb\xbf\"\xf6\"").unwrap_err();
        assert_eq!((error.line, error.column), (1, 2), "{error:?}");
    }
}
