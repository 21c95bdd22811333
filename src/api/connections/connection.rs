//! One connection, from its opening to its end.

use super::config::{MAX_BUFFER_BYTES, MAX_HEAD_BYTES};
use super::pulse::Pulse;
use super::stream::Watched;
use crate::api::held::Held;
use axum::Router;
use axum::body::Body;
use hyper::body::Incoming;
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper_util::rt::TokioIo;
use std::convert::Infallible;
use std::future::{Future, poll_fn};
use std::pin::pin;
use std::task::Poll;
use tokio::net::TcpStream;
use tokio::time::{Instant, sleep_until};
use tokio_util::sync::CancellationToken;
use tower::ServiceExt;

/// Serves requests until the client ends, a deadline passes, or (between requests) `leave` is cancelled.
pub async fn run(stream: TcpStream, app: Router, pulse: Pulse, leave: CancellationToken) {
    let requests = {
        let pulse = pulse.clone();
        service_fn(move |request: hyper::Request<Incoming>| {
            let busy = pulse.begin();
            let answer = app.clone().oneshot(request.map(Body::new));
            async move {
                let answer = answer.await?;
                // The end of the answer's body is the end of the request.
                Ok::<_, Infallible>(answer.map(|body| Held::new(body, busy)))
            }
        })
    };
    let stream = TokioIo::new(Watched::new(stream, pulse.clone()));
    let mut http = http1::Builder::new();
    http.max_header_size(MAX_HEAD_BYTES).max_buf_size(MAX_BUFFER_BYTES).header_read_timeout(None);
    let mut connection = pin!(http.serve_connection(stream, requests));
    let mut left = pin!(leave.cancelled_owned());
    let mut is_leaving = false;
    let mut alarm = pin!(sleep_until(Instant::now()));
    poll_fn(|context| {
        if !is_leaving && left.as_mut().poll(context).is_ready() {
            is_leaving = true;
            // An answer in progress is the last one; a connection between requests ends.
            connection.as_mut().graceful_shutdown();
        }
        if connection.as_mut().poll(context).is_ready() || (is_leaving && pulse.is_dispensable()) {
            return Poll::Ready(());
        }
        let Some(deadline) = pulse.deadline() else { return Poll::Pending };
        if alarm.deadline() != deadline {
            alarm.as_mut().reset(deadline);
        }
        alarm.as_mut().poll(context)
    })
    .await;
}
