//! `herringbone check`: checks a document without solving it.

use super::input::{invalid, read_document};
use clap::Args;
use herringbone_job::study::CheckedJob;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    /// Job document (JSON); `-` reads standard input.
    file: PathBuf,
}

pub(super) fn run(arguments: CheckArguments) -> ExitCode {
    let document = match read_document(&arguments.file) {
        Ok(document) => document,
        Err(code) => return code,
    };
    match CheckedJob::new(document) {
        Ok(job) => {
            let mut out = std::io::stdout().lock();
            let written = serde_json::to_writer_pretty(&mut out, &job.report()).map_err(std::io::Error::from);
            match written.and_then(|()| writeln!(out)) {
                Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => ExitCode::FAILURE,
                _ => ExitCode::SUCCESS,
            }
        }
        Err(error) => invalid(error),
    }
}
