//! The real program as a process of its own, killed in the middle of a job.

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

struct Service {
    process: Child,
    address: String,
}

impl Service {
    fn start(directory: &Path) -> Self {
        let mut process = Command::new(env!("CARGO_BIN_EXE_herringbone"))
            .args(["serve", "--listen", "127.0.0.1:0", "--log", "warn", "--database"])
            .arg(directory.join("jobs.db"))
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        BufReader::new(process.stdout.take().expect("output")).read_line(&mut line).expect("a line");
        let address = line.trim_end().trim_end_matches('/').rsplit('/').next().expect("an address").to_owned();
        Self { process, address }
    }

    fn request(&self, method: &str, path: &str, body: &str) -> Value {
        let mut stream = TcpStream::connect(&self.address).expect("a connection");
        let head = format!(
            "{method} {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\ncontent-type: application/json\r\n\
             content-length: {}\r\n\r\n",
            body.len()
        );
        stream.write_all(head.as_bytes()).and_then(|()| stream.write_all(body.as_bytes())).expect("sent");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("an answer");
        let (_, body) = answer.split_once("\r\n\r\n").expect("head and body");
        serde_json::from_str(body).expect("JSON")
    }

    /// The job as soon as it runs for the `attempt`th time.
    fn running(&self, path: &str, attempt: i64) -> Value {
        let deadline = Instant::now() + Duration::from_secs(30);
        loop {
            let job = self.request("GET", path, "");
            if job["state"] == "running" && job["attempt"] == attempt {
                return job;
            }
            assert!(Instant::now() < deadline, "{job}");
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

#[test]
fn a_job_outlives_the_process_that_was_killed() {
    let directory = tempfile::tempdir().expect("temporary directory");
    let mut sweep: Value = serde_json::from_str(include_str!("../../examples/speed_sweep.json")).expect("JSON");
    sweep["axes"][0]["points"] = json!(100_000);
    let service = Service::start(directory.path());
    let path = service.request("POST", "/api/v1/jobs", &sweep.to_string())["links"]["self"]
        .as_str()
        .expect("a path")
        .to_owned();
    service.running(&path, 1);
    drop(service);
    let service = Service::start(directory.path());
    service.running(&path, 2);
    let asked = service.request("POST", &format!("{path}/cancel"), "");
    assert!(asked["cancel_requested_at"].is_string(), "{asked}");
    let deadline = Instant::now() + Duration::from_secs(30);
    while service.request("GET", &path, "")["state"] != "canceled" {
        assert!(Instant::now() < deadline, "the job does not stop");
        std::thread::sleep(Duration::from_millis(5));
    }
}
