//! Workers and NATS servers that die, hang or forget.

use crate::documents;
use crate::setting::{Setting, number, slow_sweep, wait_for_rows, wait_until};
use serde_json::json;

/// The points of a sweep, and that nothing was computed in another attempt.
fn assert_whole(setting: &Setting, service: crate::program::Service, path: &str, points: usize) {
    let job = service.ended(path);
    assert_eq!((&job["state"], &job["attempt"]), (&json!("succeeded"), &json!(1)), "{job}");
    let findings = setting.audit(service, &[path]);
    assert_eq!((findings.points, findings.resumed_sweeps), (points, 0));
}

#[test]
fn the_work_of_a_killed_worker_is_done_by_another() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let (first, _second) = (setting.worker(), setting.worker());
    let path = service.submit(&slow_sweep(400));
    wait_until("the first one computes", || first.log().matches("chunk taken").count() > 1);
    first.kill();
    assert_whole(&setting, service, &path, 400);
}

/// Longer than the time after which its work is given to another: the late results change nothing.
#[test]
fn results_of_a_worker_that_hung_are_dropped() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let first = setting.worker();
    let path = service.submit(&slow_sweep(300));
    wait_until("it computes", || first.log().matches("chunk taken").count() > 1);
    first.pause();
    let _second = setting.worker();
    let job = service.ended(&path);
    assert_eq!((&job["state"], &job["attempt"]), (&json!("succeeded"), &json!(1)), "{job}");
    let rows = number(setting.program.database(), "SELECT COUNT(*) FROM sweep_points");
    let computed = first.log().matches("chunk computed").count();
    first.go_on();
    // It finishes what it had, or learns that it is not wanted.
    wait_until("it goes on", || {
        let log = first.log();
        log.matches("chunk computed").count() > computed || log.contains("chunk left")
    });
    let next = service.submit(&documents::response());
    assert_eq!(service.ended(&next)["state"], "succeeded");
    assert_eq!(number(setting.program.database(), "SELECT COUNT(*) FROM sweep_points"), rows);
    setting.audit(service, &[&path, &next]);
}

#[test]
fn a_nats_server_that_is_killed_and_started_again_loses_nothing() {
    let Some(mut setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let _workers = [setting.worker(), setting.worker()];
    let path = service.submit(&slow_sweep(500));
    for rows in [20, 150, 300] {
        wait_for_rows(&setting, rows);
        setting.nats.kill();
        setting.nats.start_again();
    }
    assert_whole(&setting, service, &path, 500);
}

#[test]
fn what_nats_forgets_is_published_again() {
    let Some(mut setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let _workers = [setting.worker(), setting.worker()];
    let path = service.submit(&slow_sweep(500));
    for rows in [20, 200] {
        wait_for_rows(&setting, rows);
        setting.nats.kill();
        setting.nats.wipe();
        setting.nats.start_again();
    }
    wait_until("it is noticed", || setting.program.log().contains("NATS has lost its streams"));
    assert_whole(&setting, service, &path, 500);
}

/// The service comes back to a NATS that knows nothing of what it had published.
#[test]
fn what_nats_forgets_while_the_service_is_dead_is_published_again() {
    let Some(mut setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let workers = [setting.worker(), setting.worker()];
    let path = service.submit(&slow_sweep(300));
    wait_for_rows(&setting, 50);
    service.kill();
    drop(workers);
    setting.nats.kill();
    setting.nats.wipe();
    setting.nats.start_again();
    let service = setting.program.start();
    let _workers = [setting.worker(), setting.worker()];
    assert_whole(&setting, service, &path, 300);
}
