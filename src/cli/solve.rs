//! `herringbone solve`: solves a document in this process, without service or database.

use super::cache::DirectoryStages;
use super::input::{invalid, read_document};
use super::{problem, table};
use clap::Args;
use herringbone::api::{CsvField, CsvWriter, Decimal, Problem, write_bearing_forces};
use herringbone_job::document::JobDocument;
use herringbone_job::study::{
    self, CheckedJob, NoStageStore, RecordedChannel, SolveContext, SolveError, Stage, StageStore,
};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

#[derive(Debug, Args)]
pub(super) struct SolveArguments {
    /// Job document (JSON); `-` reads standard input.
    file: PathBuf,
    /// Write a recorded channel, full resolution, as CSV (`t_s,value`); may be given several times.
    #[arg(long, value_name = "CHANNEL=FILE.csv", value_parser = series_target)]
    series: Vec<(String, PathBuf)>,
    /// Write the forces that the bearings transmit, by mesh order, as CSV (`shaft,bearing,position_mm,axis,mesh_order,
    /// frequency_hz,amplitude_n,phase_rad`; order 0 is the mean).
    #[arg(long, value_name = "FILE.csv")]
    bearing_forces: Option<PathBuf>,
    /// Decimal sign in these files: `comma` writes them as spreadsheets read them whose language has a decimal comma
    /// (fields between semicolons, a byte order mark).
    #[arg(long, value_name = "point|comma", default_value = "point", value_parser = decimal)]
    decimal: Decimal,
    /// Keep finished stages (finite elements of a gear, contact analyses) in this directory and reuse them.
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Print the headline numbers for people instead of the result JSON.
    #[arg(long)]
    table: bool,
}

fn series_target(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((channel, file)) if !channel.is_empty() && !file.is_empty() => Ok((channel.to_owned(), file.into())),
        _ => Err("give CHANNEL=FILE.csv".to_owned()),
    }
}

pub(super) fn decimal(text: &str) -> Result<Decimal, String> {
    let decimal = Decimal::ALL.iter().find(|(name, _)| *name == text).map(|(_, decimal)| *decimal);
    decimal.ok_or_else(|| "give point or comma".to_owned())
}

pub(super) fn run(arguments: SolveArguments) -> ExitCode {
    let mut document = match read_document(&arguments.file) {
        Ok(document) => document,
        Err(code) => return code,
    };
    record(&mut document, &arguments.series);
    let stages: Box<dyn StageStore> = match arguments.cache {
        None => Box::new(NoStageStore),
        Some(directory) => match DirectoryStages::open(directory.clone()) {
            Ok(stages) => Box::new(stages),
            Err(error) => {
                eprintln!("--cache {}: {error}", directory.display());
                return ExitCode::from(2);
            }
        },
    };
    let job = match CheckedJob::new(document) {
        Ok(job) => job,
        Err(error) => return invalid(error),
    };
    let outcome = match solve(&job, &*stages) {
        Ok(outcome) => outcome,
        Err(error) => {
            problem::print(&Problem::from(error));
            return ExitCode::FAILURE;
        }
    };
    for (channel, path) in &arguments.series {
        let Some(series) = outcome.series.iter().find(|series| study::is_channel(channel, &series.name)) else {
            let known: Vec<_> = outcome.series.iter().map(|series| series.name.as_str()).collect();
            let known = if known.is_empty() { "none in this kind of job".to_owned() } else { known.join(", ") };
            eprintln!("--series {channel}: no such channel; recorded: {known}");
            return ExitCode::from(2);
        };
        if let Err(error) = write_csv(series, path, arguments.decimal) {
            eprintln!("{}: {error}", path.display());
            return ExitCode::FAILURE;
        }
    }
    if let Some(path) = &arguments.bearing_forces {
        let response = outcome.result.response.as_ref().filter(|response| !response.bearings.is_empty());
        let Some(response) = response else {
            eprintln!("--bearing-forces: no bearings in this job; one of kind response with design.shafts has them");
            return ExitCode::from(2);
        };
        let written = std::fs::File::create(path).and_then(|file| {
            write_bearing_forces(file, &response.bearings, response.mesh_frequency_hz, arguments.decimal)
        });
        if let Err(error) = written {
            eprintln!("{}: {error}", path.display());
            return ExitCode::FAILURE;
        }
    }
    let written = if arguments.table {
        table::write(&mut std::io::stdout().lock(), &outcome.result)
    } else {
        write_json(&outcome.result)
    };
    // A closed pipe is not an error: the reader needed no more.
    match written {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            eprintln!("standard output: {error}");
            ExitCode::FAILURE
        }
        _ => ExitCode::SUCCESS,
    }
}

/// Adds the channels of `--series` to those of a document that does not record all.
fn record(document: &mut JobDocument, series: &[(String, PathBuf)]) {
    if let Some(channels) = &mut document.analysis.channels {
        channels.extend(series.iter().map(|(channel, _)| channel.clone()));
    }
}

fn solve(job: &CheckedJob, stages: &dyn StageStore) -> Result<study::Outcome, SolveError> {
    let started = Instant::now();
    let bar = progress_bar();
    let progress = |stage: Stage, fraction: f64| {
        bar.set_message(stage.as_str());
        bar.set_position((fraction * 1000.0) as u64);
    };
    let outcome = study::solve(
        job,
        &SolveContext {
            stages,
            progress: &progress,
            clock_ms: &|| started.elapsed().as_secs_f64() * 1e3,
            ..SolveContext::none()
        },
    );
    bar.finish_and_clear();
    outcome.map(|mut outcome| {
        outcome.result.note_not_finite();
        outcome
    })
}

fn progress_bar() -> ProgressBar {
    if !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let style = ProgressStyle::with_template("{msg:>9} {bar:40} {percent:>3} % {elapsed}");
    ProgressBar::new(1000).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

fn write_json(result: &herringbone_job::result::JobResult) -> std::io::Result<()> {
    // Standard output alone is written line by line.
    let mut out = std::io::BufWriter::with_capacity(1 << 16, std::io::stdout().lock());
    serde_json::to_writer_pretty(&mut out, result)?;
    writeln!(out)?;
    out.flush()
}

fn write_csv(series: &RecordedChannel, path: &PathBuf, decimal: Decimal) -> std::io::Result<()> {
    let mut writer = CsvWriter::with_mark(std::fs::File::create(path)?, decimal)?;
    writer.write_record(["t_s", "value"].map(CsvField::Text))?;
    for (index, value) in series.values.iter().enumerate() {
        let time = format!("{:.12e}", series.t0_s + index as f64 * series.dt_s);
        let value = format!("{value:.17e}");
        writer.write_record([&time, &value].map(|number| CsvField::FormattedNumber(number)))?;
    }
    writer.into_inner().map(drop)
}
