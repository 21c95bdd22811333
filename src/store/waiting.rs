//! How many jobs wait, known without counting them: this process is the only one that writes.

use super::connect::Store;
use sqlx::{Row, SqlitePool};
use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

/// The number of queued jobs. Changed after the commit of each transition into or out of `queued`.
#[derive(Debug, Clone, Default)]
pub(super) struct Waiting(Arc<AtomicI64>);

impl Waiting {
    /// Counts them, once.
    pub async fn counted(pool: &SqlitePool) -> Result<Self, sqlx::Error> {
        let row = sqlx::query("SELECT COUNT(*) AS n FROM jobs WHERE state = 'queued'").fetch_one(pool).await?;
        Ok(Self(Arc::new(AtomicI64::new(row.try_get("n")?))))
    }

    pub fn add(&self, change: i64) {
        self.0.fetch_add(change, Ordering::Relaxed);
    }

    pub fn get(&self) -> i64 {
        self.0.load(Ordering::Relaxed)
    }
}

impl Store {
    /// How many jobs wait.
    pub fn waiting(&self) -> u64 {
        self.waiting.get().max(0).unsigned_abs()
    }
}
