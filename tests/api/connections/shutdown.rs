//! Stopping in bounded time, whatever is open.

use super::*;

#[tokio::test]
async fn an_open_event_stream_does_not_hold_up_the_shutdown() {
    let served = served(HttpConfig::default()).await;
    served.app.solver.breakpoints.hold("solve");
    let path = served.app.submit(&document()).await;
    served.app.solver.breakpoints.reached("solve", 1).await;
    let mut stream = served.sent(&format!("GET {path}/events HTTP/1.1\r\nhost: localhost\r\n\r\n")).await;
    until(&mut stream, "event: state").await;
    served.stop().await;
    let rest = heard(stream).await;
    assert!(rest.in_order && !rest.text.contains("event: done"), "{rest:?}");
}

#[tokio::test]
async fn idle_and_slow_clients_do_not_hold_it_up_and_a_request_in_progress_is_answered() {
    let served = served(HttpConfig { request_timeout_s: 1, ..HttpConfig::default() }).await;
    let get = "GET /healthz HTTP/1.1\r\nhost: localhost\r\n\r\n";
    let silent = served.connect().await;
    let mut idle = served.sent(get).await;
    until(&mut idle, "\"ok\"}").await;
    let slow = served.sent("GET /healthz HTTP/1.1\r\nhost: loc").await;
    let mut unfinished = served
        .sent(
            "POST /api/v1/jobs HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 9\r\n\
               expect: 100-continue\r\n\r\n",
        )
        .await;
    until(&mut unfinished, "100 Continue").await;
    let address = served.address;
    served.stop().await;
    for quiet in [silent, idle, slow] {
        assert_eq!(heard(quiet).await.text, "");
    }
    assert_eq!(heard(unfinished).await.status(), 408);
    assert!(TcpStream::connect(address).await.is_err(), "nothing listens any more");
}

#[tokio::test]
async fn a_client_that_does_not_read_is_cut_off_at_the_end_of_the_drain() {
    let served = served_with(ConnectionConfig { write_timeout: moments(500), ..ConnectionConfig::default() }).await;
    let request = "GET /assets/plotly.js HTTP/1.1\r\nhost: localhost\r\n\r\n";
    let mut stream = served.sent(&request.repeat(10)).await;
    until(&mut stream, "plotly.js").await;
    served.stop().await;
    assert!(heard(stream).await.text.len() < 40_000_000, "not all of it was sent");
}
