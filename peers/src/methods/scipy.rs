//! SciPy, in a process of its own (`scipy_peer.py`) that is asked for one run at a time and measures its time itself.

use std::cell::RefCell;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::rc::Rc;

use super::{Method, Run, Whose, ladder, straight_or_restarted};
use crate::case::{Case, REFERENCE};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/scipy_peer.py");

struct Process {
    child: Child,
    questions: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Process {
    fn start(python: &str) -> Result<Self, String> {
        let mut child = Command::new(python)
            .args([SCRIPT, REFERENCE])
            // One thread, as everybody has.
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

struct Peer {
    method: &'static str,
    restart: bool,
    process: Rc<RefCell<Process>>,
}

pub fn all(python: &str) -> Vec<Box<dyn Method>> {
    let process = match Process::start(python) {
        Ok(process) => Rc::new(RefCell::new(process)),
        Err(e) => {
            eprintln!("SciPy left out: {e}");
            return Vec::new();
        }
    };
    ["DOP853", "RK45", "LSODA", "dop853", "odeint"]
        .into_iter()
        .flat_map(|method| [false, true].map(|restart| (method, restart)))
        .map(|(method, restart)| Box::new(Peer { method, restart, process: process.clone() }) as _)
        .collect()
}

impl Method for Peer {
    fn name(&self) -> String {
        let method = match self.method {
            "dop853" => "ode(dop853)",
            "odeint" => "odeint (LSODA)",
            other => other,
        };
        straight_or_restarted(&format!("SciPy {method}"), self.restart)
    }

    fn whose(&self) -> Whose {
        Whose::Scipy
    }

    fn tolerances(&self) -> Vec<f64> {
        // Whole decades: a run takes up to a second.
        let all = if matches!(self.method, "RK45") { ladder(3, 8) } else { ladder(3, 10) };
        all.into_iter().step_by(2).collect()
    }

    fn run(&mut self, case: &Case, tolerance: f64, periods: u64) -> Result<Run, String> {
        let question = format!("{} {} {tolerance:e} {periods} {}", case.name, self.method, u8::from(self.restart));
        let answer = self.process.borrow_mut().ask(&question)?;
        let numbers: Result<Vec<f64>, _> = answer.split_whitespace().map(str::parse).collect();
        match numbers.as_deref() {
            Ok([seconds, state @ ..]) if state.len() == 24 => {
                Ok(Run { seconds: Some(*seconds), state: state.try_into().expect("24 states") })
            }
            _ => Err(format!("SciPy: {}", answer.trim())),
        }
    }
}
