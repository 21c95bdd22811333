//! A worker: takes chunks from NATS, computes them and sends their results. It has no state of its own; whatever it
//! holds when it dies is computed by another one.

mod beats;
mod chunk_run;
mod pull;
mod send;
mod stages;

use super::config::{NatsConfig, NatsServers};
use super::connect::{ClusterError, Nats, waited};
use super::names::{SPACES, Space, processor_class, solver_of, solver_of_class};
use crate::work::runner::pool;
use crate::work::solver::Solver;
use beats::{Registry, run_beats, say_goodbye};
use futures_util::StreamExt;
use herringbone_job::study::StageStore;
use pull::run_pull;
use stages::StageCache;
use std::sync::Arc;
use std::time::Duration;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;

/// Time in which all services answer with their spaces.
const SPACES_WAIT: Duration = Duration::from_secs(1);
/// Pause between two questions for a service.
const ASK_AGAIN: Duration = Duration::from_secs(1);

/// Settings of a worker.
#[derive(Debug, Clone, clap::Args)]
pub struct WorkerConfig {
    /// Address of the NATS servers (several with commas between them; `tls://` for an encrypted connection).
    #[arg(long, env = "HERRINGBONE_NATS", value_name = "nats://HOST:PORT")]
    pub nats: NatsServers,

    /// Space of the service to work for; not needed where there is one service.
    #[arg(long, env = "HERRINGBONE_SPACE", value_name = "NAME")]
    pub space: Option<Space>,

    /// Threads, and chunks that are computed at once; the number of processors when not given.
    #[arg(long, env = "HERRINGBONE_THREADS", value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    pub threads: Option<u32>,

    /// How long the worker waits, when it is asked to end, for finished points to be sent.
    #[arg(long, env = "HERRINGBONE_DRAIN_S", value_name = "SECONDS", default_value_t = 10,
          value_parser = clap::value_parser!(u32).range(0..=3600))]
    pub drain_s: u32,

    #[command(flatten)]
    pub connection: NatsConfig,
}

/// What the tasks of a worker share.
struct Worker {
    id: String,
    space: Space,
    nats: Nats,
    solver: Arc<dyn Solver>,
    /// Names under which work is taken.
    solvers: Vec<String>,
    threads: usize,
    pool: rayon::ThreadPool,
    stages: Arc<StageCache>,
    registry: Registry,
    /// Cancelled when the worker is to end.
    closing: CancellationToken,
    /// Cancelled when it no longer waits for anything.
    ended: CancellationToken,
    chunks: TaskTracker,
}

/// Runs a worker until `closing` is cancelled. Waits for NATS and for the service as long as it takes. `cache` keeps
/// stages besides.
///
/// # Errors
/// [`ClusterError`].
pub async fn run_worker(
    config: &WorkerConfig,
    solver: Arc<dyn Solver>,
    cache: Option<Arc<dyn StageStore + Send + Sync>>,
    closing: CancellationToken,
) -> Result<(), ClusterError> {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = config.threads.map_or(processors, |threads| threads as usize);
    let setup = async {
        let nats = Nats::connect(&config.nats, &config.connection, "herringbone worker", None).await?;
        let space = match &config.space {
            Some(space) => space.clone(),
            None => find_space(&nats).await?,
        };
        Ok::<_, ClusterError>((nats, space))
    };
    let (nats, space) = tokio::select! {
        made = setup => made?,
        () = closing.cancelled() => return Ok(()),
    };
    let version = solver.version();
    let worker = Arc::new(Worker {
        id: uuid::Uuid::new_v4().simple().to_string()[..12].to_owned(),
        stages: Arc::new(StageCache::new(nats.client.clone(), space.clone(), cache)),
        solvers: vec![solver_of(version), solver_of_class(version, processor_class())],
        pool: pool(threads, "solve")?,
        registry: Registry::default(),
        ended: CancellationToken::new(),
        chunks: TaskTracker::new(),
        space,
        nats,
        solver,
        threads,
        closing,
    });
    tracing::info!(worker = worker.id, space = %worker.space, threads, solver = version, "worker ready");
    let beats = tokio::spawn(run_beats(Arc::clone(&worker)));
    run_pull(Arc::clone(&worker)).await;
    tracing::info!("the worker ends");
    worker.registry.stop_all();
    worker.chunks.close();
    let drain = Duration::from_secs(config.drain_s.into());
    if tokio::time::timeout(drain, worker.chunks.wait()).await.is_err() {
        tracing::warn!("chunks were left; others compute them again");
    }
    worker.ended.cancel();
    beats.abort();
    say_goodbye(&worker).await;
    let _ = tokio::time::timeout(Duration::from_secs(1), worker.nats.client.flush()).await;
    Ok(())
}

/// The space of the only service at this NATS.
async fn find_space(nats: &Nats) -> Result<Space, ClusterError> {
    let found = waited(
        async {
            loop {
                match spaces(nats).await.as_slice() {
                    [] => tokio::time::sleep(ASK_AGAIN).await,
                    [space] => return Ok(space.clone()),
                    several => {
                        let names: Vec<String> = several.iter().map(Space::to_string).collect();
                        let names = names.join(", ");
                        return Err(ClusterError::Space(format!(
                            "several services answer: give --space, one of {names}"
                        )));
                    }
                }
            }
        },
        None,
        || format!("a service at NATS {}", nats.servers),
    )
    .await;
    found.unwrap_or_else(|| Err(ClusterError::Space("no service answers".to_owned())))
}

async fn spaces(nats: &Nats) -> Vec<Space> {
    let mut spaces = Vec::new();
    let inbox = nats.client.new_inbox();
    let Ok(mut answers) = nats.client.subscribe(inbox.clone()).await else { return spaces };
    if nats.client.publish_with_reply(SPACES, inbox, "".into()).await.is_err() {
        return spaces;
    }
    let collect = async {
        while let Some(answer) = answers.next().await {
            let name = std::str::from_utf8(&answer.payload).ok().and_then(|name| name.parse().ok());
            if let Some(space) = name.filter(|space| !spaces.contains(space)) {
                spaces.push(space);
            }
        }
    };
    let _ = tokio::time::timeout(SPACES_WAIT, collect).await;
    spaces
}
