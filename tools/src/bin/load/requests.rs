//! Status polls and submissions in a second.

use crate::documents;
use crate::times::Times;
use herringbone_tools::Failure;
use herringbone_tools::service::{Connection, Service};
use std::net::SocketAddr;
use std::time::{Duration, Instant};

const EACH: Duration = Duration::from_secs(3);

pub(crate) fn measure() -> Result<(), Failure> {
    let directory = tempfile::tempdir_in(".")?;
    println!("| requests | clients | per second | median | 99 % within | longest |\n|---|---|---|---|---|---|");
    let service = Service::start(&directory.path().join("polls.db"), &[])?;
    let path = service.connect()?.submit(&documents::response())?;
    for clients in [1, 16] {
        row("status poll, nothing runs", clients, polls(service.address, clients, &path)?);
    }
    for _ in 0..2 {
        service.connect()?.submit(&documents::integration(10_000_000))?;
    }
    std::thread::sleep(Duration::from_millis(500));
    for clients in [1, 16] {
        row("status poll, both cores solve", clients, polls(service.address, clients, &path)?);
    }
    drop(service);
    // The only worker is taken by one job on one thread, so that what is submitted waits.
    let options = ["--workers", "1", "--threads", "1", "--queue-capacity", "1000000"];
    let service = Service::start(&directory.path().join("submissions.db"), &options)?;
    service.connect()?.submit(&documents::integration(10_000_000))?;
    for clients in [1, 16] {
        let times =
            clients_at(service.address, clients, |connection| connection.submit(&documents::response()).map(drop))?;
        row("submission, one core solves", clients, times);
    }
    Ok(())
}

fn polls(address: SocketAddr, clients: usize, path: &str) -> std::io::Result<Times> {
    clients_at(address, clients, |connection| connection.send("GET", path, "*/*", "").map(drop))
}

/// Each of so many clients sends one request after the other on a connection of its own.
pub(crate) fn clients_at(
    address: SocketAddr,
    clients: usize,
    request: impl Fn(&mut Connection) -> std::io::Result<()> + Sync,
) -> std::io::Result<Times> {
    std::thread::scope(|scope| {
        let client = || -> std::io::Result<Times> {
            let mut connection = Connection::to(address)?;
            let mut times = Times::default();
            let end = Instant::now() + EACH;
            while Instant::now() < end {
                let began = Instant::now();
                request(&mut connection)?;
                times.add(began.elapsed());
            }
            Ok(times)
        };
        let clients: Vec<_> = (0..clients).map(|_| scope.spawn(client)).collect();
        let mut all = Times::default();
        for client in clients {
            all.append(client.join().map_err(|_| std::io::Error::other("a client panicked"))??);
        }
        Ok(all)
    })
}

fn row(what: &str, clients: usize, mut times: Times) {
    let per_s = times.len() as f64 / EACH.as_secs_f64();
    let [median, most, longest] = [0.5, 0.99, 1.0].map(|part| times.ms(part));
    println!("| {what} | {clients} | {per_s:.0} | {median:.2} ms | {most:.2} ms | {longest:.1} ms |");
}
