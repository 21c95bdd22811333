//! Over real connections: how many, for how long, and how they end.

mod bodies;
mod bound;
mod deadlines;
mod exchange;
mod files;
mod followers;
mod memory;
mod shutdown;

use crate::support::*;
use herringbone::api::{self, ConnectionConfig, HttpConfig};
use std::net::SocketAddr;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;
use tokio::task::JoinHandle;

/// Longer than anything here takes unless it hangs.
const PATIENCE: Duration = Duration::from_secs(20);

/// A service that listens.
struct Served {
    app: App,
    address: SocketAddr,
    stop: oneshot::Sender<()>,
    server: JoinHandle<()>,
}

async fn served(http: HttpConfig) -> Served {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
    let address = listener.local_addr().expect("an address");
    let app = app_with_http(http.clone()).await;
    let (stop, stopped) = oneshot::channel::<()>();
    let (router, jobs) = (app.router.clone(), app.jobs.clone());
    let server = tokio::spawn(async move {
        let shutdown = async { _ = stopped.await };
        api::serve(listener, router, &http.connections, jobs, shutdown).await;
    });
    Served { app, address, stop, server }
}

async fn served_with(connections: ConnectionConfig) -> Served {
    served(HttpConfig { connections, ..HttpConfig::default() }).await
}

impl Served {
    async fn connect(&self) -> TcpStream {
        in_time(TcpStream::connect(self.address)).await.expect("a connection")
    }

    /// A connection on which something was sent.
    async fn sent(&self, text: &str) -> TcpStream {
        let mut stream = self.connect().await;
        stream.write_all(text.as_bytes()).await.expect("sent");
        stream
    }

    /// One request on a connection of its own.
    async fn get(&self, path: &str) -> Heard {
        let stream = self.sent(&format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n")).await;
        heard(stream).await
    }

    /// Stops the service; it has to end.
    async fn stop(self) {
        self.stop.send(()).expect("a listening service");
        in_time(self.server).await.expect("no panic");
    }
}

async fn in_time<T>(future: impl Future<Output = T>) -> T {
    tokio::time::timeout(PATIENCE, future).await.expect("it hangs")
}

/// All that came until the end of a connection.
#[derive(Debug)]
struct Heard {
    text: String,
    /// Whether it ended in order, not by a reset.
    in_order: bool,
}

impl Heard {
    /// 0 when nothing came.
    fn status(&self) -> u16 {
        self.text.split(' ').nth(1).and_then(|word| word.parse().ok()).unwrap_or_default()
    }
}

/// Reads to the end of the connection, which has to come.
async fn heard(mut stream: TcpStream) -> Heard {
    let mut bytes = Vec::new();
    let ended = in_time(stream.read_to_end(&mut bytes)).await;
    Heard { text: String::from_utf8_lossy(&bytes).into_owned(), in_order: ended.is_ok() }
}

/// Reads until the text has come.
async fn until(stream: &mut TcpStream, wanted: &str) -> String {
    let mut seen = Vec::new();
    while !String::from_utf8_lossy(&seen).contains(wanted) {
        let n = in_time(stream.read_buf(&mut seen)).await.expect("an unbroken connection");
        assert!(n > 0, "ended without {wanted:?}: {}", String::from_utf8_lossy(&seen));
    }
    String::from_utf8_lossy(&seen).into_owned()
}

fn moments(milliseconds: u64) -> Duration {
    Duration::from_millis(milliseconds)
}
