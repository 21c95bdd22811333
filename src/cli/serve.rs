//! `herringbone serve`: runs the HTTP service in the foreground.

use anyhow::Context;
use clap::Args;
use herringbone::api::{self, Access, AppState, HttpConfig, LoginRenderer, Pages};
use herringbone::store::{Store, StoreConfig};
use herringbone::web;
use herringbone::webhook::{Deliverer, Setting as WebhookSetting, WebhookConfig};
#[cfg(feature = "cluster")]
use herringbone::work::cluster::{ClusterConfig, NatsSetup, QueueTarget};
use herringbone::work::{self, Jobs, StudySolver, WorkConfig};
use jiff::Timestamp;
use std::process::ExitCode;
use std::sync::Arc;
use tokio::net::TcpListener;
use tokio::signal::unix::{SignalKind, signal};
use tracing_subscriber::EnvFilter;

/// Number of open files besides connections: database, logs, sockets of the runtime.
const OTHER_FILES: u64 = 64;

#[derive(Debug, Args)]
pub(super) struct ServeArguments {
    #[command(flatten)]
    http: HttpConfig,
    #[command(flatten)]
    store: StoreConfig,
    #[command(flatten)]
    work: WorkConfig,
    #[cfg(feature = "cluster")]
    #[command(flatten)]
    cluster: ClusterConfig,
    #[command(flatten)]
    webhook: WebhookConfig,
    #[command(flatten)]
    log: LogConfig,
}

/// Settings of the log, which is written to standard error.
#[derive(Debug, Args)]
pub(super) struct LogConfig {
    /// Levels, for example `info` or `warn,herringbone=debug`.
    #[arg(long, env = "HERRINGBONE_LOG", value_name = "LEVELS", default_value = "info", value_parser = levels)]
    log: EnvFilter,

    /// One JSON object per line instead of text.
    #[arg(long, env = "HERRINGBONE_LOG_JSON")]
    log_json: bool,
}

pub(super) fn run(arguments: ServeArguments) -> ExitCode {
    start_log(&arguments.log);
    match serve(&arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("herringbone serve: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn levels(text: &str) -> Result<EnvFilter, String> {
    EnvFilter::try_new(text).map_err(|error| error.to_string())
}

pub(super) fn start_log(config: &LogConfig) {
    let log = tracing_subscriber::fmt().with_env_filter(config.log.clone()).with_writer(std::io::stderr);
    let log = log.with_ansi(std::io::IsTerminal::is_terminal(&std::io::stderr()));
    match config.log_json {
        true => log.json().flatten_event(true).init(),
        false => log.init(),
    }
    // Panics are logged like other events.
    std::panic::set_hook(Box::new(|panic| {
        let place = panic.location().map(ToString::to_string).unwrap_or_default();
        tracing::error!(place, message = panic.payload_as_str().unwrap_or_default(), "panic");
    }));
}

#[tokio::main]
async fn serve(arguments: &ServeArguments) -> anyhow::Result<()> {
    let http = &arguments.http;
    let mut terminate = signal(SignalKind::terminate()).context("signal handler")?;
    let mut interrupt = signal(SignalKind::interrupt()).context("signal handler")?;
    let access = Access::new(&http.access, http.listen)?;
    raise_file_limit(http.connections.max_connections);
    let listener = TcpListener::bind(http.listen).await.with_context(|| format!("cannot listen on {}", http.listen))?;
    let store = Store::open(&arguments.store).await?;
    // Before the first job can end.
    let deliverer = Deliverer::new(store.clone(), &arguments.webhook, WebhookSetting::real()).await?;
    let jobs = start_jobs(store, arguments).await?;
    if let Some(deliverer) = deliverer {
        tokio::spawn(deliverer.run(jobs.closing().clone()));
    }
    tokio::spawn(work::run_retention(jobs.clone(), arguments.store.retention, Arc::new(Timestamp::now)));
    tokio::spawn(work::run_file_watch(jobs.clone()));
    let state = AppState::new(jobs.clone(), Timestamp::now());
    let app = api::router(state, http, &access, pages(access.has_token()));
    let address = listener.local_addr()?;
    println!("herringbone {} serves on http://{address}/", env!("CARGO_PKG_VERSION"));
    let shutdown = async {
        tokio::select! {
            _ = terminate.recv() => {}
            _ = interrupt.recv() => {}
        }
        tracing::info!("shutting down");
    };
    api::serve(listener, app, &http.connections, jobs, shutdown).await;
    Ok(())
}

/// Starts the jobs: computed in this process, or by workers.
async fn start_jobs(store: Store, arguments: &ServeArguments) -> anyhow::Result<Jobs> {
    let (work, solver, clock) = (&arguments.work, Arc::new(StudySolver), Arc::new(Timestamp::now));
    let database = || format!("the database {}", arguments.store.database.display());
    #[cfg(feature = "cluster")]
    if let QueueTarget::Nats(servers) = &arguments.cluster.queue {
        let setup = NatsSetup::new(servers, &arguments.cluster, &store).await?;
        let jobs = Jobs::start_with_workers(store, (work, &arguments.cluster), setup, solver, clock).await;
        return jobs.map_err(anyhow::Error::from_boxed).with_context(database);
    }
    Jobs::start(store, work, solver, clock).await.map_err(anyhow::Error::from_boxed).with_context(database)
}

fn pages(has_login: bool) -> Pages {
    Pages {
        routes: web::routes(has_login),
        not_found: axum::routing::any(web::not_found),
        login: LoginRenderer(|notice| web::login(notice.status, notice.next, notice.error)),
    }
}

/// Raises the limit of open files to the hard limit, as each connection is one.
fn raise_file_limit(connections: u32) {
    match rlimit::increase_nofile_limit(u64::MAX) {
        Ok(files) if files < u64::from(connections) + OTHER_FILES => {
            tracing::warn!(files, connections, "fewer files may be open than connections are allowed (ulimit -n)");
        }
        Ok(_) => {}
        Err(error) => tracing::warn!(%error, "the limit of open files could not be raised"),
    }
}
