//! The transitions from running to succeeded and failed.

use super::chunks::drop_chunks;
use super::connect::{Store, StoreError};
use super::dataset::{dataset_of, drop_unused_dataset, ensure_dataset};
use super::failure::Failure;
use super::headline::Headline;
use super::lifecycle::JobId;
use super::points::{PointBatch, RowsSummary, drop_line_ends, insert_points};
use super::record::{JobRecord, job_columns, record_event};
use super::result::etag_of;
use super::series::{SampleBatch, SeriesEntry, drop_samples};
use jiff::Timestamp;
use sqlx::{Sqlite, Transaction};

/// The result of a job, to be stored when it succeeds.
#[derive(Debug, Clone)]
pub struct Completion {
    /// The result as JSON; the rows of a sweep are left out.
    pub body: String,
    pub input_hash: String,
    pub solver_version: String,
    /// Descriptions of the recorded channels.
    pub series: Vec<SeriesEntry>,
    /// Samples that are not yet stored.
    pub samples: SampleBatch,
    /// Summary of the rows of a sweep, which are stored apart from the body.
    pub rows: Option<RowsSummary>,
    /// Rows that are not yet stored.
    pub unwritten: PointBatch,
    /// The job whose result this is; its series and rows are shared.
    pub reused_from: Option<JobId>,
}

impl Store {
    /// Stores the result of a running job (running → succeeded). `None` when the job no longer belongs to this attempt
    /// or is to be canceled, or when the job whose result is to be reused was deleted.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn succeed(
        &self,
        id: JobId,
        attempt: i64,
        completion: &Completion,
        now: Timestamp,
    ) -> Result<Option<JobRecord>, StoreError> {
        // Before the transaction, for which other writers wait.
        let headline = Headline::of_result(&completion.body);
        let mut transaction = self.begin().await?;
        let done = complete(&mut transaction, id, attempt, (completion, headline), now).await?;
        if done.is_some() {
            transaction.commit().await?;
        }
        Ok(done)
    }

    /// Stores the failure of a running job (running → failed). `None` when the job no longer belongs to this attempt.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn fail(
        &self,
        id: JobId,
        attempt: i64,
        failure: &Failure,
        now: Timestamp,
    ) -> Result<Option<JobRecord>, StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
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
        drop_samples(transaction, id).await?;
        drop_chunks(transaction, id).await?;
    }
    Ok(failed)
}

/// The transition to succeeded, in a transaction that the caller commits, or drops on `None`.
pub(super) async fn complete(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    attempt: i64,
    (completion, headline): (&Completion, Headline),
    now: Timestamp,
) -> Result<Option<JobRecord>, StoreError> {
    let done: Option<JobRecord> = sqlx::query_as(concat!(
        "UPDATE jobs SET state = 'succeeded', revision = revision + 1, progress = 1, \
         ended_at_us = MAX($3, COALESCE(started_at_us, submitted_at_us)), \
         solver_version = $4, input_hash = $5, reused_from = $6, \
         mesh_acceleration_rms_m_s2 = $7, dynamic_factor = $8, transmission_error_pp_um = $9 \
         WHERE id = $1 AND attempt = $2 AND state = 'running' AND cancel_requested_at_us IS NULL RETURNING ",
        job_columns!()
    ))
    .bind(id.to_string())
    .bind(attempt)
    .bind(now.as_microsecond())
    .bind(&completion.solver_version)
    .bind(&completion.input_hash)
    .bind(completion.reused_from.map(|source| source.to_string()))
    .bind(headline.mesh_acceleration_rms_m_s2)
    .bind(headline.dynamic_factor)
    .bind(headline.transmission_error_pp_um)
    .fetch_optional(&mut **transaction)
    .await?;
    let Some(job) = done else { return Ok(None) };
    record_event(transaction, &job, now).await?;
    let dataset = match completion.reused_from {
        None => id,
        Some(source) => match dataset_of(transaction, source).await? {
            Some(dataset) => dataset,
            None => return Ok(None),
        },
    };
    if dataset == id {
        ensure_dataset(transaction, id).await?;
    }
    let rows = completion.rows.as_ref();
    sqlx::query(
        "INSERT INTO results (job_id, body, etag, input_hash, solver_version, points_n, points_digest, dataset_id) \
         VALUES ($1, $2, $3, $4, $5, $6, $7, $8)",
    )
    .bind(id.to_string())
    .bind(&completion.body)
    .bind(etag_of(&completion.body, rows))
    .bind(&completion.input_hash)
    .bind(&completion.solver_version)
    .bind(rows.map(|rows| rows.count as i64))
    .bind(rows.map(|rows| &rows.digest))
    .bind(dataset.to_string())
    .execute(&mut **transaction)
    .await?;
    drop_line_ends(transaction, id).await?;
    drop_chunks(transaction, id).await?;
    if dataset != id {
        // Of an earlier attempt, before there was a result to be reused.
        drop_unused_dataset(transaction, id).await?;
        return Ok(Some(job));
    }
    insert_points(transaction, id, &completion.unwritten).await?;
    completion.samples.insert(transaction, id).await?;
    for (position, entry) in completion.series.iter().enumerate() {
        entry.insert(transaction, id, position).await?;
    }
    Ok(Some(job))
}
