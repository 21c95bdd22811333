//! The summary of a batch: a row for each file.

use super::output::{Record, Status};
use herringbone::api::{CsvField, CsvWriter, Decimal};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::Path;

const HEAD: [&str; 8] = ["file", "status", "kind", "name", "input_hash", "solver_version", "wall_s", "error"];

/// Writes the summary: what became of each file, and the headline numbers by their pointers in the result.
///
/// # Errors
/// The file cannot be written.
pub(super) fn write(path: &Path, records: &[Record], decimal: Decimal) -> io::Result<()> {
    let pointers: BTreeSet<&String> = records.iter().flat_map(|record| record.numbers.keys()).collect();
    let mut writer = CsvWriter::with_mark(Vec::new(), decimal)?;
    writer.write_record(HEAD.into_iter().chain(pointers.iter().map(|pointer| pointer.as_str())).map(CsvField::Text))?;
    for record in records {
        let head = [
            CsvField::Text(&record.file),
            CsvField::Text(record.status.as_str()),
            CsvField::Text(&record.kind),
            CsvField::Text(record.name.as_deref().unwrap_or_default()),
            CsvField::Text(record.input_hash.as_deref().unwrap_or_default()),
            CsvField::Text(&record.solver_version),
            CsvField::Number(record.wall_s),
            CsvField::Text(record.error.as_deref().unwrap_or_default()),
        ];
        let numbers = pointers.iter().map(|pointer| match record.numbers.get(*pointer) {
            Some(number) => CsvField::Number(*number),
            None => CsvField::Empty,
        });
        writer.write_record(head.into_iter().chain(numbers))?;
    }
    fs::write(path, writer.into_inner()?)
}

/// The numbers of files, and those that failed, for people.
pub(super) fn table(records: &[Record]) -> String {
    let count = |status| records.iter().filter(|record| record.status == status).count();
    let (solved, skipped, failed) = (count(Status::Solved), count(Status::Skipped), count(Status::Failed));
    let mut text = format!("{} files: {solved} solved, {skipped} skipped, {failed} failed\n", records.len());
    for record in records.iter().filter(|record| record.status == Status::Failed) {
        // Writing to a text does not fail.
        let _ = writeln!(text, "  {}: {}", record.file, record.error.as_deref().unwrap_or_default());
    }
    text
}
