//! Ended jobs that go again: by age, or the oldest when room runs short. Live jobs are never touched.

use super::connect::{Store, StoreError};
use jiff::Timestamp;
use tokio::sync::Notify;

/// How long ended jobs stay.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct RetentionConfig {
    /// Ended jobs are deleted so many days after their end; they stay when not given.
    #[arg(long, env = "HERRINGBONE_KEEP_DAYS", value_name = "DAYS", value_parser = clap::value_parser!(u32).range(1..=36_500))]
    pub keep_days: Option<u32>,

    /// Room for the database in MB (1000000 bytes): beyond it the oldest ended jobs are deleted, and new jobs refused when
    /// that does not help. No bound when not given.
    #[arg(long, env = "HERRINGBONE_MAX_DATABASE_MB", value_name = "MB", value_parser = clap::value_parser!(u32).range(8..=100_000_000))]
    pub max_database_mb: Option<u32>,
}

impl RetentionConfig {
    /// What ended before is deleted.
    pub fn keep_from(&self, now: Timestamp) -> Option<Timestamp> {
        let age = jiff::SignedDuration::from_hours(24 * i64::from(self.keep_days?));
        now.checked_sub(age).ok()
    }

    pub(super) fn limit(&self, page_bytes: u64) -> Option<Limit> {
        let bytes = u64::from(self.max_database_mb?) * 1_000_000;
        // What cancels, deletes or ends a job needs a page here and there, even when nothing else may grow.
        let reserve = (bytes / 50).max(500_000);
        let pages = |bytes: u64| bytes / page_bytes;
        Some(Limit {
            bytes,
            max_pages: pages(bytes + bytes / 10),
            max_pages_in_need: pages(bytes + bytes / 10 + reserve),
        })
    }
}

/// The bound of the database's size and what happens around it: above `bytes` the oldest ended jobs go until 90 % are
/// left; from 105 % on no job is taken; what runs may use up 110 %, where SQLite itself stops. The last 2 % above that (at least
/// 0.5 MB) are for what makes room or ends a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Limit {
    bytes: u64,
    pub max_pages: u64,
    pub max_pages_in_need: u64,
}

impl Limit {
    fn goal(&self) -> u64 {
        self.bytes / 10 * 9
    }

    fn admits(&self) -> u64 {
        self.bytes + self.bytes / 20
    }

    /// Stages kept for reuse take at most a quarter of the room.
    pub fn stages(limit: Option<&Self>) -> i64 {
        limit.map_or(i64::MAX, |limit| i64::try_from(limit.bytes / 4).unwrap_or(i64::MAX))
    }
}

impl Store {
    /// Whether there is room for another job.
    ///
    /// # Errors
    /// [`StoreError::LimitReached`]; whoever waits for [`Store::pressed`] hears of it.
    pub async fn admit(&self) -> Result<(), StoreError> {
        let Some(limit) = &self.limit else { return Ok(()) };
        let used = self.usage().await?.used_bytes;
        if used <= limit.admits() {
            return Ok(());
        }
        self.pressed.notify_one();
        Err(StoreError::LimitReached { used_mb: used / 1_000_000, limit_mb: limit.admits() / 1_000_000 })
    }

    /// Tells when a job was refused for want of room.
    pub fn pressed(&self) -> &Notify {
        &self.pressed
    }

    /// Deletes up to `limit` of the jobs that ended before `keep_from`, oldest first, in one transaction; how many.
    pub async fn delete_ended_before(&self, keep_from: Timestamp, limit: u32) -> Result<u64, StoreError> {
        self.delete_oldest(keep_from.as_microsecond(), limit).await
    }

    /// Above the size limit, deletes up to `limit` of the oldest ended jobs, in one transaction; how many. Call it until it
    /// says 0; `going_on` tells that it did not say 0 before.
    pub async fn delete_for_room(&self, going_on: bool, limit: u32) -> Result<u64, StoreError> {
        let Some(room) = &self.limit else { return Ok(0) };
        let used = self.usage().await?.used_bytes;
        if used <= if going_on { room.goal() } else { room.bytes } {
            return Ok(0);
        }
        if !going_on {
            self.trim_stages(self.stage_cache_bytes).await?;
        }
        let deleted = self.delete_oldest(i64::MAX, limit).await?;
        if deleted == 0 {
            // Live jobs alone fill the database: what is kept for reuse is all that can go.
            self.trim_stages(0).await?;
        }
        Ok(deleted)
    }

    async fn delete_oldest(&self, ended_before_us: i64, limit: u32) -> Result<u64, StoreError> {
        let mut transaction = self.write().await?;
        let deleted = sqlx::query(
            "DELETE FROM jobs WHERE state IN ('succeeded', 'failed', 'canceled') AND id IN \
             (SELECT id FROM jobs WHERE ended_at_us IS NOT NULL AND ended_at_us < $1 ORDER BY ended_at_us, id LIMIT $2)",
        )
        .bind(ended_before_us)
        .bind(limit)
        .execute(&mut *transaction)
        .await?;
        transaction.commit().await?;
        Ok(deleted.rows_affected())
    }
}
