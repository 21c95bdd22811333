//! Canceling and deleting jobs.

use super::connect::{Store, StoreError};
use super::dataset::delete_ended;
use super::lifecycle::JobId;
use super::record::{JobRecord, job_columns, record_event};
use jiff::Timestamp;

/// The outcome of canceling a job.
#[derive(Debug, Clone, PartialEq)]
pub enum Cancellation {
    /// It was queued and is canceled.
    Canceled(JobRecord),
    /// It runs: the request was recorded, and the solver is to stop.
    Requested(JobRecord),
    /// It had ended before.
    Ended(JobRecord),
    NotFound,
}

/// The outcome of deleting a job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Deletion {
    Deleted,
    /// It has not ended and was not deleted.
    NotEnded,
    NotFound,
}

impl Store {
    /// Cancels a queued job (queued → canceled), or records the request on a running one.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn cancel(&self, id: JobId, now: Timestamp) -> Result<Cancellation, StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        let canceled: Option<JobRecord> = sqlx::query_as(concat!(
            "UPDATE jobs SET state = 'canceled', revision = revision + 1, \
             ended_at_us = MAX($2, COALESCE(started_at_us, submitted_at_us)), \
             cancel_requested_at_us = COALESCE(cancel_requested_at_us, $2) \
             WHERE id = $1 AND state = 'queued' RETURNING ",
            job_columns!()
        ))
        .bind(id.to_string())
        .bind(now.as_microsecond())
        .fetch_optional(&mut *transaction)
        .await?;
        if let Some(job) = canceled {
            record_event(&mut transaction, &job, now).await?;
            transaction.commit().await?;
            self.queued_count.add(-1);
            return Ok(Cancellation::Canceled(job));
        }
        sqlx::query(
            "UPDATE jobs SET cancel_requested_at_us = $2, revision = revision + 1 \
             WHERE id = $1 AND state = 'running' AND cancel_requested_at_us IS NULL",
        )
        .bind(id.to_string())
        .bind(now.as_microsecond())
        .execute(&mut *transaction)
        .await?;
        let job: Option<JobRecord> = sqlx::query_as(concat!("SELECT ", job_columns!(), " FROM jobs WHERE id = $1"))
            .bind(id.to_string())
            .fetch_optional(&mut *transaction)
            .await?;
        transaction.commit().await?;
        Ok(match job {
            None => Cancellation::NotFound,
            Some(job) if job.state.is_ended() => Cancellation::Ended(job),
            Some(job) => Cancellation::Requested(job),
        })
    }

    /// Deletes an ended job with its result, history, and series and rows that no other job shares.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn delete(&self, id: JobId) -> Result<Deletion, StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        let deleted = delete_ended(&mut transaction, id).await?;
        let live = sqlx::query("SELECT 1 FROM jobs WHERE id = $1")
            .bind(id.to_string())
            .fetch_optional(&mut *transaction)
            .await?;
        transaction.commit().await?;
        Ok(match (deleted, live) {
            (true, _) => Deletion::Deleted,
            (false, None) => Deletion::NotFound,
            (false, Some(_)) => Deletion::NotEnded,
        })
    }
}
