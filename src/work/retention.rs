//! Retention: deletes ended jobs as configured, and returns free space to the file system.

use super::jobs::Jobs;
use super::recorder::Clock;
use crate::store::{RetentionConfig, Store, StoreError};
use jiff::{SignedDuration, Timestamp};
use std::time::{Duration, Instant};
use tokio_util::sync::CancellationToken;

/// Target duration of a transaction, as other writers wait for it.
const TRANSACTION: Duration = Duration::from_millis(50);
/// Largest number of jobs deleted in one transaction: by age, and by size, where only as many as necessary are deleted.
const MAX_BATCH: u32 = 64;
const MAX_BATCH_BY_SIZE: u32 = 8;
/// Pause between two passes; a refused job ends it.
const PAUSE: Duration = Duration::from_secs(10);
/// Difference between the clock and the monotonic time above which the clock is taken to have been set.
const CLOCK_JUMP: SignedDuration = SignedDuration::from_mins(5);
/// Time after the start, and after the clock was set, in which nothing is deleted by age.
const CLOCK_SETTLE: Duration = Duration::from_mins(10);
/// Free space is returned if it is more than this and more than a quarter of the file.
const MIN_FREE_BYTES: u64 = 16_000_000;
/// Size of the write-ahead log above which it is truncated.
const MAX_LOG_BYTES: u64 = 64 << 20;

/// The jobs deleted in one pass.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RetentionPass {
    /// Number of jobs deleted because of their age.
    pub by_age: u64,
    /// Number of jobs deleted because of the size of the database.
    pub by_size: u64,
}

/// Runs a pass every ten seconds and when a job was refused for want of space, until the jobs are closed. Errors are
/// logged.
pub async fn run_retention(jobs: Jobs, config: RetentionConfig, clock: Clock) {
    let (store, closing) = (jobs.store(), jobs.closing());
    let mut monitor = ClockMonitor::new(clock(), Instant::now());
    loop {
        tokio::select! {
            () = tokio::time::sleep(PAUSE) => {}
            () = store.space_needed().notified() => {}
            () = closing.cancelled() => return,
        }
        let now = clock();
        let keep_from = if monitor.is_settled(now, Instant::now()) { config.keep_from(now) } else { None };
        let pass = run_retention_pass(store, keep_from, closing).await;
        // After an error, jobs may have been deleted too.
        if !matches!(pass, Ok(deleted) if deleted == RetentionPass::default()) {
            jobs.publish_resync();
        }
        match pass {
            Ok(_) => {}
            Err(_) if closing.is_cancelled() => return,
            Err(error) => {
                tracing::error!(%error, "ended jobs could not be deleted");
                // Bounds the rate of passes when every refused job starts one.
                tokio::select! {
                    () = tokio::time::sleep(Duration::from_secs(1)) => {}
                    () = closing.cancelled() => return,
                }
            }
        }
    }
}

/// Runs one pass: deletes the jobs that ended before `keep_from`, then the oldest ones while the database is above its
/// size limit, and returns free space to the file system.
///
/// # Errors
/// The database cannot be read or written.
pub async fn run_retention_pass(
    store: &Store,
    keep_from: Option<Timestamp>,
    closing: &CancellationToken,
) -> Result<RetentionPass, StoreError> {
    let before = store.usage().await?;
    let mut deleted = RetentionPass::default();
    if let Some(keep_from) = keep_from {
        let mut batch = BatchSize::up_to(MAX_BATCH);
        while !closing.is_cancelled() {
            match batch.timed(|limit| store.delete_ended_before(keep_from, limit)).await? {
                0 => break,
                count => deleted.by_age += count,
            }
        }
    }
    let mut batch = BatchSize::up_to(MAX_BATCH_BY_SIZE);
    while !closing.is_cancelled() {
        match batch.timed(|limit| store.delete_for_size(deleted.by_size > 0, limit)).await? {
            0 => break,
            count => deleted.by_size += count,
        }
    }
    let after = store.usage().await?;
    let has_free_space = after.free_bytes() > MIN_FREE_BYTES && after.free_bytes() > after.file_bytes / 4;
    if deleted != RetentionPass::default() || has_free_space || after.log_bytes > MAX_LOG_BYTES {
        store.release_space().await?;
    }
    if deleted != RetentionPass::default() {
        let (by_age, by_size) = (deleted.by_age, deleted.by_size);
        let file = store.usage().await?.file_bytes;
        let megabytes = |bytes: u64| bytes as f64 / 1e6;
        let freed_mb = megabytes(before.used_bytes.saturating_sub(after.used_bytes));
        let (used_mb, file_mb) = (megabytes(after.used_bytes), megabytes(file));
        tracing::info!(by_age, by_size, freed_mb, used_mb, file_mb, "ended jobs deleted");
        metrics::counter!("herringbone_retention_deleted_jobs_total", "reason" => "age").increment(by_age);
        metrics::counter!("herringbone_retention_deleted_jobs_total", "reason" => "size").increment(by_size);
    }
    Ok(deleted)
}

/// Number of jobs deleted in one transaction, adapted to its duration: jobs have between a thousand bytes and a hundred
/// thousand points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct BatchSize {
    jobs: u32,
    max: u32,
}

impl BatchSize {
    fn up_to(max: u32) -> Self {
        Self { jobs: 1, max }
    }

    /// Deletes a batch, and adapts the size of the next one.
    async fn timed<F: Future<Output = Result<u64, StoreError>>>(
        &mut self,
        delete: impl FnOnce(u32) -> F,
    ) -> Result<u64, StoreError> {
        let started = Instant::now();
        let deleted = delete(self.jobs).await;
        *self = self.after(started.elapsed());
        deleted
    }

    /// The size after a transaction of this duration.
    fn after(self, duration: Duration) -> Self {
        match duration {
            short if short < TRANSACTION / 2 => Self { jobs: (2 * self.jobs).min(self.max), ..self },
            long if long > TRANSACTION => Self { jobs: (self.jobs / 2).max(1), ..self },
            _ => self,
        }
    }
}

/// Compares the clock with the monotonic time, as jobs must not be deleted by a clock that was set.
#[derive(Debug, Clone, Copy)]
struct ClockMonitor {
    clock: Timestamp,
    monotonic: Instant,
    /// Start of the monitor, or last time at which the clock was set.
    settled_since: Instant,
}

impl ClockMonitor {
    fn new(clock: Timestamp, monotonic: Instant) -> Self {
        Self { clock, monotonic, settled_since: monotonic }
    }

    /// Takes a reading of both. Returns whether the clock has run evenly for [`CLOCK_SETTLE`].
    fn is_settled(&mut self, clock: Timestamp, monotonic: Instant) -> bool {
        let passed = SignedDuration::try_from(monotonic.saturating_duration_since(self.monotonic)).unwrap_or_default();
        let offset = clock.duration_since(self.clock) - passed;
        if offset.abs() > CLOCK_JUMP {
            tracing::warn!(
                seconds = offset.as_secs_f64(),
                "the clock was set; nothing is deleted by age for ten minutes"
            );
            self.settled_since = monotonic;
        }
        (self.clock, self.monotonic) = (clock, monotonic);
        monotonic.saturating_duration_since(self.settled_since) >= CLOCK_SETTLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_grow_while_they_are_fast_and_shrink_when_they_are_slow() {
        let (fast, right, slow) = (Duration::from_millis(1), Duration::from_millis(40), Duration::from_secs(1));
        let four = BatchSize::up_to(6).after(fast).after(fast).after(right);
        assert_eq!(four.jobs, 4);
        assert_eq!(four.after(fast).jobs, 6, "no more than permitted");
        assert_eq!(four.after(slow).after(slow).after(slow).jobs, 1);
    }

    #[test]
    fn the_clock_is_settled_after_it_ran_evenly_for_ten_minutes() {
        let (start, monotonic) = (Timestamp::from_second(1_800_000_000).expect("a time"), Instant::now());
        let at = |seconds: i64| start.checked_add(SignedDuration::from_secs(seconds)).expect("a time");
        let after = |seconds: u64| monotonic + Duration::from_secs(seconds);
        let mut monitor = ClockMonitor::new(start, monotonic);
        assert!(!monitor.is_settled(at(599), after(599)), "the clock may be wrong at the start");
        assert!(monitor.is_settled(at(600), after(600)));
        assert!(monitor.is_settled(at(640), after(610)), "half a minute is below the threshold");
        let year = 365 * 86_400;
        assert!(!monitor.is_settled(at(year), after(620)), "a year ahead");
        assert!(!monitor.is_settled(at(630), after(630)), "a year back");
        assert!(!monitor.is_settled(at(1229), after(1229)));
        assert!(monitor.is_settled(at(1230), after(1230)));
    }
}
