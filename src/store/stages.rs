//! The cache of stages: bounded in size, the oldest are deleted first.

use super::connect::{Store, StoreError};
use jiff::Timestamp;
use sqlx::{Row, Sqlite, Transaction};

impl Store {
    /// Reads a cached stage.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn stage(&self, hash: &str) -> Result<Option<Vec<u8>>, StoreError> {
        let row =
            sqlx::query("SELECT bytes FROM stages WHERE hash = $1").bind(hash).fetch_optional(&self.reader).await?;
        Ok(row.map(|row| row.try_get("bytes")).transpose()?)
    }

    /// Stores a stage, unless it is larger than the whole cache.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn save_stage(
        &self,
        hash: &str,
        stage: &str,
        solver_version: &str,
        bytes: &[u8],
        now: Timestamp,
    ) -> Result<(), StoreError> {
        let size = bytes.len() as i64;
        if size > self.stage_cache_bytes {
            return Ok(());
        }
        let mut transaction = self.begin().await?;
        sqlx::query(
            "INSERT INTO stages (hash, stage, solver_version, bytes, size_bytes, created_at_us) \
             VALUES ($1, $2, $3, $4, $5, $6) ON CONFLICT (hash) DO NOTHING",
        )
        .bind(hash)
        .bind(stage)
        .bind(solver_version)
        .bind(bytes)
        .bind(size)
        .bind(now.as_microsecond())
        .execute(&mut *transaction)
        .await?;
        trim(&mut transaction, self.stage_cache_bytes).await?;
        transaction.commit().await?;
        Ok(())
    }

    /// Deletes the oldest stages until at most so many bytes are left.
    pub(super) async fn trim_stages(&self, bytes: i64) -> Result<(), StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        trim(&mut transaction, bytes).await?;
        transaction.commit().await?;
        Ok(())
    }
}

/// Deletes all stages but the newest that fit into so many bytes together.
async fn trim(transaction: &mut Transaction<'static, Sqlite>, bytes: i64) -> Result<(), StoreError> {
    sqlx::query(
        "DELETE FROM stages WHERE hash IN (SELECT hash FROM (SELECT hash, SUM(size_bytes) OVER \
         (ORDER BY created_at_us DESC, hash) AS total FROM stages) WHERE total > $1)",
    )
    .bind(bytes)
    .execute(&mut **transaction)
    .await?;
    Ok(())
}
