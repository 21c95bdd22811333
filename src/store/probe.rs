//! Whether the database can be written just now.

use super::connect::{Store, StoreError};
use super::error::Unavailable;
use std::time::{Duration, Instant};

/// An answer holds so long: whoever asks often does not keep the disk busy.
const HOLDS: Duration = Duration::from_secs(2);

/// What the last try said.
pub(super) struct Probe {
    at: Instant,
    found: Result<(), (Unavailable, String)>,
}

impl Store {
    /// Tries a small write, at most every two seconds.
    ///
    /// # Errors
    /// Why jobs cannot be taken.
    pub async fn writable(&self) -> Result<(), StoreError> {
        self.admit().await?;
        let mut last = self.probe.lock().await;
        if last.as_ref().is_none_or(|last| last.at.elapsed() > HOLDS) {
            let found = match self.write_something().await {
                Ok(()) => Ok(()),
                Err(StoreError::Unavailable { why, detail }) => Err((why, detail)),
                Err(other) => return Err(other),
            };
            *last = Some(Probe { at: Instant::now(), found });
        }
        match last.as_ref().map(|last| last.found.clone()) {
            Some(Err((why, detail))) => Err(StoreError::Unavailable { why, detail }),
            _ => Ok(()),
        }
    }

    /// As much as a submission, and gone again in the same transaction; the commit goes to the disk.
    async fn write_something(&self) -> Result<(), StoreError> {
        let mut transaction = self.write_more().await?;
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
