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

    /// Whether the calculation is to be canceled, for a watch of a part of it.
    pub fn canceled(&self) -> &'a (dyn Fn() -> bool + Sync) {
        self.canceled
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

/// Multiplications and additions of a dense calculation between two checkpoints: some milliseconds of work.
const OPERATIONS_PER_CHECKPOINT: usize = 1 << 22;

/// Checkpoints of a calculation by the number of its operations.
#[derive(Clone, Copy)]
pub(crate) struct Meter<'a> {
    watch: Watch<'a>,
    since_checkpoint: usize,
}

impl<'a> Meter<'a> {
    /// A meter that passes the quiet checkpoints of `watch`.
    pub(crate) fn new(watch: Watch<'a>) -> Meter<'a> {
        Meter { watch, since_checkpoint: 0 }
    }

    /// Counts `operations`, and passes a checkpoint when enough have come together.
    ///
    /// # Errors
    /// [`Canceled`].
    #[inline(always)]
    pub(crate) fn count(&mut self, operations: usize) -> Result<(), Canceled> {
        self.since_checkpoint += operations;
        if self.since_checkpoint >= OPERATIONS_PER_CHECKPOINT { self.checkpoint() } else { Ok(()) }
    }

    /// Passes a checkpoint.
    ///
    /// # Errors
    /// [`Canceled`].
    pub(crate) fn checkpoint(&mut self) -> Result<(), Canceled> {
        self.since_checkpoint = 0;
        self.watch.checkpoint_quietly()
    }

    /// Number of pieces of so many operations each between two checkpoints, at least one.
    #[inline(always)]
    pub(crate) fn pieces(operations: usize) -> usize {
        (OPERATIONS_PER_CHECKPOINT / operations.max(1)).max(1)
    }

    /// Makes `values` so many zeros; a large vector's pages are taken piece by piece.
    ///
    /// # Errors
    /// [`Canceled`].
    pub(crate) fn zeros(&mut self, values: &mut Vec<f64>, len: usize) -> Result<(), Canceled> {
        values.clear();
        values.reserve_exact(len);
        while values.len() < len {
            let next = (values.len() + OPERATIONS_PER_CHECKPOINT).min(len);
            self.count(next - values.len())?;
            values.resize(next, 0.0);
        }
        Ok(())
    }
}
