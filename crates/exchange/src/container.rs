//! The form of a file: XML, JSON, or an archive with one of them.

use crate::refusal::{Refusal, short};
use std::borrow::Cow;
use std::io::{Cursor, Read};
use zip::ZipArchive;

/// Most bytes of a model, unpacked.
pub const MAX_UNPACKED_BYTES: u64 = 64 << 20;
/// Most files of an archive.
pub const MAX_FILES: usize = 100;

/// How a model is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Syntax {
    Xml,
    Json,
}

/// A model's text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ModelFile<'b> {
    pub syntax: Syntax,
    pub text: Cow<'b, str>,
    /// Name in its archive.
    pub name: Option<String>,
    /// Other files of the archive.
    pub others: Vec<String>,
}

/// Finds the model in a file, by its contents.
///
/// # Errors
/// [`Refusal`] for another kind of file, an archive without exactly one model, and sizes above the limits.
pub(crate) fn open(bytes: &[u8]) -> Result<ModelFile<'_>, Refusal> {
    if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06") {
        return unpack(bytes);
    }
    if bytes.len() as u64 > MAX_UNPACKED_BYTES {
        let detail = format!("has {} bytes; permitted: {MAX_UNPACKED_BYTES}", bytes.len());
        return Err(Refusal::unreadable("too-large", detail));
    }
    let (syntax, text) = decode(Cow::Borrowed(bytes))?;
    Ok(ModelFile { syntax, text, name: None, others: Vec::new() })
}

/// The text without its byte order mark, and how it is written.
fn decode(bytes: Cow<'_, [u8]>) -> Result<(Syntax, Cow<'_, str>), Refusal> {
    let is_blank = |byte: &u8| byte.is_ascii_whitespace();
    let body = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    let start = body.iter().position(|byte| !is_blank(byte));
    let syntax = match start.map(|start| body[start]) {
        Some(b'{') => Syntax::Json,
        Some(b'<') => Syntax::Xml,
        None => return Err(Refusal::unreadable("not-rexs", "is empty")),
        Some(_) => return Err(other_kind(&bytes)),
    };
    let skipped = bytes.len() - body.len() + start.unwrap_or(0);
    let text = match bytes {
        Cow::Borrowed(bytes) => std::str::from_utf8(&bytes[skipped..]).map(Cow::Borrowed).map_err(|_| bytes),
        Cow::Owned(mut bytes) => {
            bytes.drain(..skipped);
            return match String::from_utf8(bytes) {
                Ok(text) => Ok((syntax, Cow::Owned(text))),
                Err(error) => single_byte(syntax, error.as_bytes()).map(|text| (syntax, Cow::Owned(text))),
            };
        }
    };
    match text {
        Ok(text) => Ok((syntax, text)),
        Err(bytes) => single_byte(syntax, &bytes[skipped..]).map(|text| (syntax, Cow::Owned(text))),
    }
}

/// The text of XML that says it is in ISO 8859-1 or Windows-1252, which differ in signs that no REXS value has.
fn single_byte(syntax: Syntax, bytes: &[u8]) -> Result<String, Refusal> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).to_ascii_lowercase();
    let declared = ["iso-8859-1", "windows-1252", "latin1", "us-ascii"].iter().any(|name| head.contains(name));
    if syntax == Syntax::Xml && head.starts_with("<?xml") && declared {
        return Ok(bytes.iter().map(|byte| char::from(*byte)).collect());
    }
    Err(Refusal::unreadable("encoding", "is not text in UTF-8"))
}

/// Why a file that is neither XML nor JSON nor an archive is refused.
fn other_kind(bytes: &[u8]) -> Refusal {
    let detail = if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        "is text in UTF-16; needed: UTF-8"
    } else if bytes.starts_with(b"\x1f\x8b") {
        "is compressed with gzip; needed: the model itself, or a zip archive"
    } else {
        "is neither a REXS model (XML or JSON), nor a zip archive with one, nor a calculation of KISSsoft (.Z12)"
    };
    Refusal::unreadable("not-rexs", detail)
}

fn is_model(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    [".rexs", ".rexsj", ".rexs.xml", ".rexs.json"].iter().any(|ending| name.ends_with(ending))
}

/// Whether a path of an archive stays in it.
fn stays_inside(path: &str) -> bool {
    let is_absolute = path.starts_with(['/', '\\']) || path.as_bytes().get(1) == Some(&b':');
    !is_absolute && !path.contains('\0') && path.split(['/', '\\']).all(|part| part != "..")
}

fn unpack(bytes: &[u8]) -> Result<ModelFile<'_>, Refusal> {
    let archive_error = |error: &dyn std::fmt::Display| {
        Refusal::unreadable(
            "not-readable",
            format!("is a zip archive that cannot be read: {}", short(&error.to_string())),
        )
    };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| archive_error(&error))?;
    if archive.len() > MAX_FILES {
        let detail = format!("is a zip archive of {} files; permitted: {MAX_FILES}", archive.len());
        return Err(Refusal::unreadable("too-large", detail));
    }
    let names: Result<Vec<String>, _> = archive.file_names().map(|name| name.map(|name| name.into_owned())).collect();
    let names = names.map_err(|error| archive_error(&error))?;
    if let Some(path) = names.iter().find(|path| !stays_inside(path)) {
        let detail = format!("is a zip archive with a path that leads out of it: {}", short(path));
        return Err(Refusal::unreadable("path", detail));
    }
    let models: Vec<&String> = names.iter().filter(|name| is_model(name)).collect();
    let name = match models.as_slice() {
        [one] => (*one).clone(),
        [] => {
            let detail = "is a zip archive without a REXS model (.rexs or .rexsj)";
            return Err(Refusal::unreadable("no-model", detail));
        }
        several => {
            let list: Vec<_> = several.iter().take(5).map(|name| short(name)).collect();
            let detail = format!("is a zip archive with {} models ({}); needed: one", several.len(), list.join(", "));
            return Err(Refusal::unreadable("several-models", detail));
        }
    };
    let mut content = Vec::new();
    let file = archive.by_name(&name).map_err(|error| archive_error(&error))?;
    file.take(MAX_UNPACKED_BYTES + 1).read_to_end(&mut content).map_err(|error| archive_error(&error))?;
    if content.len() as u64 > MAX_UNPACKED_BYTES {
        let detail = format!("unpacks to more than {} MiB", MAX_UNPACKED_BYTES >> 20);
        return Err(Refusal::unreadable("too-large", detail));
    }
    let (syntax, text) = decode(Cow::Owned(content))?;
    let others = names.into_iter().filter(|other| *other != name && !other.ends_with('/')).collect();
    Ok(ModelFile { syntax, text, name: Some(name), others })
}
