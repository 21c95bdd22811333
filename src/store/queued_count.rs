//! The number of queued jobs, kept in memory: this process is the only one that writes.

use super::connect::Store;
use sqlx::{Row, SqlitePool};
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

/// The number of queued jobs. Changed after the commit of each transition into or out of `queued`.
#[derive(Debug, Clone, Default)]
pub(super) struct QueuedCount(Arc<AtomicI64>);

impl QueuedCount {
    /// Counts the queued jobs in the database.
    pub(super) async fn read(pool: &SqlitePool) -> Result<Self, sqlx::Error> {
        let row = sqlx::query("SELECT COUNT(*) AS n FROM jobs WHERE state = 'queued'").fetch_one(pool).await?;
        Ok(Self(Arc::new(AtomicI64::new(row.try_get("n")?))))
    }

    pub(super) fn add(&self, change: i64) {
        self.0.fetch_add(change, Ordering::Relaxed);
    }

    pub(super) fn get(&self) -> i64 {
        self.0.load(Ordering::Relaxed)
    }
}

impl Store {
    /// The number of queued jobs.
    pub fn queued_count(&self) -> u64 {
        self.queued_count.get().max(0).unsigned_abs()
    }
}
