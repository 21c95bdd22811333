//! The bytes of a connection, with an eye on whether they move.

use super::pulse::Pulse;
use std::io::{self, IoSlice};
use std::pin::Pin;
use std::task::{Context, Poll, ready};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::TcpStream;

/// A stream that tells its connection's [`Pulse`] what happens to it.
pub struct Watched {
    inner: TcpStream,
    pulse: Pulse,
    /// This side has said that it sends no more.
    is_shut: bool,
}

impl Watched {
    pub fn new(inner: TcpStream, pulse: Pulse) -> Self {
        Self { inner, pulse, is_shut: false }
    }

    fn wrote(&self, written: Poll<io::Result<usize>>) -> Poll<io::Result<usize>> {
        self.pulse.wrote(written.is_pending());
        written
    }
}

impl AsyncRead for Watched {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        let read = Pin::new(&mut self.inner).poll_read(context, buffer);
        if buffer.filled().len() > before {
            self.pulse.heard();
        }
        read
    }
}

impl AsyncWrite for Watched {
    fn poll_write(mut self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.inner).poll_write(context, bytes);
        self.wrote(written)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        slices: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let written = Pin::new(&mut self.inner).poll_write_vectored(context, slices);
        self.wrote(written)
    }

    fn is_write_vectored(&self) -> bool {
        self.inner.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.inner).poll_flush(context)
    }

    /// Sends the end, then throws away what the client still sends until it ends too or the connection's deadline comes:
    /// closed at once, with bytes unread, the system would tell the client of a broken connection, and the answer (a 413
    /// to a large body, say) would be lost.
    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        if !self.is_shut {
            ready!(Pin::new(&mut self.inner).poll_shutdown(context))?;
            self.is_shut = true;
            self.pulse.linger();
        }
        let mut scratch = [0; 4096];
        // A client that sends faster than this reads must not keep the thread.
        for _ in 0..16 {
            let mut buffer = ReadBuf::new(&mut scratch);
            if self.pulse.is_leaving() || ready!(Pin::new(&mut self.inner).poll_read(context, &mut buffer)).is_err() {
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

impl Drop for Watched {
    /// What a client does not take is not kept by the system for it either.
    fn drop(&mut self) {
        if self.pulse.is_blocked() {
            // A connection that the client has reset meanwhile has nothing to forget.
            let _ = self.inner.set_zero_linger();
        }
    }
}
