//! Memory of the process: idle, with many jobs, during a large sweep, with many connections.

use crate::requests::clients_at;
use crate::store::{MANY, fill};
use crate::{documents, times::Times};
use herringbone_tools::Failure;
use herringbone_tools::service::Connection;
use herringbone_tools::service::Service;
use std::path::Path;
use std::time::{Duration, Instant};

const POINTS: u32 = 100_000;
const CONNECTIONS: usize = 10_000;

pub(crate) fn measure() -> Result<(), Failure> {
    let directory = tempfile::tempdir_in(".")?;
    println!("| memory and large answers | |\n|---|---|");
    many_jobs(&directory.path().join("many.db"))?;
    large_sweep(&directory.path().join("sweep.db"))?;
    many_connections(&directory.path().join("connections.db"))
}

#[tokio::main]
async fn filled(database: &Path) -> Result<Duration, Failure> {
    fill(database, MANY).await
}

fn many_jobs(database: &Path) -> Result<(), Failure> {
    let service = Service::start(&database.with_file_name("idle.db"), &[])?;
    println!("| resident, idle after the start | {:.0} MB |", service.memory_mb("VmRSS"));
    drop(service);
    filled(database)?;
    println!("| database with 100 000 waiting jobs | {:.0} MB |", std::fs::metadata(database)?.len() as f64 / 1e6);
    let began = Instant::now();
    let service = Service::start(database, &["--queue-capacity", "1000000"])?;
    println!("| started over them in | {:.2} s |", began.elapsed().as_secs_f64());
    let mut connection = service.connect()?;
    std::thread::sleep(Duration::from_secs(2));
    for _ in 0..50 {
        connection.send("GET", "/api/v1/jobs?limit=200", "*/*", "")?;
    }
    println!("| resident, working them off, 50 pages of 200 read | {:.0} MB |", service.memory_mb("VmRSS"));
    Ok(())
}

fn large_sweep(database: &Path) -> Result<(), Failure> {
    let service = Service::start(database, &[])?;
    let mut connection = service.connect()?;
    let began = Instant::now();
    let path = connection.submit(&documents::sweep(POINTS))?;
    let mut during: f64 = 0.0;
    loop {
        let job = connection.json("GET", &path, "")?;
        if job["ended_at"].is_string() {
            if job["state"] != "succeeded" {
                return Err(job.to_string().into());
            }
            break;
        }
        during = during.max(service.memory_mb("VmRSS"));
        std::thread::sleep(Duration::from_millis(200));
    }
    println!("| sweep of 100 000 cheap points | {:.1} s |", began.elapsed().as_secs_f64());
    println!("| resident during it, at most | {during:.0} MB |");
    println!("| resident after it / at most so far | {:.0} MB / {:.0} MB |", rss(&service), service.memory_mb("VmHWM"));
    for (name, path, accept) in [
        ("its result as JSON", format!("{path}/result"), "application/json"),
        ("its points as CSV", format!("{path}/points"), "text/csv"),
    ] {
        let began = Instant::now();
        let (status, body) = connection.send("GET", &path, accept, "")?;
        if status != 200 {
            return Err(format!("{path}: {status}").into());
        }
        let (mb, seconds) = (body.len() as f64 / 1e6, began.elapsed().as_secs_f64());
        println!("| {name}: {mb:.0} MB read in | {seconds:.2} s |");
    }
    println!(
        "| resident after that / at most so far | {:.0} MB / {:.0} MB |",
        rss(&service),
        service.memory_mb("VmHWM")
    );
    Ok(())
}

fn many_connections(database: &Path) -> Result<(), Failure> {
    let files = rlimit::increase_nofile_limit(u64::MAX)?;
    let wanted = CONNECTIONS.min((files as usize).saturating_sub(200));
    let service = Service::start(database, &["--max-connections", "10100"])?;
    let path = service.connect()?.submit(&documents::response())?;
    let mut idle = Vec::new();
    for _ in 0..wanted {
        let mut connection = Connection::to(service.address)?;
        connection.send("GET", "/healthz", "*/*", "")?;
        idle.push(connection);
    }
    println!("| resident with {} idle connections | {:.0} MB |", idle.len(), rss(&service));
    let mut times: Times =
        clients_at(service.address, 1, |connection| connection.send("GET", &path, "*/*", "").map(drop))?;
    println!("| status poll beside them, median / 99 % within | {:.2} ms / {:.2} ms |", times.ms(0.5), times.ms(0.99));
    Ok(())
}

fn rss(service: &Service) -> f64 {
    service.memory_mb("VmRSS")
}
