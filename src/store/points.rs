//! Points of sweeps: one row each, written while the sweep runs and served as they are.

use super::connect::{Store, StoreError};
use super::lifecycle::JobId;
use sha2::{Digest, Sha256};
use sqlx::sqlite::SqliteRow;
use sqlx::{FromRow, Row, Sqlite, Transaction};

/// A solved point.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PointRow {
    /// Its place in the result's `sweep.points`.
    pub position: u64,
    /// JSON.
    pub body: String,
}

/// How far a line of a sweep with continuation was followed.
#[derive(Debug, Clone, PartialEq)]
pub struct LineEndRow {
    pub line: u64,
    pub position: u64,
    /// None: there is nothing to continue from.
    pub state: Option<Vec<f64>>,
}

/// Points that were solved since the last were written.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointBatch {
    pub solver_version: String,
    pub rows: Vec<PointRow>,
    pub ends: Vec<LineEndRow>,
}

/// What is left of the points of a result when its rows stand apart: where they belong in the body, and a hash of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PointsOfResult {
    /// Byte offset in the body: between the brackets of an empty list.
    pub at: usize,
    /// How many they are.
    pub n: u64,
    pub digest: String,
}

impl PointBatch {
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty() && self.ends.is_empty()
    }

    /// Adds what came later.
    pub fn append(&mut self, mut later: PointBatch) {
        self.solver_version = later.solver_version;
        self.rows.append(&mut later.rows);
        self.ends.append(&mut later.ends);
    }
}

impl Store {
    /// What a worker that starts this attempt can go on from: the rows and line ends an earlier attempt left or, where there
    /// are none, those of the newest failed or canceled job with the same input. Rows of another solver version are dropped.
    pub async fn kept_points(
        &self,
        id: JobId,
        attempt: i64,
        input_hash: &str,
        solver_version: &str,
    ) -> Result<PointBatch, StoreError> {
        let mut transaction = self.write_more().await?;
        if is_current(&mut transaction, id, attempt).await? {
            drop_other_versions(&mut transaction, id, solver_version).await?;
            adopt(&mut transaction, id, input_hash, solver_version).await?;
        }
        let rows = sqlx::query_as("SELECT position, body FROM sweep_points WHERE job_id = $1 ORDER BY position")
            .bind(id.to_string())
            .fetch_all(&mut *transaction)
            .await?;
        let ends = sqlx::query_as("SELECT line, position, state FROM sweep_line_ends WHERE job_id = $1")
            .bind(id.to_string())
            .fetch_all(&mut *transaction)
            .await?;
        transaction.commit().await?;
        Ok(PointBatch { solver_version: solver_version.to_owned(), rows, ends })
    }

    /// Up to `limit` rows of a job from position `from` on and before `to`, in their order.
    pub async fn points(&self, id: JobId, from: u64, to: u64, limit: u32) -> Result<Vec<PointRow>, StoreError> {
        Ok(sqlx::query_as(
            "SELECT position, body FROM sweep_points WHERE job_id = $1 AND position >= $2 AND position < $3 \
             ORDER BY position LIMIT $4",
        )
        .bind(id.to_string())
        .bind(i64::try_from(from).unwrap_or(i64::MAX))
        .bind(i64::try_from(to).unwrap_or(i64::MAX))
        .bind(limit)
        .fetch_all(&self.reader)
        .await?)
    }

    /// How many rows a job has.
    pub async fn point_count(&self, id: JobId) -> Result<u64, StoreError> {
        let row = sqlx::query("SELECT COUNT(*) AS n FROM sweep_points WHERE job_id = $1")
            .bind(id.to_string())
            .fetch_one(&self.reader)
            .await?;
        Ok(row.try_get::<i64, _>("n")?.unsigned_abs())
    }
}

async fn is_current(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    attempt: i64,
) -> Result<bool, StoreError> {
    let row = sqlx::query("SELECT 1 FROM jobs WHERE id = $1 AND attempt = $2 AND state = 'running'")
        .bind(id.to_string())
        .bind(attempt)
        .fetch_optional(&mut **transaction)
        .await?;
    Ok(row.is_some())
}

async fn drop_other_versions(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    solver_version: &str,
) -> Result<(), StoreError> {
    let dropped = sqlx::query("DELETE FROM sweep_points WHERE job_id = $1 AND solver_version <> $2")
        .bind(id.to_string())
        .bind(solver_version)
        .execute(&mut **transaction)
        .await?;
    if dropped.rows_affected() > 0 {
        drop_line_ends(transaction, id).await?;
    }
    Ok(())
}

/// Takes the rows of an interrupted job with the same input over into a job that has none.
async fn adopt(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    input_hash: &str,
    solver_version: &str,
) -> Result<(), StoreError> {
    let own = sqlx::query("SELECT 1 FROM sweep_points WHERE job_id = $1 LIMIT 1")
        .bind(id.to_string())
        .fetch_optional(&mut **transaction)
        .await?;
    if own.is_some() {
        return Ok(());
    }
    let source = sqlx::query(
        "SELECT id FROM jobs WHERE input_hash = $1 AND id <> $2 AND state IN ('failed', 'canceled') \
         AND EXISTS (SELECT 1 FROM sweep_points WHERE job_id = jobs.id AND solver_version = $3) \
         ORDER BY id DESC LIMIT 1",
    )
    .bind(input_hash)
    .bind(id.to_string())
    .bind(solver_version)
    .fetch_optional(&mut **transaction)
    .await?;
    let Some(source) = source else { return Ok(()) };
    let source: String = source.try_get("id")?;
    sqlx::query(
        "INSERT INTO sweep_points (job_id, position, solver_version, body) \
         SELECT $2, position, solver_version, body FROM sweep_points WHERE job_id = $1 AND solver_version = $3",
    )
    .bind(&source)
    .bind(id.to_string())
    .bind(solver_version)
    .execute(&mut **transaction)
    .await?;
    sqlx::query(
        "INSERT INTO sweep_line_ends (job_id, line, position, state) \
         SELECT $2, line, position, state FROM sweep_line_ends WHERE job_id = $1",
    )
    .bind(&source)
    .bind(id.to_string())
    .execute(&mut **transaction)
    .await?;
    Ok(())
}

/// Writes points within a transaction that has made sure that the job is this worker's.
pub(super) async fn insert_points(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    batch: &PointBatch,
) -> Result<(), StoreError> {
    let id = id.to_string();
    for row in &batch.rows {
        sqlx::query(
            "INSERT INTO sweep_points (job_id, position, solver_version, body) VALUES ($1, $2, $3, $4) \
             ON CONFLICT (job_id, position) DO NOTHING",
        )
        .bind(&id)
        .bind(row.position as i64)
        .bind(&batch.solver_version)
        .bind(&row.body)
        .execute(&mut **transaction)
        .await?;
    }
    for end in &batch.ends {
        let state: Option<Vec<u8>> =
            end.state.as_ref().map(|state| state.iter().flat_map(|value| value.to_le_bytes()).collect());
        sqlx::query(
            "INSERT INTO sweep_line_ends (job_id, line, position, state) VALUES ($1, $2, $3, $4) \
             ON CONFLICT (job_id, line) DO UPDATE SET position = excluded.position, state = excluded.state",
        )
        .bind(&id)
        .bind(end.line as i64)
        .bind(end.position as i64)
        .bind(state)
        .execute(&mut **transaction)
        .await?;
    }
    Ok(())
}

pub(super) async fn drop_line_ends(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
) -> Result<(), StoreError> {
    sqlx::query("DELETE FROM sweep_line_ends WHERE job_id = $1")
        .bind(id.to_string())
        .execute(&mut **transaction)
        .await?;
    Ok(())
}

/// The rows of one job become those of another as well.
pub(super) async fn copy_points(
    transaction: &mut Transaction<'static, Sqlite>,
    source: JobId,
    target: JobId,
) -> Result<(), StoreError> {
    sqlx::query(
        "INSERT INTO sweep_points (job_id, position, solver_version, body) \
         SELECT $2, position, solver_version, body FROM sweep_points WHERE job_id = $1 \
         ON CONFLICT (job_id, position) DO NOTHING",
    )
    .bind(source.to_string())
    .bind(target.to_string())
    .execute(&mut **transaction)
    .await?;
    Ok(())
}

/// Hash of the rows of a result, which are added in the order of their positions.
#[derive(Default)]
pub struct PointsDigest(Sha256);

impl PointsDigest {
    pub fn add(&mut self, body: &str) {
        self.0.update(body);
        self.0.update([0]);
    }

    pub fn finish(self) -> String {
        self.0.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect()
    }
}

impl<'r> FromRow<'r, SqliteRow> for PointRow {
    fn from_row(row: &'r SqliteRow) -> Result<Self, sqlx::Error> {
        Ok(Self { position: row.try_get::<i64, _>("position")?.unsigned_abs(), body: row.try_get("body")? })
    }
}

impl<'r> FromRow<'r, SqliteRow> for LineEndRow {
    fn from_row(row: &'r SqliteRow) -> Result<Self, sqlx::Error> {
        let state: Option<Vec<u8>> = row.try_get("state")?;
        Ok(Self {
            line: row.try_get::<i64, _>("line")?.unsigned_abs(),
            position: row.try_get::<i64, _>("position")?.unsigned_abs(),
            state: state.map(|bytes| bytes.as_chunks::<8>().0.iter().map(|eight| f64::from_le_bytes(*eight)).collect()),
        })
    }
}
