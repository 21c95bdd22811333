//! The request to stop a calculation.

use std::sync::atomic::{AtomicU8, Ordering};
use tokio_util::sync::CancellationToken;

/// The reason for stopping a calculation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum StopReason {
    Cancel = 1,
    Shutdown,
    /// Its turn is over, and other jobs wait.
    Turn,
    TimeLimit,
}

/// A request to stop, set once and read by the calculation at every checkpoint. The first reason is kept.
#[derive(Debug, Default)]
pub(super) struct StopSignal {
    reason: AtomicU8,
    requested: CancellationToken,
}

impl StopSignal {
    /// Requests the stop, unless it was requested before.
    pub(super) fn request(&self, reason: StopReason) {
        let _ = self.reason.compare_exchange(0, reason as u8, Ordering::Relaxed, Ordering::Relaxed);
        self.requested.cancel();
    }

    /// Waits until the stop is requested.
    pub(super) async fn requested(&self) {
        self.requested.cancelled().await;
    }

    /// Whether the stop was requested.
    pub(super) fn is_requested(&self) -> bool {
        self.reason.load(Ordering::Relaxed) != 0
    }

    /// The first reason; `None` without a request.
    pub(super) fn reason(&self) -> Option<StopReason> {
        [StopReason::Cancel, StopReason::Shutdown, StopReason::Turn, StopReason::TimeLimit]
            .into_iter()
            .find(|reason| *reason as u8 == self.reason.load(Ordering::Relaxed))
    }
}
