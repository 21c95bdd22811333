//! The byte stream of a connection.

use super::state::ConnectionState;
use std::io::{self, IoSlice};
use std::pin::Pin;
use std::task::{Context, Poll, ready};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;

/// A TCP stream that reports reads and writes to its connection's [`ConnectionState`].
pub(crate) struct TrackedStream {
    inner: TcpStream,
    state: ConnectionState,
    /// Whether the writing side was shut down.
    is_shut: bool,
}

impl TrackedStream {
    pub(crate) fn new(inner: TcpStream, state: ConnectionState) -> Self {
        Self { inner, state, is_shut: false }
    }

    fn record_write(&self, written: Poll<io::Result<usize>>) -> Poll<io::Result<usize>> {
        self.state.record_write(written.is_pending());
        written
    }
}

impl AsyncRead for TrackedStream {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        let read = Pin::new(&mut self.inner).poll_read(context, buffer);
        if buffer.filled().len() > before {
            self.state.record_read();
        }
        read
    }
}

impl AsyncWrite for TrackedStream {
    fn poll_write(mut self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.inner).poll_write(context, bytes);
        self.record_write(written)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        slices: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.inner).poll_write_vectored(context, slices);
        self.record_write(written)
    }

    fn is_write_vectored(&self) -> bool {
        self.inner.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.inner).poll_flush(context)
    }

    /// Shuts down the writing side, then discards incoming bytes until the client closes too or the deadline passes.
    /// Closed at once with bytes unread, the operating system would reset the connection, and the response (for example
    /// a 413 to a large body) would be lost.
    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        if !self.is_shut {
            ready!(Pin::new(&mut self.inner).poll_shutdown(context))?;
            self.is_shut = true;
            self.state.begin_linger();
        }
        let mut scratch = [0; 4096];
        // A client that sends faster than this reads must not occupy the thread.
        for _ in 0..16 {
            let mut buffer = ReadBuf::new(&mut scratch);
            if self.state.is_closing() || ready!(Pin::new(&mut self.inner).poll_read(context, &mut buffer)).is_err() {
                return Poll::Ready(Ok(()));
            }
            if buffer.filled().is_empty() {
                return Poll::Ready(Ok(()));
            }
        }
        context.waker().wake_by_ref();
        Poll::Pending
    }
}

impl Drop for TrackedStream {
    /// Discards the unsent rest of a response that the client does not accept.
    fn drop(&mut self) {
        if self.state.is_blocked() {
            // Fails only for a connection that the client has reset already.
            let _ = self.inner.set_zero_linger();
        }
    }
}
