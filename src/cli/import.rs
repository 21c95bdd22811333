//! `herringbone import`: makes a job document of a gear model of another program.

use super::input::read_bytes;
use super::output;
use super::problem;
use clap::Args;
use herringbone::api::{MAX_IMPORT_BYTES, Problem};
use herringbone_exchange::{FaceWidth, Import, ImportOptions, PointChoice, import};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Args)]
pub(super) struct ImportArguments {
    /// Gear model: REXS 1.0 to 2.0.0 as XML, JSON or zip, or a KISSsoft calculation of a gear pair (`.Z12`); `-` reads
    /// standard input.
    file: PathBuf,
    /// Pair to take: its number in the list that is shown where there are several, or the id of its stage.
    #[arg(long, value_name = "N")]
    pair: Option<u64>,
    /// Make a symmetric double-helical pair of a single-helical stage: each half a copy of it, the torque doubled.
    #[arg(long)]
    mirror: bool,
    /// Gap between the halves of a mirrored pair; 30 mm when it is not given.
    #[arg(long, value_name = "MM", value_parser = positive)]
    gap_mm: Option<f64>,
    /// Torque of the whole pinion, in place of the file's.
    #[arg(long, value_name = "T", value_parser = finite, allow_negative_numbers = true)]
    torque_nm: Option<f64>,
    /// Load case to take: its number, counted from 1, or `heaviest`; the first when it is not given.
    #[arg(long, value_name = "N|heaviest", value_parser = point)]
    point: Option<PointChoice>,
    /// What the face width of a double-helical pair is in a `.Z12` file: of both halves with the groove, or of one
    /// half.
    #[arg(long, value_name = "total|half", default_value = "total", value_parser = face_width)]
    face_width_is: FaceWidth,
    /// Write the job document to this file instead of standard output.
    #[arg(short, long, value_name = "JOB.json")]
    output: Option<PathBuf>,
    /// Write the report as JSON to this file, beside the one for people on standard error.
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,
}

pub(super) fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| "give a finite number".to_owned())
}

fn positive(text: &str) -> Result<f64, String> {
    finite(text).and_then(|value| if value >= 0.0 { Ok(value) } else { Err("give 0 or more".to_owned()) })
}

fn face_width(text: &str) -> Result<FaceWidth, String> {
    match text {
        "total" => Ok(FaceWidth::Total),
        "half" => Ok(FaceWidth::Half),
        _ => Err("give total or half".to_owned()),
    }
}

fn point(text: &str) -> Result<PointChoice, String> {
    match text {
        "heaviest" => Ok(PointChoice::Heaviest),
        number => match number.parse() {
            Ok(number) if number > 0 => Ok(PointChoice::Number(number)),
            _ => Err("give a number from 1, or heaviest".to_owned()),
        },
    }
}

pub(super) fn run(arguments: ImportArguments) -> ExitCode {
    let bytes = match read_bytes(&arguments.file, MAX_IMPORT_BYTES as u64) {
        Ok(bytes) => bytes,
        Err(error) => {
            eprintln!("{}: {error}", arguments.file.display());
            return ExitCode::from(2);
        }
    };
    let options = ImportOptions {
        pair: arguments.pair,
        mirror: arguments.mirror,
        gap_width_mm: arguments.gap_mm,
        torque_nm: arguments.torque_nm,
        point: arguments.point.unwrap_or_default(),
        face_width: arguments.face_width_is,
    };
    let imported = match import(&bytes, &options) {
        Ok(imported) => imported,
        Err(refusal) => {
            problem::print(&Problem::from(refusal));
            return ExitCode::from(2);
        }
    };
    eprint!("{}", summary(&imported));
    let report = arguments.report.map(|path| output::write_json(Some(&path), &imported));
    let document = output::write_json(arguments.output.as_deref(), &imported.document);
    match report.unwrap_or(Ok(())).and(document) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// The report for people.
fn summary(imported: &Import) -> String {
    let Import { source, pair, alternatives, operating_points, .. } = imported;
    let format = source.format.to_uppercase();
    let (version, application) = (&source.version, &source.application);
    let mut text = format!("{format} {version} by {application}: pair {}, {}\n", pair.number, pair.label);
    let mut line = |arguments: std::fmt::Arguments| {
        // Writing to a text does not fail.
        let _ = writeln!(text, "{arguments}");
    };
    for other in alternatives {
        line(format_args!("  also in the file: pair {}, {}", other.number, other.label));
    }
    if operating_points.len() > 1 {
        for point in operating_points {
            let chosen = if point.chosen { ", taken" } else { "" };
            let number = |value: Option<f64>| value.map_or("?".to_owned(), |value| value.to_string());
            let share = point.share.map(|share| format!(", share {share}")).unwrap_or_default();
            let (speed, torque) = (number(point.pinion_speed_rpm), number(point.pinion_torque_nm));
            line(format_args!("  load case {}: {speed} r/min, {torque} N·m{share}{chosen}", point.number));
        }
    }
    line(format_args!("taken ({}):", imported.taken.len()));
    for taken in &imported.taken {
        let why = taken.why.as_deref().map(|why| format!(" ({why})")).unwrap_or_default();
        let unit = taken.unit.as_deref().filter(|_| !taken.value.is_null()).map(|unit| format!(" {unit}"));
        let unit = unit.unwrap_or_default();
        line(format_args!("  {} = {}{unit} ← {}{why}", taken.pointer, shown(&taken.value), taken.from));
    }
    line(format_args!("assumed ({}):", imported.assumed.len()));
    for assumed in &imported.assumed {
        line(format_args!("  {} = {}: {}", assumed.pointer, shown(&assumed.value), assumed.why));
    }
    line(format_args!("ignored ({}):", imported.ignored.len()));
    for ignored in &imported.ignored {
        let amount = ignored.amount.as_deref().map(|amount| format!(" = {amount}")).unwrap_or_default();
        line(format_args!("  {}{amount}: {}", ignored.from, ignored.why));
    }
    for check in &imported.checks {
        let verdict = if check.agrees { "agrees" } else { "DIFFERS" };
        line(format_args!("check: {} {} in the file, {} here: {verdict}", check.name, check.file, check.ours));
    }
    for warning in &imported.warnings {
        line(format_args!("warning: {} {}", warning.pointer, warning.detail));
    }
    text
}

/// A value in a line.
fn shown(value: &Value) -> String {
    match value {
        Value::Null => "left open".to_owned(),
        Value::Array(items) => format!("{} entries", items.len()),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
