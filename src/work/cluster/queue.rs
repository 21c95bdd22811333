//! The queue over NATS.

use super::admit::resume;
use super::answers::{run_beats, run_owner, run_stage_reads, run_stage_writes, run_starts, take_space};
use super::config::{ClusterConfig, NatsServers};
use super::connect::{ClusterError, Nats, START_WAIT};
use super::dispatch::run_dispatcher;
use super::measure::run_measures;
use super::names::Space;
use super::reconcile::run_reconciler;
use super::results::run_results;
use super::shared::Shared;
use super::streams::Streams;
use crate::store::{ChunkState, JobId, Store, WorkClass};
use crate::work::config::WorkConfig;
use crate::work::queue::{BoxFuture, Member, Queue, Transport, WaitingWork, Workers};
use crate::work::recorder::JobRecorder;
use crate::work::runner::pool;
use crate::work::solver::Solver;
use crate::work::stop_signal::StopReason;
use async_nats::Subscriber;
use async_nats::jetstream::consumer::PullConsumer;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::watch;
use tokio_util::task::TaskTracker;

/// Name of the setting with the space of a database.
const SPACE_SETTING: &str = "space";

/// Has jobs computed by workers on other machines, and by this process what is not worth sending.
///
/// The database stays the only truth: a chunk is a row before it is published, results are stored before they are
/// acknowledged, and what NATS loses is published again.
pub struct NatsQueue {
    shared: Arc<Shared>,
    tasks: TaskTracker,
}

/// The connection of a service before it takes up jobs: the space is taken, the streams are there.
pub struct NatsSetup {
    space: Space,
    streams: Streams,
    owner: Vec<Subscriber>,
    requests: [Subscriber; 4],
    results: PullConsumer,
}

impl NatsSetup {
    /// Connects, takes the space and makes the streams; waits for a minute at most, and says for what.
    ///
    /// # Errors
    /// [`ClusterError`].
    pub async fn new(servers: &NatsServers, config: &ClusterConfig, store: &Store) -> Result<Self, ClusterError> {
        let nats = Nats::connect(servers, &config.nats, "herringbone serve", Some(START_WAIT)).await?;
        let space = match &config.space {
            Some(space) => space.clone(),
            None => {
                let kept = store.setting_or(SPACE_SETTING, &Space::generated().to_string()).await?;
                kept.parse().map_err(ClusterError::Space)?
            }
        };
        let owner = take_space(&nats, &space).await?;
        let unsuitable = |detail: String| ClusterError::Unsuitable { servers: servers.to_string(), detail };
        let subscribe = async |what: &str| {
            let subscribed = nats.client.subscribe(space.subject(what)).await;
            subscribed.map_err(|error| unsuitable(error.to_string()))
        };
        let requests = [
            subscribe("start").await?,
            subscribe("beat").await?,
            subscribe("stage.get").await?,
            subscribe("stage.put").await?,
        ];
        let streams = Streams {
            nats,
            space: space.clone(),
            replicas: config.nats_replicas.into(),
            result_bytes: i64::from(config.nats_results_mib) << 20,
            ack_wait: config.ack_wait(),
        };
        let results = streams.make().await?;
        tracing::info!(%space, "workers find this service by its space");
        Ok(Self { space, streams, owner, requests, results })
    }
}

impl NatsQueue {
    /// Starts the tasks, which take up jobs as soon as those of an earlier process are recovered.
    ///
    /// # Errors
    /// The threads cannot be started.
    pub fn start(
        setup: NatsSetup,
        (work, config): (&WorkConfig, &ClusterConfig),
        recorder: JobRecorder,
        solver: Arc<dyn Solver>,
        is_recovered: watch::Receiver<bool>,
    ) -> Result<Self, ClusterError> {
        let NatsSetup { space, streams, owner, requests, results } = setup;
        let local_pool = pool(work.thread_count(), "solve")?;
        let shared = Arc::new(Shared::new((work, config), space, streams, solver, recorder, local_pool));
        let tasks = TaskTracker::new();
        tasks.spawn(run_owner(Arc::clone(&shared), owner));
        tasks.spawn(run(Arc::clone(&shared), requests, results, is_recovered));
        Ok(Self { shared, tasks })
    }
}

/// Resumes the jobs of an earlier process, then answers workers, stores results and gives out work until the service
/// closes.
async fn run(
    shared: Arc<Shared>,
    requests: [Subscriber; 4],
    results: PullConsumer,
    mut is_recovered: watch::Receiver<bool>,
) {
    tokio::select! {
        _ = is_recovered.wait_for(|is_recovered| *is_recovered) => {}
        () = shared.closing().cancelled() => return,
    }
    while let Err(error) = resume(&shared).await {
        tracing::error!(%error, "jobs of an earlier run not read");
        if !shared.pause(Duration::from_secs(1)).await {
            return;
        }
    }
    let [starts, beats, stage_reads, stage_writes] = requests;
    let own = || Arc::clone(&shared);
    tokio::join!(
        run_starts(own(), starts),
        run_beats(own(), beats),
        run_stage_reads(own(), stage_reads),
        run_stage_writes(own(), stage_writes),
        run_results(own(), results),
        run_reconciler(own()),
        run_dispatcher(own()),
        run_measures(own()),
    );
}

impl Queue for NatsQueue {
    fn announce(&self, _job: JobId, _class: WorkClass) {
        self.shared.wake.notify_one();
    }

    fn stop(&self, job: JobId) {
        if let Some(job) = self.shared.state().jobs.get_mut(&job) {
            job.stop = Some(StopReason::Cancel);
        }
        self.shared.runner.cancel(job);
        self.shared.wake.notify_one();
    }

    fn workers(&self) -> Workers {
        let (state, (singles_here, sweeps_here)) = (self.shared.state(), self.shared.runner.busy());
        let (slots, running) = state.members.totals(Instant::now());
        let sweeps = state.jobs.values().filter(|job| job.class == WorkClass::Sweep && !job.runs_here()).count();
        Workers {
            total: slots + self.shared.config.local_workers as usize,
            busy: running + singles_here,
            sweeps_total: (self.shared.work.sweep_workers as usize).max(sweeps + sweeps_here),
            sweeps_busy: sweeps + sweeps_here,
        }
    }

    fn transport(&self) -> Transport {
        Transport::Nats { is_connected: self.shared.nats.is_up(), ack_wait: self.shared.config.ack_wait() }
    }

    fn members(&self) -> Vec<Member> {
        self.shared.state().members.list(Instant::now())
    }

    fn waiting_work(&self) -> Vec<WaitingWork> {
        let (state, now) = (self.shared.state(), Instant::now());
        let mut waiting: BTreeMap<&str, usize> = BTreeMap::new();
        for job in state.jobs.values() {
            let open = job.open.values().filter(|chunk| chunk.state != ChunkState::Stored && !chunk.is_running(now));
            *waiting.entry(&job.solver).or_default() += open.count();
        }
        let work = waiting.into_iter().filter(|(_, chunks)| *chunks > 0);
        work.map(|(solver, chunks)| WaitingWork {
            solver: solver.to_owned(),
            chunks,
            slots: state.members.slots(solver, now),
        })
        .collect()
    }

    fn close(&self, limit: Duration) -> BoxFuture<'_, bool> {
        self.shared.runner.close();
        self.tasks.close();
        self.shared.tasks.close();
        let all = async { tokio::join!(self.tasks.wait(), self.shared.tasks.wait()) };
        Box::pin(async move { tokio::time::timeout(limit, all).await.is_ok() })
    }
}
