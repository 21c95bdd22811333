//! A persistent HTTP/1.1 connection with one request at a time.

use serde_json::Value;
use std::io::{BufRead, BufReader, Error, ErrorKind, Read, Result, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

/// A persistent connection.
#[derive(Debug)]
pub struct Connection {
    stream: BufReader<TcpStream>,
    address: SocketAddr,
}

impl Connection {
    /// Opens a connection; an answer that takes longer than a minute is an error.
    ///
    /// # Errors
    /// If it cannot be opened.
    pub fn to(address: SocketAddr) -> Result<Self> {
        let stream = TcpStream::connect(address)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(Duration::from_secs(60)))?;
        Ok(Self { stream: BufReader::with_capacity(1 << 16, stream), address })
    }

    /// Sends a request; status and body of its answer.
    ///
    /// # Errors
    /// If the connection or the answer breaks off.
    pub fn send(&mut self, method: &str, path: &str, accept: &str, body: &str) -> Result<(u16, Vec<u8>)> {
        let length = body.len();
        let request = format!(
            "{method} {path} HTTP/1.1\r\nhost: {}\r\naccept: {accept}\r\ncontent-type: application/json\r\n\
             content-length: {length}\r\n\r\n{body}",
            self.address
        );
        self.stream.get_mut().write_all(request.as_bytes())?;
        let status = self.line()?.split(' ').nth(1).and_then(|status| status.parse().ok()).ok_or_else(broken)?;
        let (mut length, mut chunked) = (0, false);
        loop {
            let line = self.line()?.to_ascii_lowercase();
            match line.split_once(": ") {
                Some(("content-length", value)) => length = value.parse().map_err(|_| broken())?,
                Some(("transfer-encoding", _)) => chunked = true,
                Some(_) => {}
                None => break,
            }
        }
        let mut body = Vec::new();
        if !chunked {
            body.resize(length, 0);
            self.stream.read_exact(&mut body)?;
            return Ok((status, body));
        }
        loop {
            let size = usize::from_str_radix(&self.line()?, 16).map_err(|_| broken())?;
            let start = body.len();
            body.resize(start + size, 0);
            self.stream.read_exact(&mut body[start..])?;
            self.line()?;
            if size == 0 {
                return Ok((status, body));
            }
        }
    }

    /// Sends a request; the JSON of its answer, whatever its status.
    ///
    /// # Errors
    /// If the connection breaks off or the answer is not JSON.
    pub fn json(&mut self, method: &str, path: &str, body: &str) -> Result<Value> {
        let (_, body) = self.send(method, path, "application/json", body)?;
        serde_json::from_slice(&body).map_err(Error::other)
    }

    /// Submits a job document; the path of the job.
    ///
    /// # Errors
    /// The answer, where it is not a job.
    pub fn submit(&mut self, document: &Value) -> Result<String> {
        let job = self.json("POST", "/api/v1/jobs", &document.to_string())?;
        job["links"]["self"].as_str().map(str::to_owned).ok_or_else(|| Error::other(job.to_string()))
    }

    /// Reads a job again and again, with a pause between, until it meets a condition.
    ///
    /// # Errors
    /// As [`Connection::json`].
    pub fn until(&mut self, path: &str, pause: Duration, enough: impl Fn(&Value) -> bool) -> Result<Value> {
        loop {
            let job = self.json("GET", path, "")?;
            if enough(&job) {
                return Ok(job);
            }
            std::thread::sleep(pause);
        }
    }

    fn line(&mut self) -> Result<String> {
        let mut line = String::new();
        if self.stream.read_line(&mut line)? == 0 {
            return Err(broken());
        }
        Ok(line.trim_end().to_owned())
    }
}

fn broken() -> Error {
    Error::new(ErrorKind::UnexpectedEof, "the answer broke off")
}
