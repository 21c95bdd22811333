//! Clients that keep the service waiting.

use super::*;
use tokio::io::Interest;
use tokio::net::TcpSocket;

const GET: &str = "GET /healthz HTTP/1.1\r\nhost: localhost\r\n\r\n";

#[tokio::test]
async fn a_client_that_says_nothing_is_cut_off() {
    let served = served_with(ConnectionConfig { header_timeout: moments(200), ..ConnectionConfig::default() }).await;
    assert_eq!(heard(served.connect().await).await.text, "");
}

#[tokio::test]
async fn a_client_that_sends_its_headers_byte_by_byte_is_cut_off() {
    let served = served_with(ConnectionConfig { header_timeout: moments(300), ..ConnectionConfig::default() }).await;
    let mut stream = served.sent("GET /healthz HTTP/1.1\r\nx: ").await;
    let cut = in_time(async {
        loop {
            if stream.write_all(b"a").await.is_err() || matches!(stream.try_read(&mut [0; 64]), Ok(0)) {
                break;
            }
            tokio::time::sleep(moments(20)).await;
        }
    });
    cut.await;
}

#[tokio::test]
async fn the_second_request_of_a_connection_has_no_more_time_for_its_headers() {
    let limits =
        ConnectionConfig { header_timeout: moments(300), idle_timeout: PATIENCE * 2, ..ConnectionConfig::default() };
    let served = served_with(limits).await;
    let mut stream = served.sent(GET).await;
    until(&mut stream, "\"ok\"}").await;
    stream.write_all(b"GET /healthz HTTP/1.1\r\n").await.unwrap();
    assert_eq!(heard(stream).await.text, "");
}

#[tokio::test]
async fn a_connection_without_requests_ends() {
    let limits =
        ConnectionConfig { header_timeout: PATIENCE * 2, idle_timeout: moments(200), ..ConnectionConfig::default() };
    let served = served_with(limits).await;
    let answer = heard(served.sent(GET).await).await;
    assert_eq!((answer.status(), answer.in_order), (200, true), "{answer:?}");
}

#[tokio::test]
async fn a_request_in_progress_is_not_idle() {
    let limits = ConnectionConfig {
        header_timeout: moments(100),
        idle_timeout: moments(100),
        write_timeout: moments(100),
        ..ConnectionConfig::default()
    };
    let served = served_with(limits).await;
    served.app.solver.breakpoints.hold("solve");
    let path = served.app.submit(&document()).await;
    let request = format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nprefer: wait=1\r\n\r\n");
    let answer = heard(served.sent(&request).await).await;
    assert_eq!(answer.status(), 200, "{answer:?}");
    assert!(answer.text.contains("preference-applied: wait=1"), "{answer:?}");
    served.app.solver.breakpoints.release("solve");
}

#[tokio::test]
async fn a_body_that_does_not_come_is_answered_with_408() {
    let served = served(HttpConfig { request_timeout_s: 1, ..HttpConfig::default() }).await;
    let head = "POST /api/v1/jobs HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 1000\r\n\r\n{";
    let answer = heard(served.sent(head).await).await;
    assert_eq!(answer.status(), 408, "{answer:?}");
    assert!(answer.text.contains("request-timeout"), "{answer:?}");
}

#[tokio::test]
async fn a_client_that_takes_nothing_of_its_answer_is_cut_off() {
    let served = served_with(ConnectionConfig { write_timeout: moments(300), ..ConnectionConfig::default() }).await;
    let socket = TcpSocket::new_v4().unwrap();
    socket.set_recv_buffer_size(4096).unwrap();
    let mut stream = in_time(socket.connect(served.address)).await.unwrap();
    // Several megabytes each: more than the system keeps for a connection.
    let request = "GET /assets/plotly.js HTTP/1.1\r\nhost: localhost\r\n\r\n";
    stream.write_all(request.repeat(10).as_bytes()).await.unwrap();
    in_time(stream.ready(Interest::ERROR)).await.unwrap();
    let mut bytes = Vec::new();
    let ended = in_time(stream.read_to_end(&mut bytes)).await;
    assert!(ended.is_err(), "reset, so that the system keeps nothing for it; {} bytes came", bytes.len());
}

#[tokio::test]
async fn a_client_that_reads_slowly_gets_the_whole_answer() {
    let served = served_with(ConnectionConfig { write_timeout: moments(1000), ..ConnectionConfig::default() }).await;
    let mut stream =
        served.sent("GET /assets/plotly.js HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n").await;
    let head = until(&mut stream, "\r\n\r\n").await;
    let length = head.split("content-length: ").nth(1).and_then(|rest| rest.split('\r').next()).unwrap();
    let (length, mut taken) = (length.parse::<usize>().unwrap(), head.len() - head.find("\r\n\r\n").unwrap() - 4);
    let mut piece = vec![0; 1 << 18];
    loop {
        let n = in_time(stream.read(&mut piece)).await.unwrap();
        taken += n;
        if n == 0 {
            break;
        }
        tokio::time::sleep(moments(5)).await;
    }
    assert_eq!(taken, length);
}
