//! What a batch writes for a file: the result, tables and series in other forms, and a record by which it is known
//! again.

use super::Format;
use herringbone::api::{
    CsvWriter, Decimal, MAX_WORKBOOK_ROWS, Problem, Table, document_value, quantities_of, write_workbook,
};
use herringbone_exchange::arrays::{ArrayForm, ArrayWriter};
use herringbone_job::document::JobDocument;
use herringbone_job::result::quantities;
use herringbone_job::study::{Outcome, RecordedChannel, SOLVER_VERSION};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Error};
use std::path::{Path, PathBuf};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Status {
    Solved,
    Skipped,
    Failed,
}

impl Status {
    pub(super) fn as_str(self) -> &'static str {
        match self {
            Status::Solved => "solved",
            Status::Skipped => "skipped",
            Status::Failed => "failed",
        }
    }
}

/// What became of a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Record {
    pub file: String,
    pub status: Status,
    pub kind: String,
    pub name: Option<String>,
    pub input_hash: Option<String>,
    pub solver_version: String,
    pub wall_s: f64,
    /// Code and detail of the problem, with the first violations.
    pub error: Option<String>,
    /// Forms that were written besides the result.
    formats: Vec<String>,
    /// Headline numbers by their pointers.
    pub numbers: BTreeMap<String, f64>,
}

impl Record {
    pub(super) fn failed(file: &str, input_hash: Option<String>, problem: &Problem) -> Self {
        const SHOWN: usize = 5;
        let violations = problem.errors.iter().take(SHOWN).map(|one| format!("{} {}", one.pointer, one.detail));
        let details: Vec<_> = std::iter::once(problem.detail.clone()).chain(violations).collect();
        Self {
            file: file.to_owned(),
            status: Status::Failed,
            kind: String::new(),
            name: None,
            input_hash,
            solver_version: SOLVER_VERSION.to_owned(),
            wall_s: 0.0,
            error: Some(format!("{}: {}", problem.code, details.join("; "))),
            formats: Vec::new(),
            numbers: BTreeMap::new(),
        }
    }

    /// A line for people.
    pub(super) fn line(&self) -> String {
        match &self.error {
            Some(error) => format!("{}: {} ({error})", self.file, self.status.as_str()),
            None => format!("{}: {} in {:.1} s", self.file, self.status.as_str(), self.wall_s),
        }
    }
}

fn beside(out: &Path, file: &str, ending: &str) -> PathBuf {
    let mut path = out.to_path_buf();
    path.extend(file.split('/'));
    let mut name = path.file_name().map(|name| name.to_os_string()).unwrap_or_default();
    name.push(ending);
    path.with_file_name(name)
}

/// The record of a file that was solved before, with the same document, program and forms.
pub(super) fn known(out: &Path, file: &str, input_hash: &str, formats: &[Format]) -> Option<Record> {
    let record: Record = serde_json::from_slice(&fs::read(beside(out, file, ".batch.json")).ok()?).ok()?;
    let is_same = record.input_hash.as_deref() == Some(input_hash) && record.solver_version == SOLVER_VERSION;
    let is_there = beside(out, file, ".result.json").is_file()
        && formats.iter().all(|format| record.formats.contains(&format.name()));
    let usable = record.status != Status::Failed && is_same && is_there;
    usable.then_some(Record { status: Status::Skipped, ..record })
}

/// Keeps the record of a file; written last, so that what it tells of is there.
pub(super) fn remember(out: &Path, record: &Record) {
    let path = beside(out, &record.file, ".batch.json");
    let written = serde_json::to_vec_pretty(record).map_err(Error::other).and_then(|bytes| replace(&path, &bytes));
    if let Err(error) = written {
        eprintln!("{}: {error}", path.display());
    }
}

/// Writes a file that is whole or as it was before.
fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(directory) = path.parent() {
        fs::create_dir_all(directory)?;
    }
    let mut partial = path.as_os_str().to_os_string();
    partial.push(format!(".{}.partial", std::process::id()));
    fs::write(&partial, bytes)?;
    fs::rename(&partial, path)
}

/// Writes the result of a file and its other forms.
///
/// # Errors
/// A file cannot be written, or the form has no room.
pub(super) fn write(
    out: &Path,
    file: &str,
    input_hash: String,
    document: &JobDocument,
    outcome: &Outcome,
    (formats, decimal): (&[Format], Decimal),
) -> io::Result<Record> {
    let mut text = serde_json::to_vec_pretty(&outcome.result)?;
    text.push(b'\n');
    replace(&beside(out, file, ".result.json"), &text)?;
    let value = serde_json::to_value(&outcome.result)?;
    let sweep = outcome.result.sweep.as_ref();
    let table = match sweep {
        Some(sweep) => {
            let axes: Vec<String> = document.axes.iter().map(|axis| axis.pointer.clone()).collect();
            Table::of_sweep(&sweep.points, &axes)
        }
        None => quantities_of(&value),
    };
    for format in formats {
        let bytes = match format {
            Format::Csv => table.to_csv(CsvWriter::with_mark(Vec::new(), decimal)?)?,
            Format::Xlsx if table.n_rows() > MAX_WORKBOOK_ROWS => {
                return Err(Error::other("too many rows for a sheet"));
            }
            Format::Xlsx => {
                let name = if sweep.is_some() { "points" } else { "result" };
                write_workbook(name, &table, &document_value(document)).map_err(Error::other)?
            }
            Format::Npz | Format::Mat => {
                let form = if *format == Format::Npz { ArrayForm::Npz } else { ArrayForm::Mat };
                if sweep.is_some() { table.to_arrays(form)? } else { series(&outcome.series, form)? }
            }
        };
        replace(&beside(out, file, &format!(".{}", format.name())), &bytes)?;
    }
    Ok(record_of(file, input_hash, document, &value, formats))
}

/// As [`write`], of a result that a service has answered; `files`: forms that it has answered too.
///
/// # Errors
/// The result is none, or a file cannot be written.
pub(super) fn write_answered(
    out: &Path,
    file: &str,
    input_hash: String,
    document: &JobDocument,
    result: &[u8],
    files: Vec<(Format, Vec<u8>)>,
    (formats, decimal): (&[Format], Decimal),
) -> io::Result<Record> {
    let value: Value = serde_json::from_slice(result)?;
    let mut text = serde_json::to_vec_pretty(&value)?;
    text.push(b'\n');
    replace(&beside(out, file, ".result.json"), &text)?;
    for format in formats {
        let answered = files.iter().find(|(other, _)| other == format);
        let bytes = match (answered, format) {
            (Some((_, bytes)), _) => bytes.clone(),
            (None, Format::Csv) => quantities_of(&value).to_csv(CsvWriter::with_mark(Vec::new(), decimal)?)?,
            (None, _) => {
                write_workbook("result", &quantities_of(&value), &document_value(document)).map_err(Error::other)?
            }
        };
        replace(&beside(out, file, &format!(".{}", format.name())), &bytes)?;
    }
    Ok(record_of(file, input_hash, document, &value, formats))
}

/// The record of a file that was solved.
fn record_of(file: &str, input_hash: String, document: &JobDocument, value: &Value, formats: &[Format]) -> Record {
    let headlines = quantities().iter().filter(|quantity| quantity.headline.is_some());
    let places = headlines.flat_map(|quantity| quantity.places());
    let numbers = places.filter_map(|(pointer, _)| Some((pointer.clone(), value.pointer(&pointer)?.as_f64()?)));
    Record {
        file: file.to_owned(),
        status: Status::Solved,
        kind: document.kind.as_str().to_owned(),
        name: document.name.clone(),
        input_hash: Some(input_hash),
        solver_version: SOLVER_VERSION.to_owned(),
        wall_s: 0.0,
        error: None,
        formats: formats.iter().map(|format| format.name()).collect(),
        numbers: numbers.collect(),
    }
}

impl Format {
    pub(super) fn name(self) -> String {
        use clap::ValueEnum;
        self.to_possible_value().map(|value| value.get_name().to_owned()).unwrap_or_default()
    }
}

/// The recorded channels with their times, as the HTTP interface writes them.
fn series(channels: &[RecordedChannel], form: ArrayForm) -> io::Result<Vec<u8>> {
    let mut writer = ArrayWriter::new(form, Vec::new())?;
    let mut names = form.names();
    for reserved in ["t0_s", "dt_s", "t_s", "channels", "units"] {
        names.name(reserved);
    }
    let names: Vec<String> = channels.iter().map(|channel| names.name(&channel.name)).collect();
    if let Some(first) = channels.first() {
        writer.scalar("t0_s", first.t0_s)?;
        writer.scalar("dt_s", first.dt_s)?;
        let times: Vec<f64> = (0..first.values.len()).map(|at| first.t0_s + at as f64 * first.dt_s).collect();
        writer.numbers("t_s", &times)?;
    }
    for (name, channel) in names.iter().zip(channels) {
        writer.numbers(name, &channel.values)?;
    }
    writer.words("channels", &names.iter().map(String::as_str).collect::<Vec<_>>())?;
    writer.words("units", &channels.iter().map(|channel| channel.unit.as_str()).collect::<Vec<_>>())?;
    writer.finish()
}
