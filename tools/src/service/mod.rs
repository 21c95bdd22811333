//! The release program beside this one, as a process on loopback.

mod connection;

pub use connection::Connection;

use crate::Failure;
use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::path::Path;
use std::process::{Child, Command, Stdio};

/// A running service; it is killed when dropped.
#[derive(Debug)]
pub struct Service {
    process: Child,
    /// Listen address of the service.
    pub address: SocketAddr,
}

impl Service {
    /// Starts `herringbone serve` on a free port, with a database file and further options.
    ///
    /// # Errors
    /// If the program does not stand beside this one, or does not say where it listens.
    pub fn start(database: &Path, options: &[&str]) -> Result<Self, Failure> {
        let program = std::env::current_exe()?.with_file_name("herringbone");
        let mut process = Command::new(program)
            .args(["serve", "--listen", "127.0.0.1:0", "--log", "error", "--database"])
            .arg(database)
            .args(options)
            .stdout(Stdio::piped())
            .spawn()?;
        let mut line = String::new();
        BufReader::new(process.stdout.take().ok_or("no output")?).read_line(&mut line)?;
        let address = line.trim_end().trim_end_matches('/').rsplit('/').next().unwrap_or_default().parse()?;
        Ok(Self { process, address })
    }

    /// A new connection.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn connect(&self) -> std::io::Result<Connection> {
        Connection::to(self.address)
    }

    /// A line of `/proc/PID/status` in MB: `VmRSS` now, `VmHWM` at most so far.
    pub fn memory_mb(&self, line: &str) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.process.id())).unwrap_or_default();
        let found = status.lines().find_map(|text| text.strip_prefix(line)?.strip_prefix(':'));
        let kb = found.and_then(|text| text.trim().trim_end_matches(" kB").parse::<f64>().ok());
        kb.unwrap_or(f64::NAN) * 1024.0 / 1e6
    }

    /// Processor time that the program has used so far, all threads.
    pub fn processor_s(&self) -> f64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.process.id())).unwrap_or_default();
        // The command's name may hold spaces; behind its bracket, user and system time are the 12th and 13th field.
        let fields = stat.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11).take(2);
        fields.filter_map(|ticks| ticks.parse::<f64>().ok()).sum::<f64>() / TICKS
    }
}

/// Ticks in a second of the times in `/proc/PID/stat` (USER_HZ of Linux).
const TICKS: f64 = 100.0;

impl Drop for Service {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
