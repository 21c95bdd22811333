//! `herringbone openapi`: prints the OpenAPI document.

use std::io::Write;
use std::process::ExitCode;

pub(super) fn run() -> ExitCode {
    match std::io::stdout().lock().write_all(herringbone::api::openapi_json().as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => ExitCode::FAILURE,
        _ => ExitCode::SUCCESS,
    }
}
