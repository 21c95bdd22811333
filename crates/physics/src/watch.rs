//! Progress and cancellation of long calculations.
//!
//! The physics takes a [`Watch`] and nothing else from the outside world. Invariant: a calculation passes a
//! [`Watch::checkpoint`] at least every 50 ms of work.

#![warn(missing_docs, unreachable_pub)]

/// Error of a calculation that was canceled before it ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the calculation was canceled")]
pub struct Canceled;

/// Two callbacks: one receives progress, one says whether to stop.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    progress: &'a (dyn Fn(f64) + Sync),
    canceled: &'a (dyn Fn() -> bool + Sync),
}

impl<'a> Watch<'a> {
    /// A watch over the given callbacks. `progress` receives the fraction done (0 to 1) of the current stage.
    pub fn new(progress: &'a (dyn Fn(f64) + Sync), canceled: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self { progress, canceled }
    }

    /// A watch without effect: progress is dropped and nothing is canceled.
    pub fn none() -> Watch<'static> {
        Watch { progress: &|_| {}, canceled: &|| false }
    }

    /// Fails with [`Canceled`] when cancellation was requested, without a report of progress.
    pub fn checkpoint_quietly(&self) -> Result<(), Canceled> {
        if (self.canceled)() { Err(Canceled) } else { Ok(()) }
    }

    /// Reports the fraction done (0 to 1) and fails with [`Canceled`] when cancellation was requested.
    pub fn checkpoint(&self, fraction: f64) -> Result<(), Canceled> {
        if (self.canceled)() {
            return Err(Canceled);
        }
        (self.progress)(fraction);
        Ok(())
    }
}
