//! Rows of sweeps: one for each solved point, stored while the sweep runs and served unchanged.

use super::connect::{Store, StoreError};
use super::dataset::{ensure_dataset, is_current};
use super::lifecycle::JobId;
use sha2::{Digest, Sha256};
use sqlx::sqlite::SqliteRow;
use sqlx::{FromRow, QueryBuilder, Row, Sqlite, Transaction};

/// A solved point of a sweep.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PointRow {
    /// Index in the result's `sweep.points`.
    pub position: u64,
    /// The point as JSON.
    pub body: String,
}

/// The last solved point of a line of a sweep with continuation.
#[derive(Debug, Clone, PartialEq)]
pub struct LineEndRow {
    pub line: u64,
    pub position: u64,
    /// State of the motion at its end, from which the next point continues; `None` where there is none.
    pub state: Option<Vec<f64>>,
}

/// State of the motion at the end of a point (24 numbers in the source's order), from which its neighbour continues.
#[derive(Debug, Clone, PartialEq)]
pub struct EndStateRow {
    pub position: u64,
    pub state: Vec<f64>,
}

/// Points that are solved and not yet stored.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointBatch {
    pub solver_version: String,
    pub rows: Vec<PointRow>,
    /// Of points among `rows`.
    pub end_states: Vec<EndStateRow>,
    pub ends: Vec<LineEndRow>,
}

/// Number and digest of the rows of a result, which are stored apart from it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RowsSummary {
    pub count: u64,
    /// See [`PointsDigest`].
    pub digest: String,
}

impl PointBatch {
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty() && self.ends.is_empty()
    }

    /// Appends a later batch.
    pub fn append(&mut self, mut later: PointBatch) {
        self.solver_version = later.solver_version;
        self.rows.append(&mut later.rows);
        self.end_states.append(&mut later.end_states);
        self.ends.append(&mut later.ends);
    }
}

/// The dataset with the rows of the job `$1`: that of its result, or its own. A literal for `concat!`.
macro_rules! dataset_of_job {
    () => {
        "COALESCE((SELECT dataset_id FROM results WHERE job_id = $1), $1)"
    };
}

impl Store {
    /// The rows and line ends from which an attempt resumes: those stored by an earlier attempt or, where there are
    /// none, those of the newest failed or canceled job with the same input. Rows of another solver version are
    /// deleted.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn resume_points(
        &self,
        id: JobId,
        attempt: i64,
        input_hash: &str,
        solver_version: &str,
    ) -> Result<PointBatch, StoreError> {
        let mut transaction = self.begin().await?;
        collect_points(&mut transaction, id, attempt, input_hash, solver_version).await?;
        let rows = sqlx::query_as("SELECT position, body FROM sweep_points WHERE dataset_id = $1 ORDER BY position")
            .bind(id.to_string())
            .fetch_all(&mut *transaction)
            .await?;
        let ends = sqlx::query_as("SELECT line, position, state FROM sweep_line_ends WHERE job_id = $1")
            .bind(id.to_string())
            .fetch_all(&mut *transaction)
            .await?;
        transaction.commit().await?;
        Ok(PointBatch { solver_version: solver_version.to_owned(), rows, end_states: Vec::new(), ends })
    }

    /// As [`Store::resume_points`], for an attempt that other machines compute: nothing is read.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn collect_points(
        &self,
        id: JobId,
        attempt: i64,
        input_hash: &str,
        solver_version: &str,
    ) -> Result<(), StoreError> {
        let mut transaction = self.begin().await?;
        collect_points(&mut transaction, id, attempt, input_hash, solver_version).await?;
        transaction.commit().await?;
        Ok(())
    }

    /// Reads up to `limit` rows of a job with positions in `from..to`, in their order.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn points(&self, id: JobId, from: u64, to: u64, limit: u32) -> Result<Vec<PointRow>, StoreError> {
        Ok(sqlx::query_as(concat!(
            "SELECT position, body FROM sweep_points WHERE dataset_id = ",
            dataset_of_job!(),
            " AND position >= $2 AND position < $3 ORDER BY position LIMIT $4"
        ))
        .bind(id.to_string())
        .bind(i64::try_from(from).unwrap_or(i64::MAX))
        .bind(i64::try_from(to).unwrap_or(i64::MAX))
        .bind(limit)
        .fetch_all(&self.reader)
        .await?)
    }

    /// Reads the state at the end of a point; `None` where none is stored.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn point_end_state(&self, id: JobId, position: u64) -> Result<Option<Vec<f64>>, StoreError> {
        let row = sqlx::query(concat!(
            "SELECT end_state FROM sweep_points WHERE dataset_id = ",
            dataset_of_job!(),
            " AND position = $2"
        ))
        .bind(id.to_string())
        .bind(i64::try_from(position).unwrap_or(i64::MAX))
        .fetch_optional(&self.reader)
        .await?;
        let bytes = row.map(|row| row.try_get::<Option<Vec<u8>>, _>("end_state")).transpose()?;
        Ok(bytes.flatten().map(|bytes| unpack_state(&bytes)))
    }

    /// Reads the positions of the rows of a running job, in their order.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn point_positions(&self, id: JobId) -> Result<Vec<u64>, StoreError> {
        let rows = sqlx::query("SELECT position FROM sweep_points WHERE dataset_id = $1 ORDER BY position")
            .bind(id.to_string())
            .fetch_all(&self.reader)
            .await?;
        rows.iter().map(|row| Ok(row.try_get::<i64, _>("position")?.unsigned_abs())).collect()
    }

    /// Reads how far each line of a running job was followed.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn line_ends(&self, id: JobId) -> Result<Vec<LineEndRow>, StoreError> {
        Ok(sqlx::query_as("SELECT line, position, state FROM sweep_line_ends WHERE job_id = $1 ORDER BY line")
            .bind(id.to_string())
            .fetch_all(&self.reader)
            .await?)
    }

    /// Counts the rows of a job.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn point_count(&self, id: JobId) -> Result<u64, StoreError> {
        let row = sqlx::query(concat!("SELECT COUNT(*) AS n FROM sweep_points WHERE dataset_id = ", dataset_of_job!()))
            .bind(id.to_string())
            .fetch_one(&self.reader)
            .await?;
        Ok(row.try_get::<i64, _>("n")?.unsigned_abs())
    }
}

/// Collects the rows from which an attempt resumes.
async fn collect_points(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    attempt: i64,
    input_hash: &str,
    solver_version: &str,
) -> Result<(), StoreError> {
    if is_current(transaction, id, attempt).await? {
        drop_other_versions(transaction, id, solver_version).await?;
        copy_points_of_same_input(transaction, id, input_hash, solver_version).await?;
    }
    Ok(())
}

async fn drop_other_versions(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    solver_version: &str,
) -> Result<(), StoreError> {
    let dropped = sqlx::query("DELETE FROM sweep_points WHERE dataset_id = $1 AND solver_version <> $2")
        .bind(id.to_string())
        .bind(solver_version)
        .execute(&mut **transaction)
        .await?;
    if dropped.rows_affected() > 0 {
        drop_line_ends(transaction, id).await?;
    }
    Ok(())
}

/// Copies the rows of the newest failed or canceled job with the same input into a job that has none.
async fn copy_points_of_same_input(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    input_hash: &str,
    solver_version: &str,
) -> Result<(), StoreError> {
    let own = sqlx::query("SELECT 1 FROM sweep_points WHERE dataset_id = $1 LIMIT 1")
        .bind(id.to_string())
        .fetch_optional(&mut **transaction)
        .await?;
    if own.is_some() {
        return Ok(());
    }
    let source = sqlx::query(
        "SELECT id FROM jobs WHERE input_hash = $1 AND id <> $2 AND state IN ('failed', 'canceled') \
         AND EXISTS (SELECT 1 FROM sweep_points WHERE dataset_id = jobs.id AND solver_version = $3) \
         ORDER BY id DESC LIMIT 1",
    )
    .bind(input_hash)
    .bind(id.to_string())
    .bind(solver_version)
    .fetch_optional(&mut **transaction)
    .await?;
    let Some(source) = source else { return Ok(()) };
    let source: String = source.try_get("id")?;
    ensure_dataset(transaction, id).await?;
    sqlx::query(
        "INSERT INTO sweep_points (dataset_id, position, solver_version, body, end_state) \
         SELECT $2, position, solver_version, body, end_state FROM sweep_points \
         WHERE dataset_id = $1 AND solver_version = $3",
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

/// Rows that one statement inserts: what a statement costs beside its rows is then a small part.
const ROWS_PER_STATEMENT: usize = 64;

/// Stores points, in a transaction that has checked that the job belongs to this attempt. Rows that are stored already
/// stay as they are. Returns the number of those that were not.
pub(super) async fn insert_points(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    batch: &PointBatch,
) -> Result<u64, StoreError> {
    if !batch.rows.is_empty() {
        ensure_dataset(transaction, id).await?;
    }
    let id = id.to_string();
    let mut inserted = 0;
    let mut rows = batch.rows.as_slice();
    while !rows.is_empty() {
        // Of two sizes, so that the statements are prepared once.
        let count = if rows.len() < ROWS_PER_STATEMENT { 1 } else { ROWS_PER_STATEMENT };
        let (now, later) = rows.split_at(count);
        rows = later;
        let mut insert =
            QueryBuilder::<Sqlite>::new("INSERT INTO sweep_points (dataset_id, position, solver_version, body) ");
        insert.push_values(now, |mut values, row| {
            values.push_bind(&id).push_bind(row.position as i64);
            values.push_bind(&batch.solver_version).push_bind(&row.body);
        });
        insert.push(" ON CONFLICT (dataset_id, position) DO NOTHING");
        inserted += insert.build().execute(&mut **transaction).await?.rows_affected();
    }
    for EndStateRow { position, state } in &batch.end_states {
        sqlx::query("UPDATE sweep_points SET end_state = $3 WHERE dataset_id = $1 AND position = $2")
            .bind(&id)
            .bind(*position as i64)
            .bind(pack_state(state))
            .execute(&mut **transaction)
            .await?;
    }
    for end in &batch.ends {
        let state = end.state.as_deref().map(pack_state);
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
    Ok(inserted)
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

/// The numbers of a state as little-endian f64.
fn pack_state(state: &[f64]) -> Vec<u8> {
    state.iter().flat_map(|value| value.to_le_bytes()).collect()
}

fn unpack_state(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks::<8>().0.iter().map(|eight| f64::from_le_bytes(*eight)).collect()
}

/// Digest of the rows of a result, added in the order of their positions: 128 bits of SHA-256, in hexadecimal.
#[derive(Default)]
pub struct PointsDigest(Sha256);

impl PointsDigest {
    /// Adds the JSON of a row.
    pub fn add(&mut self, body: &str) {
        self.0.update(body);
        self.0.update([0]);
    }

    /// The digest as text.
    pub fn finish(self) -> String {
        hex::encode(&self.0.finalize()[..16])
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
            state: state.map(|bytes| unpack_state(&bytes)),
        })
    }
}
