//! Parts of running jobs that other machines compute: rows that exist before a part is published, fenced by the attempt
//! of the job. What the transport loses is published again from here.

use super::connect::{Store, StoreError};
use super::dataset::is_current;
use super::lifecycle::JobId;
use super::record::{JobRecord, job_columns, parse_column};
use super::run::Claim;
use jiff::Timestamp;
use serde::{Deserialize, Serialize};
use sqlx::sqlite::SqliteRow;
use sqlx::{FromRow, Row, Sqlite, Transaction};
use std::fmt;
use std::time::Duration;

/// The id of a chunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ChunkKey {
    pub job: JobId,
    pub attempt: i64,
    /// Number within the attempt, from 0.
    pub chunk: u32,
}

impl fmt::Display for ChunkKey {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}.{}.{}", self.job, self.attempt, self.chunk)
    }
}

/// The class of a chunk: each has a queue of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChunkClass {
    /// A whole job of one operating point.
    Single,
    /// Points of a sweep.
    Sweep,
    /// The first points of a sweep, which are solved before the others: they measure the time of a point.
    Scout,
}

impl ChunkClass {
    pub const ALL: [ChunkClass; 3] = [ChunkClass::Scout, ChunkClass::Single, ChunkClass::Sweep];

    pub fn as_str(self) -> &'static str {
        match self {
            ChunkClass::Single => "single",
            ChunkClass::Sweep => "sweep",
            ChunkClass::Scout => "scout",
        }
    }
}

/// What a chunk covers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum ChunkPart {
    /// The whole job.
    Whole,
    /// Points of a sweep: positions from the first number of each pair up to the second, which is not included.
    Points { ranges: Vec<[u64; 2]> },
    /// The places `from` to `to` (not included) of a line that is followed by continuation.
    Stretch { line: u64, from: u64, to: u64 },
    /// Evaluations of an optimisation: the positions of their rows as for points, and what is to be evaluated (JSON).
    Evaluations { ranges: Vec<[u64; 2]>, batch: String },
}

/// The state of a chunk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChunkState {
    /// To be published.
    Waiting,
    /// Published; its results are awaited.
    Issued,
    /// All its results are stored.
    Stored,
}

/// A chunk as it is stored.
#[derive(Debug, Clone, PartialEq)]
pub struct ChunkRecord {
    pub key: ChunkKey,
    pub class: ChunkClass,
    /// Which workers can take it: version of the calculation, and the class of processors where that matters.
    pub solver: String,
    pub state: ChunkState,
    pub issue: u32,
    pub part: ChunkPart,
    /// Place in the stream of its last publication.
    pub sequence: Option<u64>,
}

impl Store {
    /// Adds chunks to running jobs in one transaction. Those are left out whose job no longer belongs to the attempt or
    /// is to be canceled; returns which ones were added.
    ///
    /// # Errors
    /// The database cannot be written; none is added then.
    pub async fn add_chunks(&self, chunks: &[ChunkRecord]) -> Result<Vec<bool>, StoreError> {
        let mut transaction = self.begin().await?;
        let mut added = Vec::with_capacity(chunks.len());
        for chunk in chunks {
            let is_current = is_current(&mut transaction, chunk.key.job, chunk.key.attempt).await?;
            added.push(is_current);
            if !is_current {
                continue;
            }
            let part = serde_json::to_string(&chunk.part)
                .map_err(|error| StoreError::Corrupt { what: "chunk", detail: error.to_string() })?;
            sqlx::query(
                "INSERT INTO chunks (job_id, attempt, chunk, class, solver, state, issue, part) \
                 VALUES ($1, $2, $3, $4, $5, 'waiting', $6, $7)",
            )
            .bind(chunk.key.job.to_string())
            .bind(chunk.key.attempt)
            .bind(chunk.key.chunk)
            .bind(chunk.class.as_str())
            .bind(&chunk.solver)
            .bind(chunk.issue)
            .bind(part)
            .execute(&mut *transaction)
            .await?;
        }
        transaction.commit().await?;
        Ok(added)
    }

    /// Notes that chunks were published with these issues, at these places of the stream (waiting → issued). Those are
    /// left out that do not wait with this issue any more.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn mark_issued(&self, published: &[(ChunkKey, u32, u64)], now: Timestamp) -> Result<(), StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        for (key, issue, sequence) in published {
            sqlx::query(
                "UPDATE chunks SET state = 'issued', sequence = $5, issued_at_us = $6 \
                 WHERE job_id = $1 AND attempt = $2 AND chunk = $3 AND issue = $4 AND state = 'waiting'",
            )
            .bind(key.job.to_string())
            .bind(key.attempt)
            .bind(key.chunk)
            .bind(issue)
            .bind(i64::try_from(*sequence).unwrap_or(i64::MAX))
            .bind(now.as_microsecond())
            .execute(&mut *transaction)
            .await?;
        }
        transaction.commit().await?;
        Ok(())
    }

    /// Has a chunk published again (issued → waiting, `issue` + 1). Returns the new issue; `None` when it is not issued
    /// any more.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn reissue(&self, key: ChunkKey) -> Result<Option<u32>, StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        let row = sqlx::query(
            "UPDATE chunks SET state = 'waiting', issue = issue + 1 \
             WHERE job_id = $1 AND attempt = $2 AND chunk = $3 AND state = 'issued' RETURNING issue",
        )
        .bind(key.job.to_string())
        .bind(key.attempt)
        .bind(key.chunk)
        .fetch_optional(&mut *transaction)
        .await?;
        transaction.commit().await?;
        Ok(row.map(|row| row.try_get("issue")).transpose()?)
    }

    /// Whether a chunk is still to be computed: its job runs in this attempt and is not to be canceled, the chunk is
    /// not stored, and this is its last issue.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn is_chunk_wanted(&self, key: ChunkKey, issue: u32) -> Result<bool, StoreError> {
        let row = sqlx::query(
            "SELECT 1 FROM chunks JOIN jobs ON jobs.id = chunks.job_id AND jobs.attempt = chunks.attempt \
             WHERE job_id = $1 AND chunks.attempt = $2 AND chunk = $3 AND issue <= $4 AND chunks.state <> 'stored' \
             AND jobs.state = 'running' AND cancel_requested_at_us IS NULL",
        )
        .bind(key.job.to_string())
        .bind(key.attempt)
        .bind(key.chunk)
        .bind(issue)
        .fetch_optional(&self.reader)
        .await?;
        Ok(row.is_some())
    }

    /// Reads the chunks of an attempt in their order.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn chunks(&self, job: JobId, attempt: i64) -> Result<Vec<ChunkRecord>, StoreError> {
        let rows = sqlx::query(
            "SELECT job_id, attempt, chunk, class, solver, state, issue, part, sequence FROM chunks \
             WHERE job_id = $1 AND attempt = $2 ORDER BY chunk",
        )
        .bind(job.to_string())
        .bind(attempt)
        .fetch_all(&self.reader)
        .await?;
        Ok(rows.iter().map(ChunkRecord::from_row).collect::<Result<_, _>>()?)
    }

    /// Deletes the chunks of a job of which everything is stored, before its result is put together: from then on it
    /// runs in this process.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn end_chunks(&self, job: JobId) -> Result<(), StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        drop_chunks(&mut transaction, job).await?;
        transaction.commit().await?;
        Ok(())
    }

    /// Reads the running jobs that have chunks, oldest first.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn distributed_jobs(&self) -> Result<Vec<Claim>, StoreError> {
        let rows = sqlx::query(concat!(
            "SELECT input, computed_us, ",
            job_columns!(),
            " FROM jobs WHERE state = 'running' AND EXISTS (SELECT 1 FROM chunks WHERE chunks.job_id = jobs.id \
             AND chunks.attempt = jobs.attempt) ORDER BY id"
        ))
        .fetch_all(&self.reader)
        .await?;
        rows.iter()
            .map(|row| {
                let computed = Duration::from_micros(row.try_get::<i64, _>("computed_us")?.unsigned_abs());
                Ok(Claim { job: JobRecord::from_row(row)?, input: row.try_get("input")?, computed })
            })
            .collect()
    }

    /// Counts the chunks that are not stored, by their state: waiting, issued.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn open_chunk_counts(&self) -> Result<[u64; 2], StoreError> {
        let row = sqlx::query(
            "SELECT COUNT(*) FILTER (WHERE state = 'waiting') AS waiting, \
             COUNT(*) FILTER (WHERE state = 'issued') AS issued FROM chunks WHERE state <> 'stored'",
        )
        .fetch_one(&self.reader)
        .await?;
        Ok([row.try_get::<i64, _>("waiting")?.unsigned_abs(), row.try_get::<i64, _>("issued")?.unsigned_abs()])
    }

    /// Reads the largest place in the stream of work that a chunk has.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn last_chunk_sequence(&self) -> Result<u64, StoreError> {
        let row = sqlx::query("SELECT MAX(sequence) AS sequence FROM chunks").fetch_one(&self.reader).await?;
        Ok(row.try_get::<Option<i64>, _>("sequence")?.unwrap_or_default().unsigned_abs())
    }

    /// The setting of this name; made with this value when there is none.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn setting_or(&self, name: &str, value: &str) -> Result<String, StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        sqlx::query("INSERT INTO settings (name, value) VALUES ($1, $2) ON CONFLICT (name) DO NOTHING")
            .bind(name)
            .bind(value)
            .execute(&mut *transaction)
            .await?;
        let row =
            sqlx::query("SELECT value FROM settings WHERE name = $1").bind(name).fetch_one(&mut *transaction).await?;
        transaction.commit().await?;
        Ok(row.try_get("value")?)
    }
}

/// Deletes the chunks of a job whose attempt ends.
pub(super) async fn drop_chunks(transaction: &mut Transaction<'static, Sqlite>, id: JobId) -> Result<(), StoreError> {
    sqlx::query("DELETE FROM chunks WHERE job_id = $1").bind(id.to_string()).execute(&mut **transaction).await?;
    Ok(())
}

impl<'r> FromRow<'r, SqliteRow> for ChunkRecord {
    fn from_row(row: &'r SqliteRow) -> Result<Self, sqlx::Error> {
        let wrong =
            |column: &str, text: String| sqlx::Error::ColumnDecode { index: column.to_owned(), source: text.into() };
        let class: String = row.try_get("class")?;
        let state: String = row.try_get("state")?;
        let part: String = row.try_get("part")?;
        let key = ChunkKey {
            job: parse_column("job_id", row.try_get("job_id")?)?,
            attempt: row.try_get("attempt")?,
            chunk: row.try_get("chunk")?,
        };
        Ok(Self {
            key,
            class: ChunkClass::ALL
                .into_iter()
                .find(|known| known.as_str() == class)
                .ok_or_else(|| wrong("class", class))?,
            solver: row.try_get("solver")?,
            state: match state.as_str() {
                "waiting" => ChunkState::Waiting,
                "issued" => ChunkState::Issued,
                "stored" => ChunkState::Stored,
                _ => return Err(wrong("state", state)),
            },
            issue: row.try_get("issue")?,
            part: serde_json::from_str(&part).map_err(|error| wrong("part", error.to_string()))?,
            sequence: row.try_get::<Option<i64>, _>("sequence")?.map(i64::unsigned_abs),
        })
    }
}
