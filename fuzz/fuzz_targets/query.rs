//! Bytes as the path, query and headers of requests that read: never a panic, never a failure of the service, and a
//! problem whenever something is refused. The input's first byte chooses the path; then lines: the query, and headers
//! as `name: value`.

#![no_main]

use axum::Router;
use axum::body::Body;
use axum::http::{HeaderName, HeaderValue, Request, StatusCode, Uri};
use herringbone::api::{self, Access, AccessConfig, AppState, HttpConfig, Pages};
use herringbone::store::{Store, StoreConfig};
use herringbone::work::{Jobs, Solver, WorkConfig};
use herringbone_job::DocumentError;
use herringbone_job::document::JobDocument;
use herringbone_job::result::JobResult;
use herringbone_job::study::{self, CheckedJob, Outcome, RecordedChannel, SolveContext, SolveError};
use http_body_util::BodyExt;
use jiff::Timestamp;
use libfuzzer_sys::fuzz_target;
use std::sync::{Arc, OnceLock};
use tempfile::TempDir;
use tokio::runtime::{Builder, Runtime};
use tower::ServiceExt;

/// Every job succeeds at once, with one channel.
struct AtOnce;

impl Solver for AtOnce {
    fn check(&self, document: JobDocument) -> Result<CheckedJob, DocumentError> {
        CheckedJob::new(document)
    }

    fn input_hash(&self, document: &JobDocument) -> String {
        study::input_hash(document)
    }

    fn solve(&self, _: &CheckedJob, _: &SolveContext) -> Result<Outcome, SolveError> {
        let values = (0..5000).map(|index| f64::from(index).sin()).collect();
        let (quantity, unit) = ("acceleration".to_owned(), "m/s2".to_owned());
        let channel =
            RecordedChannel { name: "a_x_left".to_owned(), quantity, unit, t0_s: 0.5, dt_s: 1e-4, rms: 0.7, values };
        Ok(Outcome { result: JobResult::default(), series: vec![channel] })
    }

    fn version(&self) -> &'static str {
        "at-once"
    }
}

struct Service {
    runtime: Runtime,
    router: Router,
    /// Path of a job that succeeded.
    job: String,
    _directory: TempDir,
}

impl Service {
    fn start() -> Self {
        let runtime = Builder::new_current_thread().enable_all().build().expect("a runtime");
        let directory = tempfile::tempdir().expect("a directory");
        let (router, job) = runtime.block_on(async {
            let store = Store::open(&StoreConfig::at(directory.path().join("jobs.db"))).await.expect("the store opens");
            let jobs = Jobs::start(store, &WorkConfig::default(), Arc::new(AtOnce), Arc::new(Timestamp::now))
                .await
                .expect("the workers start");
            let http = HttpConfig::default();
            let access = Access::new(&AccessConfig::default(), http.listen).expect("access without a token");
            let state = AppState::new(jobs, Timestamp::now());
            let router = api::router(state, &http, &access, Pages::default());
            let request = Request::post("/api/v1/jobs")
                .header("content-type", "application/json")
                .header("prefer", "wait=30")
                .body(Body::from(include_str!("../../examples/table1.json")))
                .expect("a request");
            let response = router.clone().oneshot(request).await.expect("an answer");
            assert_eq!(response.status(), StatusCode::OK);
            let path = response.headers()["location"].to_str().expect("a path").to_owned();
            (router, path)
        });
        Self { runtime, router, job, _directory: directory }
    }

    async fn ask(&self, request: Request<Body>) {
        let shown = format!("{request:?}");
        let response = self.router.clone().oneshot(request).await.expect("an answer");
        let (status, headers) = (response.status(), response.headers().clone());
        let body = response.into_body().collect().await.expect("a whole body").to_bytes();
        assert!(status.as_u16() < 500, "{status} for {shown}");
        if status.as_u16() >= 400 {
            assert_eq!(headers["content-type"], "application/problem+json", "{shown}");
            if !headers.contains_key("content-encoding") {
                let problem: serde_json::Value = serde_json::from_slice(&body).expect("JSON");
                assert_eq!(problem["status"], status.as_u16(), "{shown}");
            }
        }
    }
}

/// The request that the bytes stand for, if they stand for one.
fn request(job: &str, bytes: &[u8]) -> Option<Request<Body>> {
    let (choice, rest) = bytes.split_first()?;
    let mut lines = rest.split(|byte| *byte == b'\n');
    let query = std::str::from_utf8(lines.next()?).ok()?;
    let path = match choice % 8 {
        0 => "/api/v1/jobs".to_owned(),
        1 => format!("{job}/series/a_x_left"),
        2 => format!("{job}/points"),
        3 => job.to_owned(),
        4 => format!("{job}/result"),
        5 => format!("{job}/series/{}", query.split('?').next().unwrap_or_default()),
        6 => format!("/api/v1/jobs/{}", query.split('?').next().unwrap_or_default()),
        _ => format!("/problems/{}", query.split('?').next().unwrap_or_default()),
    };
    let uri = match choice % 8 {
        0..=4 => format!("{path}?{query}"),
        _ => path,
    };
    let mut request = Request::get(uri.parse::<Uri>().ok()?);
    for line in lines.take(8) {
        let colon = line.iter().position(|byte| *byte == b':')?;
        let (name, value) = line.split_at(colon);
        request =
            request.header(HeaderName::from_bytes(name).ok()?, HeaderValue::from_bytes(value[1..].trim_ascii()).ok()?);
    }
    // A wait would be granted, and only make the run slow.
    request.body(Body::empty()).ok().filter(|request| !request.headers().contains_key("prefer"))
}

fuzz_target!(|bytes: &[u8]| {
    static SERVICE: OnceLock<Service> = OnceLock::new();
    let service = SERVICE.get_or_init(Service::start);
    if let Some(request) = request(&service.job, bytes) {
        service.runtime.block_on(service.ask(request));
    }
});
