//! Wrong tokens: how fast they are answered.
//!
//! The right token gets in at any time, so that nobody can lock others out by failing. What keeps guesses out is the
//! token's length; this bound keeps them (and clients with an outdated token) from being answered without end, and tells
//! them to slow down.

use std::time::{Duration, Instant};

/// Failures in a row that are answered as such.
const BURST: u32 = 10;
/// After that, one in this time.
const PACE: Duration = Duration::from_secs(1);

/// A bucket that each failure takes a drop from.
#[derive(Debug, Default)]
pub struct Failures {
    /// When the bucket is full again, if nothing is taken.
    full_at: Option<Instant>,
}

impl Failures {
    /// Notes a failure.
    ///
    /// # Errors
    /// When there were too many: the seconds to wait.
    pub fn note(&mut self, now: Instant) -> Result<(), u64> {
        let full_at = self.full_at.map_or(now, |known| known.max(now)) + PACE;
        let excess = (full_at - now).saturating_sub(PACE * BURST);
        if excess.is_zero() {
            self.full_at = Some(full_at);
            return Ok(());
        }
        Err(excess.as_secs_f64().ceil() as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ten_at_once_then_one_a_second() {
        let mut failures = Failures::default();
        let start = Instant::now();
        for _ in 0..BURST {
            assert_eq!(failures.note(start), Ok(()));
        }
        assert_eq!(failures.note(start), Err(1));
        assert_eq!(failures.note(start + PACE / 2), Err(1));
        assert_eq!(failures.note(start + PACE), Ok(()));
        assert_eq!(failures.note(start + PACE), Err(1));
        let later = start + PACE * 100;
        assert_eq!((0..50).filter(|_| failures.note(later).is_ok()).count(), BURST as usize);
    }
}
