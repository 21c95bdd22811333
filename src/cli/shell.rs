//! `herringbone completions` and `herringbone man`: files for shells and manuals, made from the arguments.

use super::Arguments;
use clap::{Args, CommandFactory};
use clap_complete::Shell;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(super) struct CompletionArguments {
    /// Shell that reads the script.
    shell: Shell,
}

#[derive(Debug, Args)]
pub(super) struct ManArguments {
    /// Write a page for the program and for each subcommand into this folder; without it, the program's page goes to
    /// standard output.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
}

/// Prints the completion script of a shell.
pub(super) fn completions(arguments: CompletionArguments) -> ExitCode {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "herringbone", &mut script);
    printed(&script)
}

/// Writes the manual pages.
pub(super) fn man(arguments: ManArguments) -> ExitCode {
    let Some(folder) = arguments.out else {
        let mut page = Vec::new();
        let rendered = clap_mangen::Man::new(Arguments::command()).render(&mut page);
        return if rendered.is_ok() { printed(&page) } else { ExitCode::FAILURE };
    };
    match write_pages(&folder) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{}: {error}", folder.display());
            ExitCode::FAILURE
        }
    }
}

fn write_pages(folder: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    clap_mangen::generate_to(Arguments::command().disable_help_subcommand(true), folder)
}

fn printed(bytes: &[u8]) -> ExitCode {
    match std::io::stdout().lock().write_all(bytes) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => ExitCode::FAILURE,
        _ => ExitCode::SUCCESS,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_subcommand_that_is_shown_has_a_page_and_is_completed() {
        let folder = tempfile::tempdir().unwrap();
        write_pages(folder.path()).unwrap();
        let page = |name: &str| std::fs::read_to_string(folder.path().join(name));
        for name in ["herringbone.1", "herringbone-serve.1", "herringbone-batch.1", "herringbone-import.1"] {
            assert!(page(name).unwrap().contains(".TH"), "{name}");
        }
        assert!(page("herringbone-man.1").is_err() && page("herringbone-completions.1").is_err());
        for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
            let mut script = Vec::new();
            clap_complete::generate(shell, &mut Arguments::command(), "herringbone", &mut script);
            let script = String::from_utf8(script).unwrap();
            assert!(script.contains("mirror") && script.contains("batch"), "{shell}");
        }
    }
}
