//! `herringbone export`: writes a job document as a gear model of another format.

use super::input::{invalid, read_bytes, read_document};
use clap::{Args, ValueEnum};
use herringbone_exchange::{ExportForm, ExportOptions, export_rexs};
use herringbone_job::result::JobResult;
use jiff::Timestamp;
use jiff::tz::TimeZone;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Largest result that is read.
const MAX_RESULT_BYTES: u64 = 256 << 20;

#[derive(Debug, Args)]
pub(super) struct ExportArguments {
    /// Job document (JSON); `-` reads standard input.
    file: PathBuf,
    /// Write it as a REXS 1.7 model to this file (`-`: standard output).
    #[arg(long, value_name = "FILE", required = true)]
    rexs: PathBuf,
    /// Form of the model; by the ending of the file when it is not given (`.rexsj`, `.json`: JSON).
    #[arg(long, value_name = "xml|json")]
    format: Option<Form>,
    /// Result of the document (JSON, from `solve`), for mesh stiffness and the rest.
    #[arg(long, value_name = "RESULT.json")]
    result: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Form {
    Xml,
    Json,
}

pub(super) fn run(arguments: ExportArguments) -> ExitCode {
    let document = match read_document(&arguments.file) {
        Ok(document) => document,
        Err(code) => return code,
    };
    let result = match arguments.result.as_deref().map(read_result).transpose() {
        Ok(result) => result,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    let is_json = matches!(arguments.rexs.extension().and_then(|ending| ending.to_str()), Some("rexsj" | "json"));
    let form = match arguments.format {
        Some(Form::Json) => ExportForm::Json,
        Some(Form::Xml) => ExportForm::Xml,
        None if is_json => ExportForm::Json,
        None => ExportForm::Xml,
    };
    let date = Timestamp::now().to_zoned(TimeZone::UTC).strftime("%Y-%m-%dT%H:%M:%S+00:00").to_string();
    let options = ExportOptions {
        form,
        date: &date,
        application_version: env!("CARGO_PKG_VERSION"),
        result: result.as_ref(),
        result_id: None,
    };
    let text = match export_rexs(&document, &options) {
        Ok(text) => text,
        Err(error) => return invalid(error),
    };
    match write(&arguments.rexs, &text) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}: {error}", arguments.rexs.display());
            ExitCode::FAILURE
        }
    }
}

fn read_result(path: &Path) -> Result<JobResult, String> {
    let bytes = read_bytes(path, MAX_RESULT_BYTES).map_err(|error| format!("{}: {error}", path.display()))?;
    serde_json::from_slice(&bytes).map_err(|error| format!("{}: no result of a job: {error}", path.display()))
}

fn write(path: &Path, text: &str) -> std::io::Result<()> {
    if path == Path::new("-") {
        return match std::io::stdout().lock().write_all(text.as_bytes()) {
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
            written => written,
        };
    }
    std::fs::write(path, text)
}
