//! Submission of jobs.

use super::connect::{Store, StoreError};
use super::finish::{Completion, complete};
use super::headline::Headline;
use super::lifecycle::JobId;
use super::record::{JobRecord, job_columns, record_event};
use jiff::Timestamp;
use sqlx::{Row, Sqlite, Transaction};

/// A job to be stored.
#[derive(Debug, Clone)]
pub struct NewJob {
    pub id: JobId,
    pub kind: &'static str,
    pub name: Option<String>,
    pub label: Option<String>,
    /// The document with every default filled in, as JSON.
    pub input: String,
    pub input_hash: String,
    pub solver_version: &'static str,
    pub request_id: Option<String>,
    /// Trace of that request (W3C Trace Context).
    pub traceparent: Option<String>,
    /// The client's idempotency key, and a hash of the document sent with it.
    pub idempotency: Option<(String, String)>,
}

/// The outcome of a submission.
#[derive(Debug, Clone, PartialEq)]
pub enum Submission {
    /// Stored: queued, or succeeded with a reused result.
    Accepted(JobRecord),
    /// The job of an earlier submission with the same key and document.
    Replayed(JobRecord),
    /// The key was used with another document.
    KeyReused,
    /// The queue is full.
    Full,
}

impl Store {
    /// Stores a job unless `capacity` jobs are queued. With `reuse`, the job succeeds in the same transaction with that
    /// result and is not queued.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn submit(
        &self,
        job: NewJob,
        reuse: Option<Completion>,
        capacity: u32,
        now: Timestamp,
    ) -> Result<Submission, StoreError> {
        // Before the transaction, for which other writers wait.
        let reuse = reuse.map(|completion| (Headline::of_result(&completion.body), completion));
        let mut transaction = self.begin().await?;
        if let Some(earlier) = earlier_submission(&mut transaction, &job).await? {
            return Ok(earlier);
        }
        let mut record = insert(&mut transaction, &job, now).await?;
        let mut ended = false;
        if let Some((headline, completion)) = &reuse {
            record = start(&mut transaction, &record, now).await?;
            if let Some(done) =
                complete(&mut transaction, record.id, record.attempt, (completion, *headline), now).await?
            {
                record = done;
                ended = true;
            } else {
                // The job of the reused result was deleted meanwhile: submitted again without it.
                transaction.rollback().await?;
                return Box::pin(self.submit(job, None, capacity, now)).await;
            }
        }
        // The count grows only in transactions on the one connection that writes.
        if !ended && self.queued_count.get() >= i64::from(capacity) {
            return Ok(Submission::Full);
        }
        // Counted before the next writer reads the count.
        let added = i64::from(!ended);
        self.queued_count.add(added);
        if let Err(error) = transaction.commit().await {
            self.queued_count.add(-added);
            return Err(error.into());
        }
        Ok(Submission::Accepted(record))
    }
}

async fn earlier_submission(
    transaction: &mut Transaction<'static, Sqlite>,
    job: &NewJob,
) -> Result<Option<Submission>, StoreError> {
    let Some((key, hash)) = &job.idempotency else { return Ok(None) };
    let row =
        sqlx::query(concat!("SELECT idempotency_hash, ", job_columns!(), " FROM jobs WHERE idempotency_key = $1"))
            .bind(key)
            .fetch_optional(&mut **transaction)
            .await?;
    let Some(row) = row else { return Ok(None) };
    let earlier: String = row.try_get("idempotency_hash")?;
    if earlier != *hash {
        return Ok(Some(Submission::KeyReused));
    }
    Ok(Some(Submission::Replayed(sqlx::FromRow::from_row(&row)?)))
}

async fn insert(
    transaction: &mut Transaction<'static, Sqlite>,
    job: &NewJob,
    now: Timestamp,
) -> Result<JobRecord, StoreError> {
    let (key, hash) = job.idempotency.clone().unzip();
    let record: JobRecord = sqlx::query_as(concat!(
        "INSERT INTO jobs (id, kind, name, label, state, revision, attempt, input, input_hash, solver_version, \
         submitted_at_us, request_id, idempotency_key, idempotency_hash, traceparent) \
         VALUES ($1, $2, $3, $4, 'queued', 1, 0, $5, $6, $7, $8, $9, $10, $11, $12) RETURNING ",
        job_columns!()
    ))
    .bind(job.id.to_string())
    .bind(job.kind)
    .bind(&job.name)
    .bind(&job.label)
    .bind(&job.input)
    .bind(&job.input_hash)
    .bind(job.solver_version)
    .bind(now.as_microsecond())
    .bind(&job.request_id)
    .bind(key)
    .bind(hash)
    .bind(&job.traceparent)
    .fetch_one(&mut **transaction)
    .await?;
    record_event(transaction, &record, now).await?;
    Ok(record)
}

async fn start(
    transaction: &mut Transaction<'static, Sqlite>,
    job: &JobRecord,
    now: Timestamp,
) -> Result<JobRecord, StoreError> {
    let record: JobRecord = sqlx::query_as(concat!(
        "UPDATE jobs SET state = 'running', attempt = attempt + 1, revision = revision + 1, \
         started_at_us = MAX($2, submitted_at_us) \
         WHERE id = $1 AND state = 'queued' RETURNING ",
        job_columns!()
    ))
    .bind(job.id.to_string())
    .bind(now.as_microsecond())
    .fetch_one(&mut **transaction)
    .await?;
    record_event(transaction, &record, now).await?;
    Ok(record)
}
