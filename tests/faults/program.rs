//! The real program as a process of its own: started, asked, killed, asked to end.

use crate::client::{self, Answer};
use serde_json::Value;
use std::fs::OpenOptions;
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for anything that has to happen.
pub(crate) const PATIENCE: Duration = Duration::from_secs(120);

/// The program: that of this build, or the one of `HERRINGBONE_PROGRAM`, as one that is optimised for measurements.
pub(crate) fn executable() -> String {
    std::env::var("HERRINGBONE_PROGRAM").unwrap_or_else(|_| env!("CARGO_BIN_EXE_herringbone").to_owned())
}

/// The command line of the program, which is started repeatedly on the same database.
#[derive(Clone)]
pub(crate) struct Program {
    directory: PathBuf,
    database: PathBuf,
    options: Vec<String>,
    /// Words before the program on the command line.
    wrapper: Vec<String>,
}

impl Program {
    /// Over `jobs.db` in a directory, with its log in `log` there.
    pub(crate) fn at(directory: &Path) -> Self {
        let (directory, database) = (directory.to_owned(), directory.join("jobs.db"));
        Self { directory, database, options: Vec::new(), wrapper: Vec::new() }
    }

    pub(crate) fn with(mut self, options: &[&str]) -> Self {
        self.options.extend(options.iter().map(|option| (*option).to_owned()));
        self
    }

    /// Started by another program, which has to become it (`exec`).
    pub(crate) fn under(mut self, wrapper: &[&str]) -> Self {
        self.wrapper = wrapper.iter().map(|word| (*word).to_owned()).collect();
        self
    }

    pub(crate) fn over(mut self, database: &Path) -> Self {
        self.database = database.to_owned();
        self
    }

    pub(crate) fn database(&self) -> &Path {
        &self.database
    }

    fn command(&self) -> Command {
        let mut words = self.wrapper.iter().cloned().chain([executable()]);
        let mut command = Command::new(words.next().unwrap_or_default());
        command.args(words).args(["serve", "--listen", "127.0.0.1:0", "--log", "info", "--database"]);
        command.arg(&self.database).args(&self.options);
        command
    }

    /// Starts it and waits until it serves.
    pub(crate) fn start(&self) -> Service {
        self.try_start().unwrap_or_else(|status| panic!("not started ({status}): {}", self.log()))
    }

    /// As [`Program::start`]; how it ended when it does not come to serve.
    pub(crate) fn try_start(&self) -> Result<Service, ExitStatus> {
        let log = OpenOptions::new().create(true).append(true).open(self.directory.join("log")).expect("a log");
        let mut process =
            self.command().stdout(Stdio::piped()).stderr(log).stdin(Stdio::null()).spawn().expect("a process");
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("output")).read_line(&mut line).expect("a line");
        let address = line.trim_end().trim_end_matches('/').rsplit('/').next().and_then(|text| text.parse().ok());
        match address {
            Some(address) => Ok(Service { process, address }),
            None => Err(process.wait().expect("it ends")),
        }
    }

    /// Starts it and kills it after this time, wherever it is then.
    pub(crate) fn start_and_kill(&self, after: Duration) {
        let mut process =
            self.command().stdout(Stdio::null()).stderr(Stdio::null()).stdin(Stdio::null()).spawn().expect("a process");
        std::thread::sleep(after);
        process.kill().expect("killed");
        process.wait().expect("it ends");
    }

    /// Everything that was logged since the first start.
    pub(crate) fn log(&self) -> String {
        std::fs::read_to_string(self.directory.join("log")).unwrap_or_default()
    }
}

/// A program that serves; killed when it is dropped.
pub(crate) struct Service {
    process: Child,
    pub address: SocketAddr,
}

impl Service {
    pub(crate) fn id(&self) -> u32 {
        self.process.id()
    }

    /// One request that has to be answered.
    pub(crate) fn send(&self, method: &str, path: &str, body: &str) -> Answer {
        let answer = client::send(self.address, method, path, &[], body);
        answer.unwrap_or_else(|error| panic!("{method} {path}: {error}"))
    }

    pub(crate) fn get(&self, path: &str) -> Value {
        self.send("GET", path, "").json()
    }

    /// Submits a job that has to be accepted; its path.
    pub(crate) fn submit(&self, document: &Value) -> String {
        let answer = self.send("POST", "/api/v1/jobs", &document.to_string());
        assert_eq!(answer.status, 202, "{}", answer.text);
        answer.header("location").expect("a location").to_owned()
    }

    /// The answer as soon as it is as asked for.
    pub(crate) fn until(&self, path: &str, enough: impl Fn(&Answer) -> bool) -> Answer {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let answer = self.send("GET", path, "");
            if enough(&answer) {
                return answer;
            }
            assert!(Instant::now() < deadline, "{path} stays: {} {}", answer.status, answer.text);
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// The job as soon as it is in this state.
    pub(crate) fn in_state(&self, path: &str, state: &str) -> Value {
        self.until(path, |answer| answer.json()["state"] == state).json()
    }

    /// The job as soon as it has ended.
    pub(crate) fn ended(&self, path: &str) -> Value {
        self.until(path, |answer| is_ended(&answer.json())).json()
    }

    /// kill −9; nothing is left of the process.
    pub(crate) fn kill(mut self) {
        self.process.kill().expect("killed");
        self.process.wait().expect("it ends");
    }

    /// Sends SIGTERM.
    pub(crate) fn ask_to_end(&self) {
        let asked = Command::new("kill").args(["-TERM", &self.id().to_string()]).status().expect("kill runs");
        assert!(asked.success());
    }

    /// Ends as an operator ends it: how, and after how long.
    pub(crate) fn end(mut self) -> (ExitStatus, Duration) {
        let asked = Instant::now();
        self.ask_to_end();
        (self.process.wait().expect("it ends"), asked.elapsed())
    }

    /// After [`Service::ask_to_end`].
    pub(crate) fn wait(mut self) -> ExitStatus {
        self.process.wait().expect("it ends")
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

pub(crate) fn is_ended(job: &Value) -> bool {
    ["succeeded", "failed", "canceled"].iter().any(|state| job["state"] == *state)
}
