//! Run time against error of other programs and ours, on the reference cases of the equations of motion, in one run.
//!
//! `scripts/peers` builds and starts it. Arguments: `--python PATH` (interpreter for SciPy and heyoka; without it they
//! are left out), `--plots FOLDER` (draws peers_*.svg there), `--rounds N`. The tables go to standard output as
//! Markdown.
//!
//! Every method integrates 20 mesh periods from the reference's start, on one thread. The time is processor time per
//! mesh period, set-up included; the error is [`case::ReferenceCase::error`] after 20 periods, in the chaotic case B
//! after 5, because the motion itself multiplies later errors.

mod case;
mod equations;
mod measure;
mod methods;
mod plot;
mod tables;

use std::path::PathBuf;
use std::process::ExitCode;

struct Arguments {
    python: Option<String>,
    plots: Option<PathBuf>,
    rounds: usize,
}

fn arguments() -> Result<Arguments, String> {
    let mut out = Arguments { python: None, plots: None, rounds: 15 };
    let mut given = std::env::args().skip(1);
    while let Some(name) = given.next() {
        let value = given.next().ok_or_else(|| format!("{name}: a value is missing"))?;
        match name.as_str() {
            "--python" => out.python = Some(value),
            "--plots" => out.plots = Some(value.into()),
            "--rounds" => out.rounds = value.parse().map_err(|_| format!("--rounds: not a number: {value}"))?,
            _ => return Err(format!("unknown argument {name}")),
        }
    }
    Ok(out)
}

fn run() -> Result<(), String> {
    let arguments = arguments()?;
    // All work on this thread, since its processor time is measured.
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global().map_err(|e| e.to_string())?;
    let cases = case::all();
    let mut methods = methods::all(arguments.python.as_deref());
    let results = measure::all(&cases, &mut methods, arguments.rounds);
    println!("{}", tables::all(&cases, &results));
    if let Some(folder) = arguments.plots {
        for case in &cases {
            let path = folder.join(format!("peers_{}.svg", case.name.to_lowercase()));
            std::fs::write(&path, plot::draw(case, &results)).map_err(|e| format!("{}: {e}", path.display()))?;
        }
    }
    Ok(())
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
