//! The real program as a process of its own.

use serde_json::Value;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A service over `jobs.db` in a directory; killed when it is dropped.
pub struct Service {
    process: Child,
    address: String,
    log: PathBuf,
}

impl Service {
    pub fn start(directory: &Path) -> Self {
        Self::start_with(directory, &["--log", "warn"])
    }

    pub fn start_with(directory: &Path, arguments: &[&str]) -> Self {
        let log = directory.join("log");
        let mut process = Command::new(env!("CARGO_BIN_EXE_herringbone"))
            .args(["serve", "--listen", "127.0.0.1:0"])
            .args(arguments)
            .arg("--database")
            .arg(directory.join("jobs.db"))
            .stdout(Stdio::piped())
            .stderr(File::create(&log).expect("a file for the log"))
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("output")).read_line(&mut line).expect("a line");
        let address = line.trim_end().trim_end_matches('/').rsplit('/').next().expect("an address").to_owned();
        Self { process, address, log }
    }

    /// Status and body.
    pub fn exchange(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> (u16, String) {
        let mut stream = TcpStream::connect(&self.address).expect("a connection");
        let mut head = format!(
            "{method} {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\ncontent-type: application/json\r\n\
             content-length: {}\r\n",
            body.len()
        );
        for (name, value) in headers {
            head += &format!("{name}: {value}\r\n");
        }
        head += "\r\n";
        stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(body.as_bytes())).expect("sent");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        let (head, body) = answer.split_once("\r\n\r\n").expect("head and body");
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        (status, body.to_owned())
    }

    pub fn request(&self, method: &str, path: &str, body: &str) -> Value {
        let (_, body) = self.exchange(method, path, &[], body);
        serde_json::from_str(&body).expect("JSON")
    }

    /// Submits a job; its path.
    pub fn submit(&self, document: &Value) -> String {
        let job = self.request("POST", "/api/v1/jobs", &document.to_string());
        job["links"]["self"].as_str().unwrap_or_else(|| panic!("{job}")).to_owned()
    }

    /// The job as soon as it is as asked for.
    pub fn until(&self, path: &str, enough: impl Fn(&Value) -> bool) -> Value {
        let deadline = Instant::now() + Duration::from_secs(60);
        loop {
            let job = self.request("GET", path, "");
            if enough(&job) {
                return job;
            }
            assert!(Instant::now() < deadline, "{job}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// The job as soon as it runs for the `attempt`th time.
    pub fn running(&self, path: &str, attempt: i64) -> Value {
        self.until(path, |job| job["state"] == "running" && job["attempt"] == attempt)
    }

    /// Stops as an operator does; the lines of the log.
    pub fn stop(mut self) -> Vec<String> {
        let id = self.process.id().to_string();
        assert!(Command::new("kill").args(["-TERM", &id]).status().expect("kill runs").success());
        assert!(self.process.wait().expect("it ends").success());
        let log = std::fs::read_to_string(&self.log).expect("a log");
        log.lines().map(str::to_owned).collect()
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
