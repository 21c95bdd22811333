//! Optimisation: searches over evaluations of a document, and what is said of the best design.

mod neighbours;
mod outcome;
mod problem;
mod robust;
mod run;

pub(super) use neighbours::warnings;
pub(super) use problem::{Problem, check_shafts};
pub(super) use run::{run, run_part};
