//! Accepting connections.

use super::config::ConnectionConfig;
use super::connection;
use super::limiter::ConnectionLimiter;
use super::state::ConnectionState;
use crate::api::telemetry::OpenConnection;
use axum::Router;
use std::io;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::net::{TcpListener, TcpStream};
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;

/// Pauses after a connection could not be accepted: where an idle one was closed for it, and where none could be.
const SHORT_PAUSE: Duration = Duration::from_millis(5);
const PAUSE: Duration = Duration::from_millis(100);
/// Shortest time between two log lines about it.
const LOG_INTERVAL: Duration = Duration::from_secs(1);

/// The two steps of a shutdown, as seen by connections.
#[derive(Debug, Clone, Default)]
pub(crate) struct ShutdownTokens {
    /// No further connections; open ones end with the request in progress.
    pub(crate) graceful: CancellationToken,
    /// Open ones end at once.
    pub(crate) immediate: CancellationToken,
}

/// Accepts connections until [`ShutdownTokens::graceful`] is cancelled, then waits for the end of all.
pub(crate) async fn listen(listener: TcpListener, app: Router, config: ConnectionConfig, shutdown: ShutdownTokens) {
    let limiter = Arc::new(ConnectionLimiter::new(config.max_connections));
    let tasks = TaskTracker::new();
    let mut errors = AcceptErrorLog::default();
    while let Some(stream) = accept(&listener, &limiter, &mut errors, &shutdown.graceful).await {
        // With all permits held by requests in progress, this connection waits here and later ones in the system's
        // backlog.
        let permit = tokio::select! {
            permit = limiter.acquire() => permit,
            () = shutdown.graceful.cancelled() => break,
        };
        let close = shutdown.graceful.child_token();
        let state = ConnectionState::new(limiter.clone(), close.clone(), config.clone());
        let (app, immediate) = (app.clone(), shutdown.immediate.clone());
        tasks.spawn(async move {
            let _guards = (permit, OpenConnection::new());
            let connection = connection::run(stream, app, state, close);
            let _ = immediate.run_until_cancelled_owned(connection).await;
        });
    }
    drop(listener);
    tasks.close();
    tasks.wait().await;
}

/// The next connection; `None` once `stop` is cancelled.
async fn accept(
    listener: &TcpListener,
    limiter: &ConnectionLimiter,
    errors: &mut AcceptErrorLog,
    stop: &CancellationToken,
) -> Option<TcpStream> {
    loop {
        let accepted = stop.run_until_cancelled(listener.accept()).await?;
        match accepted {
            Ok((stream, _)) => {
                // Events are small and must not wait for each other.
                if let Err(error) = stream.set_nodelay(true) {
                    tracing::debug!(%error, "no TCP_NODELAY");
                }
                return Some(stream);
            }
            // The client closed before the connection was accepted.
            Err(error) if is_client_error(&error) => {}
            Err(error) => {
                errors.record(&error);
                let pause = if limiter.evict() { SHORT_PAUSE } else { PAUSE };
                stop.run_until_cancelled(tokio::time::sleep(pause)).await?;
            }
        }
    }
}

/// Log of connections that cannot be accepted (no file descriptors, no memory), with a bounded rate.
#[derive(Default)]
struct AcceptErrorLog {
    logged_at: Option<Instant>,
}

impl AcceptErrorLog {
    fn record(&mut self, error: &io::Error) {
        let now = Instant::now();
        if self.logged_at.is_none_or(|last| now - last >= LOG_INTERVAL) {
            tracing::warn!(%error, "connections cannot be accepted");
            self.logged_at = Some(now);
        }
    }
}

fn is_client_error(error: &io::Error) -> bool {
    use io::ErrorKind::{ConnectionAborted, ConnectionRefused, ConnectionReset, Interrupted};
    matches!(error.kind(), ConnectionAborted | ConnectionRefused | ConnectionReset | Interrupted)
}
