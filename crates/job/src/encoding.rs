//! The character encoding of text that comes from outside: UTF-8 is read, with or without a byte order mark; others are
//! named.

/// U+FEFF in UTF-8. RFC 8259, section 8.1: a parser may ignore it at the start of a JSON text.
const UTF8_MARK: &[u8] = b"\xef\xbb\xbf";

/// Byte order marks of other encodings (The Unicode Standard, section 23.8), longer ones first: UTF-32's begins as
/// UTF-16's.
const OTHER_MARKS: [(&[u8], &str); 4] = [
    (b"\xff\xfe\0\0", "UTF-32 (little-endian)"),
    (b"\0\0\xfe\xff", "UTF-32 (big-endian)"),
    (b"\xff\xfe", "UTF-16 (little-endian)"),
    (b"\xfe\xff", "UTF-16 (big-endian)"),
];

/// Failure to decode bytes as UTF-8 text.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum EncodingError {
    /// Another Unicode encoding, detected by its byte order mark or by the positions of its zero bytes.
    #[error("the text is encoded in {0}; needed: UTF-8")]
    Other(&'static str),
    /// A byte that is invalid in UTF-8 at its offset.
    #[error(
        "the text is not encoded in UTF-8: byte 0x{byte:02x} at offset {offset} (perhaps it is in Windows-1252 or ISO 8859-1); \
         needed: UTF-8"
    )]
    Invalid { byte: u8, offset: usize },
}

/// The text without its byte order mark. Checks the first bytes only: see [`utf8_text`].
///
/// # Errors
/// [`EncodingError::Other`] if the first bytes are those of UTF-16 or UTF-32. Without a byte order mark these are
/// detected by the zero bytes of ASCII characters (RFC 4627, section 3).
pub fn without_mark(bytes: &[u8]) -> Result<&[u8], EncodingError> {
    if let Some((_, name)) = OTHER_MARKS.iter().find(|(mark, _)| bytes.starts_with(mark)) {
        return Err(EncodingError::Other(name));
    }
    match *bytes {
        [0, 0, 0, a, ..] if a != 0 => Err(EncodingError::Other("UTF-32 (big-endian)")),
        [a, 0, 0, 0, ..] if a != 0 => Err(EncodingError::Other("UTF-32 (little-endian)")),
        [0, a, ..] if a != 0 => Err(EncodingError::Other("UTF-16 (big-endian)")),
        [a, 0, ..] if a != 0 => Err(EncodingError::Other("UTF-16 (little-endian)")),
        _ => Ok(bytes.strip_prefix(UTF8_MARK).unwrap_or(bytes)),
    }
}

/// The whole text, without its byte order mark.
///
/// # Errors
/// [`EncodingError`] if the text is not UTF-8, with the detected encoding or the first invalid byte.
pub fn utf8_text(bytes: &[u8]) -> Result<&str, EncodingError> {
    let text = without_mark(bytes)?;
    std::str::from_utf8(text).map_err(|error| {
        let place = error.valid_up_to();
        EncodingError::Invalid { byte: text[place], offset: place + bytes.len() - text.len() }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
        text.encode_utf16().flat_map(bytes).collect()
    }

    fn utf32(text: &str, bytes: fn(u32) -> [u8; 4]) -> Vec<u8> {
        text.chars().flat_map(|letter| bytes(letter.into())).collect()
    }

    #[test]
    fn f07_a_byte_order_mark_is_no_part_of_the_text() {
        for text in ["{}", " {\"name\": \"Größe\"}\r\n", "", "1", "\u{fffe}"] {
            assert_eq!(utf8_text(text.as_bytes()), Ok(text));
            assert_eq!(utf8_text(format!("\u{feff}{text}").as_bytes()), Ok(text));
        }
        // One mark, at the start.
        assert_eq!(utf8_text("\u{feff}\u{feff}{}".as_bytes()), Ok("\u{feff}{}"));
        assert_eq!(utf8_text("{}\u{feff}".as_bytes()), Ok("{}\u{feff}"));
    }

    #[test]
    fn f07_other_encodings_are_named() {
        for text in ["{}", "\u{feff}{\"name\": \"Größe\"}", "\u{feff}", "{\"名\": 1}", "12", "token-of-some-length"]
        {
            for (bytes, name) in [
                (utf16(text, u16::to_le_bytes), "UTF-16 (little-endian)"),
                (utf16(text, u16::to_be_bytes), "UTF-16 (big-endian)"),
                (utf32(text, u32::to_le_bytes), "UTF-32 (little-endian)"),
                (utf32(text, u32::to_be_bytes), "UTF-32 (big-endian)"),
            ] {
                assert_eq!(utf8_text(&bytes), Err(EncodingError::Other(name)), "{text:?}");
                assert!(without_mark(&bytes).unwrap_err().to_string().contains(name));
            }
        }
        // "Größe" in ISO 8859-1, without and with a mark of UTF-8 before it.
        assert_eq!(utf8_text(b"\"Gr\xf6\xdfe\""), Err(EncodingError::Invalid { byte: 0xf6, offset: 3 }));
        assert_eq!(utf8_text(b"\xef\xbb\xbf\xf6"), Err(EncodingError::Invalid { byte: 0xf6, offset: 3 }));
        let detail = utf8_text(b"\xe4").unwrap_err().to_string();
        assert!(detail.contains("0xe4 at offset 0") && detail.contains("Windows-1252"), "{detail}");
    }
}
