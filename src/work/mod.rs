//! Running jobs: submission, the queue, workers on CPU thread pools, storing results and publishing events. The only
//! bridge between async code and CPU threads.
//!
//! Invariant: no HTTP and no SQL here; the state of a job changes only through the [`JobRecorder`].

#[cfg(feature = "cluster")]
pub mod cluster;
mod config;
mod database_stages;
mod estimate;
mod failure;
mod file_watch;
mod hub;
mod job_run;
mod jobs;
mod local_queue;
mod measure;
mod memory;
mod queue;
mod recorder;
mod retention;
mod reuse;
mod runner;
mod running_points;
mod solver;
mod stop_signal;
mod trace;

pub use config::WorkConfig;
pub use estimate::Estimate;
pub use file_watch::run_file_watch;
pub use hub::{JobEvent, JobEventListener, JobSubscription};
pub use jobs::{Jobs, SubmitError, SubmitRequest, Submitted};
pub use local_queue::LocalQueue;
pub use queue::{BoxFuture, Member, MemberChunk, Queue, Transport, WaitingWork, Workers};
pub use recorder::{Clock, JobRecorder};
pub use retention::{RetentionPass, run_retention, run_retention_pass};
pub use solver::{Solver, StudySolver};
pub use trace::is_traceparent;
