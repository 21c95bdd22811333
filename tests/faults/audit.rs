//! Audit of a database against the answers of the service. Reads the file with its own SQL.

use sha2::{Digest, Sha256};
use sqlx::sqlite::{SqliteConnectOptions, SqliteConnection, SqliteRow};
use sqlx::{ConnectOptions, Connection, Row};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// The submissions that the service accepted.
#[derive(Debug, Default, Clone)]
pub(crate) struct Accepted {
    /// Ids of accepted jobs.
    pub ids: Vec<String>,
    /// Idempotency key and the id answered under it, as often as it was answered.
    pub keys: Vec<(String, String)>,
}

/// The findings of an audit.
#[derive(Debug, Default)]
pub(crate) struct Findings {
    /// Violations of the guarantees.
    pub broken: Vec<String>,
    /// Jobs by state.
    pub states: BTreeMap<String, usize>,
    /// Jobs that were started more than once.
    pub restarted: usize,
    /// Sweeps that went on from points of an earlier attempt.
    pub resumed_sweeps: usize,
    /// Points of sweeps and tolerance studies.
    pub points: usize,
}

struct Job {
    kind: String,
    state: String,
    revision: i64,
    attempt: i64,
    has_error: bool,
    input: String,
    key: Option<String>,
}

struct Event {
    revision: i64,
    state: String,
}

/// Reads the database, which no service may have open, and compares.
pub(crate) fn audit(database: &Path, accepted: &Accepted) -> Findings {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    runtime.block_on(async {
        let mut connection =
            SqliteConnectOptions::new().filename(database).connect().await.expect("the database opens");
        let findings = Audit { connection: &mut connection, findings: Findings::default() }.run(accepted).await;
        connection.close().await.expect("closed");
        findings
    })
}

struct Audit<'a> {
    connection: &'a mut SqliteConnection,
    findings: Findings,
}

impl Audit<'_> {
    async fn run(mut self, accepted: &Accepted) -> Findings {
        for pragma in ["PRAGMA integrity_check", "PRAGMA foreign_key_check"] {
            for row in self.rows(pragma).await {
                let said: String = row.try_get(0).unwrap_or_default();
                if said != "ok" {
                    self.breaks(format!("{pragma}: {said}"));
                }
            }
        }
        let jobs = self.jobs().await;
        self.nothing_is_lost(&jobs, accepted);
        self.each_ended_once(&jobs).await;
        self.results_are_those_of_succeeded_jobs(&jobs).await;
        self.sweeps_are_whole(&jobs).await;
        self.datasets_have_jobs().await;
        self.findings
    }

    fn breaks(&mut self, what: String) {
        self.findings.broken.push(what);
    }

    async fn rows(&mut self, sql: &'static str) -> Vec<SqliteRow> {
        sqlx::query(sql).fetch_all(&mut *self.connection).await.expect("rows")
    }

    async fn jobs(&mut self) -> HashMap<String, Job> {
        let sql = "SELECT id, kind, state, revision, attempt, error IS NOT NULL AS has_error, input, idempotency_key FROM jobs";
        let rows = self.rows(sql).await;
        let job = |row: &SqliteRow| Job {
            kind: row.get("kind"),
            state: row.get("state"),
            revision: row.get("revision"),
            attempt: row.get("attempt"),
            has_error: row.get("has_error"),
            input: row.get("input"),
            key: row.get("idempotency_key"),
        };
        rows.iter().map(|row| (row.get("id"), job(row))).collect()
    }

    fn nothing_is_lost(&mut self, jobs: &HashMap<String, Job>, accepted: &Accepted) {
        for id in accepted.ids.iter().chain(accepted.keys.iter().map(|(_, id)| id)) {
            if !jobs.contains_key(id) {
                self.breaks(format!("{id} was accepted and is not there"));
            }
        }
        let mut first: HashMap<&str, &str> = HashMap::new();
        for (key, id) in &accepted.keys {
            let known = *first.entry(key).or_insert(id);
            if known != id {
                self.breaks(format!("the key {key} was answered with {known} and with {id}"));
            }
            if jobs.get(id).is_some_and(|job| job.key.as_deref() != Some(key)) {
                self.breaks(format!("{id} does not have the key {key}"));
            }
        }
    }

    /// From queued by permitted steps to one end, which is the last that happened.
    async fn each_ended_once(&mut self, jobs: &HashMap<String, Job>) {
        let mut events: HashMap<String, Vec<Event>> = HashMap::new();
        for row in self.rows("SELECT job_id, revision, state FROM job_events ORDER BY job_id, revision").await {
            let event = Event { revision: row.get("revision"), state: row.get("state") };
            events.entry(row.get("job_id")).or_default().push(event);
        }
        for (id, job) in jobs {
            *self.findings.states.entry(job.state.clone()).or_default() += 1;
            self.findings.restarted += usize::from(job.attempt > 1);
            let events = events.remove(id).unwrap_or_default();
            let ends = events.iter().filter(|event| is_end(&event.state)).count();
            if ends != 1 {
                self.breaks(format!("{id} ended {ends} times"));
            }
            if events.last().is_none_or(|last| last.state != job.state || last.revision > job.revision) {
                self.breaks(format!("{id} is {}, which its history does not end with", job.state));
            }
            if events.first().is_none_or(|first| first.state != "queued")
                || events.windows(2).any(|two| !is_step(&two[0].state, &two[1].state))
            {
                let words: Vec<_> = events.iter().map(|event| event.state.as_str()).collect();
                self.breaks(format!("{id} went through {}", words.join(", ")));
            }
            let starts = events.iter().filter(|event| event.state == "running").count();
            if starts as i64 != job.attempt {
                self.breaks(format!("{id} was started {starts} times and counts {}", job.attempt));
            }
            if job.has_error != (job.state == "failed") {
                self.breaks(format!("{id} is {} and has_error is {}", job.state, job.has_error));
            }
        }
        for id in events.keys() {
            self.breaks(format!("{id} has a history and does not exist"));
        }
    }

    async fn results_are_those_of_succeeded_jobs(&mut self, jobs: &HashMap<String, Job>) {
        let mut results: HashMap<String, usize> = HashMap::new();
        for row in self.rows("SELECT job_id FROM results").await {
            *results.entry(row.get("job_id")).or_default() += 1;
        }
        for (id, job) in jobs {
            let n = results.remove(id).unwrap_or_default();
            if n != usize::from(job.state == "succeeded") {
                self.breaks(format!("{id} is {} and has {n} results", job.state));
            }
        }
        for id in results.keys() {
            self.breaks(format!("{id} has a result and does not exist"));
        }
    }

    /// What was recorded belongs to a result, or is the rows of a sweep that did not succeed.
    async fn datasets_have_jobs(&mut self) {
        let sql = "SELECT 'the dataset ' || id || ' has no job' FROM datasets WHERE id NOT IN (SELECT dataset_id FROM results WHERE dataset_id IS NOT NULL) \
                   AND id NOT IN (SELECT id FROM jobs WHERE state <> 'succeeded') \
                   UNION ALL SELECT DISTINCT dataset_id || ' has samples and no result' FROM series_samples \
                   WHERE dataset_id NOT IN (SELECT dataset_id FROM results WHERE dataset_id IS NOT NULL) \
                   UNION ALL SELECT job_id || ' has a result without a dataset' FROM results WHERE dataset_id IS NULL \
                   UNION ALL SELECT dataset_id || ' has no samples of ' || channel FROM series WHERE NOT EXISTS \
                   (SELECT 1 FROM series_samples AS part WHERE part.dataset_id = series.dataset_id \
                   AND part.position = series.position)";
        for row in self.rows(sql).await {
            self.breaks(row.get(0));
        }
    }

    /// The rows of a finished sweep or tolerance study are all its points, without gaps, and those that its result was
    /// made of.
    async fn sweeps_are_whole(&mut self, jobs: &HashMap<String, Job>) {
        let sql = "SELECT points_n, points_digest, json_extract(body, '$.numerics.reused') AS reused FROM results WHERE job_id = $1";
        let sweeps: Vec<_> =
            jobs.iter().filter(|(_, job)| ["sweep", "tolerance"].contains(&job.kind.as_str())).collect();
        for (id, job) in sweeps {
            let rows = sqlx::query(
                "SELECT position, body FROM sweep_points \
                 WHERE dataset_id = COALESCE((SELECT dataset_id FROM results WHERE job_id = $1), $1) ORDER BY position",
            )
            .bind(id)
            .fetch_all(&mut *self.connection)
            .await
            .expect("rows");
            self.findings.points += rows.len();
            let document = herringbone_job::parse(job.input.as_bytes()).expect("the stored document is valid");
            let wanted = document.sweep_points().max(document.evaluations() as usize);
            if job.state != "succeeded" {
                if rows.len() > wanted {
                    self.breaks(format!("{id} has {} of {wanted} points", rows.len()));
                }
                continue;
            }
            let result = sqlx::query(sql).bind(id).fetch_optional(&mut *self.connection).await.expect("a row");
            let Some(result) = result else { continue };
            let (n, digest): (Option<i64>, Option<String>) = (result.get("points_n"), result.get("points_digest"));
            let bodies: Vec<String> = rows.iter().map(|row| row.get("body")).collect();
            if rows.iter().map(|row| row.get::<i64, _>("position")).ne(0..wanted as i64) {
                self.breaks(format!("the {} points of {id} are not 0 to {wanted}", rows.len()));
            }
            if n != Some(wanted as i64) || digest != Some(digest_of(&bodies)) {
                self.breaks(format!("the points of {id} are not those of its result"));
            }
            let reused: Option<String> = result.get("reused");
            self.findings.resumed_sweeps += usize::from(reused.is_some_and(|reused| reused.contains("\"points\"")));
        }
    }
}

/// The digest of rows as the service documents it: the rows in order, a zero byte after each, 128 bits of SHA-256 in
/// hex.
fn digest_of(bodies: &[String]) -> String {
    let mut hasher = Sha256::new();
    for body in bodies {
        hasher.update(body);
        hasher.update([0]);
    }
    hex::encode(&hasher.finalize()[..16])
}

fn is_end(state: &str) -> bool {
    ["succeeded", "failed", "canceled"].contains(&state)
}

/// The transitions of a job's life.
fn is_step(from: &str, to: &str) -> bool {
    match from {
        "queued" => to == "running" || to == "canceled",
        "running" => to == "queued" || is_end(to),
        _ => false,
    }
}
