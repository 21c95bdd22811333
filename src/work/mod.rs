//! The only bridge between async and the CPU: jobs are accepted here, handed to a queue, run on one pool of threads, and
//! what becomes of them is written and told to whoever waits.
//!
//! Invariant: nothing here knows HTTP or SQL; a job's state changes only through the [`Recorder`].

mod config;
mod failure;
mod hub;
mod jobs;
mod local;
mod measure;
mod memory;
mod points;
mod queue;
mod recorder;
mod retention;
mod reuse;
mod run;
mod solver;
mod stages;
mod stop;

pub use config::WorkConfig;
pub use hub::{Listener, News, Subscription};
pub use jobs::{Jobs, SubmitError, SubmitRequest, Submitted};
pub use local::LocalQueue;
pub use queue::{Pending, Queue, Workers};
pub use recorder::{Clock, Recorder};
pub use retention::{Sweep, sweep, tend};
pub use solver::{Solver, StudySolver};
