//! Over a real connection: serving, and stopping in bounded time.

use crate::support::*;
use herringbone::api::{self, ConnectionConfig};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;

#[tokio::test]
async fn an_open_event_stream_does_not_hold_up_the_shutdown() {
    let app = app().await;
    app.solver.breakpoints.hold("solve");
    let path = app.submit(&document()).await;
    app.solver.breakpoints.reached("solve", 1).await;
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let (stop, stopped) = oneshot::channel::<()>();
    let server = tokio::spawn({
        let (router, jobs) = (app.router.clone(), app.jobs.clone());
        async move {
            let shutdown = async { _ = stopped.await };
            api::serve(listener, router, &ConnectionConfig::default(), jobs, shutdown).await;
        }
    });
    let mut stream = TcpStream::connect(address).await.unwrap();
    let request = format!("GET {path}/events HTTP/1.1\r\nhost: {address}\r\n\r\n");
    stream.write_all(request.as_bytes()).await.unwrap();
    let mut seen = Vec::new();
    while !String::from_utf8_lossy(&seen).contains("event: state") {
        assert!(stream.read_buf(&mut seen).await.unwrap() > 0, "the stream ended early");
    }
    stop.send(()).unwrap();
    let ended = tokio::time::timeout(std::time::Duration::from_secs(20), server).await;
    ended.expect("the server stops in time").unwrap();
    let mut rest = Vec::new();
    stream.read_to_end(&mut rest).await.unwrap();
    assert!(!String::from_utf8_lossy(&rest).contains("event: done"));
}
