//! A service with its NATS, and what its database says.

use crate::audit::{Accepted, Findings, audit};
use crate::documents;
use crate::nats::NatsServer;
use crate::program::{PATIENCE, Program, Service};
use crate::worker::Worker;
use serde_json::{Value, json};
use sqlx::sqlite::SqliteConnectOptions;
use sqlx::{ConnectOptions, Connection, Row};
use std::path::Path;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A NATS server and the command line of a service that uses it.
pub(crate) struct Setting {
    pub nats: NatsServer,
    pub program: Program,
    folder: TempDir,
}

impl Setting {
    /// `None` where there is no NATS server.
    pub(crate) fn new(options: &[&str]) -> Option<Self> {
        Self::with_ack_wait("2", options)
    }

    /// With this time, in seconds, for which a worker may be silent.
    pub(crate) fn with_ack_wait(ack_wait_s: &str, options: &[&str]) -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder");
        let nats = NatsServer::start(folder.path())?;
        let url = nats.url();
        let program =
            Program::at(folder.path()).with(&["--queue", &url, "--space", "test", "--ack-wait-s", ack_wait_s]);
        Some(Self { nats, program: program.with(options), folder })
    }

    pub(crate) fn folder(&self) -> &Path {
        self.folder.path()
    }

    pub(crate) fn worker(&self) -> Worker {
        self.worker_of("test")
    }

    pub(crate) fn worker_of(&self, space: &str) -> Worker {
        Worker::start(self.folder(), &self.nats.url(), &["--space", space])
    }

    /// Ends the service and audits its database.
    pub(crate) fn audit(&self, service: Service, jobs: &[&str]) -> Findings {
        audit_of(&self.program, service, jobs)
    }
}

/// Ends a service, of which all jobs have ended, and audits its database.
pub(crate) fn audit_of(program: &Program, service: Service, jobs: &[&str]) -> Findings {
    assert!(service.end().0.success());
    let ids = jobs.iter().map(|path| path.rsplit('/').next().unwrap_or_default().to_owned()).collect();
    let findings = audit(program.database(), &Accepted { ids, keys: Vec::new() });
    assert_eq!(findings.broken, [""; 0], "{}", program.log());
    assert!(!program.log().contains("panicked"), "{}", program.log());
    assert_eq!(number(program.database(), "SELECT COUNT(*) FROM chunks"), 0, "chunks of ended jobs are left");
    findings
}

/// One number from a database, which a service may have open.
pub(crate) fn number(database: &Path, sql: &'static str) -> i64 {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    runtime.block_on(async {
        let options = SqliteConnectOptions::new().filename(database).read_only(true);
        let mut connection = options.connect().await.expect("the database opens");
        let row = sqlx::query(sql).fetch_one(&mut connection).await.expect("a row");
        connection.close().await.expect("closed");
        row.get(0)
    })
}

/// Changes a database that no service has open.
pub(crate) fn change(database: &Path, sql: &'static str) {
    change_all(database, sql);
}

/// As [`change`], by a statement that is put together.
pub(crate) fn change_all(database: &Path, sql: &str) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    runtime.block_on(async {
        let mut connection = SqliteConnectOptions::new().filename(database).connect().await.expect("it opens");
        let done = sqlx::query(sqlx::AssertSqlSafe(sql)).execute(&mut connection).await.expect("executed");
        assert!(done.rows_affected() > 0);
        connection.close().await.expect("closed");
    });
}

/// Waits until something holds.
pub(crate) fn wait_until(what: &str, holds: impl Fn() -> bool) {
    let deadline = Instant::now() + PATIENCE;
    while !holds() {
        assert!(Instant::now() < deadline, "not in time: {what}");
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Waits until the database says a number that is enough.
pub(crate) fn wait_for_rows(setting: &Setting, least: i64) {
    let database = setting.program.database();
    wait_until("rows", || number(database, "SELECT COUNT(*) FROM sweep_points") >= least);
}

/// A sweep whose points take some ten milliseconds each.
pub(crate) fn slow_sweep(points: u32) -> Value {
    let mut document = documents::sweep(points);
    document["analysis"] =
        json!({"method": "integrate", "mesh_periods": 2000, "record_mesh_periods": 1, "samples_per_mesh_period": 8});
    document
}

/// The result of a job and its rows, without what differs between two runs: times.
pub(crate) fn outcome(service: &Service, path: &str) -> (Value, Value) {
    let mut result = service.get(&format!("{path}/result"));
    if let Some(numerics) = result["numerics"].as_object_mut() {
        numerics.remove("wall_ms");
    }
    (result, service.get(&format!("{path}/series")))
}
