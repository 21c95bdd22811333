//! `herringbone batch`: solves every file of a folder, in this process or by a service, and goes on where it was
//! stopped.

mod files;
mod output;
mod service;
mod summary;

use super::cache::DirectoryStages;
use clap::{Args, ValueEnum};
use files::InputFile;
use herringbone::api::{Decimal, Problem};
use herringbone_exchange::ImportOptions;
use herringbone_job::document::JobDocument;
use herringbone_job::study::{self, CheckedJob, NoStageStore, SolveContext, StageStore};
use output::{Record, Status};
use service::Service;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Jobs that a service has at once: enough to keep its workers busy.
const AT_ONCE_AT_A_SERVICE: usize = 20;

#[derive(Debug, Args)]
pub(super) struct BatchArguments {
    /// Folder with job documents (`.json`) and gear models (`.rexs`, `.rexsj`, `.rexsz`, …), also in folders below.
    folder: PathBuf,
    /// Folder of the results; `results` in the folder when it is not given.
    #[arg(long, value_name = "FOLDER")]
    out: Option<PathBuf>,
    /// Files that are solved at once; as many as processors when it is not given, 20 with `--server`.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
    /// Files beside each result (JSON): csv and xlsx have the numbers of the result, of a sweep its rows; npz and mat
    /// the series, of a sweep its rows.
    #[arg(long, value_name = "FORMATS", value_delimiter = ',')]
    format: Vec<Format>,
    /// Decimal sign of CSV files, the summary among them.
    #[arg(long, value_name = "point|comma", default_value = "point", value_parser = super::solve::decimal)]
    decimal: Decimal,
    /// Solve again what has its result already.
    #[arg(long)]
    force: bool,
    /// Take only every Nth file, from the Ith on: for job arrays of a cluster.
    #[arg(long, value_name = "I/N", value_parser = part)]
    part: Option<(usize, usize)>,
    /// Have a service solve the files, at this address; what was submitted goes on there when the batch is stopped.
    #[arg(long, value_name = "URL", conflicts_with = "cache")]
    server: Option<String>,
    /// File with the token of that service.
    #[arg(long, env = "HERRINGBONE_TOKEN_FILE", value_name = "FILE", requires = "server")]
    token_file: Option<PathBuf>,
    /// Keep finished stages (finite elements of a gear, contact analyses) in this directory and reuse them.
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Make double-helical pairs of the single-helical stages of gear models.
    #[arg(long)]
    mirror: bool,
    /// Torque of the whole pinion, in place of that of gear models.
    #[arg(long, value_name = "T", value_parser = super::import::finite, allow_negative_numbers = true)]
    torque_nm: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
enum Format {
    Csv,
    Xlsx,
    Npz,
    Mat,
}

fn part(text: &str) -> Result<(usize, usize), String> {
    let wrong = || "give I/N with I from 1 to N".to_owned();
    let (index, of) = text.split_once('/').ok_or_else(wrong)?;
    match (index.parse(), of.parse()) {
        (Ok(index), Ok(of)) if (1..=of).contains(&index) => Ok((index, of)),
        _ => Err(wrong()),
    }
}

pub(super) fn run(arguments: BatchArguments) -> ExitCode {
    match Batch::new(&arguments).and_then(|batch| batch.run()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

struct Batch<'a> {
    arguments: &'a BatchArguments,
    out: PathBuf,
    files: Vec<InputFile>,
    stages: Box<dyn StageStore + Sync>,
    service: Option<Service>,
    options: ImportOptions,
}

impl<'a> Batch<'a> {
    fn new(arguments: &'a BatchArguments) -> Result<Self, String> {
        let out = arguments.out.clone().unwrap_or_else(|| arguments.folder.join("results"));
        let told = |path: &std::path::Path, error: std::io::Error| format!("{}: {error}", path.display());
        std::fs::read_dir(&arguments.folder).map_err(|error| told(&arguments.folder, error))?;
        std::fs::create_dir_all(&out).map_err(|error| told(&out, error))?;
        let mut files = files::below(&arguments.folder, &out).map_err(|error| told(&arguments.folder, error))?;
        if let Some((index, of)) = arguments.part {
            files = files.into_iter().skip(index - 1).step_by(of).collect();
        }
        let stages: Box<dyn StageStore + Sync> = match &arguments.cache {
            None => Box::new(NoStageStore),
            Some(path) => Box::new(DirectoryStages::open(path.clone()).map_err(|error| told(path, error))?),
        };
        let options =
            ImportOptions { mirror: arguments.mirror, torque_nm: arguments.torque_nm, ..ImportOptions::default() };
        let token_file = arguments.token_file.as_deref();
        let service = arguments.server.as_deref().map(|url| Service::new(url, token_file)).transpose()?;
        Ok(Self { arguments, out, files, stages, service, options })
    }

    /// Solves the files; returns whether all of them have a result.
    fn run(&self) -> Result<bool, String> {
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        let pool =
            rayon::ThreadPoolBuilder::new().num_threads(processors).build().map_err(|error| error.to_string())?;
        let most = if self.service.is_some() { AT_ONCE_AT_A_SERVICE } else { processors };
        let at_once = self.arguments.jobs.map_or(most, usize::from).min(self.files.len().max(1));
        let (next, done, records) = (AtomicUsize::new(0), AtomicUsize::new(0), Mutex::new(Vec::new()));
        std::thread::scope(|scope| {
            for _ in 0..at_once {
                scope.spawn(|| {
                    while let Some(file) = self.files.get(next.fetch_add(1, Ordering::Relaxed)) {
                        let record = self.file(file, &pool);
                        let number = done.fetch_add(1, Ordering::Relaxed) + 1;
                        eprintln!("[{number}/{}] {}", self.files.len(), record.line());
                        records.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push(record);
                    }
                });
            }
        });
        let mut records = records.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        records.sort_by(|a, b| a.file.cmp(&b.file));
        let name = match self.arguments.part {
            None => "summary.csv".to_owned(),
            Some((index, of)) => format!("summary-{index}-of-{of}.csv"),
        };
        let path = self.out.join(name);
        summary::write(&path, &records, self.arguments.decimal)
            .map_err(|error| format!("{}: {error}", path.display()))?;
        eprint!("{}", summary::table(&records));
        println!("{}", path.display());
        Ok(records.iter().all(|record| record.status != Status::Failed))
    }

    /// The record of a file: solved, skipped or failed.
    fn file(&self, file: &InputFile, pool: &rayon::ThreadPool) -> Record {
        let started = Instant::now();
        let failed = |hash: Option<String>, problem: &Problem| {
            let mut record = Record::failed(&file.name, hash, problem);
            record.wall_s = started.elapsed().as_secs_f64();
            output::remember(&self.out, &record);
            record
        };
        let document = match file.read(&self.options) {
            Ok(document) => document,
            Err(problem) => return failed(None, &problem),
        };
        let hash = study::input_hash(&document);
        if !self.arguments.force
            && let Some(record) = output::known(&self.out, &file.name, &hash, &self.arguments.format)
        {
            return record;
        }
        if let Some(service) = &self.service {
            return match self.solve_by(service, file, hash.clone(), &document) {
                Ok(mut record) => {
                    record.wall_s = started.elapsed().as_secs_f64();
                    output::remember(&self.out, &record);
                    record
                }
                Err(problem) => failed(Some(hash), &problem),
            };
        }
        let job = match CheckedJob::new(document) {
            Ok(job) => job,
            Err(error) => return failed(Some(hash), &Problem::from(error)),
        };
        let clock_ms = || started.elapsed().as_secs_f64() * 1e3;
        let context = SolveContext { stages: &*self.stages, clock_ms: &clock_ms, ..SolveContext::none() };
        let mut outcome = match pool.install(|| study::solve(&job, &context)) {
            Ok(outcome) => outcome,
            Err(error) => return failed(Some(hash), &Problem::from(error)),
        };
        outcome.result.note_not_finite();
        let formats = (&*self.arguments.format, self.arguments.decimal);
        match output::write(&self.out, &file.name, hash.clone(), job.document(), &outcome, formats) {
            Ok(mut record) => {
                record.wall_s = started.elapsed().as_secs_f64();
                output::remember(&self.out, &record);
                record
            }
            Err(error) => failed(Some(hash), &unwritten(&error)),
        }
    }

    /// Has a service solve a document, and writes what it answers.
    fn solve_by(
        &self,
        service: &Service,
        file: &InputFile,
        hash: String,
        document: &JobDocument,
    ) -> Result<Record, Box<Problem>> {
        let path = service.solve(document)?;
        let result = service.result(&path)?;
        let mut files = Vec::new();
        for format in &self.arguments.format {
            // The numbers of a result without rows are in the result.
            if service::has_rows(document.kind) || matches!(format, Format::Npz | Format::Mat) {
                files.push((*format, service.file(&path, document.kind, *format, self.arguments.decimal)?));
            }
        }
        let formats = (&*self.arguments.format, self.arguments.decimal);
        output::write_answered(&self.out, &file.name, hash, document, &result, files, formats)
            .map_err(|error| Box::new(unwritten(&error)))
    }
}

fn unwritten(error: &std::io::Error) -> Problem {
    Problem::new(herringbone::api::ProblemCode::Internal, format!("the result could not be written: {error}"))
}
