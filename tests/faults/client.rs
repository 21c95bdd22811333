//! A small HTTP client over a plain socket: whatever breaks is an error, nothing waits for ever.

use serde_json::Value;
use std::io::{Error, ErrorKind, Read, Result, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

/// Longest silence of the service that is put up with; longer than any `Prefer: wait` and any wait for a lock.
const PATIENCE: Duration = Duration::from_secs(40);

/// Status, headers (names in lower case) and body.
#[derive(Debug, Clone)]
pub(crate) struct Answer {
    pub status: u16,
    headers: Vec<(String, String)>,
    pub text: String,
}

impl Answer {
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.headers.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// The body as JSON; null when it is none.
    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.text).unwrap_or_default()
    }

    /// Whether it is the problem with this code.
    pub(crate) fn is_problem(&self, status: u16, code: &str) -> bool {
        self.status == status && self.json()["code"] == code
    }
}

/// One request on a connection of its own.
///
/// # Errors
/// No connection is made, it breaks, or the answer ends early.
pub(crate) fn send(
    address: SocketAddr,
    method: &str,
    path: &str,
    headers: &[(&str, &str)],
    body: &str,
) -> Result<Answer> {
    let mut stream = open(address, method, path, headers, body)?;
    let mut bytes = Vec::new();
    stream.read_to_end(&mut bytes)?;
    parse(&bytes)
}

/// The connection with the request sent, for whoever reads the answer as it comes.
///
/// # Errors
/// No connection is made, or it breaks.
pub(crate) fn open(
    address: SocketAddr,
    method: &str,
    path: &str,
    headers: &[(&str, &str)],
    body: &str,
) -> Result<TcpStream> {
    let mut stream = TcpStream::connect_timeout(&address, PATIENCE)?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut text = format!("{method} {path} HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\n");
    for (name, value) in headers {
        text += &format!("{name}: {value}\r\n");
    }
    if !body.is_empty() {
        text += &format!("content-type: application/json\r\ncontent-length: {}\r\n", body.len());
    }
    text += "\r\n";
    text += body;
    stream.write_all(text.as_bytes())?;
    Ok(stream)
}

fn parse(bytes: &[u8]) -> Result<Answer> {
    let broken = |what: &str| Error::new(ErrorKind::UnexpectedEof, what.to_owned());
    let at = bytes.windows(4).position(|four| four == b"\r\n\r\n").ok_or_else(|| broken("no end of the head"))?;
    let head = std::str::from_utf8(&bytes[..at]).map_err(|_| broken("head"))?;
    let mut lines = head.split("\r\n");
    let status = lines.next().and_then(|line| line.split(' ').nth(1)).and_then(|status| status.parse().ok());
    let status = status.ok_or_else(|| broken("status"))?;
    let headers: Vec<_> = lines
        .filter_map(|line| line.split_once(':'))
        .map(|(name, value)| (name.to_ascii_lowercase(), value.trim().to_owned()))
        .collect();
    let mut answer = Answer { status, headers, text: String::new() };
    let body = &bytes[at + 4..];
    let body = match (answer.header("content-length"), answer.header("transfer-encoding")) {
        (Some(length), _) if length.parse() != Ok(body.len()) => return Err(broken("the body ends early")),
        (None, Some("chunked")) => joined(body).ok_or_else(|| broken("a chunk ends early"))?,
        _ => body.to_vec(),
    };
    answer.text = String::from_utf8(body).map_err(|_| broken("not UTF-8"))?;
    Ok(answer)
}

/// The chunks of a body; none when the last one is missing.
fn joined(mut chunks: &[u8]) -> Option<Vec<u8>> {
    let mut body = Vec::new();
    loop {
        let at = chunks.windows(2).position(|two| two == b"\r\n")?;
        let length = usize::from_str_radix(std::str::from_utf8(&chunks[..at]).ok()?, 16).ok()?;
        if length == 0 {
            return Some(body);
        }
        chunks = &chunks[at + 2..];
        body.extend_from_slice(chunks.get(..length)?);
        chunks = chunks.get(length + 2..)?;
    }
}
