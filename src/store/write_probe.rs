//! The check that the database can be written.

use super::connect::{Store, StoreError};
use super::error::Unavailable;
use std::time::{Duration, Instant};

/// Validity of a result, which bounds the writes caused by frequent checks.
const VALIDITY: Duration = Duration::from_secs(2);

/// The result of the last check.
pub(super) struct WriteProbe {
    at: Instant,
    result: Result<(), (Unavailable, String)>,
}

impl Store {
    /// Checks that jobs can be stored, with a small write at most every two seconds.
    ///
    /// # Errors
    /// The size limit is reached, the file was moved or deleted, or the database cannot be written.
    pub async fn writable(&self) -> Result<(), StoreError> {
        self.admit().await?;
        let mut last = self.probe.lock().await;
        if last.as_ref().is_none_or(|last| last.at.elapsed() > VALIDITY) {
            let result = match self.probe_write().await {
                Ok(()) => Ok(()),
                Err(StoreError::Unavailable { cause, detail }) => Err((cause, detail)),
                Err(other) => return Err(other),
            };
            *last = Some(WriteProbe { at: Instant::now(), result });
        }
        match last.as_ref().map(|last| last.result.clone()) {
            Some(Err((cause, detail))) => Err(StoreError::Unavailable { cause, detail }),
            _ => Ok(()),
        }
    }

    /// Writes as much as a submission, deletes it in the same transaction, and commits.
    async fn probe_write(&self) -> Result<(), StoreError> {
        let mut transaction = self.begin().await?;
        sqlx::query(
            "INSERT INTO stages (hash, stage, solver_version, size_bytes, created_at_us, bytes) \
             VALUES ('probe', 'probe', '', 0, 0, zeroblob(65536)) ON CONFLICT (hash) DO NOTHING",
        )
        .execute(&mut *transaction)
        .await?;
        sqlx::query("DELETE FROM stages WHERE hash = 'probe'").execute(&mut *transaction).await?;
        transaction.commit().await?;
        Ok(())
    }
}
