//! The service under load: what it answers in a second, how it grows with the jobs it holds, how soon a cancel is done, what
//! memory it takes. Drives the release program over loopback and prints the tables of docs/BENCHMARKS.md; see `scripts/load`.

mod cancel;
mod connection;
#[path = "../../../../tests/faults/documents.rs"]
mod documents;
mod memory;
mod requests;
#[allow(dead_code, reason = "shared with the study, which reads other figures of the program")]
mod service;
mod store;
mod times;

use std::error::Error;

type Part = fn() -> Result<(), Box<dyn Error>>;

fn main() -> Result<(), Box<dyn Error>> {
    let chosen: Vec<String> = std::env::args().skip(1).collect();
    let parts: [(&str, Part); 5] = [
        ("requests", requests::measure),
        ("commit", store::commits),
        ("jobs", store::many_jobs),
        ("cancel", cancel::measure),
        ("memory", memory::measure),
    ];
    for (name, measure) in parts {
        if chosen.is_empty() || chosen.iter().any(|chosen| chosen == name) {
            measure()?;
            println!();
        }
    }
    Ok(())
}
