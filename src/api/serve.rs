//! Serving until told to stop, and stopping in bounded time.

use crate::work::Jobs;
use axum::Router;
use std::future::{Future, IntoFuture};
use std::io;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio_util::sync::CancellationToken;

/// What open connections are given to end after the jobs have stopped.
const CONNECTION_DRAIN: Duration = Duration::from_secs(5);

/// Serves until `shutdown` completes; then takes no more jobs, ends event streams and waits, stops running jobs (they
/// run again after the restart), and returns within the configured drain time.
///
/// # Errors
/// When the listener fails.
pub async fn serve(
    listener: TcpListener,
    app: Router,
    jobs: Jobs,
    shutdown: impl Future<Output = ()>,
) -> io::Result<()> {
    let stop = CancellationToken::new();
    let server = axum::serve(listener, app).with_graceful_shutdown(stop.clone().cancelled_owned()).into_future();
    tokio::pin!(server);
    tokio::select! {
        ended = &mut server => return ended,
        () = shutdown => {}
    }
    stop.cancel();
    let drained = async {
        if !jobs.close().await {
            tracing::warn!("running jobs did not stop in time; they are taken up after the restart");
        }
    };
    let connections = tokio::time::timeout(CONNECTION_DRAIN + jobs.drain(), &mut server);
    let ((), ended) = tokio::join!(drained, connections);
    if ended.is_err() {
        tracing::warn!("some connections were still open at the end of the drain");
    }
    jobs.store().close().await;
    ended.unwrap_or(Ok(()))
}
