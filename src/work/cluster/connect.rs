//! The connection to NATS.

use super::config::{NatsConfig, NatsServers};
use async_nats::jetstream;
use async_nats::{Client, ConnectOptions, Event};
use std::sync::Arc;
use std::sync::Mutex;
use std::time::Duration;
use tokio::sync::watch;

/// Longest wait for the first connection and for the first streams.
pub(super) const START_WAIT: Duration = Duration::from_secs(60);
/// Time after which a wait is mentioned in the log, again and again.
const MENTION: Duration = Duration::from_secs(5);
/// Longest pause between two attempts to connect.
const MAX_PAUSE: Duration = Duration::from_secs(2);
/// Longest wait for the answer of a NATS server.
const API_TIMEOUT: Duration = Duration::from_secs(3);
/// Least size of messages that the NATS servers must take.
const LEAST_PAYLOAD: usize = 1 << 20;

/// Failure to reach NATS, or to find there what is needed.
#[derive(Debug, thiserror::Error)]
pub enum ClusterError {
    #[error("{file}: {detail}")]
    File { file: String, detail: String },
    #[error("no connection to NATS at {servers}: {detail}")]
    Unreachable { servers: String, detail: String },
    #[error("NATS at {servers}: {detail}")]
    Unsuitable { servers: String, detail: String },
    #[error("another service has the space \"{0}\": give this one another with --space")]
    SpaceTaken(String),
    #[error("{0}")]
    Space(String),
    #[error("threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    #[error(transparent)]
    Store(#[from] crate::store::StoreError),
}

/// Whether the connection stands, and how often it was made.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Connection {
    pub is_up: bool,
    pub count: u64,
}

/// A connection to NATS. It is made again by itself whenever it is lost. Cheap to clone.
#[derive(Clone)]
pub(super) struct Nats {
    pub client: Client,
    pub jetstream: jetstream::Context,
    pub connection: watch::Receiver<Connection>,
    pub servers: NatsServers,
}

impl Nats {
    /// Connects, and waits until the connection stands: for `limit`, or as long as it takes.
    ///
    /// # Errors
    /// [`ClusterError`].
    pub(super) async fn connect(
        servers: &NatsServers,
        config: &NatsConfig,
        name: &str,
        limit: Option<Duration>,
    ) -> Result<Self, ClusterError> {
        let (state, connection) = watch::channel(Connection::default());
        let last_error = Arc::new(Mutex::new(String::from("no answer")));
        let (sender, error) = (Arc::new(state), Arc::clone(&last_error));
        let options = options(config)
            .await?
            .name(name)
            .retry_on_initial_connect()
            .max_reconnects(None)
            .reconnect_delay_callback(|attempts| {
                (Duration::from_millis(100) * u32::try_from(attempts.min(20)).unwrap_or(20)).min(MAX_PAUSE)
            })
            .event_callback(move |event| {
                on_event(&event, &sender, &error);
                async {}
            });
        let unreachable = |detail: String| ClusterError::Unreachable { servers: servers.to_string(), detail };
        let client = options.connect(servers.addresses()).await.map_err(|error| unreachable(error.to_string()))?;
        let why = || last_error.lock().map(|text| text.clone()).unwrap_or_default();
        let mut changes = connection.clone();
        let up = async { changes.wait_for(|state| state.is_up).await.is_ok() };
        if !waited(up, limit, || format!("the connection to NATS at {servers} ({})", why())).await.unwrap_or(false) {
            return Err(unreachable(why()));
        }
        // Without it the information about the server may not be there.
        let _ = tokio::time::timeout(API_TIMEOUT, client.flush()).await;
        let payload = client.max_payload();
        if payload < LEAST_PAYLOAD {
            let detail = format!("max_payload is {payload} bytes; at least {LEAST_PAYLOAD} are needed");
            return Err(ClusterError::Unsuitable { servers: servers.to_string(), detail });
        }
        let mut jetstream = jetstream::new(client.clone());
        jetstream.set_timeout(API_TIMEOUT);
        tracing::info!(%servers, version = client.server_info().version, "connected to NATS");
        Ok(Self { client, jetstream, connection, servers: servers.clone() })
    }

    pub(super) fn is_up(&self) -> bool {
        self.connection.borrow().is_up
    }
}

/// Waits for something, for `limit` or as long as it takes; `None` when the limit is over. Says for what it waits.
pub(super) async fn waited<T>(
    until: impl Future<Output = T>,
    limit: Option<Duration>,
    what: impl Fn() -> String,
) -> Option<T> {
    let started = tokio::time::Instant::now();
    let mut until = std::pin::pin!(until);
    loop {
        tokio::select! {
            done = &mut until => return Some(done),
            () = tokio::time::sleep(MENTION) => {
                if limit.is_some_and(|limit| started.elapsed() >= limit) {
                    return None;
                }
                tracing::info!(waits_for = what(), "waiting");
            }
        }
    }
}

async fn options(config: &NatsConfig) -> Result<ConnectOptions, ClusterError> {
    let mut options = ConnectOptions::new();
    let file_error =
        |file: &std::path::Path, detail: String| ClusterError::File { file: file.display().to_string(), detail };
    for file in [&config.nats_ca, &config.nats_cert, &config.nats_key].into_iter().flatten() {
        std::fs::metadata(file).map_err(|error| file_error(file, error.to_string()))?;
    }
    if let Some(file) = &config.nats_ca {
        options = options.add_root_certificates(file.clone());
    }
    if let (Some(certificate), Some(key)) = (&config.nats_cert, &config.nats_key) {
        options = options.add_client_certificate(certificate.clone(), key.clone());
    }
    if let Some(file) = &config.nats_creds {
        options = options.credentials_file(file).await.map_err(|error| file_error(file, error.to_string()))?;
    }
    if let (Some(user), Some(file)) = (&config.nats_user, &config.nats_password_file) {
        let text = std::fs::read_to_string(file).map_err(|error| file_error(file, error.to_string()))?;
        let password = text.lines().next().unwrap_or_default().to_owned();
        options = options.user_and_password(user.clone(), password);
    }
    Ok(options)
}

fn on_event(event: &Event, state: &watch::Sender<Connection>, last_error: &Mutex<String>) {
    match event {
        Event::Connected => {
            state.send_modify(|state| *state = Connection { is_up: true, count: state.count + 1 });
            if state.borrow().count > 1 {
                tracing::info!("connected to NATS again");
                metrics::counter!("herringbone_nats_reconnects_total").increment(1);
            }
        }
        Event::Disconnected => {
            state.send_modify(|state| state.is_up = false);
            tracing::warn!("the connection to NATS is lost");
        }
        Event::ServerError(_) | Event::ClientError(_) => {
            if let Ok(mut text) = last_error.lock() {
                *text = event.to_string();
            }
            tracing::debug!(%event, "NATS");
        }
        _ => tracing::debug!(%event, "NATS"),
    }
}
