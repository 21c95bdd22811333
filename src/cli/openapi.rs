//! `herringbone openapi`: prints the OpenAPI document.

use clap::Args;
use herringbone::api::{openapi_for_generators, openapi_json};
use std::io::Write;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(super) struct OpenapiArguments {
    /// In the terms that generators of clients understand: nothing that is sent is null, every list says what it holds,
    /// each body has one media type.
    #[arg(long)]
    for_generators: bool,
}

pub(super) fn run(arguments: OpenapiArguments) -> ExitCode {
    let text = if arguments.for_generators { openapi_for_generators() } else { openapi_json() };
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => ExitCode::FAILURE,
        _ => ExitCode::SUCCESS,
    }
}
