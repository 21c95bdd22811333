//! The command line: the subcommands, one file each.

mod backup;
mod batch;
mod cache;
mod check;
mod export;
mod import;
mod input;
mod openapi;
mod output;
mod problem;
mod serve;
mod shell;
mod solve;
mod table;
#[cfg(test)]
mod tests;
#[cfg(feature = "cluster")]
mod worker;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// Contact, mesh-in impact and nonlinear vibration of double-helical gear pairs.
#[derive(Debug, Parser)]
#[command(version, about, long_about = None, arg_required_else_help = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Serve the HTTP interface and the web pages.
    Serve(Box<serve::ServeArguments>),
    /// Compute for a service on another machine.
    #[cfg(feature = "cluster")]
    Worker(Box<worker::WorkerArguments>),
    /// Copy the database, also while the service runs.
    Backup(backup::BackupArguments),
    /// Solve one job document in place: the result as JSON on standard output.
    Solve(solve::SolveArguments),
    /// Solve every document and gear model of a folder, and go on where it was stopped.
    Batch(batch::BatchArguments),
    /// Check one job document: geometry and warnings, or every violation.
    Check(check::CheckArguments),
    /// Write a job document as a gear model for other programs (REXS).
    Export(export::ExportArguments),
    /// Make a job document of a gear model of another program (REXS, KISSsoft).
    Import(import::ImportArguments),
    /// Print the description of the HTTP interface (OpenAPI, JSON).
    Openapi(openapi::OpenapiArguments),
    /// Print the completion script of a shell.
    #[command(hide = true)]
    Completions(shell::CompletionArguments),
    /// Write the manual pages.
    #[command(hide = true)]
    Man(shell::ManArguments),
}

/// Runs the subcommand. Returns the exit code of the process.
pub(crate) fn run(arguments: Arguments) -> ExitCode {
    match arguments.command {
        Command::Serve(arguments) => serve::run(*arguments),
        #[cfg(feature = "cluster")]
        Command::Worker(arguments) => worker::run(*arguments),
        Command::Backup(arguments) => backup::run(arguments),
        Command::Solve(arguments) => solve::run(arguments),
        Command::Batch(arguments) => batch::run(arguments),
        Command::Check(arguments) => check::run(arguments),
        Command::Export(arguments) => export::run(arguments),
        Command::Import(arguments) => import::run(arguments),
        Command::Openapi(arguments) => openapi::run(arguments),
        Command::Completions(arguments) => shell::completions(arguments),
        Command::Man(arguments) => shell::man(arguments),
    }
}
