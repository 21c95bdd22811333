//! Measured rates for docs/SCALING.md, in one run:
//! `HERRINGBONE_PROGRAM=target/release/herringbone cargo test --test cluster -- --ignored --nocapture rates`.
//! What is compared is measured by turns, and medians are compared: the machine may have other work, which is printed.

mod memory;
mod sizing;

use crate::documents;
use crate::nats::NatsServer;
use crate::program::{Program, Service, executable};
use crate::setting::{number, slow_sweep, wait_until};
use crate::worker::Worker;
use jiff::Timestamp;
use serde_json::{Value, json};
use sizing::{Chunks, Sizing};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Turns of a comparison.
const TURNS: usize = 3;

/// A service over one or three NATS servers.
struct Bench {
    program: Program,
    servers: Vec<NatsServer>,
    url: String,
    folder: TempDir,
}

impl Bench {
    fn new(servers: usize) -> Option<Self> {
        let folder = tempfile::tempdir().expect("a folder");
        let nats: Vec<NatsServer> = match servers {
            1 => vec![NatsServer::start(folder.path())?],
            _ => NatsServer::start_three(folder.path())?.into(),
        };
        let url = nats.iter().map(NatsServer::url).collect::<Vec<_>>().join(",");
        let program = Program::at(folder.path()).with(&["--queue", &url, "--space", "test", "--ack-wait-s", "3"]);
        let program = program.with(&["--nats-replicas", &servers.to_string(), "--queue-capacity", "100000"]);
        Some(Self { program, servers: nats, url, folder })
    }

    fn worker(&self) -> Worker {
        self.worker_with("1")
    }

    fn worker_with(&self, threads: &str) -> Worker {
        Worker::start(self.folder.path(), &self.url, &["--space", "test", "--threads", threads])
    }

    fn rows(&self) -> i64 {
        number(self.program.database(), "SELECT COUNT(*) FROM sweep_points")
    }

    /// Processor time of all NATS servers.
    fn nats_cpu_s(&self) -> f64 {
        self.servers.iter().map(|server| cpu_s(server.id())).sum()
    }
}

/// Processor time of a process so far.
fn cpu_s(id: u32) -> f64 {
    let text = std::fs::read_to_string(format!("/proc/{id}/stat")).unwrap_or_default();
    // After the name, which is in brackets: user and system time are the 12th and 13th field, in 1/100 s.
    let rest = text.rsplit_once(')').map_or("", |(_, rest)| rest);
    let ticks = |place: usize| rest.split_whitespace().nth(place).and_then(|word| word.parse::<f64>().ok());
    (ticks(11).unwrap_or_default() + ticks(12).unwrap_or_default()) / 100.0
}

/// Load of the machine.
fn load() -> String {
    std::fs::read_to_string("/proc/loadavg").unwrap_or_default().split(' ').take(3).collect::<Vec<_>>().join(" ")
}

/// Time until a job has succeeded.
fn seconds(service: &Service, document: &Value) -> f64 {
    let started = Instant::now();
    let path = service.submit(document);
    let job = service.ended(&path);
    assert_eq!(job["state"], "succeeded", "{job}");
    started.elapsed().as_secs_f64()
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}

/// Times of the lines of a worker's log that contain these words, in seconds since 1970.
fn times_s(worker: &Worker, words: &str) -> Vec<f64> {
    let log = worker.log();
    let of_line = |line: &str| line.split_whitespace().next()?.parse::<Timestamp>().ok();
    let lines = log.lines().filter(|line| line.contains(words));
    lines.filter_map(of_line).map(|time| time.as_microsecond() as f64 * 1e-6).collect()
}

/// Times of a worker between the end of a chunk and the start of the next one.
fn gaps_s(worker: &Worker, since_s: f64) -> Vec<f64> {
    let (taken, computed) = (times_s(worker, "chunk taken"), times_s(worker, "chunk computed"));
    let next = |end: &f64| taken.iter().find(|start| *start >= end).map(|start| start - end);
    computed.iter().filter(|end| **end >= since_s).filter_map(next).collect()
}

fn now_s() -> f64 {
    Timestamp::now().as_microsecond() as f64 * 1e-6
}

/// A sweep of 2000 points of some ten milliseconds; each one differs, so that no result is reused.
fn sweep(number: u32) -> Value {
    let mut document = slow_sweep(2000);
    document["analysis"]["mesh_periods"] = json!(crate::chance::setting("RATES_PERIODS", 2700));
    document["operation"]["pinion_torque_nm"] = json!(800.0 + f64::from(number));
    document
}

/// Two workers against two threads of one process, and against one worker; by turns.
fn speeds(sizing: &mut Sizing) -> Option<()> {
    let (bench, folder) = (Bench::new(1)?, tempfile::tempdir().expect("a folder"));
    let service = bench.program.start();
    let [mut alone_s, mut one_s, mut two_s, mut gaps, mut idle] = [const { Vec::new() }; 5];
    for turn in 0..TURNS as u32 {
        let alone = Program::at(folder.path()).with(&["--threads", "2"]).start();
        alone_s.push(seconds(&alone, &sweep(3 * turn)));
        assert!(alone.end().0.success());
        let first = bench.worker();
        one_s.push(seconds(&service, &sweep(3 * turn + 1)));
        let second = bench.worker();
        service.until("/api/v1/system", |answer| answer.json()["workers"]["total"] == 2);
        let began_s = now_s();
        two_s.push(seconds(&service, &sweep(3 * turn + 2)));
        let of_two = [&first, &second].map(|worker| gaps_s(worker, began_s));
        let chunks: usize = of_two.iter().map(|gaps| gaps.len() + 1).sum();
        gaps.extend(of_two.into_iter().flatten());
        // From the end of the first worker to be done to that of the other.
        let ends =
            [&first, &second].map(|worker| times_s(worker, "chunk computed").last().copied().unwrap_or_default());
        idle.push((ends[0] - ends[1]).abs() / (2.0 * two_s.last().copied().unwrap_or_default()));
        assert!(first.end().success() && second.end().success());
        println!(
            "turn {turn} (load {}): process with two threads {:.1} s, one worker {:.1} s, two {:.1} s, {chunks} chunks",
            load(),
            alone_s[turn as usize],
            one_s[turn as usize],
            two_s[turn as usize]
        );
    }
    let by_turn = |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a / b).collect() };
    println!("two workers against the process: {:.3} of its speed", median(&mut by_turn(&alone_s, &two_s)));
    println!("two workers against one: {:.2} times", median(&mut by_turn(&one_s, &two_s)));
    println!("idle share of the workers at the end of a sweep: {:.1} %", 100.0 * median(&mut idle));
    sizing.point_s = 2.0 * median(&mut alone_s) / 2000.0;
    sizing.gap_s = median(&mut gaps);
    println!(
        "point: {:.1} ms; gap between two chunks, one server: median {:.1} ms of {}",
        1e3 * sizing.point_s,
        1e3 * sizing.gap_s,
        gaps.len()
    );
    assert!(service.end().0.success());
    Some(())
}

/// With three servers: gaps, and the longest time without a row while the leader of the results dies.
fn three_servers() -> Option<()> {
    let mut bench = Bench::new(3)?;
    let service = bench.program.start();
    let workers = [bench.worker(), bench.worker()];
    let began_s = now_s();
    seconds(&service, &sweep(100));
    let mut gaps: Vec<f64> = workers.iter().flat_map(|worker| gaps_s(worker, began_s)).collect();
    println!("gap between two chunks, three servers: median {:.1} ms of {}", 1e3 * median(&mut gaps), gaps.len());
    let path = service.submit(&sweep(101));
    let before = bench.rows();
    wait_until("rows", || bench.rows() > before + 100);
    let leader = bench.servers.iter().find_map(|server| server.leader("HB_test_RESULT")).expect("a leader");
    let number: usize = leader.trim_start_matches('n').parse().expect("a server");
    bench.servers[number].kill();
    let (mut last, mut longest, mut rows) = (Instant::now(), Duration::ZERO, bench.rows());
    loop {
        let (now, is_ended) = (bench.rows(), crate::program::is_ended(&service.get(&path)));
        if now != rows {
            (longest, last, rows) = (longest.max(last.elapsed()), Instant::now(), now);
        }
        if is_ended {
            break;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(service.get(&path)["state"], "succeeded");
    println!("leader killed: longest time without a stored row {:.1} s", longest.as_secs_f64());
    bench.servers[number].start_again();
    series(&bench, &service, "three servers");
    drop(workers);
    assert!(service.end().0.success());
    Some(())
}

/// What a worker needs besides the calculation for a job with megabytes of series, until it is stored.
fn series(bench: &Bench, service: &Service, what: &str) {
    let stored = || number(bench.program.database(), "SELECT COALESCE(SUM(LENGTH(samples)), 0) FROM series_samples");
    let mut times = Vec::new();
    let before = stored();
    for turn in 0..TURNS {
        let mut recorded = documents::integration(400);
        recorded["analysis"] = json!({
            "method": "integrate", "mesh_periods": 300 + turn, "record_mesh_periods": 300,
            "samples_per_mesh_period": 256,
        });
        let started = Instant::now();
        let path = service.submit(&recorded);
        assert_eq!(service.ended(&path)["state"], "succeeded");
        let all_s = started.elapsed().as_secs_f64();
        let wall = service.get(&format!("{path}/result"))["numerics"]["wall_ms"].clone();
        let solved_ms: f64 = wall.as_object().expect("stages").values().filter_map(Value::as_f64).sum();
        times.push(all_s - 1e-3 * solved_ms);
    }
    let megabytes = (stored() - before) as f64 * 1e-6 / TURNS as f64;
    println!(
        "{what}: {megabytes:.1} MB of compressed series, submitted to stored less the calculation: median {:.2} s",
        median(&mut times)
    );
}

/// What a killed worker had is with another one, and a canceled job is computed by nobody.
fn reactions() -> Option<()> {
    let bench = Bench::new(1)?;
    let service = bench.program.start();
    let [mut canceled, mut stopped, mut taken] = [const { Vec::new() }; 3];
    let worker = bench.worker();
    for _ in 0..5 {
        let path = service.submit(&documents::integration(10_000_000));
        let lines = || worker.log().matches("chunk left").count();
        let before = lines();
        service.until(&path, |job| job.json()["progress"].as_f64() > Some(0.0));
        let asked = Instant::now();
        assert_eq!(service.send("POST", &format!("{path}/cancel"), "").status, 202);
        service.ended(&path);
        canceled.push(asked.elapsed().as_secs_f64());
        wait_until("the worker stops", || lines() > before);
        stopped.push(asked.elapsed().as_secs_f64());
    }
    println!(
        "cancel: ended after {:.0} ms, computed by nobody after {:.0} ms (medians of 5)",
        1e3 * median(&mut canceled),
        1e3 * median(&mut stopped)
    );
    drop(worker);
    for _ in 0..TURNS {
        let path = service.submit(&documents::integration(10_000_000));
        let first = bench.worker();
        wait_until("it is taken", || first.log().contains("chunk taken"));
        let second = bench.worker();
        wait_until("the other one is there", || second.log().contains("worker ready"));
        first.kill();
        let killed = Instant::now();
        wait_until("the other one has it", || second.log().contains("chunk taken"));
        taken.push(killed.elapsed().as_secs_f64());
        service.send("POST", &format!("{path}/cancel"), "");
        service.ended(&path);
    }
    println!(
        "kill -9 of a worker: its chunk is with another one after {:.1} s, with --ack-wait-s 3",
        median(&mut taken)
    );
    let _worker = bench.worker();
    series(&bench, &service, "one server");
    Some(())
}

/// What rows cost the service: a sweep of many cheap points. Nobody asks for it meanwhile, as answers cost too.
fn rows(sizing: &mut Sizing) -> Option<()> {
    const ROWS: u32 = 40_000;
    let bench = Bench::new(1)?;
    let service = bench.program.start();
    let _worker = bench.worker_with("2");
    service.until("/api/v1/system", |answer| answer.json()["workers"]["total"] == 2);
    let mut many = documents::sweep(ROWS);
    many["operation"]["pinion_torque_nm"] = json!(904.0);
    let (service_s, nats_s, started) = (cpu_s(service.id()), bench.nats_cpu_s(), Instant::now());
    let path = service.submit(&many);
    while !crate::program::is_ended(&service.get(&path)) {
        std::thread::sleep(Duration::from_secs(1));
    }
    let took_s = started.elapsed().as_secs_f64();
    sizing.row_s = (cpu_s(service.id()) - service_s) / f64::from(ROWS);
    let bytes = number(bench.program.database(), "SELECT SUM(LENGTH(body)) / COUNT(*) FROM sweep_points");
    println!(
        "{ROWS} rows of {bytes} bytes in {took_s:.0} s (load {}): processor time of the service {:.0} µs for each, so {:.0} \
         rows/s of one processor; of NATS {:.0} µs",
        load(),
        1e6 * sizing.row_s,
        1.0 / sizing.row_s,
        1e6 * (bench.nats_cpu_s() - nats_s) / f64::from(ROWS)
    );
    Some(())
}

/// A part of the measurements; None where it could not be measured.
type Part<'a> = &'a dyn Fn(&mut Sizing) -> Option<()>;

/// Jobs of one operating point that take no time: what a chunk costs each of them.
fn chunk_costs(sizing: &mut Sizing, servers: usize) -> Option<()> {
    let bench = Bench::new(servers)?;
    let service = bench.program.start();
    const JOBS: usize = 1000;
    for _ in 0..JOBS {
        service.submit(&documents::response());
    }
    let (nats_s, service_s) = (bench.nats_cpu_s(), cpu_s(service.id()));
    let started = Instant::now();
    let workers = [bench.worker_with("8"), bench.worker_with("8")];
    service.until("/api/v1/jobs?state=queued,running&limit=1", |answer| answer.json()["items"] == json!([]));
    let took_s = started.elapsed().as_secs_f64();
    let cost = |used_s: f64| 1e3 * used_s / JOBS as f64;
    println!(
        "{servers} server(s): {JOBS} jobs of one operating point in {took_s:.1} s, {:.0}/s; processor time for each: NATS \
         {:.2} ms, service {:.2} ms",
        JOBS as f64 / took_s,
        cost(bench.nats_cpu_s() - nats_s),
        cost(cpu_s(service.id()) - service_s)
    );
    sizing.chunks.push(Chunks {
        servers,
        nats_s: (bench.nats_cpu_s() - nats_s) / JOBS as f64,
        service_s: (cpu_s(service.id()) - service_s) / JOBS as f64,
    });
    drop(workers);
    Some(())
}

#[test]
#[ignore = "measures for some minutes"]
fn rates() {
    println!("program {}, load {}", executable(), load());
    let mut sizing = Sizing::default();
    let parts: [(&str, Part); 7] = [
        ("speeds", &speeds),
        ("three", &|_| three_servers()),
        ("reactions", &|_| reactions()),
        ("rows", &rows),
        ("chunks", &|sizing| chunk_costs(sizing, 1)),
        ("chunks", &|sizing| chunk_costs(sizing, 3)),
        ("memory", &|_| memory::of_a_hundred_thousand_chunks()),
    ];
    let wanted = std::env::var("RATES_PARTS").ok();
    for (name, part) in parts {
        if wanted.as_ref().is_none_or(|wanted| wanted.split(',').any(|one| one == name)) && part(&mut sizing).is_none()
        {
            return;
        }
    }
    sizing.print();
}
