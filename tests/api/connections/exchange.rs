//! Ordinary and odd exchanges over a connection.

use super::*;

const GET: &str = "GET /healthz HTTP/1.1\r\nhost: localhost\r\n\r\n";
const LAST: &str = "GET /healthz HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n";

#[tokio::test]
async fn requests_follow_each_other_on_a_connection() {
    let served = served(HttpConfig::default()).await;
    let mut stream = served.sent(GET).await;
    until(&mut stream, "\"ok\"}").await;
    stream.write_all(format!("{GET}HEAD{}{LAST}", &GET[3..]).as_bytes()).await.unwrap();
    let rest = heard(stream).await;
    assert!(rest.in_order);
    assert_eq!(rest.text.matches("HTTP/1.1 200 OK").count(), 3, "sent at once, answered in turn: {rest:?}");
    assert_eq!(rest.text.matches("\"ok\"}").count(), 2, "no body for HEAD: {rest:?}");
    assert!(rest.text.contains("content-length: 15"), "{rest:?}");
}

#[tokio::test]
async fn a_client_of_the_first_version_is_answered() {
    let served = served(HttpConfig::default()).await;
    let answer = heard(served.sent("GET /healthz HTTP/1.0\r\n\r\n").await).await;
    assert_eq!((answer.status(), answer.in_order), (200, true), "{answer:?}");
}

#[tokio::test]
async fn headers_beyond_the_bound_are_refused() {
    let served = served(HttpConfig::default()).await;
    let long = format!("GET /healthz HTTP/1.1\r\nhost: localhost\r\nx: {}\r\n\r\n", "y".repeat(40 << 10));
    assert_eq!(heard(served.sent(&long).await).await.status(), 431);
    let endless = format!("GET /{}", "y".repeat(40 << 10));
    assert!([414, 431].contains(&heard(served.sent(&endless).await).await.status()));
    let many = format!("GET /healthz HTTP/1.1\r\nhost: localhost\r\n{}\r\n", "x: y\r\n".repeat(200));
    assert_eq!(heard(served.sent(&many).await).await.status(), 431);
    let fits =
        format!("GET /healthz HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\nx: {}\r\n\r\n", "y".repeat(30 << 10));
    assert_eq!(heard(served.sent(&fits).await).await.status(), 200);
}

#[tokio::test]
async fn what_is_no_http_is_refused_and_the_service_goes_on() {
    let served = served(HttpConfig::default()).await;
    for text in [
        "\0\0\0\0\r\n\r\n",
        "\x16\x03\x01\x02\x00\x01\x00\x01\u{fc}\x03\x03 a TLS client\r\n\r\n",
        "GET\r\n\r\n",
        "GET / HTTP/9.9\r\n\r\n",
        "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
        "POST /api/v1/jobs HTTP/1.1\r\nhost: localhost\r\ncontent-length: 1\r\ncontent-length: 2\r\n\r\n{}",
        "POST /api/v1/jobs HTTP/1.1\r\nhost: localhost\r\ncontent-length: -1\r\n\r\n",
        "POST /api/v1/jobs HTTP/1.1\r\nhost: localhost\r\ntransfer-encoding: gzip\r\n\r\n",
    ] {
        let answer = heard(served.sent(text).await).await;
        assert!([0, 400, 505].contains(&answer.status()), "{text:?}: {answer:?}");
    }
    assert_eq!(served.get("/healthz").await.status(), 200);
}

#[tokio::test]
async fn a_client_that_leaves_in_the_middle_is_no_trouble() {
    let served = served(HttpConfig::default()).await;
    for part in
        ["", "GE", "GET /api/v1/jobs HTTP/1.1\r\n", "POST /api/v1/jobs HTTP/1.1\r\ncontent-length: 9\r\n\r\n{", GET]
    {
        drop(served.sent(part).await);
    }
    assert_eq!(served.get("/healthz").await.status(), 200);
    served.stop().await;
}
