//! Taking connections in.

use super::config::ConnectionConfig;
use super::connection;
use super::crowd::Crowd;
use super::pulse::Pulse;
use crate::api::telemetry::OpenConnection;
use axum::Router;
use std::io;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::net::{TcpListener, TcpStream};
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;

/// Pauses after a connection could not be accepted: where another one made room, and where none could.
const SHORT_PAUSE: Duration = Duration::from_millis(5);
const PAUSE: Duration = Duration::from_millis(100);
/// Time between two reports of it.
const REPORT_PAUSE: Duration = Duration::from_secs(1);

/// How connections are brought to an end.
#[derive(Debug, Clone, Default)]
pub struct Endings {
    /// No more connections; open ones end with the request in progress.
    pub stop: CancellationToken,
    /// Open ones end now.
    pub cut: CancellationToken,
}

/// Takes connections in until told to stop, then waits for the end of all.
pub async fn listen(listener: TcpListener, app: Router, config: ConnectionConfig, endings: Endings) {
    let crowd = Arc::new(Crowd::new(config.max_connections));
    let tasks = TaskTracker::new();
    let mut trouble = Trouble::default();
    while let Some(stream) = next(&listener, &crowd, &mut trouble, &endings.stop).await {
        // The newcomer waits here when all places are taken by requests in progress, the ones after it in the system.
        let place = tokio::select! {
            place = crowd.place() => place,
            () = endings.stop.cancelled() => break,
        };
        let leave = endings.stop.child_token();
        let pulse = Pulse::new(crowd.clone(), leave.clone(), config.clone());
        let (app, cut) = (app.clone(), endings.cut.clone());
        tasks.spawn(async move {
            let _held = (place, OpenConnection::new());
            let connection = connection::run(stream, app, pulse, leave);
            let _ = cut.run_until_cancelled_owned(connection).await;
        });
    }
    drop(listener);
    tasks.close();
    tasks.wait().await;
}

/// The next connection; `None` when it is time to stop.
async fn next(
    listener: &TcpListener,
    crowd: &Crowd,
    trouble: &mut Trouble,
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
            // The client was gone before it was its turn.
            Err(error) if is_of_client(&error) => {}
            Err(error) => {
                trouble.report(&error);
                let pause = if crowd.make_room() { SHORT_PAUSE } else { PAUSE };
                stop.run_until_cancelled(tokio::time::sleep(pause)).await?;
            }
        }
    }
}

/// Connections that cannot be accepted (no file descriptors, no memory), reported now and then.
#[derive(Default)]
struct Trouble {
    reported_at: Option<Instant>,
}

impl Trouble {
    fn report(&mut self, error: &io::Error) {
        let now = Instant::now();
        if self.reported_at.is_none_or(|last| now - last >= REPORT_PAUSE) {
            tracing::warn!(%error, "connections cannot be accepted");
            self.reported_at = Some(now);
        }
    }
}

fn is_of_client(error: &io::Error) -> bool {
    use io::ErrorKind::{ConnectionAborted, ConnectionRefused, ConnectionReset, Interrupted};
    matches!(error.kind(), ConnectionAborted | ConnectionRefused | ConnectionReset | Interrupted)
}
