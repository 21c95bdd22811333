//! What the tasks of a service with workers share.

use super::active::State;
use super::config::ClusterConfig;
use super::connect::Nats;
use super::names::Space;
use super::streams::Streams;
use crate::store::{ChunkClass, JobId, Store};
use crate::work::config::WorkConfig;
use crate::work::recorder::JobRecorder;
use crate::work::runner::Runner;
use crate::work::solver::Solver;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::{Notify, Semaphore};
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;

/// What the tasks share.
pub(super) struct Shared {
    pub work: WorkConfig,
    pub config: ClusterConfig,
    pub space: Space,
    pub nats: Nats,
    pub streams: Streams,
    pub solver: Arc<dyn Solver>,
    /// Runs jobs in this process, and puts the results of sweeps together.
    pub runner: Arc<Runner>,
    pub local_pool: Arc<rayon::ThreadPool>,
    /// Places for jobs in this process.
    pub local_places: Arc<Semaphore>,
    /// Jobs that run in this process.
    pub tasks: TaskTracker,
    /// Wakes the dispatcher.
    pub wake: Notify,
    state: Mutex<State>,
    /// Consumers of work that were made.
    consumers: Mutex<BTreeSet<(String, ChunkClass)>>,
}

impl Shared {
    pub(super) fn new(
        (work, config): (&WorkConfig, &ClusterConfig),
        space: Space,
        streams: Streams,
        solver: Arc<dyn Solver>,
        recorder: JobRecorder,
        local_pool: rayon::ThreadPool,
    ) -> Self {
        let local_places = Arc::new(Semaphore::new(config.local_workers as usize));
        Self {
            runner: Arc::new(Runner::new(work, recorder, Arc::clone(&solver))),
            work: work.clone(),
            config: config.clone(),
            space,
            nats: streams.nats.clone(),
            streams,
            solver,
            local_pool: Arc::new(local_pool),
            local_places,
            tasks: TaskTracker::new(),
            wake: Notify::new(),
            state: Mutex::default(),
            consumers: Mutex::default(),
        }
    }

    pub(super) fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn consumers(&self) -> MutexGuard<'_, BTreeSet<(String, ChunkClass)>> {
        self.consumers.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(super) fn recorder(&self) -> &JobRecorder {
        self.runner.recorder()
    }

    pub(super) fn store(&self) -> &Store {
        self.recorder().store()
    }

    pub(super) fn closing(&self) -> &CancellationToken {
        self.runner.closing()
    }

    /// Tells all workers to stop a job; one that misses it learns it with its next beat.
    pub(super) async fn broadcast_stop(&self, job: JobId) {
        let _ = self.nats.client.publish(self.space.subject("cancel"), job.to_string().into()).await;
    }

    /// Waits for so long; false when the service closes.
    pub(super) async fn pause(&self, time: std::time::Duration) -> bool {
        tokio::select! {
            () = tokio::time::sleep(time) => true,
            () = self.closing().cancelled() => false,
        }
    }
}
