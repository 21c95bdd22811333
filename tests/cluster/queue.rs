//! Start and roll call: spaces, versions, what waits why.

use crate::documents;
use crate::setting::{Setting, wait_until};
use crate::worker::Worker;
use serde_json::{Value, json};

/// Says for five seconds that a worker of another version is there.
async fn beat_of_another_version(url: &str) {
    let client = async_nats::connect(url).await.expect("connected");
    let beat = json!({
        "schema": 1, "worker": "other", "host": "elsewhere", "version": "0.0.1", "solver_version": "0.0.1-1",
        "solvers": ["0_0_1-1"], "slots": 4, "running": [],
    });
    client.request("hb.test.beat", beat.to_string().into()).await.expect("answered");
}

#[test]
fn work_waits_for_a_worker_of_its_version() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime");
    runtime.block_on(beat_of_another_version(&setting.nats.url()));
    let path = service.submit(&documents::response());
    let system = service.until("/api/v1/system", |answer| answer.json()["waiting_work"] != json!([])).json();
    assert_eq!(system["machines"][0]["solver_version"], "0.0.1-1", "{system}");
    let version = system["solver_version"].as_str().expect("a version").replace('.', "_");
    assert_eq!(system["waiting_work"], json!([{"solver": version, "chunks": 1, "slots": 0}]));
    assert_ne!(service.get(&path)["state"], "succeeded");
    let _worker = setting.worker();
    assert_eq!(service.ended(&path)["state"], "succeeded");
    setting.audit(service, &[&path]);
}

#[test]
fn workers_are_listed_with_what_they_do() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    // Without the name of the space: there is one service.
    let _worker = Worker::start(setting.folder(), &setting.nats.url(), &["--threads", "3"]);
    let path = service.submit(&documents::integration(10_000_000));
    let is_busy = |system: &Value| system["machines"][0]["running"][0]["stage"] == "response";
    let system = service.until("/api/v1/system", |answer| is_busy(&answer.json())).json();
    let machine = &system["machines"][0];
    assert_eq!((&machine["slots"], &machine["solver_version"]), (&json!(3), &system["solver_version"]));
    assert!(path.ends_with(machine["running"][0]["job"].as_str().expect("an id")));
    assert_eq!((&system["workers"]["total"], &system["workers"]["busy"]), (&json!(3), &json!(1)));
    let names = [
        "herringbone_machines{version=",
        "herringbone_chunks{state=\"issued\"} 1",
        "herringbone_nats_stream_messages{stream=\"work\"} 1",
    ];
    service.until("/metrics", |answer| names.iter().all(|name| answer.text.contains(name)));
    assert_eq!(service.send("POST", &format!("{path}/cancel"), "").status, 202);
    service.ended(&path);
    setting.audit(service, &[&path]);
}

#[test]
fn a_space_belongs_to_one_service() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let folder = tempfile::tempdir().expect("a folder");
    let second = crate::program::Program::at(folder.path());
    let second = second.with(&["--queue", &setting.nats.url(), "--space", "test"]);
    assert!(second.try_start().is_err_and(|status| !status.success()));
    assert!(second.log().contains("another service has the space"), "{}", second.log());
    // With a space of its own, which is kept in the database, it has its own work.
    let third = crate::program::Program::at(folder.path()).with(&["--queue", &setting.nats.url()]);
    let other = third.start();
    let lost = Worker::start(setting.folder(), &setting.nats.url(), &[]);
    wait_until("the worker asks which", || lost.log().contains("several services answer"));
    let _worker = setting.worker_of("test");
    let (mine, theirs) = (service.submit(&documents::response()), other.submit(&documents::response()));
    assert_eq!(service.ended(&mine)["state"], "succeeded");
    assert_ne!(other.get(&theirs)["state"], "succeeded");
    setting.audit(service, &[&mine]);
}

#[test]
fn a_service_that_waits_for_nats_says_so() {
    let Some(mut setting) = Setting::new(&[]) else { return };
    setting.nats.kill();
    let program = setting.program.clone();
    let starting = std::thread::spawn(move || program.start());
    wait_until("it says for what it waits", || setting.program.log().contains("the connection to NATS at"));
    setting.nats.start_again();
    let service = starting.join().expect("it starts");
    setting.audit(service, &[]);
}

/// The trace of whoever submits a job is in the log lines of the service and of the worker about it.
#[test]
fn traces_are_passed_on() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let worker = setting.worker();
    let trace = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";
    let wrong = "00-4bf92f3577b34da6a3ce929d0e0e4736-0000000000000000-01";
    let submit = |trace: &str| {
        let (document, headers) = (documents::response().to_string(), [("traceparent", trace)]);
        let answer =
            crate::client::send(service.address, "POST", "/api/v1/jobs", &headers, &document).expect("answered");
        answer.header("location").expect("a location").to_owned()
    };
    let jobs = [submit(trace), submit(wrong), service.submit(&documents::response())];
    for path in &jobs {
        assert_eq!(service.ended(path)["state"], "succeeded");
    }
    let lines_of = |log: &str, path: &str| -> Vec<String> {
        let id = path.rsplit('/').next().expect("an id");
        log.lines().filter(|line| line.contains(id)).map(str::to_owned).collect()
    };
    for log in [worker.log(), setting.program.log()] {
        let lines = lines_of(&log, &jobs[0]);
        assert!(lines.iter().any(|line| line.contains("traceparent") && line.contains(trace)), "{lines:?}");
        for path in &jobs[1..] {
            let lines = lines_of(&log, path);
            assert!(!lines.is_empty() && !lines.iter().any(|line| line.contains("traceparent")), "{lines:?}");
        }
    }
    setting.audit(service, &[&jobs[0], &jobs[1], &jobs[2]]);
}

/// What is not worth sending is computed by the service where it may.
#[test]
fn jobs_run_here_where_no_worker_is() {
    let Some(setting) = Setting::new(&["--local-workers", "2"]) else { return };
    let service = setting.program.start();
    let jobs = [service.submit(&documents::response()), service.submit(&documents::sweep(50))];
    for path in &jobs {
        assert_eq!(service.ended(path)["state"], "succeeded");
    }
    let worker = setting.worker();
    service.until("/api/v1/system", |answer| answer.json()["machines"] != json!([]));
    // A quick job stays here; one of many periods is sent.
    let (quick, long) = (service.submit(&documents::response()), service.submit(&documents::integration(11_000)));
    for path in [&quick, &long] {
        assert_eq!(service.ended(path)["state"], "succeeded");
    }
    let id = |path: &str| path.rsplit('/').next().expect("an id").to_owned();
    let log = worker.log();
    assert!(log.contains(&id(&long)) && !log.contains(&id(&quick)), "{log}");
    setting.audit(service, &[&jobs[0], &jobs[1], &quick, &long]);
}
