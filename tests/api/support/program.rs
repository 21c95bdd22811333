//! The real program as a process of its own.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::process::{Child, Command, Output, Stdio};
use std::thread::JoinHandle;

const PROGRAM: &str = env!("CARGO_BIN_EXE_herringbone");

/// A service that runs until it is dropped.
pub(crate) struct Program {
    process: Child,
    address: SocketAddr,
    log: Option<JoinHandle<String>>,
}

/// `herringbone serve` with arguments, and none of the variables that are set here.
fn serve(arguments: &[&str]) -> Command {
    let mut command = Command::new(PROGRAM);
    command.arg("serve").args(arguments);
    without_variables(command)
}

fn without_variables(mut command: Command) -> Command {
    for (name, _) in std::env::vars().filter(|(name, _)| name.starts_with("HERRINGBONE_")) {
        command.env_remove(name);
    }
    command
}

impl Program {
    /// Starts it and waits until it listens.
    pub(crate) fn start(arguments: &[&str]) -> Self {
        Self::of(serve(arguments))
    }

    /// The same with few files.
    pub(crate) fn start_with_files(files: u32, arguments: &[&str]) -> Self {
        let mut command = Command::new("sh");
        let script = format!("ulimit -n {files}; exec \"$0\" serve \"$@\"");
        command.args(["-c", &script, PROGRAM]).args(arguments);
        Self::of(without_variables(command))
    }

    /// The output of a start that has to fail.
    pub(crate) fn refused(arguments: &[&str], variables: &[(&str, &str)]) -> Output {
        let output = serve(arguments).envs(variables.iter().copied()).output().expect("the program starts");
        assert!(!output.status.success(), "{output:?}");
        output
    }

    fn of(mut command: Command) -> Self {
        let command = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut process = command.spawn().expect("the program starts");
        let mut log = process.stderr.take().expect("a log");
        let log = std::thread::spawn(move || {
            let mut text = String::new();
            let _ = log.read_to_string(&mut text);
            text
        });
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("output")).read_line(&mut line).expect("a line");
        let address = line.trim_end().trim_end_matches('/').rsplit('/').next().and_then(|text| text.parse().ok());
        let Some(address) = address else {
            let _ = process.kill();
            panic!("no address in {line:?}; {}", log.join().unwrap_or_default());
        };
        Self { process, address, log: Some(log) }
    }

    /// The loopback address on which it listens.
    pub(crate) fn address(&self) -> SocketAddr {
        SocketAddr::from(([127, 0, 0, 1], self.address.port()))
    }

    /// The most memory that it has held so far, in MB (`VmHWM`: peak resident set size).
    pub(crate) fn peak_memory_mb(&self) -> f64 {
        let status = std::fs::read_to_string(format!("/proc/{}/status", self.process.id())).expect("a process");
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("its memory");
        line.trim().trim_end_matches(" kB").parse::<f64>().expect("a number") / 1e3
    }

    /// Status and body.
    pub(crate) fn get(&self, path: &str) -> (u16, String) {
        self.get_with(path, "")
    }

    /// The same with header lines.
    pub(crate) fn get_with(&self, path: &str, headers: &str) -> (u16, String) {
        self.exchange("GET", path, headers, "")
    }

    /// Status and body of a request with header lines and a body.
    pub(crate) fn exchange(&self, method: &str, path: &str, headers: &str, body: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(self.address()).expect("a connection");
        // In HTTP/1.0 no answer comes in chunks.
        let request =
            format!("{method} {path} HTTP/1.0\r\nhost: localhost\r\nconnection: close\r\n{headers}\r\n{body}");
        stream.write_all(request.as_bytes()).expect("sent");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        let (head, body) = answer.split_once("\r\n\r\n").expect("head and body");
        let status = head.split(' ').nth(1).and_then(|word| word.parse().ok()).expect("a status");
        (status, body.to_owned())
    }

    /// Ends it; what it has logged.
    pub(crate) fn end(mut self) -> String {
        let _ = self.process.kill();
        self.logged()
    }

    /// Has it end itself, as an operator does; what it has logged.
    pub(crate) fn stop(mut self) -> String {
        let id = self.process.id().to_string();
        assert!(Command::new("kill").args(["-TERM", &id]).status().expect("kill runs").success());
        assert!(self.process.wait().expect("it ends").success());
        self.logged()
    }

    fn logged(&mut self) -> String {
        let _ = self.process.wait();
        self.log.take().and_then(|log| log.join().ok()).unwrap_or_default()
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
