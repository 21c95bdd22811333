//! The rate limit of wrong tokens.
//!
//! The right token is accepted at any time, so that nobody can lock others out by failing. The length of the token
//! protects against guessing; this limit slows down repeated attempts, also of clients with an outdated token.

use std::time::{Duration, Instant};

/// Failures in a row that are answered with 401.
const BURST: u32 = 10;
/// Time after which one further failure is answered with 401.
const INTERVAL: Duration = Duration::from_secs(1);

/// A token bucket from which each failure takes one token.
#[derive(Debug, Default)]
pub(crate) struct FailureLimiter {
    /// Time at which the bucket is full again, if nothing is taken.
    full_at: Option<Instant>,
}

impl FailureLimiter {
    /// Records a failure.
    ///
    /// # Errors
    /// The bucket is empty: the seconds to wait.
    pub(crate) fn record(&mut self, now: Instant) -> Result<(), u64> {
        let full_at = self.full_at.map_or(now, |known| known.max(now)) + INTERVAL;
        let excess = (full_at - now).saturating_sub(INTERVAL * BURST);
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
        let mut failures = FailureLimiter::default();
        let start = Instant::now();
        for _ in 0..BURST {
            assert_eq!(failures.record(start), Ok(()));
        }
        assert_eq!(failures.record(start), Err(1));
        assert_eq!(failures.record(start + INTERVAL / 2), Err(1));
        assert_eq!(failures.record(start + INTERVAL), Ok(()));
        assert_eq!(failures.record(start + INTERVAL), Err(1));
        let later = start + INTERVAL * 100;
        assert_eq!((0..50).filter(|_| failures.record(later).is_ok()).count(), BURST as usize);
    }
}
