//! Response bodies sent in small pieces, so that the buffers of a connection whose client does not read stay small.

use axum::body::{Body, Bytes, HttpBody};
use hyper::body::{Frame, SizeHint};
use std::convert::Infallible;
use std::pin::Pin;
use std::task::{Context, Poll};

/// Largest piece of a body.
pub(super) const PIECE_BYTES: usize = 32 * 1024;

/// A text in memory as a response body. The HTTP library takes a piece when the client has accepted most of those
/// before, and drops the body, with what guards it, when it has taken the last one.
pub(super) struct TextBody {
    text: Vec<u8>,
    sent: usize,
}

impl TextBody {
    pub(super) fn new(text: impl Into<Vec<u8>>) -> Self {
        Self { text: text.into(), sent: 0 }
    }
}

/// The pieces of the text.
impl Iterator for TextBody {
    type Item = Bytes;

    fn next(&mut self) -> Option<Bytes> {
        let rest = self.text.get(self.sent..).unwrap_or_default();
        // A copy: a slice in the buffers of the connection would keep the whole text in memory.
        let piece = Bytes::copy_from_slice(rest.get(..PIECE_BYTES).unwrap_or(rest));
        self.sent += piece.len();
        (!piece.is_empty()).then_some(piece)
    }
}

impl HttpBody for TextBody {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(mut self: Pin<&mut Self>, _: &mut Context<'_>) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        Poll::Ready(self.next().map(|piece| Ok(Frame::data(piece))))
    }

    fn is_end_stream(&self) -> bool {
        self.sent == self.text.len()
    }

    fn size_hint(&self) -> SizeHint {
        SizeHint::with_exact((self.text.len() - self.sent) as u64)
    }
}

impl From<TextBody> for Body {
    fn from(body: TextBody) -> Self {
        Body::new(body)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use http_body_util::BodyExt;

    #[tokio::test]
    async fn a_text_comes_in_pieces_and_tells_its_length() {
        let text: Vec<u8> = (0..=2 * PIECE_BYTES).map(|index| index as u8).collect();
        let mut body = TextBody::new(text.clone());
        assert_eq!(HttpBody::size_hint(&body).exact(), Some(text.len() as u64));
        let mut received = Vec::new();
        while let Some(frame) = body.frame().await {
            let piece = frame.unwrap().into_data().unwrap();
            assert!(piece.len() <= PIECE_BYTES);
            received.extend_from_slice(&piece);
        }
        assert!(received == text && body.is_end_stream());
        assert!(TextBody::new(Vec::new()).is_end_stream());
    }
}
