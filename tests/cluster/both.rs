//! What a job's life has to be whoever computes it: the same tests against the queue in the process and against workers
//! over NATS.

use crate::documents;
use crate::nats::NatsServer;
use crate::program::{Program, Service};
use crate::setting::{audit_of, change_all, number, slow_sweep, wait_until};
use crate::worker::Worker;
use rstest::rstest;
use serde_json::{Value, json};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Who computes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Queue {
    Local,
    Nats,
}

/// A service with one place for jobs of one operating point and one for sweeps.
struct Bench {
    program: Program,
    nats: Option<NatsServer>,
    folder: TempDir,
}

impl Bench {
    /// `None` where there is no NATS server.
    fn new(queue: Queue, options: &[&str]) -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder");
        let nats = match queue {
            Queue::Local => None,
            Queue::Nats => Some(NatsServer::start(folder.path())?),
        };
        let program = Program::at(folder.path()).with(&["--sweep-workers", "1", "--drain-s", "5"]).with(options);
        let program = match &nats {
            None => program.with(&["--workers", "1", "--threads", "1"]),
            Some(nats) => program.with(&["--queue", &nats.url(), "--space", "test", "--ack-wait-s", "2"]),
        };
        Some(Self { program, nats, folder })
    }

    /// Whoever computes, where that is not the service.
    fn worker(&self) -> Option<Worker> {
        let nats = self.nats.as_ref()?;
        Some(Worker::start(self.folder.path(), &nats.url(), &["--space", "test"]))
    }

    fn rows(&self) -> i64 {
        number(self.program.database(), "SELECT COUNT(*) FROM sweep_points")
    }

    /// A job that went on, in another attempt where the process that computed it was another one.
    fn assert_went_on(&self, job: &Value, queue: Queue) {
        let attempt = if queue == Queue::Local { 2 } else { 1 };
        assert_eq!((&job["state"], &job["attempt"]), (&json!("succeeded"), &json!(attempt)), "{job}");
    }
}

/// Cancels a job, which ends at once (200) or as soon as it stops (202).
fn cancel(service: &Service, path: &str) {
    let answer = service.send("POST", &format!("{path}/cancel"), "");
    assert!(matches!(answer.status, 200 | 202), "{}", answer.text);
}

#[rstest]
fn progress_is_shown(#[values(Queue::Local, Queue::Nats)] queue: Queue) {
    let Some(bench) = Bench::new(queue, &[]) else { return };
    let service = bench.program.start();
    let _worker = bench.worker();
    let path = service.submit(&slow_sweep(150));
    let half = service.until(&path, |answer| {
        let progress = answer.json()["progress"].as_f64().unwrap_or_default();
        progress > 0.1 && progress < 0.9
    });
    assert_eq!(half.json()["state"], "running");
    assert_eq!(service.ended(&path)["progress"], 1.0);
    let single = service.submit(&documents::integration(10_000_000));
    service.until(&single, |answer| answer.json()["progress"].as_f64() > Some(0.0));
    cancel(&service, &single);
    assert_eq!(service.ended(&single)["state"], "canceled");
    audit_of(&bench.program, service, &[&path, &single]);
}

#[rstest]
fn canceled_jobs_end_and_make_room(#[values(Queue::Local, Queue::Nats)] queue: Queue) {
    let Some(bench) = Bench::new(queue, &[]) else { return };
    let service = bench.program.start();
    let _worker = bench.worker();
    let [single, sweep] = [service.submit(&documents::integration(10_000_000)), service.submit(&slow_sweep(20_000))];
    service.until(&single, |answer| answer.json()["state"] == "running");
    wait_until("the sweep runs", || bench.nats.is_some() || bench.rows() > 0);
    let waiting = service.submit(&documents::integration(10_000_000));
    for path in [&waiting, &single, &sweep] {
        let asked = Instant::now();
        cancel(&service, path);
        assert_eq!(service.ended(path)["state"], "canceled");
        assert!(asked.elapsed() < Duration::from_secs(30), "a checkpoint is never far");
    }
    let next = [service.submit(&documents::response()), service.submit(&documents::sweep(20))];
    for path in &next {
        assert_eq!(service.ended(path)["state"], "succeeded");
    }
    let findings = audit_of(&bench.program, service, &[&single, &sweep, &waiting, &next[0], &next[1]]);
    assert_eq!((findings.states["canceled"], findings.states["succeeded"]), (3, 2));
}

/// Jobs are taken by priority, then by age. Priorities are in the database only.
#[rstest]
fn priorities_decide_who_is_next(#[values(Queue::Local, Queue::Nats)] queue: Queue) {
    let Some(bench) = Bench::new(queue, &[]) else { return };
    let service = bench.program.start();
    // As many as are taken at once; over NATS two without a worker.
    let blockers = [(); 2].map(|()| service.submit(&documents::integration(10_000_000)));
    let taken = if queue == Queue::Local { 1 } else { 2 };
    for path in &blockers[..taken] {
        service.until(path, |answer| answer.json()["state"] == "running");
    }
    let jobs = [(); 3].map(|()| service.submit(&documents::response()));
    assert!(jobs.iter().all(|path| service.get(path)["state"] == "queued"));
    assert!(service.end().0.success());
    let id = jobs[2].rsplit('/').next().expect("an id");
    change_all(bench.program.database(), &format!("UPDATE jobs SET priority = 1 WHERE id = '{id}'"));
    let service = bench.program.start();
    // What is canceled makes room for one after the other.
    blockers.iter().for_each(|path| cancel(&service, path));
    let _worker = bench.worker();
    let mut started: Vec<(String, &String)> = Vec::new();
    for path in &jobs {
        let job = service.ended(path);
        assert_eq!(job["state"], "succeeded", "{job}");
        started.push((job["started_at"].as_str().expect("a time").to_owned(), path));
    }
    started.sort();
    let order: Vec<&String> = started.into_iter().map(|(_, path)| path).collect();
    assert_eq!(order, [&jobs[2], &jobs[0], &jobs[1]]);
    let all: Vec<&str> = blockers.iter().chain(&jobs).map(String::as_str).collect();
    audit_of(&bench.program, service, &all);
}

#[rstest]
fn sweeps_take_turns(#[values(Queue::Local, Queue::Nats)] queue: Queue) {
    let Some(bench) = Bench::new(queue, &["--sweep-turn-s", "1"]) else { return };
    let service = bench.program.start();
    let _worker = bench.worker();
    // Over NATS there is room for two while the first one's scout is out.
    let long = [service.submit(&slow_sweep(300)), service.submit(&slow_sweep(301))];
    let short = service.submit(&slow_sweep(20));
    assert_eq!(service.ended(&short)["state"], "succeeded");
    assert!(long.iter().any(|path| service.get(path)["state"] != "succeeded"), "the short one was let in between");
    let jobs = long.each_ref().map(|path| service.ended(path));
    assert!(jobs.iter().all(|job| job["state"] == "succeeded"), "{jobs:?}");
    assert!(jobs.iter().any(|job| job["attempt"].as_i64() > Some(1)), "{jobs:?}");
    assert_eq!(audit_of(&bench.program, service, &[&long[0], &long[1], &short]).points, 621);
}

#[rstest]
fn jobs_fail_at_their_time_limit(#[values(Queue::Local, Queue::Nats)] queue: Queue) {
    let Some(bench) = Bench::new(queue, &["--job-time-limit-s", "2", "--sweep-time-limit-s", "2"]) else { return };
    let service = bench.program.start();
    let _worker = bench.worker();
    let paths = [service.submit(&documents::integration(10_000_000)), service.submit(&slow_sweep(20_000))];
    for path in &paths {
        let job = service.ended(path);
        assert_eq!((&job["state"], &job["error"]["code"]), (&json!("failed"), &json!("time-limit")), "{job}");
    }
    // Some milliseconds of work: far from the limit on a busy machine too.
    let next = service.submit(&documents::mesh());
    let job = service.ended(&next);
    assert_eq!(job["state"], "succeeded", "{job}");
    audit_of(&bench.program, service, &[&paths[0], &paths[1], &next]);
}

/// SIGTERM: an end in bounded time that is no loss, and everything goes on after the next start.
#[rstest]
fn a_shutdown_ends_in_time_and_loses_nothing(#[values(Queue::Local, Queue::Nats)] queue: Queue) {
    let Some(bench) = Bench::new(queue, &["--max-losses", "1"]) else { return };
    let service = bench.program.start();
    let _worker = bench.worker();
    let sweep = service.submit(&slow_sweep(150));
    wait_until("rows", || bench.rows() >= 20);
    let waiting = service.submit(&slow_sweep(30));
    let (status, took) = service.end();
    assert!(status.success() && took < Duration::from_secs(15), "{status} after {took:?}");
    assert_eq!(number(bench.program.database(), "SELECT MAX(losses) FROM jobs"), 0);
    let kept = bench.rows();
    let service = bench.program.start();
    assert!(bench.rows() >= kept && kept >= 20);
    bench.assert_went_on(&service.ended(&sweep), queue);
    assert_eq!(service.ended(&waiting)["state"], "succeeded");
    assert_eq!(audit_of(&bench.program, service, &[&sweep, &waiting]).points, 180);
}

/// kill −9.
#[rstest]
fn jobs_go_on_after_the_process_has_died(#[values(Queue::Local, Queue::Nats)] queue: Queue) {
    let Some(bench) = Bench::new(queue, &[]) else { return };
    let service = bench.program.start();
    let _worker = bench.worker();
    let sweep = service.submit(&slow_sweep(120));
    wait_until("rows", || bench.rows() >= 20);
    let waiting = [(); 3].map(|()| service.submit(&documents::response()));
    service.kill();
    let service = bench.program.start();
    bench.assert_went_on(&service.ended(&sweep), queue);
    for path in &waiting {
        assert_eq!(service.ended(path)["state"], "succeeded");
    }
    let paths: Vec<&str> = waiting.iter().chain([&sweep]).map(String::as_str).collect();
    assert_eq!(audit_of(&bench.program, service, &paths).points, 120);
}
