//! Stored results: read, and found again for the same input.

use super::connect::{Store, StoreError};
use super::lifecycle::JobId;
use super::record::parsed;
use sha2::{Digest, Sha256};
use sqlx::Row;

/// The result of a job that succeeded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredResult {
    /// JSON.
    pub body: String,
    /// Strong entity tag, without quotes: a hash of the body.
    pub etag: String,
}

/// A result that another job left for the same input and solver version.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reusable {
    pub job: JobId,
    /// JSON.
    pub body: String,
}

impl Store {
    pub async fn result(&self, id: JobId) -> Result<Option<StoredResult>, StoreError> {
        let row = sqlx::query("SELECT body, etag FROM results WHERE job_id = $1")
            .bind(id.to_string())
            .fetch_optional(&self.reader)
            .await?;
        row.map(|row| Ok(StoredResult { body: row.try_get("body")?, etag: row.try_get("etag")? })).transpose()
    }

    /// The newest result of the same input under the same solver version.
    pub async fn reusable(&self, input_hash: &str, solver_version: &str) -> Result<Option<Reusable>, StoreError> {
        let row = sqlx::query(
            "SELECT job_id, body FROM results WHERE input_hash = $1 AND solver_version = $2 \
             ORDER BY job_id DESC LIMIT 1",
        )
        .bind(input_hash)
        .bind(solver_version)
        .fetch_optional(&self.reader)
        .await?;
        row.map(|row| Ok(Reusable { job: parsed("job_id", row.try_get("job_id")?)?, body: row.try_get("body")? }))
            .transpose()
    }
}

/// 128 bits of the SHA-256 of the body, in hex.
pub(super) fn etag_of(body: &str) -> String {
    Sha256::digest(body.as_bytes()).iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}
