//! Jobs of a batch that a service solves: submitted under a key, so that a batch that was stopped finds them again.

use super::Format;
use herringbone::api::{Decimal, Problem, ProblemCode};
use herringbone::webhook::tls_of_system;
use herringbone_job::document::{JobDocument, JobKind};
use http_body_util::{BodyExt, Full};
use hyper::body::Bytes;
use hyper::client::conn::http1;
use hyper::header::{AUTHORIZATION, HOST, RETRY_AFTER};
use hyper::{HeaderMap, Method, Request, Uri};
use hyper_util::rt::TokioIo;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::path::Path;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpStream;
use tokio_rustls::TlsConnector;
use tokio_rustls::rustls::pki_types::ServerName;

/// Longest wait for an answer; a request that waits for the end of a job waits for 30 s.
const ANSWER_WAIT: Duration = Duration::from_secs(300);
/// Tries of a request while the service does not answer, as over its restart, and the pause between two.
const TRIES: u32 = 30;
const RETRY_AFTER_ERROR: Duration = Duration::from_secs(2);
/// Longest pause that an answer may ask for.
const LONGEST_PAUSE_S: u64 = 60;

/// A service and how it is reached.
pub(super) struct Service {
    runtime: tokio::runtime::Runtime,
    host: String,
    port: u16,
    authority: String,
    tls: Option<TlsConnector>,
    token: Option<String>,
}

/// An answer that was read to its end.
struct Answer {
    status: u16,
    headers: HeaderMap,
    body: Vec<u8>,
}

impl Answer {
    fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_default()
    }

    /// The problem that it tells of.
    fn problem(&self) -> Box<Problem> {
        problem_of(&self.json(), || format!("the service answered with status {}", self.status))
    }
}

/// A problem as a service writes it.
fn problem_of(value: &Value, otherwise: impl Fn() -> String) -> Box<Problem> {
    let problem = serde_json::from_value(value.clone());
    Box::new(problem.unwrap_or_else(|_| Problem::new(ProblemCode::Internal, otherwise())))
}

fn unreachable(detail: String) -> Box<Problem> {
    Box::new(Problem::new(ProblemCode::StorageUnavailable, detail))
}

impl Service {
    /// A service at an address, with the token in a file.
    ///
    /// # Errors
    /// What is wrong with the address or the file.
    pub(super) fn new(url: &str, token_file: Option<&Path>) -> Result<Self, String> {
        let uri: Uri = url.parse().map_err(|error| format!("--server {url}: {error}"))?;
        let wrong = |what: &str| format!("--server {url}: {what}");
        let tls = match uri.scheme_str() {
            Some("http") => None,
            Some("https") => Some(tls_of_system()?),
            _ => return Err(wrong("give http://HOST:PORT or https://HOST:PORT")),
        };
        let authority = uri.authority().ok_or_else(|| wrong("there is no host"))?;
        if authority.as_str().contains('@') || !matches!(uri.path(), "" | "/") {
            return Err(wrong("give http://HOST:PORT or https://HOST:PORT, without a user and a path"));
        }
        let token = match token_file {
            None => None,
            Some(path) => {
                let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
                Some(text.trim().to_owned())
            }
        };
        let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build();
        Ok(Self {
            runtime: runtime.map_err(|error| error.to_string())?,
            host: authority.host().trim_matches(['[', ']']).to_owned(),
            port: authority.port_u16().unwrap_or(if tls.is_some() { 443 } else { 80 }),
            authority: authority.to_string(),
            tls,
            token,
        })
    }

    /// Submits a document and waits until its job has succeeded; the path of the job.
    ///
    /// # Errors
    /// The problem that the service told of, or that it is not reached.
    pub(super) fn solve(&self, document: &JobDocument) -> Result<String, Box<Problem>> {
        let body = serde_json::to_string(document)
            .map_err(|error| Box::new(Problem::new(ProblemCode::Internal, error.to_string())))?;
        let key = format!("batch-{}", hex::encode(Sha256::digest(&body)));
        let headers = [("idempotency-key", key.as_str()), ("content-type", "application/json")];
        let submitted = self.request(Method::POST, "/api/v1/jobs", &headers, &body)?;
        let mut job = submitted.json();
        let path = job["links"]["self"].as_str().map(str::to_owned).ok_or_else(|| submitted.problem())?;
        loop {
            match job["state"].as_str() {
                Some("succeeded") => return Ok(path),
                Some("failed") => return Err(problem_of(&job["error"], || "the job failed".to_owned())),
                Some("canceled") => {
                    return Err(Box::new(Problem::new(ProblemCode::JobNotSucceeded, "the job was canceled")));
                }
                _ => job = self.request(Method::GET, &path, &[("prefer", "wait=30")], "")?.json(),
            }
        }
    }

    /// The result of a job, as JSON.
    ///
    /// # Errors
    /// As [`Service::solve`].
    pub(super) fn result(&self, path: &str) -> Result<Vec<u8>, Box<Problem>> {
        Ok(self.request(Method::GET, &format!("{path}/result"), &[], "")?.body)
    }

    /// The rows of a job, or its series, in a form.
    ///
    /// # Errors
    /// As [`Service::solve`].
    pub(super) fn file(
        &self,
        path: &str,
        kind: JobKind,
        format: Format,
        decimal: Decimal,
    ) -> Result<Vec<u8>, Box<Problem>> {
        let (what, name) = (if has_rows(kind) { "points" } else { "series" }, format.name());
        let comma = if format == Format::Csv && decimal == Decimal::Comma { "&decimal=comma" } else { "" };
        Ok(self.request(Method::GET, &format!("{path}/{what}?format={name}{comma}"), &[], "")?.body)
    }

    /// An answer with a status below 400; waits while the service is busy or starts again.
    fn request(
        &self,
        method: Method,
        path: &str,
        headers: &[(&str, &str)],
        body: &str,
    ) -> Result<Answer, Box<Problem>> {
        let mut failures = 0;
        loop {
            let exchange = self.exchange(&method, path, headers, body);
            let pause = match self.runtime.block_on(async { tokio::time::timeout(ANSWER_WAIT, exchange).await }) {
                Ok(Ok(answer)) if answer.status < 400 => return Ok(answer),
                Ok(Ok(answer)) if answer.status == 503 || answer.status == 429 => {
                    let asked = answer.headers.get(RETRY_AFTER).and_then(|value| value.to_str().ok()?.parse().ok());
                    Duration::from_secs(asked.unwrap_or(1).clamp(1, LONGEST_PAUSE_S))
                }
                Ok(Ok(answer)) => return Err(answer.problem()),
                failed => {
                    failures += 1;
                    if failures == TRIES {
                        let detail = match failed {
                            Ok(Err(error)) => error,
                            _ => "no answer in time".to_owned(),
                        };
                        return Err(unreachable(format!("the service at {}: {detail}", self.authority)));
                    }
                    RETRY_AFTER_ERROR
                }
            };
            std::thread::sleep(pause);
        }
    }

    async fn exchange(
        &self,
        method: &Method,
        path: &str,
        headers: &[(&str, &str)],
        body: &str,
    ) -> Result<Answer, String> {
        let stream = TcpStream::connect((self.host.as_str(), self.port)).await.map_err(|error| error.to_string())?;
        let mut request = Request::builder().method(method).uri(path).header(HOST, self.authority.as_str());
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        if let Some(token) = &self.token {
            request = request.header(AUTHORIZATION, format!("Bearer {token}"));
        }
        let request = request.body(Full::new(Bytes::from(body.to_owned()))).map_err(|error| error.to_string())?;
        match &self.tls {
            None => send(stream, request).await,
            Some(tls) => {
                let name = ServerName::try_from(self.host.clone()).map_err(|error| error.to_string())?;
                send(tls.connect(name, stream).await.map_err(|error| error.to_string())?, request).await
            }
        }
    }
}

async fn send<S>(stream: S, request: Request<Full<Bytes>>) -> Result<Answer, String>
where
    S: AsyncRead + AsyncWrite + Unpin + Send + 'static,
{
    let (mut sender, connection) = http1::handshake(TokioIo::new(stream)).await.map_err(|error| error.to_string())?;
    // What goes wrong is told by the request.
    let connection = tokio::spawn(async move { drop(connection.await) });
    let answer = sender.send_request(request).await.map_err(|error| error.to_string())?;
    let (parts, body) = answer.into_parts();
    let body = body.collect().await.map_err(|error| error.to_string())?.to_bytes().to_vec();
    connection.abort();
    Ok(Answer { status: parts.status.as_u16(), headers: parts.headers, body })
}

pub(super) fn has_rows(kind: JobKind) -> bool {
    matches!(kind, JobKind::Sweep | JobKind::Optimise | JobKind::Tolerance)
}
