//! The end of a running job.

use super::connect::{Store, StoreError};
use super::failure::Failure;
use super::lifecycle::JobId;
use super::points::{PointBatch, PointsOfResult, copy_points, drop_line_ends, insert_points};
use super::record::{JobRecord, job_columns, record_event};
use super::result::etag_of;
use super::series::PackedSeries;
use jiff::Timestamp;
use sqlx::{Sqlite, Transaction};

/// What a job leaves behind when it succeeds.
#[derive(Debug, Clone)]
pub struct Completion {
    /// The result, as JSON.
    pub body: String,
    pub input_hash: String,
    pub solver_version: String,
    pub series: Vec<PackedSeries>,
    /// Of a sweep: its rows stand apart from the body, at this place.
    pub points: Option<PointsOfResult>,
    /// Those of its rows that are not yet written.
    pub rows: PointBatch,
    /// The job whose series and rows are copied instead, when its result was taken.
    pub reused_from: Option<JobId>,
}

impl Store {
    /// running → succeeded, with the result and the series; `None` when the job is no longer this attempt's, or when
    /// the job whose result is to be reused is gone.
    pub async fn succeed(
        &self,
        id: JobId,
        attempt: i64,
        completion: &Completion,
        now: Timestamp,
    ) -> Result<Option<JobRecord>, StoreError> {
        let mut transaction = self.write_more().await?;
        let done = complete(&mut transaction, id, attempt, completion, now).await?;
        if done.is_some() {
            transaction.commit().await?;
        }
        Ok(done)
    }

    /// running → failed; `None` when the job is no longer this attempt's.
    pub async fn fail(
        &self,
        id: JobId,
        attempt: i64,
        failure: &Failure,
        now: Timestamp,
    ) -> Result<Option<JobRecord>, StoreError> {
        let mut transaction = self.write().await?;
        let failed = fail_in(&mut transaction, id, attempt, failure, now).await?;
        transaction.commit().await?;
        Ok(failed)
    }
}

pub(super) async fn fail_in(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    attempt: i64,
    failure: &Failure,
    now: Timestamp,
) -> Result<Option<JobRecord>, StoreError> {
    let error = serde_json::to_string(failure)
        .map_err(|error| StoreError::Corrupt { what: "failure", detail: error.to_string() })?;
    let failed: Option<JobRecord> = sqlx::query_as(concat!(
        "UPDATE jobs SET state = 'failed', revision = revision + 1, error = $4, \
         ended_at_us = MAX($3, COALESCE(started_at_us, submitted_at_us)) \
         WHERE id = $1 AND attempt = $2 AND state = 'running' RETURNING ",
        job_columns!()
    ))
    .bind(id.to_string())
    .bind(attempt)
    .bind(now.as_microsecond())
    .bind(error)
    .fetch_optional(&mut **transaction)
    .await?;
    if let Some(job) = &failed {
        record_event(transaction, job, now).await?;
    }
    Ok(failed)
}

/// The transition to succeeded within a transaction that the caller commits, or drops on `None`.
pub(super) async fn complete(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    attempt: i64,
    completion: &Completion,
    now: Timestamp,
) -> Result<Option<JobRecord>, StoreError> {
    let done: Option<JobRecord> = sqlx::query_as(concat!(
        "UPDATE jobs SET state = 'succeeded', revision = revision + 1, progress = 1, \
         ended_at_us = MAX($3, COALESCE(started_at_us, submitted_at_us)), \
         solver_version = $4, input_hash = $5, reused_from = $6 \
         WHERE id = $1 AND attempt = $2 AND state = 'running' RETURNING ",
        job_columns!()
    ))
    .bind(id.to_string())
    .bind(attempt)
    .bind(now.as_microsecond())
    .bind(&completion.solver_version)
    .bind(&completion.input_hash)
    .bind(completion.reused_from.map(|source| source.to_string()))
    .fetch_optional(&mut **transaction)
    .await?;
    let Some(job) = done else { return Ok(None) };
    record_event(transaction, &job, now).await?;
    let points = completion.points.as_ref();
    sqlx::query(
        "INSERT INTO results (job_id, body, etag, input_hash, solver_version, points_at, points_n, points_digest) \
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8)",
    )
    .bind(id.to_string())
    .bind(&completion.body)
    .bind(etag_of(&completion.body, points))
    .bind(&completion.input_hash)
    .bind(&completion.solver_version)
    .bind(points.map(|points| points.at as i64))
    .bind(points.map(|points| points.n as i64))
    .bind(points.map(|points| &points.digest))
    .execute(&mut **transaction)
    .await?;
    insert_points(transaction, id, &completion.rows).await?;
    drop_line_ends(transaction, id).await?;
    match completion.reused_from {
        Some(source) => {
            if !copy_results(transaction, source, id).await? {
                return Ok(None);
            }
        }
        None => {
            for (position, series) in completion.series.iter().enumerate() {
                series.insert(transaction, id, position).await?;
            }
        }
    }
    Ok(Some(job))
}

/// False when the source has no result any more.
async fn copy_results(
    transaction: &mut Transaction<'static, Sqlite>,
    source: JobId,
    target: JobId,
) -> Result<bool, StoreError> {
    let there = sqlx::query("SELECT 1 FROM results WHERE job_id = $1")
        .bind(source.to_string())
        .fetch_optional(&mut **transaction)
        .await?;
    if there.is_none() {
        return Ok(false);
    }
    copy_points(transaction, source, target).await?;
    sqlx::query(
        "INSERT INTO series (job_id, position, channel, quantity, unit, n, t0_s, dt_s, min, max, rms, samples) \
         SELECT $2, position, channel, quantity, unit, n, t0_s, dt_s, min, max, rms, samples FROM series \
         WHERE job_id = $1",
    )
    .bind(source.to_string())
    .bind(target.to_string())
    .execute(&mut **transaction)
    .await?;
    Ok(true)
}
