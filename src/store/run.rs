//! A job on its way through a worker: claimed, progressing, given back.

use super::connect::{Store, StoreError};
use super::failure::Failure;
use super::lifecycle::JobId;
use super::record::{JobRecord, job_columns, record_event};
use jiff::Timestamp;
use sqlx::{FromRow, Row, Sqlite, Transaction};

/// A job that was just started.
#[derive(Debug, Clone)]
pub struct Claim {
    pub job: JobRecord,
    /// The document, as JSON.
    pub input: String,
}

/// What was found at the start of the process.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Recovery {
    /// Running jobs of a dead process that wait again.
    pub requeued: u64,
    /// Running jobs whose cancellation was already asked for.
    pub canceled: u64,
    /// Running jobs that were lost as often as allowed.
    pub given_up: u64,
    /// Jobs that wait, the requeued ones included.
    pub waiting: u64,
}

impl Store {
    /// queued → running, for the job that is next in line.
    pub async fn claim_next(&self, now: Timestamp) -> Result<Option<Claim>, StoreError> {
        let mut transaction = self.write().await?;
        let row = sqlx::query(concat!(
            "UPDATE jobs SET state = 'running', attempt = attempt + 1, revision = revision + 1, started_at_us = $1, \
             progress = 0, stage = NULL WHERE state = 'queued' AND id = (SELECT id FROM jobs WHERE state = 'queued' \
             ORDER BY priority DESC, id LIMIT 1) RETURNING input, ",
            job_columns!()
        ))
        .bind(now.as_microsecond())
        .fetch_optional(&mut *transaction)
        .await?;
        let Some(row) = row else { return Ok(None) };
        let claim = Claim { job: sqlx::FromRow::from_row(&row)?, input: row.try_get("input")? };
        record_event(&mut transaction, &claim.job, now).await?;
        transaction.commit().await?;
        Ok(Some(claim))
    }

    /// Notes how far a running job is; `None` when the job is no longer this attempt's.
    pub async fn progress(
        &self,
        id: JobId,
        attempt: i64,
        stage: &str,
        fraction: f64,
    ) -> Result<Option<JobRecord>, StoreError> {
        Ok(sqlx::query_as(concat!(
            "UPDATE jobs SET progress = $3, stage = $4, revision = revision + 1 \
             WHERE id = $1 AND attempt = $2 AND state = 'running' RETURNING ",
            job_columns!()
        ))
        .bind(id.to_string())
        .bind(attempt)
        .bind(fraction.clamp(0.0, 1.0))
        .bind(stage)
        .fetch_optional(&self.writer)
        .await?)
    }

    /// running → canceled when that was asked for, else running → queued: the worker stopped before the end.
    pub async fn release(&self, id: JobId, attempt: i64, now: Timestamp) -> Result<Option<JobRecord>, StoreError> {
        let mut transaction = self.write().await?;
        let released = release_in(&mut transaction, id, attempt, now).await?;
        transaction.commit().await?;
        Ok(released)
    }

    /// Takes up what a dead process left: its running jobs wait again, unless they were lost `max_losses` times.
    pub async fn recover(&self, max_losses: u32, now: Timestamp) -> Result<Recovery, StoreError> {
        let mut transaction = self.write().await?;
        let lost = sqlx::query(concat!(
            "UPDATE jobs SET losses = losses + 1 WHERE state = 'running' RETURNING losses, ",
            job_columns!()
        ))
        .fetch_all(&mut *transaction)
        .await?;
        let mut recovery = Recovery::default();
        for row in lost {
            let job = JobRecord::from_row(&row)?;
            let losses: i64 = row.try_get("losses")?;
            if job.cancel_requested_at.is_some() {
                release_in(&mut transaction, job.id, job.attempt, now).await?;
                recovery.canceled += 1;
            } else if losses >= i64::from(max_losses) {
                give_up(&mut transaction, &job, losses, now).await?;
                recovery.given_up += 1;
            } else {
                release_in(&mut transaction, job.id, job.attempt, now).await?;
                recovery.requeued += 1;
            }
        }
        let row =
            sqlx::query("SELECT COUNT(*) AS n FROM jobs WHERE state = 'queued'").fetch_one(&mut *transaction).await?;
        recovery.waiting = row.try_get::<i64, _>("n")?.unsigned_abs();
        transaction.commit().await?;
        Ok(recovery)
    }
}

async fn release_in(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    attempt: i64,
    now: Timestamp,
) -> Result<Option<JobRecord>, StoreError> {
    let released: Option<JobRecord> = sqlx::query_as(concat!(
        "UPDATE jobs SET revision = revision + 1, \
         state = CASE WHEN cancel_requested_at_us IS NULL THEN 'queued' ELSE 'canceled' END, \
         ended_at_us = CASE WHEN cancel_requested_at_us IS NULL THEN NULL ELSE $3 END, \
         started_at_us = CASE WHEN cancel_requested_at_us IS NULL THEN NULL ELSE started_at_us END, \
         progress = CASE WHEN cancel_requested_at_us IS NULL THEN 0 ELSE progress END, \
         stage = CASE WHEN cancel_requested_at_us IS NULL THEN NULL ELSE stage END \
         WHERE id = $1 AND attempt = $2 AND state = 'running' RETURNING ",
        job_columns!()
    ))
    .bind(id.to_string())
    .bind(attempt)
    .bind(now.as_microsecond())
    .fetch_optional(&mut **transaction)
    .await?;
    if let Some(job) = &released {
        record_event(transaction, job, now).await?;
    }
    Ok(released)
}

async fn give_up(
    transaction: &mut Transaction<'static, Sqlite>,
    job: &JobRecord,
    losses: i64,
    now: Timestamp,
) -> Result<(), StoreError> {
    let detail = format!("the process ended while the job ran, {losses} times; it is not started again");
    super::finish::fail_in(transaction, job.id, job.attempt, &Failure::new("worker-lost", detail), now).await?;
    Ok(())
}
