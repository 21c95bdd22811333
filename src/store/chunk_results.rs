//! Results of chunks: stored once, however often they arrive.

use super::chunks::ChunkKey;
use super::connect::{Store, StoreError};
use super::dataset::ensure_dataset;
use super::failure::Failure;
use super::finish::fail_in;
use super::lifecycle::JobId;
use super::points::{LineEndRow, PointBatch, insert_points};
use super::record::JobRecord;
use super::series::SampleBatch;
use jiff::Timestamp;
use sqlx::{Row, Sqlite, Transaction};
use std::collections::HashMap;

/// A part of the result of a chunk.
#[derive(Debug, Clone)]
pub struct ChunkResult {
    pub key: ChunkKey,
    pub content: ChunkContent,
}

/// What a part of a result contains.
#[derive(Debug, Clone)]
pub enum ChunkContent {
    /// Rows of a sweep.
    Rows(PointBatch),
    /// Samples of recorded channels.
    Samples(SampleBatch),
    /// A piece of the result of a whole job, by the computation it belongs to.
    Piece { run: String, piece: u32, bytes: Vec<u8> },
    /// All rows of a part of a sweep were sent. `ranges`: their positions, as pairs of the first one and the one after
    /// the last.
    End { ranges: Vec<[u64; 2]>, line_end: Option<LineEndRow> },
    /// The job cannot be solved.
    Failure(Failure),
}

/// What became of a part of a result.
#[derive(Debug, Clone, PartialEq)]
pub enum ChunkOutcome {
    /// Stored, with so many rows that were not stored before.
    Stored { new_rows: u64 },
    /// All of the chunk is stored.
    Done,
    /// The chunk has ended, but rows of it are missing.
    Incomplete,
    /// The job failed.
    JobFailed(Box<JobRecord>),
    /// Nothing was stored.
    Dropped(DropReason),
}

/// The reason for dropping a part of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DropReason {
    /// The job has ended, is to be canceled, or runs in a later attempt.
    Late,
    /// The chunk is stored.
    Duplicate,
}

impl DropReason {
    pub fn as_str(self) -> &'static str {
        match self {
            DropReason::Late => "late",
            DropReason::Duplicate => "duplicate",
        }
    }
}

impl Store {
    /// Stores parts of results in one transaction, in their order. Each is fenced by the attempt of its job and the
    /// state of its chunk; what is stored already stays as it is.
    ///
    /// # Errors
    /// The database cannot be written; nothing is stored then.
    pub async fn store_chunk_results(
        &self,
        results: &[ChunkResult],
        now: Timestamp,
    ) -> Result<Vec<ChunkOutcome>, StoreError> {
        let mut transaction = self.begin().await?;
        let mut fences = HashMap::new();
        let mut outcomes = Vec::with_capacity(results.len());
        for ChunkResult { key, content } in results {
            let fence = match fences.get(key) {
                Some(known) => *known,
                None => fence(&mut transaction, *key).await?,
            };
            let outcome = match fence {
                Err(reason) => ChunkOutcome::Dropped(reason),
                Ok(()) => store(&mut transaction, *key, content, now).await?,
            };
            let fence = match &outcome {
                ChunkOutcome::Done => Err(DropReason::Duplicate),
                ChunkOutcome::JobFailed(_) => {
                    // Other chunks of the job are fenced too.
                    fences.clear();
                    Err(DropReason::Late)
                }
                _ => fence,
            };
            fences.insert(*key, fence);
            outcomes.push(outcome);
        }
        transaction.commit().await?;
        Ok(outcomes)
    }

    /// Reads the pieces of the result of a whole job, as one computation sent them; `None` when one is missing.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn chunk_pieces(&self, key: ChunkKey, run: &str, pieces: u32) -> Result<Option<Vec<u8>>, StoreError> {
        let rows = sqlx::query(
            "SELECT bytes FROM chunk_pieces WHERE job_id = $1 AND attempt = $2 AND chunk = $3 AND run = $4 \
             AND piece < $5 ORDER BY piece",
        )
        .bind(key.job.to_string())
        .bind(key.attempt)
        .bind(key.chunk)
        .bind(run)
        .bind(pieces)
        .fetch_all(&self.reader)
        .await?;
        if rows.len() != pieces as usize {
            return Ok(None);
        }
        let bytes: Result<Vec<Vec<u8>>, _> = rows.iter().map(|row| row.try_get("bytes")).collect();
        Ok(Some(bytes?.concat()))
    }

    /// Counts the stored parts of the samples of a running job.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn sample_parts(&self, job: JobId) -> Result<u64, StoreError> {
        let row = sqlx::query("SELECT COUNT(*) AS n FROM series_samples WHERE dataset_id = $1")
            .bind(job.to_string())
            .fetch_one(&self.reader)
            .await?;
        Ok(row.try_get::<i64, _>("n")?.unsigned_abs())
    }
}

/// Whether results of a chunk are stored.
async fn fence(
    transaction: &mut Transaction<'static, Sqlite>,
    key: ChunkKey,
) -> Result<Result<(), DropReason>, StoreError> {
    let row = sqlx::query(
        "SELECT chunks.state = 'stored' AS is_stored FROM chunks \
         JOIN jobs ON jobs.id = chunks.job_id AND jobs.attempt = chunks.attempt \
         WHERE job_id = $1 AND chunks.attempt = $2 AND chunk = $3 \
         AND jobs.state = 'running' AND cancel_requested_at_us IS NULL",
    )
    .bind(key.job.to_string())
    .bind(key.attempt)
    .bind(key.chunk)
    .fetch_optional(&mut **transaction)
    .await?;
    let Some(row) = row else { return Ok(Err(DropReason::Late)) };
    Ok(if row.try_get("is_stored")? { Err(DropReason::Duplicate) } else { Ok(()) })
}

async fn store(
    transaction: &mut Transaction<'static, Sqlite>,
    key: ChunkKey,
    content: &ChunkContent,
    now: Timestamp,
) -> Result<ChunkOutcome, StoreError> {
    match content {
        ChunkContent::Rows(batch) => {
            let new_rows = insert_points(transaction, key.job, batch).await?;
            Ok(ChunkOutcome::Stored { new_rows })
        }
        ChunkContent::Samples(batch) => {
            ensure_dataset(transaction, key.job).await?;
            batch.insert(transaction, key.job).await?;
            Ok(ChunkOutcome::Stored { new_rows: 0 })
        }
        ChunkContent::Piece { run, piece, bytes } => {
            sqlx::query(
                "INSERT INTO chunk_pieces (job_id, attempt, chunk, run, piece, bytes) VALUES ($1, $2, $3, $4, $5, $6) \
                 ON CONFLICT (job_id, attempt, chunk, run, piece) DO NOTHING",
            )
            .bind(key.job.to_string())
            .bind(key.attempt)
            .bind(key.chunk)
            .bind(run)
            .bind(piece)
            .bind(bytes)
            .execute(&mut **transaction)
            .await?;
            Ok(ChunkOutcome::Stored { new_rows: 0 })
        }
        ChunkContent::End { ranges, line_end } => end(transaction, key, ranges, line_end.as_ref()).await,
        ChunkContent::Failure(failure) => {
            let failed = fail_in(transaction, key.job, key.attempt, failure, now).await?;
            Ok(failed.map_or(ChunkOutcome::Dropped(DropReason::Late), |job| ChunkOutcome::JobFailed(Box::new(job))))
        }
    }
}

/// Ends a chunk of a sweep if all its rows are stored.
async fn end(
    transaction: &mut Transaction<'static, Sqlite>,
    key: ChunkKey,
    ranges: &[[u64; 2]],
    line_end: Option<&LineEndRow>,
) -> Result<ChunkOutcome, StoreError> {
    for [from, to] in ranges {
        let row = sqlx::query(
            "SELECT COUNT(*) AS n FROM sweep_points WHERE dataset_id = $1 AND position >= $2 AND position < $3",
        )
        .bind(key.job.to_string())
        .bind(*from as i64)
        .bind(*to as i64)
        .fetch_one(&mut **transaction)
        .await?;
        if row.try_get::<i64, _>("n")?.unsigned_abs() != to.saturating_sub(*from) {
            return Ok(ChunkOutcome::Incomplete);
        }
    }
    let ends = PointBatch { ends: line_end.into_iter().cloned().collect(), ..PointBatch::default() };
    insert_points(transaction, key.job, &ends).await?;
    sqlx::query("UPDATE chunks SET state = 'stored' WHERE job_id = $1 AND attempt = $2 AND chunk = $3")
        .bind(key.job.to_string())
        .bind(key.attempt)
        .bind(key.chunk)
        .execute(&mut **transaction)
        .await?;
    Ok(ChunkOutcome::Done)
}
