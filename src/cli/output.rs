//! JSON on standard output or in a file.

use serde::Serialize;
use std::fs::File;
use std::io::{BufWriter, Error, ErrorKind, Write};
use std::path::Path;

/// Writes a value as JSON for people; a reader of standard output that went away is no error.
///
/// # Errors
/// The file or standard output cannot be written.
pub(super) fn write_json(path: Option<&Path>, value: &impl Serialize) -> Result<(), Error> {
    let Some(path) = path else {
        return match write(std::io::stdout().lock(), value) {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
            written => written,
        };
    };
    let written = File::create(path).and_then(|file| write(BufWriter::new(file), value));
    written.map_err(|error| Error::new(error.kind(), format!("{}: {error}", path.display())))
}

fn write(mut out: impl Write, value: &impl Serialize) -> Result<(), Error> {
    serde_json::to_writer_pretty(&mut out, value)?;
    writeln!(out)?;
    out.flush()
}
