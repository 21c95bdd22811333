//! Three NATS servers, three workers, one service, and an event every five seconds:
//! `CHAOS_SEED=1 CHAOS_S=300 cargo test --test cluster -- --ignored --nocapture chaos`.

use crate::audit::{Accepted, audit};
use crate::chance::{Chance, setting};
use crate::documents;
use crate::nats::NatsServer;
use crate::program::{PATIENCE, Program, Service};
use crate::setting::slow_sweep;
use crate::worker::Worker;
use serde_json::json;
use std::time::{Duration, Instant};

/// Time between two events.
const PAUSE: Duration = Duration::from_secs(5);

struct Scene {
    servers: [NatsServer; 3],
    workers: Vec<Worker>,
    program: Program,
    service: Option<Service>,
    folder: tempfile::TempDir,
    url: String,
}

impl Scene {
    fn worker(&self) -> Worker {
        Worker::start(self.folder.path(), &self.url, &["--space", "test"])
    }

    /// Something happens; its name.
    fn event(&mut self, chance: &mut Chance) -> &'static str {
        let (one, other) = (chance.below(3) as usize, chance.below(3) as usize);
        match chance.below(8) {
            0 => {
                self.servers[one].kill();
                std::thread::sleep(Duration::from_millis(500 + chance.below(3000)));
                self.servers[one].spawn();
                "a server was killed"
            }
            1 => {
                self.servers[one].pause();
                std::thread::sleep(Duration::from_millis(1000 + chance.below(5000)));
                self.servers[one].go_on();
                "a server hung"
            }
            2 if one != other => {
                self.servers[one].kill();
                self.servers[other].kill();
                std::thread::sleep(Duration::from_secs(2));
                self.servers[one].spawn();
                self.servers[other].spawn();
                "two servers were killed"
            }
            2 => {
                self.servers.iter_mut().for_each(NatsServer::kill);
                self.servers.iter_mut().for_each(NatsServer::spawn);
                "all servers were killed"
            }
            3 | 4 => {
                let worker = self.worker();
                std::mem::replace(&mut self.workers[one], worker).kill();
                "a worker was killed"
            }
            5 => {
                self.workers[one].pause();
                std::thread::sleep(Duration::from_millis(1000 + chance.below(5000)));
                self.workers[one].go_on();
                "a worker hung"
            }
            6 => {
                let worker = self.worker();
                assert!(std::mem::replace(&mut self.workers[one], worker).end().success());
                "a worker was asked to end"
            }
            _ => {
                if let Some(service) = self.service.take() {
                    service.kill();
                }
                std::thread::sleep(Duration::from_millis(chance.below(3000)));
                self.service = Some(self.program.start());
                "the service was killed"
            }
        }
    }
}

#[test]
#[ignore = "takes five minutes"]
fn chaos() {
    let (seed, limit) = (setting("CHAOS_SEED", 20_261_130), Duration::from_secs(setting("CHAOS_S", 300)));
    let mut chance = Chance::new(seed);
    let folder = tempfile::tempdir().expect("a folder");
    let Some(servers) = NatsServer::start_three(folder.path()) else { return };
    let url = servers.each_ref().map(NatsServer::url).join(",");
    let program = Program::at(folder.path()).with(&["--queue", &url, "--space", "test", "--ack-wait-s", "2"]);
    let program = program.with(&["--nats-replicas", "3", "--max-losses", "100"]);
    let service = Some(program.start());
    let mut scene = Scene { servers, workers: Vec::new(), program, service, folder, url };
    scene.workers = (0..3).map(|_| scene.worker()).collect();
    let (began, mut ids, mut number) = (Instant::now(), Vec::new(), 0);
    while began.elapsed() < limit {
        let service = scene.service.as_ref().expect("it runs");
        for _ in 0..2 {
            number += 1;
            // Each one differs, so that no result is reused.
            let mut sweep = slow_sweep(40 + u32::try_from(chance.below(60)).unwrap_or_default());
            sweep["operation"]["pinion_torque_nm"] = json!(700.0 + f64::from(number));
            if number % 3 == 0 {
                sweep["continuation"] = json!("both");
            }
            let document = if number % 4 == 0 { documents::integration(20_000) } else { sweep };
            let path = service.submit(&document);
            ids.push(path.rsplit('/').next().expect("an id").to_owned());
        }
        let event = scene.event(&mut chance);
        println!("{:5.1} s: {event}", began.elapsed().as_secs_f64());
        std::thread::sleep(PAUSE);
    }
    let service = scene.service.take().expect("it runs");
    let deadline = Instant::now() + 3 * PATIENCE;
    while service.get("/api/v1/jobs?state=queued,running&limit=1")["items"] != json!([]) {
        assert!(Instant::now() < deadline, "seed {seed}: jobs do not end: {}", service.get("/api/v1/system"));
        std::thread::sleep(Duration::from_millis(100));
    }
    let ended_s = began.elapsed().as_secs_f64();
    assert!(service.end().0.success());
    let count = ids.len();
    let findings = audit(scene.program.database(), &Accepted { ids, keys: Vec::new() });
    println!(
        "seed {seed}: {count} jobs, ended after {ended_s:.0} s: {:?}, {} points, started more than once: {}",
        findings.states, findings.points, findings.restarted
    );
    assert_eq!(findings.broken, [""; 0], "seed {seed}");
    // A chunk may have been with more than five workers that died.
    assert_eq!(findings.states.get("succeeded"), Some(&count), "seed {seed}");
    assert!(!scene.program.log().contains("panicked"), "seed {seed}");
}
