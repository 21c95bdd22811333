//! The access token: read at the start, compared in constant time, never logged.

use herringbone_job::{EncodingError, without_mark};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Read;
use std::ops::RangeInclusive;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use subtle::ConstantTimeEq;

/// Permitted lengths, in characters.
const TOKEN_LENGTH: RangeInclusive<usize> = 16..=1024;

/// The SHA-256 digest of the token.
pub(crate) struct Token([u8; 32]);

/// Failure to read a token file. The message does not contain any of its content.
#[derive(Debug, thiserror::Error)]
pub enum TokenError {
    #[error("the token file {} cannot be read: {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("the token file {} is empty", path.display())]
    Empty { path: PathBuf },
    #[error("the token in {} is too short or too long: {} to {} characters are needed", path.display(), TOKEN_LENGTH.start(), TOKEN_LENGTH.end())]
    Length { path: PathBuf },
    #[error("the token file {} cannot be read: {source}", path.display())]
    Encoding { path: PathBuf, source: EncodingError },
    #[error("the token in {} is not one word of visible ASCII characters", path.display())]
    Characters { path: PathBuf },
}

impl Token {
    /// Reads a token file, ignoring a byte order mark and white space around the token. Logs a warning when every user
    /// of the machine can read the file.
    ///
    /// # Errors
    /// The file cannot be read, or does not hold a usable token.
    pub(crate) fn read(path: &Path) -> Result<Self, TokenError> {
        let (bytes, mode) = read_start(path).map_err(|source| TokenError::Unreadable { path: path.into(), source })?;
        let path = path.to_owned();
        let token = match without_mark(&bytes) {
            Ok(text) => text.trim_ascii(),
            Err(source) => return Err(TokenError::Encoding { path, source }),
        };
        if token.is_empty() {
            return Err(TokenError::Empty { path });
        }
        if !token.iter().all(u8::is_ascii_graphic) {
            return Err(TokenError::Characters { path });
        }
        if !TOKEN_LENGTH.contains(&token.len()) {
            return Err(TokenError::Length { path });
        }
        if mode & 0o004 != 0 {
            tracing::warn!(path = %path.display(), "every user of this machine can read the token file (chmod o-r)");
        }
        Ok(Self(digest(token)))
    }

    /// Whether `presented` is the token. The time taken reveals neither the place of the first difference nor the
    /// length, as digests are compared in constant time.
    pub(crate) fn matches(&self, presented: &[u8]) -> bool {
        self.0.ct_eq(&digest(presented)).into()
    }
}

/// The beginning of the file, longer than any valid token, and the file's mode.
fn read_start(path: &Path) -> std::io::Result<(Vec<u8>, u32)> {
    let file = File::open(path)?;
    let mode = file.metadata()?.permissions().mode();
    let mut bytes = Vec::new();
    file.take(2 * *TOKEN_LENGTH.end() as u64).read_to_end(&mut bytes)?;
    Ok((bytes, mode))
}

fn digest(token: &[u8]) -> [u8; 32] {
    Sha256::digest(token).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(contents: &[u8]) -> Result<Token, TokenError> {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), contents).unwrap();
        Token::read(file.path())
    }

    #[test]
    fn only_the_token_itself_is_the_token() {
        let token = read(b"  0123456789abcdef\r\n").unwrap();
        assert!(token.matches(b"0123456789abcdef"));
        for wrong in [&b""[..], b"0123456789abcde", b"0123456789abcdef0", b"0123456789abcdeF", b"0123456789abcdef\n"] {
            assert!(!token.matches(wrong), "{wrong:?}");
        }
    }

    #[test]
    fn f07_a_byte_order_mark_is_not_part_of_the_token_and_other_encodings_are_named() {
        let token = read(b"\xef\xbb\xbf0123456789abcdef\r\n").unwrap();
        assert!(token.matches(b"0123456789abcdef"));
        let utf16: Vec<u8> = "\u{feff}0123456789abcdef\r\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let error = read(&utf16).err().unwrap().to_string();
        assert!(error.contains("UTF-16") && !error.contains("0123456789"), "{error}");
        assert!(read(b"\xef\xbb\xbf\n").err().unwrap().to_string().contains("empty"));
    }

    #[test]
    fn what_is_no_token_is_refused_and_not_shown() {
        for (contents, what) in [
            (&b""[..], "empty"),
            (b" \n\t", "empty"),
            (b"0123456789abcde", "too short"),
            (&[b'x'; 1025], "too long"),
            (&[b'x'; 5000], "too long"),
            (b"0123456789 abcdef", "one word"),
            (b"0123456789abcdef\nsecond-word", "one word"),
            ("0123456789abcdefü".as_bytes(), "one word"),
            (b"0123456789abcdef\0", "one word"),
        ] {
            let error = read(contents).err().unwrap().to_string();
            assert!(error.contains(what), "{error}");
            assert!(!error.contains("0123456789"), "{error}");
        }
        let missing = Token::read(Path::new("/no/such/file")).err().unwrap().to_string();
        assert!(missing.contains("/no/such/file") && missing.contains("cannot be read"), "{missing}");
        assert!(Token::read(Path::new("/")).is_err());
    }
}
