//! `herringbone worker`: computes for a service on another machine, in the foreground.

use super::cache::DirectoryStages;
use super::serve::{LogConfig, start_log};
use anyhow::Context;
use clap::Args;
use herringbone::work::StudySolver;
use herringbone::work::cluster::{WorkerConfig, run_worker};
use herringbone_job::study::StageStore;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use tokio::signal::unix::{SignalKind, signal};
use tokio_util::sync::CancellationToken;

#[derive(Debug, Args)]
pub(super) struct WorkerArguments {
    #[command(flatten)]
    worker: WorkerConfig,

    /// Keep finished stages (finite elements of a gear, contact analyses) in this directory and reuse them.
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,

    #[command(flatten)]
    log: LogConfig,
}

pub(super) fn run(arguments: WorkerArguments) -> ExitCode {
    start_log(&arguments.log);
    match work(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("herringbone worker: {error:#}");
            ExitCode::FAILURE
        }
    }
}

#[tokio::main]
async fn work(arguments: WorkerArguments) -> anyhow::Result<()> {
    let mut terminate = signal(SignalKind::terminate()).context("signal handler")?;
    let mut interrupt = signal(SignalKind::interrupt()).context("signal handler")?;
    let cache = match arguments.cache {
        None => None,
        Some(directory) => {
            let named = directory.display().to_string();
            let stages = DirectoryStages::open(directory).with_context(|| named)?;
            Some(Arc::new(stages) as Arc<dyn StageStore + Send + Sync>)
        }
    };
    let closing = CancellationToken::new();
    let asked = closing.clone();
    tokio::spawn(async move {
        tokio::select! {
            _ = terminate.recv() => {}
            _ = interrupt.recv() => {}
        }
        asked.cancel();
    });
    run_worker(&arguments.worker, Arc::new(StudySolver), cache, closing).await?;
    Ok(())
}
