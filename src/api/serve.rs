//! Serving until told to stop, and stopping in bounded time.

use super::connections::{ConnectionConfig, Endings, listen};
use crate::work::Jobs;
use axum::Router;
use std::future::Future;
use std::time::Duration;
use tokio::net::TcpListener;

/// What open connections are given to end after the jobs have stopped.
const CONNECTION_DRAIN: Duration = Duration::from_secs(5);

/// Serves until `shutdown` completes; then takes no more jobs, ends event streams and waits, stops running jobs (they
/// run again after the restart), and returns within the configured drain time. Connections still open then are cut off.
pub async fn serve(
    listener: TcpListener,
    app: Router,
    connections: &ConnectionConfig,
    jobs: Jobs,
    shutdown: impl Future<Output = ()>,
) {
    let endings = Endings::default();
    let server = listen(listener, app, connections.clone(), endings.clone());
    tokio::pin!(server);
    tokio::select! {
        () = &mut server => return,
        () = shutdown => {}
    }
    endings.stop.cancel();
    let drained = async {
        if !jobs.close().await {
            tracing::warn!("running jobs did not stop in time; they are taken up after the restart");
        }
    };
    let ended = tokio::time::timeout(CONNECTION_DRAIN + jobs.drain(), &mut server);
    let ((), ended) = tokio::join!(drained, ended);
    if ended.is_err() {
        tracing::warn!("some connections were still open at the end of the drain");
        endings.cut.cancel();
        server.await;
    }
    jobs.store().close().await;
}
