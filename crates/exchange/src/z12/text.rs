//! The text of a calculation file and the values in it.

use crate::draft::Reading;
use std::collections::HashMap;

/// Part of a file in which its first keys stand.
const HEAD_BYTES: usize = 400;
/// Sign at the end of a line with a value.
const END: char = '¶';
/// Keys of the first lines, which may lack that sign.
const HEAD_KEYS: [&str; 3] = ["VERSION", "KSOFTVERSION", "MODULE"];

/// The text of a file that is such a calculation: UTF-16 with a byte order mark, or single bytes (Windows-1252).
pub(crate) fn recognise(bytes: &[u8]) -> Option<String> {
    let big = bytes.starts_with(b"\xfe\xff");
    if big || bytes.starts_with(b"\xff\xfe") {
        let unit = |pair: &[u8]| {
            let pair = [pair[0], pair[1]];
            if big { u16::from_be_bytes(pair) } else { u16::from_le_bytes(pair) }
        };
        let decode = |bytes: &[u8]| -> String {
            let units: Vec<u16> = bytes.chunks_exact(2).map(unit).collect();
            String::from_utf16_lossy(&units)
        };
        let body = &bytes[2..];
        return is_calculation(&decode(&body[..body.len().min(2 * HEAD_BYTES)])).then(|| decode(body));
    }
    // The signs that matter here are the same in ISO 8859-1.
    let decode = |bytes: &[u8]| -> String { bytes.iter().map(|byte| char::from(*byte)).collect() };
    is_calculation(&decode(&bytes[..bytes.len().min(HEAD_BYTES)])).then(|| decode(bytes))
}

fn is_calculation(head: &str) -> bool {
    let head = head.trim_start();
    head.starts_with("VERSION=") && (head.contains("KSOFTVERSION=") || head.contains("MODULE="))
}

/// The values of a file; the last one of a key counts.
#[derive(Debug, Default)]
pub(super) struct Values<'t> {
    of: HashMap<&'t str, &'t str>,
}

impl<'t> Values<'t> {
    pub(super) fn read(text: &'t str) -> Self {
        let mut of = HashMap::new();
        for line in text.lines() {
            let Some((key, value)) = line.split_once('=') else { continue };
            let is_key =
                !key.is_empty() && key.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"_.[]".contains(&byte));
            let (value, is_ended) = match value.trim_end().strip_suffix(END) {
                Some(value) => (value, true),
                None => (value.trim_end(), false),
            };
            // Whole scripts stand in a file: their lines have no sign at the end.
            if is_key && (is_ended || (HEAD_KEYS.contains(&key) && !of.contains_key(key))) {
                of.insert(key, value.trim_end_matches(';'));
            }
        }
        Self { of }
    }

    pub(super) fn text(&self, key: &str) -> Option<&'t str> {
        self.of.get(key).copied().map(str::trim).filter(|value| !value.is_empty())
    }

    /// A number of a gear or of the pair. `factor` leads from the file's unit to that of the value.
    ///
    /// # Errors
    /// What stands there is no finite number.
    pub(super) fn number(&self, key: &Key, factor: f64) -> Result<Option<Reading>, String> {
        let name = key.name();
        let Some(text) = self.text(&name) else { return Ok(None) };
        let file_value = text.parse().ok().filter(|value: &f64| value.is_finite());
        let file_value = file_value.ok_or_else(|| format!("{name} is no number in the file"))?;
        Ok(Some(Reading {
            value: if factor == 1.0 { file_value } else { crate::unit::clean(file_value * factor) },
            file_value,
            file_unit: key.unit.to_owned(),
            of: key.of.clone(),
            component: key.index,
            attribute: key.attribute,
            unit_assumed: false,
        }))
    }
}

/// A key of the file: component, attribute, and the format's unit.
#[derive(Debug, Clone)]
pub(super) struct Key {
    of: String,
    index: i64,
    attribute: &'static str,
    unit: &'static str,
}

impl Key {
    /// `ZR[i].attribute`.
    pub(super) fn of_gear(index: usize, attribute: &'static str, unit: &'static str) -> Self {
        Self { of: format!("ZR[{index}]"), index: index as i64, attribute, unit }
    }

    /// `of.attribute`.
    pub(super) fn of_pair(of: &str, attribute: &'static str, unit: &'static str) -> Self {
        Self { of: of.to_owned(), index: 0, attribute, unit }
    }

    pub(super) fn name(&self) -> String {
        format!("{}.{}", self.of, self.attribute)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_value_of_a_key_counts_and_scripts_do_not() {
        let text = "VERSION=20.0;\nMODULE=Z012;\nZR[0].z=20¶\nZR[0].z=21¶\r\nZR[0].z = 99\nZR[0].z=98\n  ZR[0].z=97¶\nZR[1].z=x¶\n\
                    VERSION=script\nlist=1,2¶\n";
        let values = Values::read(text);
        let z = |index| values.number(&Key::of_gear(index, "z", ""), 1.0);
        assert_eq!(z(0).unwrap().unwrap().value, 21.0);
        assert!(z(1).is_err() && z(2).unwrap().is_none());
        assert_eq!((values.text("VERSION"), values.text("list")), (Some("20.0"), Some("1,2")));
    }

    #[test]
    fn both_encodings_are_recognised_and_nothing_else() {
        let text = "VERSION=20.0;\r\nMODULE=Z012;¶\r\n";
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let single: Vec<u8> = text.chars().map(|letter| letter as u8).collect();
        for bytes in [[b"\xff\xfe", &little[..]].concat(), [b"\xfe\xff", &big[..]].concat(), single] {
            assert_eq!(recognise(&bytes).as_deref(), Some(text));
        }
        for other in [&b"<model>"[..], b"{}", b"", b"\xff\xfe", b"\xff\xfeV", b"VERSION=1", b"PK\x03\x04"] {
            assert_eq!(recognise(other), None);
        }
    }
}
