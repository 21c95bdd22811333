//! Workers as processes of their own.

use crate::program::executable;
use std::fs::OpenOptions;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

/// A worker with one thread; killed when it is dropped.
pub(crate) struct Worker {
    process: Child,
    log: PathBuf,
}

impl Worker {
    pub(crate) fn start(folder: &Path, url: &str, options: &[&str]) -> Self {
        Self::start_with(folder, url, options, &[])
    }

    /// With variables of the environment besides.
    pub(crate) fn start_with(folder: &Path, url: &str, options: &[&str], variables: &[(&str, &str)]) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let log = folder.join(format!("worker-{}.log", COUNT.fetch_add(1, Ordering::Relaxed)));
        let output = OpenOptions::new().create(true).append(true).open(&log).expect("a log");
        let mut command = Command::new(executable());
        command.envs(variables.iter().copied());
        command.args(["worker", "--nats", url, "--log", "herringbone=debug,info"]).args(options);
        if !options.contains(&"--threads") {
            command.args(["--threads", "1"]);
        }
        let process = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(output).spawn().expect("a process");
        Self { process, log }
    }

    fn signal(&self, name: &str) {
        let id = self.process.id().to_string();
        assert!(Command::new("kill").args([name, &id]).status().expect("kill runs").success());
    }

    /// Stops it, as a machine that hangs.
    pub(crate) fn pause(&self) {
        self.signal("-STOP");
    }

    pub(crate) fn go_on(&self) {
        self.signal("-CONT");
    }

    pub(crate) fn kill(mut self) {
        self.process.kill().expect("killed");
        self.process.wait().expect("it ends");
    }

    /// Asks it to end.
    pub(crate) fn end(mut self) -> ExitStatus {
        self.signal("-TERM");
        self.process.wait().expect("it ends")
    }

    pub(crate) fn log(&self) -> String {
        std::fs::read_to_string(&self.log).unwrap_or_default()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
