//! Run time against error of every way to the mesh stiffness: ISO 6336-1, the analytic contact at several accuracies,
//! finite elements at every resolution. Prints the tables of docs/BENCHMARKS.md and draws docs/contact_ladder.svg.
//!
//! `RAYON_NUM_THREADS=1 scripts/tool contact_ladder [KEEP]`
//!
//! Everything runs on one thread. `KEEP` is a folder for the finite elements of the references, which take most of the
//! time: those found there are not solved again.

mod cases;
mod growth;
mod plot;
mod rungs;
mod tables;

use std::path::PathBuf;

use herringbone_tools::Failure;
use herringbone_tools::arguments::Arguments;

fn main() -> Result<(), Failure> {
    let keep = Arguments::of_process().word(0).map(PathBuf::from);
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    one_thread.install(|| -> Result<(), Failure> {
        let cases = cases::cases();
        let answers = rungs::answers(&cases, keep.as_deref())?;
        tables::summary(&answers);
        tables::analytic_by_case(&cases, &answers);
        tables::by_case(&cases, &answers);
        growth::tables(&cases[cases::SOURCE_CASE])?;
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/contact_ladder.svg");
        std::fs::write(path, plot::draw(&answers))?;
        Ok(())
    })
}
