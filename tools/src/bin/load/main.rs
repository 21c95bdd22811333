//! The service under load: requests per second, growth of the times with the number of jobs, delay of a cancellation,
//! memory. Drives the release program over loopback and prints the tables of docs/BENCHMARKS.md; see
//! `scripts/load`.

mod cancel;
#[path = "../../../../tests/faults/documents.rs"]
mod documents;
mod memory;
mod requests;
mod store;
mod times;

use herringbone_tools::{Failure, arguments::Arguments};

type Part = fn() -> Result<(), Failure>;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::of_process();
    let parts: [(&str, Part); 5] = [
        ("requests", requests::measure),
        ("commit", store::commits),
        ("jobs", store::many_jobs),
        ("cancel", cancel::measure),
        ("memory", memory::measure),
    ];
    for (name, measure) in parts {
        if arguments.choose(name) {
            measure()?;
            println!();
        }
    }
    Ok(())
}
