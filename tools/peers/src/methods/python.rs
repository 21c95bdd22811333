//! Methods of SciPy and heyoka, each in a process of its own (`scipy_peer.py`, `heyoka_peer.py`) that does one run per
//! request and measures its time itself.

use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::rc::Rc;

use super::{Method, Origin, RunResult, ladder, straight_or_restarted};
use crate::case::{REFERENCE, ReferenceCase};

struct Process {
    child: Child,
    questions: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Process {
    fn start(python: &str, script: &str) -> Result<Self, String> {
        let script = format!("{}/{script}", env!("CARGO_MANIFEST_DIR"));
        let mut child = Command::new(python)
            .args([&script, REFERENCE])
            // One thread, as for all methods.
            .envs(["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"].map(|name| (name, "1")))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|e| format!("{python}: {e}"))?;
        let (questions, answers) = (child.stdin.take().ok_or("no pipe")?, child.stdout.take().ok_or("no pipe")?);
        Ok(Self { child, questions, answers: BufReader::new(answers) })
    }

    fn ask(&mut self, question: &str) -> Result<String, String> {
        let mut answer = String::new();
        writeln!(self.questions, "{question}").and_then(|()| self.questions.flush()).map_err(|e| e.to_string())?;
        self.answers.read_line(&mut answer).map_err(|e| e.to_string())?;
        Ok(answer)
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// One method of SciPy.
struct Scipy {
    method: &'static str,
    restart: bool,
    process: Rc<RefCell<Process>>,
}

/// Taylor series with events, compiled for the case; `motions` of it side by side.
struct Heyoka {
    motions: usize,
    process: Rc<RefCell<Process>>,
}

fn process(python: &str, script: &str) -> Option<Rc<RefCell<Process>>> {
    match Process::start(python, script) {
        Ok(process) => Some(Rc::new(RefCell::new(process))),
        Err(e) => {
            eprintln!("{script} left out: {e}");
            None
        }
    }
}

pub fn all(python: &str) -> Vec<Box<dyn Method>> {
    let mut out: Vec<Box<dyn Method>> = Vec::new();
    if let Some(process) = process(python, "heyoka_peer.py") {
        out.extend([8, 1].map(|motions| Box::new(Heyoka { motions, process: process.clone() }) as _));
    }
    if let Some(process) = process(python, "scipy_peer.py") {
        for method in ["DOP853", "RK45", "LSODA", "dop853", "odeint"] {
            out.extend([false, true].map(|restart| Box::new(Scipy { method, restart, process: process.clone() }) as _));
        }
    }
    out
}

/// Sends the request "CASE METHOD TOLERANCE PERIODS RESTART" and parses the reply.
fn ask(process: &RefCell<Process>, question: &str) -> Result<RunResult, String> {
    let answer = process.borrow_mut().ask(question)?;
    let numbers: Result<Vec<f64>, _> = answer.split_whitespace().map(str::parse).collect();
    match numbers.as_deref() {
        Ok([seconds, state @ ..]) if state.len() == 24 => {
            Ok(RunResult { seconds: Some(*seconds), state: state.try_into().expect("24 states") })
        }
        _ => Err(format!("no result: {}", answer.trim())),
    }
}

impl Method for Scipy {
    fn name(&self) -> String {
        let method = match self.method {
            "dop853" => "ode(dop853)",
            "odeint" => "odeint (LSODA)",
            other => other,
        };
        straight_or_restarted(&format!("SciPy {method}"), self.restart)
    }

    fn origin(&self) -> Origin {
        Origin::Scipy
    }

    fn tolerances(&self) -> Vec<f64> {
        // Whole decades: a run takes up to a second.
        let all = if self.method == "RK45" { ladder(3, 8) } else { ladder(3, 10) };
        all.into_iter().step_by(2).collect()
    }

    fn run(&mut self, case: &ReferenceCase, tolerance: f64, periods: u64) -> Result<RunResult, String> {
        let question = format!("{} {} {tolerance:e} {periods} {}", case.name, self.method, u8::from(self.restart));
        ask(&self.process, &question)
    }
}

impl Method for Heyoka {
    fn name(&self) -> String {
        let name = "heyoka Taylor with events";
        if self.motions > 1 { format!("{name}, {} side by side", self.motions) } else { name.into() }
    }

    fn origin(&self) -> Origin {
        Origin::Peer
    }

    fn tolerances(&self) -> Vec<f64> {
        // Whole decades: each is compiled.
        ladder(3, 14).into_iter().step_by(2).collect()
    }

    fn points(&self) -> usize {
        self.motions
    }

    fn run(&mut self, case: &ReferenceCase, tolerance: f64, periods: u64) -> Result<RunResult, String> {
        ask(&self.process, &format!("{} {} {tolerance:e} {periods} 1", case.name, self.motions))
    }
}
