//! The housekeeper: deletes ended jobs as configured, and gives room back to the disk.

use super::jobs::Jobs;
use super::recorder::Clock;
use crate::store::{RetentionConfig, Store, StoreError};
use jiff::{SignedDuration, Timestamp};
use std::time::{Duration, Instant};
use tokio_util::sync::CancellationToken;

/// A transaction that deletes takes about this long: nobody waits much longer for the next one.
const TRANSACTION: Duration = Duration::from_millis(50);
/// Jobs deleted in one transaction, at most: by age, and for room, where no more should go than must.
const LARGEST_BATCH: u32 = 64;
const LARGEST_BATCH_FOR_ROOM: u32 = 8;
/// Pause between two sweeps; a refused job ends it.
const EVERY: Duration = Duration::from_secs(10);
/// A clock that moves this much more or less than the process's own time was set.
const JUMP: SignedDuration = SignedDuration::from_mins(5);
/// Nothing is deleted by age for so long after the start, and after the clock was set: time to set it right.
const SETTLE: Duration = Duration::from_mins(10);
/// Free pages are given back when they are more than this and more than a quarter of the file.
const WORTHWHILE_BYTES: u64 = 16_000_000;
/// A log longer than this is cut.
const LONG_LOG_BYTES: u64 = 64 << 20;

/// What one sweep did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Sweep {
    /// Jobs deleted because of their age.
    pub by_age: u64,
    /// Jobs deleted to make room.
    pub by_size: u64,
}

/// Sweeps until the jobs are closed. Errors are logged, and tried again at the next sweep.
pub async fn tend(jobs: Jobs, config: RetentionConfig, clock: Clock) {
    let (store, closing) = (jobs.store(), jobs.closing());
    let mut settled = Settled::since(clock(), Instant::now());
    loop {
        tokio::select! {
            () = tokio::time::sleep(EVERY) => {}
            () = store.pressed().notified() => {}
            () = closing.cancelled() => return,
        }
        let now = clock();
        let keep_from = if settled.still(now, Instant::now()) { config.keep_from(now) } else { None };
        match told(sweep(store, keep_from, closing).await, &jobs) {
            Ok(_) => {}
            Err(_) if closing.is_cancelled() => return,
            Err(error) => {
                tracing::error!(%error, "ended jobs could not be deleted");
                // Pressed again and again, it would fail again and again.
                tokio::select! {
                    () = tokio::time::sleep(Duration::from_secs(1)) => {}
                    () = closing.cancelled() => return,
                }
            }
        }
    }
}

/// Tells whoever listens when jobs went, or may have gone before an error.
fn told(swept: Result<Sweep, StoreError>, jobs: &Jobs) -> Result<Sweep, StoreError> {
    if !matches!(swept, Ok(done) if done == Sweep::default()) {
        jobs.deleted_several();
    }
    swept
}

/// One sweep: what ended before `keep_from` goes, then the oldest while room is short; then room is given back.
///
/// # Errors
/// When the store does not answer.
pub async fn sweep(
    store: &Store,
    keep_from: Option<Timestamp>,
    closing: &CancellationToken,
) -> Result<Sweep, StoreError> {
    let before = store.usage().await?;
    let mut done = Sweep::default();
    if let Some(keep_from) = keep_from {
        let mut batch = Batch::up_to(LARGEST_BATCH);
        while !closing.is_cancelled() {
            match batch.timed(|limit| store.delete_ended_before(keep_from, limit)).await? {
                0 => break,
                deleted => done.by_age += deleted,
            }
        }
    }
    let mut batch = Batch::up_to(LARGEST_BATCH_FOR_ROOM);
    while !closing.is_cancelled() {
        match batch.timed(|limit| store.delete_for_room(done.by_size > 0, limit)).await? {
            0 => break,
            deleted => done.by_size += deleted,
        }
    }
    let after = store.usage().await?;
    let worthwhile = after.free_bytes() > WORTHWHILE_BYTES && after.free_bytes() > after.file_bytes / 4;
    if done != Sweep::default() || worthwhile || after.log_bytes > LONG_LOG_BYTES {
        store.give_back().await?;
    }
    if done != Sweep::default() {
        let (by_age, by_size) = (done.by_age, done.by_size);
        let file = store.usage().await?.file_bytes;
        let megabytes = |bytes: u64| bytes as f64 / 1e6;
        let freed_mb = megabytes(before.used_bytes.saturating_sub(after.used_bytes));
        let (used_mb, file_mb) = (megabytes(after.used_bytes), megabytes(file));
        tracing::info!(by_age, by_size, freed_mb, used_mb, file_mb, "ended jobs deleted");
        metrics::counter!("herringbone_retention_deleted_jobs_total", "reason" => "age").increment(done.by_age);
        metrics::counter!("herringbone_retention_deleted_jobs_total", "reason" => "size").increment(done.by_size);
    }
    Ok(done)
}

/// How many jobs go in one transaction: one has a thousand bytes, another a hundred thousand points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Batch {
    jobs: u32,
    most: u32,
}

impl Batch {
    fn up_to(most: u32) -> Self {
        Self { jobs: 1, most }
    }

    async fn timed<F: Future<Output = Result<u64, StoreError>>>(
        &mut self,
        delete: impl FnOnce(u32) -> F,
    ) -> Result<u64, StoreError> {
        let started = Instant::now();
        let deleted = delete(self.jobs).await;
        *self = self.after(started.elapsed());
        deleted
    }

    fn after(self, took: Duration) -> Self {
        match took {
            short if short < TRANSACTION / 2 => Self { jobs: (2 * self.jobs).min(self.most), ..self },
            long if long > TRANSACTION => Self { jobs: (self.jobs / 2).max(1), ..self },
            _ => self,
        }
    }
}

/// Whether the clock has run evenly for long enough to delete by it.
#[derive(Debug, Clone, Copy)]
struct Settled {
    clock: Timestamp,
    own: Instant,
    since: Instant,
}

impl Settled {
    fn since(clock: Timestamp, own: Instant) -> Self {
        Self { clock, own, since: own }
    }

    fn still(&mut self, clock: Timestamp, own: Instant) -> bool {
        let passed = SignedDuration::try_from(own.saturating_duration_since(self.own)).unwrap_or_default();
        let off = clock.duration_since(self.clock) - passed;
        if off.abs() > JUMP {
            tracing::warn!(seconds = off.as_secs_f64(), "the clock was set; nothing is deleted by age for ten minutes");
            self.since = own;
        }
        (self.clock, self.own) = (clock, own);
        own.saturating_duration_since(self.since) >= SETTLE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn batches_grow_while_they_are_quick_and_shrink_when_they_are_not() {
        let (quick, right, slow) = (Duration::from_millis(1), Duration::from_millis(40), Duration::from_secs(1));
        let four = Batch::up_to(6).after(quick).after(quick).after(right);
        assert_eq!(four.jobs, 4);
        assert_eq!(four.after(quick).jobs, 6, "no more than permitted");
        assert_eq!(four.after(slow).after(slow).after(slow).jobs, 1);
    }

    #[test]
    fn a_clock_is_trusted_after_it_ran_evenly_for_a_while() {
        let (start, own) = (Timestamp::from_second(1_800_000_000).expect("a time"), Instant::now());
        let at = |seconds: i64| start.checked_add(SignedDuration::from_secs(seconds)).expect("a time");
        let after = |seconds: u64| own + Duration::from_secs(seconds);
        let mut settled = Settled::since(start, own);
        assert!(!settled.still(at(599), after(599)), "the clock may be wrong at the start");
        assert!(settled.still(at(600), after(600)));
        assert!(settled.still(at(640), after(610)), "half a minute is no jump");
        let year = 365 * 86_400;
        assert!(!settled.still(at(year), after(620)), "a year ahead");
        assert!(!settled.still(at(630), after(630)), "and back again");
        assert!(!settled.still(at(1229), after(1229)));
        assert!(settled.still(at(1230), after(1230)));
    }
}
