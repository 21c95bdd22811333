//! A service over a scripted solver, in this process and without a network.

mod answer;
mod breakpoints;
mod document;
mod program;
mod service;
mod solver;

pub(crate) use answer::{Answer, Event, EventStream};
pub(crate) use breakpoints::Breakpoints;
pub(crate) use document::{document, scripted, sweep};
pub(crate) use program::Program;
pub(crate) use service::Service;
pub(crate) use solver::ScriptedSolver;

use axum::Router;
use axum::body::Body;
use axum::http::{Method, Request};
use herringbone::api::{self, Access, AppState, HttpConfig, LoginRenderer, Pages};
use herringbone::store::{RetentionConfig, Store, StoreConfig};
use herringbone::web;
use herringbone::work::{Jobs, Solver, WorkConfig};
use jiff::Timestamp;
use serde_json::Value;
use std::sync::Arc;
use tempfile::TempDir;
use tower::ServiceExt;

/// A running service.
pub(crate) struct App {
    pub router: Router,
    pub jobs: Jobs,
    pub solver: Arc<ScriptedSolver>,
    directory: TempDir,
}

/// Two workers, a queue of ten.
pub(crate) fn small() -> WorkConfig {
    WorkConfig { workers: Some(2), threads: Some(2), queue_capacity: 10, drain_s: 5, ..WorkConfig::default() }
}

pub(crate) async fn app() -> App {
    app_with(small()).await
}

pub(crate) async fn app_with(work: WorkConfig) -> App {
    start(tempfile::tempdir().expect("temporary directory"), work, HttpConfig::default()).await
}

/// A service over `jobs.db` in a directory that is kept.
pub(crate) async fn app_at(directory: &std::path::Path) -> App {
    let other = tempfile::tempdir().expect("temporary directory");
    let work = WorkConfig { sweep_time_limit_s: 600, ..small() };
    start_with_store(&StoreConfig::at(directory.join("jobs.db")), other, work, HttpConfig::default()).await
}

/// A service with a request timeout of zero.
pub(crate) async fn impatient_app() -> App {
    let http = HttpConfig { request_timeout_s: 0, ..HttpConfig::default() };
    start(tempfile::tempdir().expect("temporary directory"), small(), http).await
}

/// A service with these HTTP settings.
pub(crate) async fn app_with_http(http: HttpConfig) -> App {
    start(tempfile::tempdir().expect("temporary directory"), small(), http).await
}

/// A service whose database may not grow beyond so many megabytes.
pub(crate) async fn limited_app(max_database_mb: u32) -> App {
    let directory = tempfile::tempdir().expect("temporary directory");
    let retention = RetentionConfig { keep_days: None, max_database_mb: Some(max_database_mb) };
    let store = StoreConfig { retention, ..StoreConfig::at(directory.path().join("jobs.db")) };
    start_with_store(&store, directory, small(), HttpConfig::default()).await
}

async fn start(directory: TempDir, work: WorkConfig, http: HttpConfig) -> App {
    start_with_store(&StoreConfig::at(directory.path().join("jobs.db")), directory, work, http).await
}

async fn start_with_store(store: &StoreConfig, directory: TempDir, work: WorkConfig, http: HttpConfig) -> App {
    let solver = Arc::new(ScriptedSolver::default());
    let store = Store::open(store).await.expect("store opens");
    let dyn_solver: Arc<dyn Solver> = solver.clone();
    let jobs = Jobs::start(store, &work, dyn_solver, Arc::new(Timestamp::now)).await.expect("jobs start");
    let state = AppState::new(jobs.clone(), Timestamp::now());
    let access = Access::new(&http.access, http.listen).expect("access");
    let pages = Pages {
        routes: web::routes(access.has_token()).route("/panics", axum::routing::get(panics)),
        not_found: axum::routing::any(async || (axum::http::StatusCode::NOT_FOUND, axum::response::Html("no page"))),
        login: LoginRenderer(|notice| web::login(notice.status, notice.next, notice.error)),
    };
    let router = api::router(state, &http, &access, pages);
    App { router, jobs, solver, directory }
}

/// These headers, and a host where they have none.
fn with_host<'a>(headers: &[(&'a str, &'a str)]) -> Vec<(&'a str, &'a str)> {
    let host = (!headers.iter().any(|(name, _)| *name == "host")).then_some(("host", "localhost"));
    headers.iter().copied().chain(host).collect()
}

async fn panics() -> &'static str {
    panic!("secret detail")
}

impl App {
    /// Sends a request with headers given as `name: value`; the host is localhost unless it is given.
    pub(crate) async fn send(
        &self,
        method: Method,
        path: &str,
        headers: &[(&str, &str)],
        body: impl Into<Body>,
    ) -> Answer {
        let mut request = Request::builder().method(method).uri(path);
        for (name, value) in with_host(headers) {
            request = request.header(name, value);
        }
        let request = request.body(body.into()).expect("a valid request");
        let response = self.router.clone().oneshot(request).await.expect("the router never fails");
        Answer::of(response).await
    }

    pub(crate) async fn get(&self, path: &str) -> Answer {
        self.send(Method::GET, path, &[], Body::empty()).await
    }

    pub(crate) async fn get_with(&self, path: &str, headers: &[(&str, &str)]) -> Answer {
        self.send(Method::GET, path, headers, Body::empty()).await
    }

    pub(crate) async fn post(&self, path: &str) -> Answer {
        self.send(Method::POST, path, &[], Body::empty()).await
    }

    pub(crate) async fn delete(&self, path: &str) -> Answer {
        self.send(Method::DELETE, path, &[], Body::empty()).await
    }

    /// `POST /jobs` with more headers than the media type.
    pub(crate) async fn submit_with(&self, document: &Value, headers: &[(&str, &str)]) -> Answer {
        let headers = [&[("content-type", "application/json")], headers].concat();
        self.send(Method::POST, "/api/v1/jobs", &headers, document.to_string()).await
    }

    /// `POST /jobs`; the job's path.
    pub(crate) async fn submit(&self, document: &Value) -> String {
        let answer = self.submit_with(document, &[]).await;
        assert_eq!(answer.status, 202, "{answer:?}");
        answer.header("location").to_owned()
    }

    /// Submits and waits for the end; the job's path and the ended job.
    pub(crate) async fn run(&self, document: &Value) -> (String, Value) {
        let path = self.submit(document).await;
        let job = self.ended(&path).await;
        (path, job)
    }

    /// Waits for the end of a job.
    pub(crate) async fn ended(&self, path: &str) -> Value {
        let answer = self.get_with(path, &[("prefer", "wait=30")]).await;
        assert!(!["queued", "running"].contains(&answer.json["state"].as_str().unwrap_or_default()), "{answer:?}");
        answer.json
    }

    /// Events of a job, read one by one.
    pub(crate) async fn events(&self, path: &str, headers: &[(&str, &str)]) -> EventStream {
        self.stream(&format!("{path}/events"), headers).await
    }

    /// Events from this path, read one by one.
    pub(crate) async fn stream(&self, path: &str, headers: &[(&str, &str)]) -> EventStream {
        let mut request = Request::builder().uri(path);
        for (name, value) in with_host(headers) {
            request = request.header(name, value);
        }
        let request = request.body(Body::empty()).expect("a valid request");
        EventStream::of(self.router.clone().oneshot(request).await.expect("the router never fails"))
    }

    /// Stops as a shutdown does and starts again over the same database.
    pub(crate) async fn restart(self) -> App {
        assert!(self.jobs.close().await, "running jobs did not stop");
        self.jobs.store().close().await;
        let App { router, jobs, solver, directory } = self;
        drop((router, jobs, solver));
        start(directory, small(), HttpConfig::default()).await
    }

    /// Stops as a shutdown does.
    pub(crate) async fn close(self) {
        assert!(self.jobs.close().await, "running jobs did not stop");
        self.jobs.store().close().await;
    }

    pub(crate) fn database(&self) -> std::path::PathBuf {
        self.directory.path().join("jobs.db")
    }
}
