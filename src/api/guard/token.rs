//! The token: read once at the start, compared in constant time, never shown.

use herringbone_job::{EncodingError, without_mark};
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io::Read;
use std::ops::RangeInclusive;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use subtle::ConstantTimeEq;

const CHARS: RangeInclusive<usize> = 16..=1024;

/// The token's digest; the token itself is not kept.
pub struct Token([u8; 32]);

/// Why a file holds no usable token. Says nothing about what is in it.
#[derive(Debug, thiserror::Error)]
pub enum TokenError {
    #[error("the token file {} cannot be read: {source}", path.display())]
    Unreadable { path: PathBuf, source: std::io::Error },
    #[error("the token file {} is empty", path.display())]
    Empty { path: PathBuf },
    #[error("the token in {} is too short or too long: {} to {} characters are needed", path.display(), CHARS.start(), CHARS.end())]
    Length { path: PathBuf },
    #[error("the token file {} cannot be read: {source}", path.display())]
    Encoding { path: PathBuf, source: EncodingError },
    #[error("the token in {} is not one word of visible ASCII characters", path.display())]
    Characters { path: PathBuf },
}

impl Token {
    /// Reads a token file; a byte order mark before the token and white space around it are left out. Warns when everybody on the machine can read it.
    ///
    /// # Errors
    /// When there is no usable token in it.
    pub fn read(path: &Path) -> Result<Self, TokenError> {
        let (bytes, mode) = contents(path).map_err(|source| TokenError::Unreadable { path: path.into(), source })?;
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
        if !CHARS.contains(&token.len()) {
            return Err(TokenError::Length { path });
        }
        if mode & 0o004 != 0 {
            tracing::warn!(path = %path.display(), "every user of this machine can read the token file (chmod o-r)");
        }
        Ok(Self(digest(token)))
    }

    /// Whether this is the token, in a time that tells nothing about it: digests are compared, so that neither the place
    /// of the first difference nor the length shows.
    pub fn is(&self, presented: &[u8]) -> bool {
        self.0.ct_eq(&digest(presented)).into()
    }
}

/// At most what a token can have, and one byte more; and the file's mode.
fn contents(path: &Path) -> std::io::Result<(Vec<u8>, u32)> {
    let file = File::open(path)?;
    let mode = file.metadata()?.permissions().mode();
    let mut bytes = Vec::new();
    file.take(2 * *CHARS.end() as u64).read_to_end(&mut bytes)?;
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
        assert!(token.is(b"0123456789abcdef"));
        for wrong in [&b""[..], b"0123456789abcde", b"0123456789abcdef0", b"0123456789abcdeF", b"0123456789abcdef\n"] {
            assert!(!token.is(wrong), "{wrong:?}");
        }
    }

    #[test]
    fn f07_a_byte_order_mark_is_not_part_of_the_token_and_other_encodings_are_named() {
        let token = read(b"\xef\xbb\xbf0123456789abcdef\r\n").unwrap();
        assert!(token.is(b"0123456789abcdef"));
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
