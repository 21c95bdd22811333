//! Client of the service's HTTP interface: submits documents and returns results.

use herringbone_tools::Failure;
use herringbone_tools::service::{Connection, Service};
use serde_json::Value;
use std::time::{Duration, Instant};
use tempfile::TempDir;

pub(crate) type Outcome<T> = Result<T, Failure>;

/// The running service, with the numbers of jobs and operating points requested so far.
pub(crate) struct Bench {
    connection: Connection,
    service: Service,
    _directory: TempDir,
    pub jobs: usize,
    pub points: usize,
}

/// An input varied by a sweep, and further inputs that take the same values.
pub(crate) struct Axis<'a> {
    pub pointer: &'a str,
    pub also: &'a [&'a str],
    pub values: &'a [f64],
}

/// A sweep's points, in the order of the axes (the first one fastest; those that were not solved have an `error`), and
/// the time they took, s.
pub(crate) struct Swept {
    pub points: Vec<Value>,
    pub seconds: f64,
}

impl Bench {
    pub(crate) fn start() -> Outcome<Self> {
        let directory = tempfile::tempdir()?;
        let service = Service::start(&directory.path().join("study.db"), &[])?;
        Ok(Self { connection: service.connect()?, service, _directory: directory, jobs: 0, points: 0 })
    }

    /// Processor time that the service has used.
    pub(crate) fn processor_s(&self) -> f64 {
        self.service.processor_s()
    }

    /// The result of a document.
    ///
    /// # Errors
    /// The message of the service, if it refuses the document or cannot solve it.
    pub(crate) fn result(&mut self, document: &Value) -> Outcome<Value> {
        let path = self.solved(document)?;
        Ok(self.connection.json("GET", &format!("{path}/result"), "")?)
    }

    /// The result, or the code and the message of the first violation of a refused document.
    pub(crate) fn result_or_refusal(&mut self, document: &Value) -> Outcome<Result<Value, String>> {
        let answer = self.connection.json("POST", "/api/v1/jobs", &document.to_string())?;
        match answer["errors"][0]["code"].as_str() {
            Some(code) => Ok(Err(code.replace('-', " "))),
            None => self.result(document).map(Ok),
        }
    }

    /// The result with recorded channels, each as (time in s, values).
    pub(crate) fn series(&mut self, document: &Value, channels: &[&str]) -> Outcome<(Value, Vec<Vec<f64>>)> {
        let mut document = document.clone();
        document["analysis"]["channels"] = channels.into();
        document["analysis"]["samples_per_mesh_period"] = 1024.into();
        let path = self.solved(&document)?;
        let result = self.connection.json("GET", &format!("{path}/result"), "")?;
        let read = |channel: &&str| -> Outcome<Vec<f64>> {
            let series = self.connection.json("GET", &format!("{path}/series/{channel}?method=none"), "")?;
            let values = series["y"].as_array().ok_or_else(|| series.to_string())?;
            values.iter().map(|value| value.as_f64().ok_or_else(|| "a sample is missing".into())).collect()
        };
        let series = channels.iter().map(read).collect::<Outcome<_>>()?;
        Ok((result, series))
    }

    /// A sweep of a document over one or two axes.
    pub(crate) fn sweep(&mut self, document: &Value, axes: &[Axis]) -> Outcome<Swept> {
        let mut document = document.clone();
        document["kind"] = "sweep".into();
        let axis = |Axis { pointer, also, values }: &Axis| serde_json::json!({"pointer": pointer, "also": also, "values": values});
        document["axes"] = axes.iter().map(axis).collect();
        let began = Instant::now();
        let mut result = self.result(&document)?;
        let seconds = began.elapsed().as_secs_f64();
        let Value::Array(points) = result["sweep"]["points"].take() else { return Err("a sweep has no points".into()) };
        self.points += points.len();
        Ok(Swept { points, seconds })
    }

    /// Submits a document and waits until it is solved; its path.
    fn solved(&mut self, document: &Value) -> Outcome<String> {
        self.jobs += 1;
        let path = self.connection.submit(document)?;
        let ended = |job: &Value| !matches!(job["state"].as_str(), Some("queued" | "running"));
        let job = self.connection.until(&path, Duration::from_millis(3), ended)?;
        if job["state"] != "succeeded" {
            return Err(job.to_string().into());
        }
        Ok(path)
    }
}

/// The number at a JSON pointer.
///
/// # Errors
/// If there is no number at the pointer.
pub(crate) fn number(value: &Value, pointer: &str) -> Outcome<f64> {
    value.pointer(pointer).and_then(Value::as_f64).ok_or_else(|| format!("no number at {pointer}").into())
}
