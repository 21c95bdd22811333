//! The task of one connection.

use super::config::{MAX_BUFFER_BYTES, MAX_HEAD_BYTES};
use super::state::ConnectionState;
use super::stream::TrackedStream;
use crate::api::guarded_body::GuardedBody;
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

/// Serves requests until the client closes, a deadline passes, or (between requests) `close` is cancelled.
pub(crate) async fn run(stream: TcpStream, app: Router, state: ConnectionState, close: CancellationToken) {
    let requests = {
        let state = state.clone();
        service_fn(move |request: hyper::Request<Incoming>| {
            let guard = state.begin_request();
            let response = app.clone().oneshot(request.map(Body::new));
            async move {
                let response = response.await?;
                // The end of the response's body is the end of the request.
                Ok::<_, Infallible>(response.map(|body| GuardedBody::new(body, guard)))
            }
        })
    };
    let stream = TokioIo::new(TrackedStream::new(stream, state.clone()));
    let mut http = http1::Builder::new();
    http.max_header_size(MAX_HEAD_BYTES).max_buf_size(MAX_BUFFER_BYTES).header_read_timeout(None);
    let mut connection = pin!(http.serve_connection(stream, requests));
    let mut close = pin!(close.cancelled_owned());
    let mut is_closing = false;
    let mut timer = pin!(sleep_until(Instant::now()));
    poll_fn(|context| {
        if !is_closing && close.as_mut().poll(context).is_ready() {
            is_closing = true;
            // A response in progress is the last one; a connection between requests ends.
            connection.as_mut().graceful_shutdown();
        }
        if connection.as_mut().poll(context).is_ready() || (is_closing && state.can_close()) {
            return Poll::Ready(());
        }
        let Some(deadline) = state.deadline() else { return Poll::Pending };
        if timer.deadline() != deadline {
            timer.as_mut().reset(deadline);
        }
        timer.as_mut().poll(context)
    })
    .await;
}
