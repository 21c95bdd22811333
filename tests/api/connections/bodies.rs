//! Large requests: refused before they are taken in, and the client hears why.

use super::*;
use axum::body::{Body, Bytes};
use axum::http::Method;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

const LARGE: usize = 64 << 20;
const PIECE: usize = 1 << 16;
const HEAD: &str = "POST /api/v1/jobs HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\n";

#[tokio::test]
async fn no_more_of_a_large_body_is_taken_in_than_may_be() {
    let app = app().await;
    let taken = Arc::new(AtomicUsize::new(0));
    let pieces = futures_util::stream::unfold(taken.clone(), |taken| async move {
        let sent = taken.fetch_add(PIECE, Ordering::Relaxed);
        (sent < LARGE).then(|| (Ok::<_, std::io::Error>(Bytes::from(vec![b' '; PIECE])), taken))
    });
    let json = [("content-type", "application/json")];
    let answer = app.send(Method::POST, "/api/v1/jobs", &json, Body::from_stream(pieces)).await;
    answer.assert_problem(413, "payload-too-large");
    let taken = taken.load(Ordering::Relaxed);
    assert!(taken <= api::MAX_BODY_BYTES + 2 * PIECE, "{taken} bytes were taken");
}

/// Sends a whole body whatever the service says, as simple clients do, and then reads.
async fn pushed(served: &Served, head: &str, piece: Vec<u8>, count: usize) -> Heard {
    let mut stream = served.sent(head).await;
    for _ in 0..count {
        in_time(stream.write_all(&piece))
            .await
            .expect("listened to, or such a client would hear of a broken connection");
    }
    heard(stream).await
}

#[tokio::test]
async fn a_client_that_announces_too_much_hears_413() {
    let served = served(HttpConfig::default()).await;
    let answer =
        heard(served.sent(&format!("{HEAD}content-length: {LARGE}\r\nexpect: 100-continue\r\n\r\n")).await).await;
    assert_eq!(answer.status(), 413, "not 100: {answer:?}");
}

#[tokio::test]
async fn a_client_that_sends_sixteen_megabytes_first_and_reads_then_hears_413() {
    let served = served(HttpConfig::default()).await;
    // More than the system's buffers hold.
    let length = 16 << 20;
    let answer =
        pushed(&served, &format!("{HEAD}content-length: {length}\r\n\r\n"), vec![b' '; PIECE], length / PIECE).await;
    assert_eq!((answer.status(), answer.in_order), (413, true), "{answer:?}");
    let chunk = [format!("{PIECE:x}\r\n").into_bytes(), vec![b' '; PIECE], b"\r\n".to_vec()].concat();
    let answer = pushed(&served, &format!("{HEAD}transfer-encoding: chunked\r\n\r\n"), chunk, length / PIECE).await;
    assert_eq!((answer.status(), answer.in_order), (413, true), "{answer:?}");
}

#[tokio::test]
async fn sixty_four_megabytes_do_not_get_through() {
    let served = served(HttpConfig::default()).await;
    for head in [format!("{HEAD}content-length: {LARGE}\r\n\r\n"), format!("{HEAD}transfer-encoding: chunked\r\n\r\n")]
    {
        let chunk = [format!("{PIECE:x}\r\n").into_bytes(), vec![b' '; PIECE], b"\r\n".to_vec()].concat();
        let stream = served.sent(&head).await;
        let (mut reader, mut writer) = stream.into_split();
        let writing = tokio::spawn(async move {
            for _ in 0..LARGE / PIECE {
                if writer.write_all(&chunk).await.is_err() {
                    break;
                }
            }
        });
        // A client that reads while it sends hears why it is refused, at once.
        let mut seen = Vec::new();
        while !String::from_utf8_lossy(&seen).contains("payload-too-large") {
            let n = in_time(reader.read_buf(&mut seen)).await.expect("an answer before the end");
            assert!(n > 0, "no answer: {}", String::from_utf8_lossy(&seen));
        }
        assert!(String::from_utf8_lossy(&seen).starts_with("HTTP/1.1 413 "));
        in_time(writing).await.unwrap();
    }
    assert_eq!(served.get("/healthz").await.status(), 200);
}

#[tokio::test]
async fn http_1_1_names_one_host_and_http_1_0_need_not() {
    let served = served_with(ConnectionConfig::default()).await;
    for (head, status) in [
        ("GET /healthz HTTP/1.1\r\n", 400),
        ("GET http://localhost/healthz HTTP/1.1\r\n", 400),
        ("GET /api/v1/jobs HTTP/1.1\r\nhost: localhost\r\nhost: localhost\r\n", 400),
        ("GET /healthz HTTP/1.1\r\nhost: localhost\r\n", 200),
        ("GET /healthz HTTP/1.0\r\n", 200),
    ] {
        let answer = heard(served.sent(&format!("{head}connection: close\r\n\r\n")).await).await;
        assert_eq!(answer.status(), status, "{head}: {}", answer.text);
        assert_eq!(answer.text.contains("\"code\":\"invalid-parameter\""), status == 400, "{}", answer.text);
    }
}
