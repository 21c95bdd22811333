//! Stored results: read, and found again for the same input.

use super::connect::{Store, StoreError};
use super::lifecycle::JobId;
use super::points::PointsOfResult;
use super::record::parsed;
use sha2::{Digest, Sha256};
use sqlx::Row;
use sqlx::sqlite::SqliteRow;

/// The result of a job that succeeded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredResult {
    /// JSON.
    pub body: String,
    /// Strong entity tag, without quotes: a hash of the body and of its points.
    pub etag: String,
    /// Of a sweep: where its rows belong in the body.
    pub points: Option<PointsOfResult>,
}

/// A result that another job left for the same input and solver version.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reusable {
    pub job: JobId,
    /// JSON.
    pub body: String,
    pub points: Option<PointsOfResult>,
}

impl Store {
    pub async fn result(&self, id: JobId) -> Result<Option<StoredResult>, StoreError> {
        let row = sqlx::query("SELECT body, etag, points_at, points_n, points_digest FROM results WHERE job_id = $1")
            .bind(id.to_string())
            .fetch_optional(&self.reader)
            .await?;
        row.map(|row| {
            Ok(StoredResult { body: row.try_get("body")?, etag: row.try_get("etag")?, points: points_of(&row)? })
        })
        .transpose()
    }

    /// The newest result of the same input under the same solver version.
    pub async fn reusable(&self, input_hash: &str, solver_version: &str) -> Result<Option<Reusable>, StoreError> {
        let row = sqlx::query(
            "SELECT job_id, body, points_at, points_n, points_digest FROM results WHERE input_hash = $1 AND solver_version = $2 \
             ORDER BY job_id DESC LIMIT 1",
        )
        .bind(input_hash)
        .bind(solver_version)
        .fetch_optional(&self.reader)
        .await?;
        row.map(|row| {
            let job = parsed("job_id", row.try_get("job_id")?)?;
            Ok(Reusable { job, body: row.try_get("body")?, points: points_of(&row)? })
        })
        .transpose()
    }
}

fn points_of(row: &SqliteRow) -> Result<Option<PointsOfResult>, StoreError> {
    let (at, n): (Option<i64>, Option<i64>) = (row.try_get("points_at")?, row.try_get("points_n")?);
    let digest: Option<String> = row.try_get("points_digest")?;
    let points = at.zip(n).zip(digest);
    Ok(points.map(|((at, n), digest)| PointsOfResult { at: at.unsigned_abs() as usize, n: n.unsigned_abs(), digest }))
}

/// 128 bits of the SHA-256 of the body and of what stands for its points, in hex.
pub(super) fn etag_of(body: &str, points: Option<&PointsOfResult>) -> String {
    let mut hasher = Sha256::new();
    hasher.update(body);
    if let Some(points) = points {
        hasher.update([0]);
        hasher.update(&points.digest);
    }
    hasher.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect()
}
