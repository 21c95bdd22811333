//! Workers and NATS servers that die, hang or forget.

use crate::audit::{Accepted, audit};
use crate::documents;
use crate::nats::NatsServer;
use crate::program::Program;
use crate::proxy::Proxy;
use crate::setting::{Setting, number, slow_sweep, wait_for_rows, wait_until};
use crate::worker::Worker;
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

/// A worker without a connection goes on; its work is given to another, and what it sends later changes nothing.
#[test]
fn a_worker_that_is_cut_off_comes_back() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let proxy = Proxy::to(&setting.nats.url());
    let far = Worker::start(setting.folder(), &proxy.url(), &["--space", "test"]);
    let path = service.submit(&slow_sweep(400));
    wait_until("it computes", || far.log().matches("chunk taken").count() > 1);
    proxy.cut();
    let near = setting.worker();
    // Two chunks may have been with the one that is cut off.
    wait_until("the other one computes", || near.log().matches("chunk computed").count() > 2);
    assert_whole(&setting, service, &path, 400);
    let computed = far.log().matches("chunk computed").count();
    proxy.mend();
    wait_until("it is heard of again", || {
        far.log().contains("connected to NATS again") && far.log().matches("chunk computed").count() > computed
    });
    // Stored nothing: the service is gone, and its result waits for the next one.
    let service = setting.program.start();
    let next = service.submit(&documents::response());
    assert_eq!(service.ended(&next)["state"], "succeeded");
    assert_eq!(setting.audit(service, &[&path, &next]).points, 400);
}

/// Results wait in NATS and with the workers while the database takes none.
#[test]
fn results_wait_while_the_database_is_full() {
    let Some(mut setting) = Setting::new(&[]) else { return };
    let command = ["prlimit", "--fsize=1500000:unlimited", "sh", "-c", "trap '' XFSZ; exec \"$@\"", "sh"];
    setting.program = setting.program.clone().under(&command);
    let service = setting.program.start();
    let id = service.id().to_string();
    let _workers = [setting.worker(), setting.worker()];
    let mut voluminous = documents::integration(300);
    let analysis = voluminous["analysis"].as_object_mut().expect("an object");
    analysis.remove("channels");
    analysis.insert("record_mesh_periods".into(), json!(300));
    analysis.insert("samples_per_mesh_period".into(), json!(256));
    let (large, sweep) = (service.submit(&voluminous), service.submit(&slow_sweep(200)));
    wait_until("a result is refused", || setting.program.log().contains("results not written"));
    // Longer than the time after which NATS would give work away.
    std::thread::sleep(std::time::Duration::from_secs(5));
    assert_eq!(service.get(&large)["state"], "running");
    let more = std::process::Command::new("prlimit").args(["--pid", &id, "--fsize=unlimited"]).status();
    assert!(more.expect("prlimit runs").success());
    for path in [&large, &sweep] {
        let job = service.ended(path);
        assert_eq!((&job["state"], &job["attempt"]), (&json!("succeeded"), &json!(1)), "{job}");
    }
    assert_eq!(setting.audit(service, &[&large, &sweep]).points, 200);
}

#[test]
fn a_nats_server_that_hangs_holds_up_only() {
    let Some(setting) = Setting::new(&[]) else { return };
    let service = setting.program.start();
    let _workers = [setting.worker(), setting.worker()];
    let path = service.submit(&slow_sweep(300));
    wait_for_rows(&setting, 30);
    setting.nats.pause();
    std::thread::sleep(std::time::Duration::from_secs(6));
    setting.nats.go_on();
    assert_whole(&setting, service, &path, 300);
}

/// Each of three servers is killed in turn, so also whoever leads; then all of them.
#[test]
fn three_servers_lose_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let Some(mut servers) = NatsServer::start_three(folder.path()) else { return };
    let url = servers.each_ref().map(NatsServer::url).join(",");
    let program = Program::at(folder.path()).with(&["--queue", &url, "--space", "test", "--ack-wait-s", "2"]);
    let program = program.with(&["--nats-replicas", "3"]);
    let service = program.start();
    let _workers = [0, 1].map(|_| Worker::start(folder.path(), &url, &["--space", "test"]));
    let path = service.submit(&slow_sweep(900));
    let rows = || number(program.database(), "SELECT COUNT(*) FROM sweep_points");
    let more = |least: i64| wait_until("rows", || rows() >= least.min(900));
    more(20);
    for server in &mut servers {
        server.kill();
        // Two of three go on.
        more(rows() + 60);
        server.start_again();
    }
    servers.iter_mut().for_each(NatsServer::kill);
    servers.iter_mut().for_each(NatsServer::spawn);
    let job = service.ended(&path);
    assert_eq!((&job["state"], &job["attempt"]), (&json!("succeeded"), &json!(1)), "{job}");
    assert!(service.end().0.success());
    let accepted = Accepted { ids: vec![path.rsplit('/').next().expect("an id").to_owned()], keys: Vec::new() };
    let findings = audit(program.database(), &accepted);
    assert_eq!((findings.broken, findings.points), (Vec::new(), 900), "{}", program.log());
}
