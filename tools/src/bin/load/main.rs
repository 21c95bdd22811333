//! The service under load: what it answers in a second, how it grows with the jobs it holds, how soon a cancel is done,
//! what memory it takes. Drives the release program over loopback and prints the tables of docs/BENCHMARKS.md; see
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
