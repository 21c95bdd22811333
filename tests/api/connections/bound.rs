//! More connections than the bound permits.

use super::*;

/// Number of these connections that the service holds open.
fn open_count(streams: &[TcpStream]) -> usize {
    let is_open = |stream: &&TcpStream| match stream.try_read(&mut [0; 16]) {
        Ok(n) => n > 0,
        Err(error) => error.kind() == std::io::ErrorKind::WouldBlock,
    };
    streams.iter().filter(is_open).count()
}

async fn at_most_open(streams: &[TcpStream], limit: usize) -> usize {
    in_time(async {
        loop {
            let n = open_count(streams);
            if n <= limit {
                return n;
            }
            tokio::time::sleep(moments(10)).await;
        }
    })
    .await
}

/// Opens idle connections, and asks in between and afterwards.
async fn open_idle_connections(idle: usize, max_connections: u32) {
    // No timeout applies: only eviction closes connections.
    let limits = ConnectionConfig { max_connections, header_timeout: PATIENCE * 10, ..ConnectionConfig::default() };
    let served = served_with(limits).await;
    let mut streams = Vec::with_capacity(idle);
    for index in 0..idle {
        streams.push(served.connect().await);
        if index % 1000 == 999 {
            assert_eq!(served.get("/healthz").await.status(), 200, "after {} connections", index + 1);
        }
    }
    let served_at_once = served.get("/api/v1/jobs").await;
    assert_eq!(served_at_once.status(), 200, "the connection idle longest was closed");
    let left = at_most_open(&streams, max_connections as usize).await;
    assert!(left > 0, "no more connections are closed than necessary");
    println!("{idle} idle connections, at most {max_connections}: {left} are held, clients with requests are served");
    // The youngest are those that stay.
    assert_eq!(open_count(&streams[idle - left..]), left);
}

#[tokio::test]
async fn idle_connections_beyond_the_bound_are_closed_for_requests() {
    open_idle_connections(2000, 200).await;
}

#[tokio::test]
#[ignore = "opens ten thousand connections: needs `ulimit -n` of 12000"]
async fn ten_thousand_idle_connections_are_bounded() {
    open_idle_connections(10_000, 1024).await;
}

#[tokio::test]
async fn idle_connections_are_closed_after_the_timeout() {
    let limits = ConnectionConfig { max_connections: 50, header_timeout: moments(300), ..ConnectionConfig::default() };
    let served = served_with(limits).await;
    let mut streams = Vec::new();
    for _ in 0..50 {
        streams.push(served.connect().await);
    }
    assert_eq!(at_most_open(&streams, 0).await, 0);
}

#[tokio::test]
async fn connections_with_a_request_in_progress_are_not_closed() {
    let connections = ConnectionConfig { max_connections: 2, ..ConnectionConfig::default() };
    let served = served(HttpConfig { request_timeout_s: 1, connections, ..HttpConfig::default() }).await;
    let head = "POST /api/v1/jobs HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\n\
                content-length: 9\r\nexpect: 100-continue\r\n\r\n";
    let mut slow = Vec::new();
    for _ in 0..2 {
        // The service has read the head when it asks for the body.
        let mut stream = served.sent(head).await;
        until(&mut stream, "100 Continue").await;
        slow.push(stream);
    }
    // Waits in the system's queue until one of them has had its time.
    let third = served.get("/healthz").await;
    assert_eq!(third.status(), 200);
    for stream in slow {
        assert_eq!(heard(stream).await.status(), 408);
    }
}
