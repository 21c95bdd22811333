//! The interface of job queues.

use crate::store::{JobId, WorkClass};
use jiff::Timestamp;
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

/// A worker on another machine, as it was heard of last.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    pub id: String,
    pub host: String,
    /// Version of the program.
    pub version: String,
    /// Version of the calculation: it computes only work of the same.
    pub solver_version: String,
    /// Chunks that it computes at once.
    pub slots: u32,
    pub last_beat_at: Timestamp,
    /// Time since then.
    pub silence: Duration,
    /// Silent for so long that its work is for others.
    pub is_lost: bool,
    pub running: Vec<MemberChunk>,
}

/// What a worker computes.
#[derive(Debug, Clone, PartialEq)]
pub struct MemberChunk {
    pub job: String,
    pub chunk: u32,
    pub stage: String,
    /// Fraction of the chunk that is done, 0 to 1.
    pub fraction: f64,
}

/// Work that waits for workers of one kind.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WaitingWork {
    /// Version of the calculation, and the class of processors where that matters.
    pub solver: String,
    /// Chunks that are published and not computed.
    pub chunks: usize,
    /// Slots of the workers that can take them.
    pub slots: usize,
}

/// What carries work to the workers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transport {
    /// Nothing: jobs run in this process.
    Local,
    /// NATS. `ack_wait`: silence of a worker after which its work is given to another.
    Nats { is_connected: bool, ack_wait: Duration },
}

/// Runs queued jobs and reports their outcome to the [`super::JobRecorder`]. A queue has no state of its own that must
/// survive a restart: queued jobs are in the database.
pub trait Queue: Send + Sync + 'static {
    /// Notifies the queue of a queued job of this class.
    fn announce(&self, job: JobId, class: WorkClass);

    /// Requests a running job to stop; without effect when it does not run.
    fn stop(&self, job: JobId);

    fn workers(&self) -> Workers;

    fn transport(&self) -> Transport {
        Transport::Local
    }

    /// The workers on other machines.
    fn members(&self) -> Vec<Member> {
        Vec::new()
    }

    /// Work that waits for workers on other machines.
    fn waiting_work(&self) -> Vec<WaitingWork> {
        Vec::new()
    }

    /// Starts no further job, requests the running ones to stop and waits for them, for `limit` at most; jobs that
    /// still run then run again after the restart. Returns whether all have stopped.
    fn close(&self, limit: Duration) -> BoxFuture<'_, bool>;
}
