//! Reading job documents from files or standard input, and reporting invalid ones as problem+json.

use herringbone::api::{MAX_BODY_BYTES, Problem};
use herringbone_job::DocumentError;
use herringbone_job::document::JobDocument;
use std::io::Read;
use std::path::Path;
use std::process::ExitCode;

/// Largest document, as over HTTP.
const MAX_BYTES: u64 = MAX_BODY_BYTES as u64;

/// Reads and parses the document at `path` (`-`: standard input).
///
/// # Errors
/// The exit code, after the error was printed on standard error.
pub(super) fn read_document(path: &Path) -> Result<JobDocument, ExitCode> {
    let bytes = read_bytes(path, MAX_BYTES).map_err(|error| {
        eprintln!("{}: {error}", path.display());
        ExitCode::from(2)
    })?;
    herringbone_job::parse(&bytes).map_err(invalid)
}

/// Prints the errors of a document as problem+json. Returns the exit code for invalid input, 2.
pub(super) fn invalid(error: DocumentError) -> ExitCode {
    super::problem::print(&Problem::from(error));
    ExitCode::from(2)
}

/// Reads a file (`-`: standard input) of at most so many bytes.
///
/// # Errors
/// The file cannot be read, or is larger.
pub(super) fn read_bytes(path: &Path, most: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        std::io::stdin().lock().take(most + 1).read_to_end(&mut bytes)?;
    } else {
        std::fs::File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    }
    if bytes.len() as u64 > most {
        return Err(std::io::Error::other(format!("larger than {most} bytes")));
    }
    Ok(bytes)
}
