//! The lives of jobs with workers: canceled, given up, taken up again after a restart.

use crate::documents;
use crate::setting::{Setting, change, number, slow_sweep, wait_for_rows, wait_until};
use serde_json::{Value, json};
use std::time::{Duration, Instant};

/// Chunks that the workers of a service compute, as it says.
fn running(system: &Value) -> usize {
    let machines = system["machines"].as_array().expect("machines");
    machines.iter().map(|machine| machine["running"].as_array().map_or(0, Vec::len)).sum()
}

#[test]
fn a_canceled_job_is_computed_by_nobody() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let worker = setting.worker();
    let path = service.submit(&documents::integration(10_000_000));
    service.until("/api/v1/system", |answer| running(&answer.json()) == 1);
    let asked = Instant::now();
    assert_eq!(service.send("POST", &format!("{path}/cancel"), "").status, 202);
    let job = service.ended(&path);
    let ended_ms = asked.elapsed().as_millis();
    assert_eq!(job["state"], "canceled", "{job}");
    wait_until("the worker stops", || worker.log().contains("chunk left"));
    println!("canceled after {ended_ms} ms, computed by nobody after {} ms", asked.elapsed().as_millis());
    service.until("/api/v1/system", |answer| running(&answer.json()) == 0);
    // The worker is free for others, and so is what waits in the stream.
    let next = service.submit(&documents::response());
    assert_eq!(service.ended(&next)["state"], "succeeded");
    let findings = setting.audit(service, &[&path, &next]);
    assert_eq!((findings.states["canceled"], findings.states["succeeded"]), (1, 1));
}

#[test]
fn chunks_of_a_canceled_sweep_are_dropped() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let worker = setting.worker();
    let path = service.submit(&slow_sweep(4000));
    wait_for_rows(&setting, 20);
    service.until("/api/v1/system", |answer| {
        let system = answer.json();
        running(&system) == 1 && system["waiting_work"][0]["chunks"] == 1
    });
    assert_eq!(service.send("POST", &format!("{path}/cancel"), "").status, 202);
    assert_eq!(service.ended(&path)["state"], "canceled");
    wait_until("its other chunk is dropped", || worker.log().contains("chunk dropped"));
    let rows = number(setting.program.database(), "SELECT COUNT(*) FROM sweep_points");
    let next = service.submit(&documents::sweep(30));
    assert_eq!(service.ended(&next)["state"], "succeeded");
    assert_eq!(number(setting.program.database(), "SELECT COUNT(*) FROM sweep_points"), rows + 30);
    setting.audit(service, &[&path, &next]);
}

/// Whoever takes the job dies.
#[test]
fn a_job_that_kills_its_workers_is_given_up_and_others_are_not_affected() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let poison = service.submit(&documents::integration(10_000_000));
    let id = poison.rsplit('/').next().expect("an id").to_owned();
    let mut kills = 0;
    while service.get(&poison)["state"] != "failed" {
        let worker = setting.worker();
        wait_until("a worker takes it, or it is given up", || {
            worker.log().contains("chunk taken") || service.get(&poison)["state"] == "failed"
        });
        if service.get(&poison)["state"] != "failed" {
            kills += 1;
            worker.kill();
        }
        assert!(kills <= 5, "not given up");
    }
    let job = service.get(&poison);
    assert_eq!(job["error"]["code"], "worker-lost", "{job}");
    assert_eq!((kills, &job["attempt"]), (5, &json!(1)), "{job}");
    let _worker = setting.worker();
    let next = service.submit(&documents::response());
    assert_eq!(service.ended(&next)["state"], "succeeded");
    assert_eq!(service.get("/api/v1/system")["waiting_work"], json!([]), "{id}");
    setting.audit(service, &[&poison, &next]);
}

#[test]
fn results_that_arrive_while_the_service_is_dead_are_stored_once() {
    let Some(setting) = Setting::new(&[]) else { return };
    let mut service = setting.program.start();
    let workers = [setting.worker(), setting.worker()];
    let jobs = [service.submit(&slow_sweep(600)), service.submit(&documents::integration(20_000))];
    for rows in [30, 150, 300] {
        wait_for_rows(&setting, rows);
        service.kill();
        // The workers go on with what they have, and their results wait.
        wait_until("a result is sent", || sent(&workers) > 0);
        let before = sent(&workers);
        wait_until("another one is sent, or nothing is left to be computed", || {
            sent(&workers) > before || is_idle(&workers)
        });
        service = setting.program.start();
    }
    for path in &jobs {
        let job = service.ended(path);
        // The attempt goes on: nothing that the workers have computed is lost.
        assert_eq!((&job["state"], &job["attempt"]), (&json!("succeeded"), &json!(1)), "{job}");
    }
    let findings = setting.audit(service, &[&jobs[0], &jobs[1]]);
    assert_eq!((findings.points, findings.restarted, findings.resumed_sweeps), (600, 0, 0));
}

fn sent(workers: &[crate::worker::Worker]) -> usize {
    workers.iter().map(|worker| worker.log().matches("chunk computed").count()).sum()
}

fn is_idle(workers: &[crate::worker::Worker]) -> bool {
    let counts = |word: &str| -> usize { workers.iter().map(|worker| worker.log().matches(word).count()).sum() };
    counts("chunk taken") == counts("chunk computed") + counts("chunk left")
}

#[test]
fn a_service_goes_on_alone_with_what_workers_had() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let worker = setting.worker();
    let path = service.submit(&slow_sweep(200));
    wait_for_rows(&setting, 20);
    drop(worker);
    assert!(service.end().0.success());
    let rows = number(setting.program.database(), "SELECT COUNT(*) FROM sweep_points");
    let service = crate::program::Program::at(setting.folder()).start();
    let job = service.ended(&path);
    assert_eq!((&job["state"], &job["attempt"]), (&json!("succeeded"), &json!(2)), "{job}");
    assert!(rows >= 20);
    let losses = number(setting.program.database(), "SELECT MAX(losses) FROM jobs");
    assert_eq!(losses, 0, "an orderly end is no loss");
    setting.audit(service, &[&path]);
}

/// After an upgrade of the service: rows of two versions are not mixed.
#[test]
fn a_job_that_workers_of_another_version_had_begins_again() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let _worker = setting.worker();
    let path = service.submit(&slow_sweep(200));
    wait_for_rows(&setting, 20);
    service.kill();
    change(setting.program.database(), "UPDATE chunks SET solver = '0_0_1-1'");
    change(setting.program.database(), "UPDATE sweep_points SET solver_version = '0.0.1-1', body = '{}'");
    let service = setting.program.start();
    let job = service.ended(&path);
    assert_eq!((&job["state"], &job["attempt"]), (&json!("succeeded"), &json!(2)), "{job}");
    let mixed = "SELECT COUNT(*) FROM sweep_points WHERE body = '{}' OR solver_version = '0.0.1-1'";
    assert_eq!(number(setting.program.database(), mixed), 0);
    assert_eq!(setting.audit(service, &[&path]).points, 200);
}

/// A worker that is asked to end gives its chunk back at once, and what it has solved is kept.
#[test]
fn a_worker_that_ends_gives_its_work_back() {
    let Some(setting) = Setting::with_ack_wait("600", &[]) else { return };
    let service = setting.program.start();
    let first = setting.worker();
    let path = service.submit(&slow_sweep(150));
    wait_for_rows(&setting, 30);
    let asked = Instant::now();
    assert!(first.end().success());
    assert!(asked.elapsed() < Duration::from_secs(60), "it does not compute to the end");
    let _second = setting.worker();
    // Without the gift the second one would wait for ten minutes.
    assert_eq!(service.ended(&path)["state"], "succeeded");
    assert_eq!(setting.audit(service, &[&path]).points, 150);
}
