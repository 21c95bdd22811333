//! `herringbone backup`: copies the database, also while the service runs.

use clap::Args;
use herringbone::store;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(super) struct BackupArguments {
    /// Database to copy; the service may be using it.
    #[arg(long, env = "HERRINGBONE_DATABASE", value_name = "FILE", default_value = "herringbone.db")]
    database: PathBuf,

    /// Overwrite the target.
    #[arg(long)]
    force: bool,

    /// File to write. It appears under this name when it is whole and checked.
    #[arg(value_name = "TARGET")]
    target: PathBuf,
}

#[tokio::main(flavor = "current_thread")]
pub(super) async fn run(arguments: BackupArguments) -> ExitCode {
    let BackupArguments { database, force, target } = arguments;
    match store::backup(&database, &target, force).await {
        Ok(summary) => {
            let total: u64 = summary.jobs.values().sum();
            let states: Vec<_> = summary.jobs.iter().map(|(state, n)| format!("{n} {state}")).collect();
            let states = if states.is_empty() { String::new() } else { format!(": {}", states.join(", ")) };
            println!("{}: {:.1} MB, {total} jobs{states}", target.display(), summary.bytes as f64 / 1e6);
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("herringbone backup: {error}");
            ExitCode::FAILURE
        }
    }
}
