//! Deletion of ended jobs by age and by size of the database. Jobs that have not ended are never deleted.

use super::connect::{Store, StoreError};
use super::dataset::delete_ended;
use super::record::parse_column;
use jiff::Timestamp;
use sqlx::Row;
use tokio::sync::Notify;

/// Settings of retention.
#[derive(Debug, Clone, Copy, Default, clap::Args)]
pub struct RetentionConfig {
    /// Ended jobs are deleted so many days after their end; they stay when not given.
    #[arg(long, env = "HERRINGBONE_KEEP_DAYS", value_name = "DAYS", value_parser = clap::value_parser!(u32).range(1..=36_500))]
    pub keep_days: Option<u32>,

    /// Room for the database in MB (1000000 bytes): beyond it the oldest ended jobs are deleted, and new jobs refused
    /// when that does not help. No bound when not given.
    #[arg(long, env = "HERRINGBONE_MAX_DATABASE_MB", value_name = "MB", value_parser = clap::value_parser!(u32).range(8..=100_000_000))]
    pub max_database_mb: Option<u32>,
}

impl RetentionConfig {
    /// The end time before which ended jobs are deleted; `None` when they are not deleted by age.
    pub fn keep_from(&self, now: Timestamp) -> Option<Timestamp> {
        let age = jiff::SignedDuration::from_hours(24 * i64::from(self.keep_days?));
        now.checked_sub(age).ok()
    }

    pub(super) fn limit(&self, page_bytes: u64) -> Option<SizeLimit> {
        let bytes = u64::from(self.max_database_mb?) * 1_000_000;
        // Canceling, deleting and ending jobs needs some pages in a full database.
        let reserve = (bytes / 50).max(500_000);
        let pages = |bytes: u64| bytes / page_bytes;
        Some(SizeLimit {
            bytes,
            max_pages: pages(bytes + bytes / 10),
            max_pages_with_reserve: pages(bytes + bytes / 10 + reserve),
        })
    }
}

/// The size limit of the database. Above `bytes` the oldest ended jobs are deleted down to 90 %; above 105 % jobs are
/// refused; running jobs may use 110 %, where SQLite itself stops. A reserve of 2 % above that (at least 0.5 MB) is for
/// transactions that delete, cancel or end jobs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct SizeLimit {
    bytes: u64,
    pub max_pages: u64,
    pub max_pages_with_reserve: u64,
}

impl SizeLimit {
    /// Size down to which jobs are deleted.
    fn target_bytes(&self) -> u64 {
        self.bytes / 10 * 9
    }

    /// Size up to which jobs are accepted.
    fn admission_bytes(&self) -> u64 {
        self.bytes + self.bytes / 20
    }

    /// Largest size of the stage cache: a quarter of the limit.
    pub(super) fn stage_cache_bytes(limit: Option<&Self>) -> i64 {
        limit.map_or(i64::MAX, |limit| i64::try_from(limit.bytes / 4).unwrap_or(i64::MAX))
    }
}

impl Store {
    /// Checks that the database file is in its place and that the size limit permits another job; notifies
    /// [`Store::space_needed`] if the limit does not.
    ///
    /// # Errors
    /// [`StoreError::LimitReached`], the file was moved or deleted, or the database cannot be read.
    pub async fn admit(&self) -> Result<(), StoreError> {
        self.check_file()?;
        let Some(limit) = &self.limit else { return Ok(()) };
        let used = self.usage().await?.used_bytes;
        if used <= limit.admission_bytes() {
            return Ok(());
        }
        self.space_needed.notify_one();
        Err(StoreError::LimitReached { used_mb: used / 1_000_000, limit_mb: limit.admission_bytes() / 1_000_000 })
    }

    /// Notified when a job was refused for want of space.
    pub fn space_needed(&self) -> &Notify {
        &self.space_needed
    }

    /// Deletes up to `limit` of the jobs that ended before `keep_from`, oldest first, in one transaction. Returns their
    /// number.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn delete_ended_before(&self, keep_from: Timestamp, limit: u32) -> Result<u64, StoreError> {
        self.delete_oldest(keep_from.as_microsecond(), limit).await
    }

    /// Deletes up to `max_jobs` of the oldest ended jobs in one transaction, if the database is above its size limit.
    /// Returns their number. To be repeated until it is 0, with `continued` after the first call.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn delete_for_size(&self, continued: bool, max_jobs: u32) -> Result<u64, StoreError> {
        let Some(limit) = &self.limit else { return Ok(0) };
        let used = self.usage().await?.used_bytes;
        if used <= if continued { limit.target_bytes() } else { limit.bytes } {
            return Ok(0);
        }
        if !continued {
            self.trim_stages(self.stage_cache_bytes).await?;
        }
        let deleted = self.delete_oldest(i64::MAX, max_jobs).await?;
        if deleted == 0 {
            // Only jobs that have not ended are left: the stage cache is all that can be deleted.
            self.trim_stages(0).await?;
        }
        Ok(deleted)
    }

    async fn delete_oldest(&self, ended_before_us: i64, limit: u32) -> Result<u64, StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        let oldest = sqlx::query(
            "SELECT id FROM jobs WHERE ended_at_us IS NOT NULL AND ended_at_us < $1 ORDER BY ended_at_us, id LIMIT $2",
        )
        .bind(ended_before_us)
        .bind(limit)
        .fetch_all(&mut *transaction)
        .await?;
        let mut deleted = 0;
        for row in oldest {
            let id = parse_column("id", row.try_get("id")?)?;
            deleted += u64::from(delete_ended(&mut transaction, id).await?);
        }
        transaction.commit().await?;
        Ok(deleted)
    }
}
