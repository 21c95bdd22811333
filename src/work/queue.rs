//! Where accepted jobs go to be run.

use crate::store::{JobId, WorkClass};
use std::future::Future;
use std::pin::Pin;
use std::time::Duration;

/// A future behind a pointer, so that queues can be exchanged at run time.
pub type Pending<'a, T> = Pin<Box<dyn Future<Output = T> + Send + 'a>>;

/// How many jobs can run at once, and how many do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Workers {
    /// Of jobs of one operating point.
    pub total: usize,
    pub busy: usize,
    pub sweeps_total: usize,
    pub sweeps_busy: usize,
}

/// Runs the jobs that wait in the store, and reports what becomes of them to the [`super::Recorder`]. A queue owns no
/// state that a restart would miss: what waits is in the store.
pub trait Queue: Send + Sync + 'static {
    /// Tells that a job of this class waits in the store.
    fn announce(&self, job: JobId, class: WorkClass);

    /// Asks whoever runs the job to stop; nothing happens when nobody does.
    fn stop(&self, job: JobId);

    fn workers(&self) -> Workers;

    /// Starts no further job, asks the running ones to stop and waits for them up to `limit`; whatever still runs then is
    /// taken up after the restart. True when all had stopped.
    fn close(&self, limit: Duration) -> Pending<'_, bool>;
}
