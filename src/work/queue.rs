//! The interface of job queues.

use crate::store::{JobId, WorkClass};
use std::future::Future;
use std::pin::Pin;
use std::time::Duration;

/// A boxed future, as [`Queue`] is used as a trait object.
pub type BoxFuture<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;

/// Numbers of workers, and of those that are busy.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Workers {
    /// Workers for jobs of one operating point.
    pub total: usize,
    pub busy: usize,
    pub sweeps_total: usize,
    pub sweeps_busy: usize,
}

/// Runs queued jobs and reports their outcome to the [`super::JobRecorder`]. A queue has no state of its own that must
/// survive a restart: queued jobs are in the database.
pub trait Queue: Send + Sync + 'static {
    /// Notifies the queue of a queued job of this class.
    fn announce(&self, job: JobId, class: WorkClass);

    /// Requests a running job to stop; without effect when it does not run.
    fn stop(&self, job: JobId);

    fn workers(&self) -> Workers;

    /// Starts no further job, requests the running ones to stop and waits for them, for `limit` at most; jobs that
    /// still run then run again after the restart. Returns whether all have stopped.
    fn close(&self, limit: Duration) -> BoxFuture<'_, bool>;
}
