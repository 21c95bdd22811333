//! Progress and cancellation of long calculations.
//!
//! A [`Watch`] is the only connection of a calculation to its caller. Invariant: a calculation calls
//! [`Watch::checkpoint`] at least every 50 ms of work.

/// Error of a calculation that was canceled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the calculation was canceled")]
pub struct Canceled;

/// Callbacks of a calculation: one receives its progress, the other asks for its cancellation.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    progress: &'a (dyn Fn(f64) + Sync),
    canceled: &'a (dyn Fn() -> bool + Sync),
}

impl<'a> Watch<'a> {
    /// `progress` receives the completed fraction (0 to 1) of the current stage; `canceled` returns true to cancel.
    pub fn new(progress: &'a (dyn Fn(f64) + Sync), canceled: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self { progress, canceled }
    }

    /// A watch that reports nothing and never cancels.
    pub fn none() -> Watch<'static> {
        Watch { progress: &|_| {}, canceled: &|| false }
    }

    /// Checks for cancellation without a progress report.
    ///
    /// # Errors
    /// [`Canceled`].
    pub fn checkpoint_quietly(&self) -> Result<(), Canceled> {
        if (self.canceled)() { Err(Canceled) } else { Ok(()) }
    }

    /// Reports the completed fraction (0 to 1) and checks for cancellation.
    ///
    /// # Errors
    /// [`Canceled`].
    pub fn checkpoint(&self, fraction: f64) -> Result<(), Canceled> {
        if (self.canceled)() {
            return Err(Canceled);
        }
        (self.progress)(fraction);
        Ok(())
    }
}
