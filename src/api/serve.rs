//! Serving, and shutting down in bounded time.

use super::connections::{ConnectionConfig, ShutdownTokens, listen};
use crate::work::Jobs;
use axum::Router;
use std::future::Future;
use std::time::Duration;
use tokio::net::TcpListener;

/// Time for open connections to end after the jobs have stopped.
const CONNECTION_DRAIN: Duration = Duration::from_secs(5);

/// Serves until `shutdown` completes. Then accepts no further jobs, ends event streams and waits, stops running jobs
/// (they run again after the restart), and returns within the configured drain time; connections still open then are
/// closed.
pub async fn serve(
    listener: TcpListener,
    app: Router,
    connections: &ConnectionConfig,
    jobs: Jobs,
    shutdown: impl Future<Output = ()>,
) {
    let tokens = ShutdownTokens::default();
    let server = listen(listener, app, connections.clone(), tokens.clone());
    tokio::pin!(server);
    tokio::select! {
        () = &mut server => return,
        () = shutdown => {}
    }
    tokens.graceful.cancel();
    let drained = async {
        if !jobs.close().await {
            tracing::warn!("running jobs did not stop in time; they are taken up after the restart");
        }
    };
    let ended = tokio::time::timeout(CONNECTION_DRAIN + jobs.drain(), &mut server);
    let ((), ended) = tokio::join!(drained, ended);
    if ended.is_err() {
        tracing::warn!("some connections were still open at the end of the drain");
        tokens.immediate.cancel();
        server.await;
    }
    jobs.store().close().await;
}
