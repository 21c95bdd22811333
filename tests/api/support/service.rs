//! The real program over a database of its own, and its jobs.

use super::Program;
use serde_json::Value;
use std::path::Path;
use std::time::{Duration, Instant};

/// A service over `jobs.db` in a directory; killed when it is dropped.
pub(crate) struct Service(Program);

impl Service {
    pub(crate) fn start(directory: &Path) -> Self {
        Self::start_with(directory, &["--log", "warn"])
    }

    pub(crate) fn start_with(directory: &Path, arguments: &[&str]) -> Self {
        let database = directory.join("jobs.db");
        let here = ["--listen", "127.0.0.1:0", "--database", database.to_str().expect("a path in UTF-8")];
        Self(Program::start(&[&here, arguments].concat()))
    }

    /// Status and body.
    pub(crate) fn exchange(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> (u16, String) {
        let mut lines = format!("content-type: application/json\r\ncontent-length: {}\r\n", body.len());
        for (name, value) in headers {
            lines += &format!("{name}: {value}\r\n");
        }
        self.0.exchange(method, path, &lines, body)
    }

    pub(crate) fn request(&self, method: &str, path: &str, body: &str) -> Value {
        let (_, body) = self.exchange(method, path, &[], body);
        serde_json::from_str(&body).expect("JSON")
    }

    pub(crate) fn program(&self) -> &Program {
        &self.0
    }

    /// Submits a job; its path.
    pub(crate) fn submit(&self, document: &Value) -> String {
        let job = self.request("POST", "/api/v1/jobs", &document.to_string());
        job["links"]["self"].as_str().unwrap_or_else(|| panic!("{job}")).to_owned()
    }

    /// The job as soon as it is as asked for.
    pub(crate) fn until(&self, path: &str, enough: impl Fn(&Value) -> bool) -> Value {
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
    pub(crate) fn running(&self, path: &str, attempt: i64) -> Value {
        self.until(path, |job| job["state"] == "running" && job["attempt"] == attempt)
    }

    /// Stops as an operator does; the lines of the log.
    pub(crate) fn stop(self) -> Vec<String> {
        self.0.stop().lines().map(str::to_owned).collect()
    }
}
