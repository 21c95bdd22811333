//! Stored results.

use super::connect::{Store, StoreError};
use super::lifecycle::JobId;
use super::points::RowsSummary;
use super::record::parse_column;
use sha2::{Digest, Sha256};
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

/// The result of a job that succeeded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredResult {
    /// The result as JSON; the rows of a sweep are left out.
    pub body: String,
    /// Strong entity tag, without quotes: a hash of the body and of the rows.
    pub etag: String,
    /// Summary of the rows of a sweep.
    pub rows: Option<RowsSummary>,
}

/// What is told of a result without reading it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResultSummary {
    /// As in [`StoredResult`].
    pub etag: String,
    /// Length of the body.
    pub bytes: u64,
}

/// A result of another job with the same input and solver version.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ReusableResult {
    pub job: JobId,
    /// The result as JSON; the rows of a sweep are left out.
    pub body: String,
    pub rows: Option<RowsSummary>,
}

impl Store {
    /// Reads the result of a job.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn result(&self, id: JobId) -> Result<Option<StoredResult>, StoreError> {
        let row = sqlx::query("SELECT body, etag, points_n, points_digest FROM results WHERE job_id = $1")
            .bind(id.to_string())
            .fetch_optional(&self.reader)
            .await?;
        row.map(|row| {
            Ok(StoredResult { body: row.try_get("body")?, etag: row.try_get("etag")?, rows: rows_summary(&row)? })
        })
        .transpose()
    }

    /// Reads entity tag and length of the result of a job.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn result_summary(&self, id: JobId) -> Result<Option<ResultSummary>, StoreError> {
        let row = sqlx::query("SELECT etag, octet_length(body) AS bytes FROM results WHERE job_id = $1")
            .bind(id.to_string())
            .fetch_optional(&self.reader)
            .await?;
        row.map(|row| {
            Ok(ResultSummary { etag: row.try_get("etag")?, bytes: row.try_get::<i64, _>("bytes")?.unsigned_abs() })
        })
        .transpose()
    }

    /// Reads the newest result with this input and solver version.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn reusable(&self, input_hash: &str, solver_version: &str) -> Result<Option<ReusableResult>, StoreError> {
        let row = sqlx::query(
            "SELECT job_id, body, points_n, points_digest FROM results WHERE input_hash = $1 AND solver_version = $2 \
             ORDER BY job_id DESC LIMIT 1",
        )
        .bind(input_hash)
        .bind(solver_version)
        .fetch_optional(&self.reader)
        .await?;
        row.map(|row| {
            let job = parse_column("job_id", row.try_get("job_id")?)?;
            Ok(ReusableResult { job, body: row.try_get("body")?, rows: rows_summary(&row)? })
        })
        .transpose()
    }
}

fn rows_summary(row: &SqliteRow) -> Result<Option<RowsSummary>, StoreError> {
    let (count, digest): (Option<i64>, Option<String>) = (row.try_get("points_n")?, row.try_get("points_digest")?);
    Ok(count.zip(digest).map(|(count, digest)| RowsSummary { count: count.unsigned_abs(), digest }))
}

/// The entity tag of a result: 128 bits of the SHA-256 of the body and of the digest of the rows, in hexadecimal.
pub(super) fn etag_of(body: &str, rows: Option<&RowsSummary>) -> String {
    let mut hasher = Sha256::new();
    hasher.update(body);
    if let Some(rows) = rows {
        hasher.update([0]);
        hasher.update(&rows.digest);
    }
    hex::encode(&hasher.finalize()[..16])
}
