//! Claiming, progress and release of jobs by workers, and recovery after a restart.

use super::chunks::drop_chunks;
use super::connect::{Store, StoreError};
use super::failure::Failure;
use super::lifecycle::{JobId, JobState};
use super::points::{PointBatch, insert_points};
use super::record::{JobRecord, job_columns, record_event};
use super::series::drop_samples;
use jiff::Timestamp;
use sqlx::{FromRow, Row, Sqlite, Transaction};
use std::time::Duration;

/// A job claimed by a worker.
#[derive(Debug, Clone)]
pub struct Claim {
    pub job: JobRecord,
    /// The document as JSON.
    pub input: String,
    /// Computing time of earlier attempts, without lost ones.
    pub computed: Duration,
}

/// The class of a job by its computing time; each class has its own workers and queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum WorkClass {
    /// One operating point (seconds).
    Single,
    /// Many operating points (hours), each with a row: sweeps, optimisations, tolerance studies.
    Sweep,
}

impl WorkClass {
    /// The class of a kind of job.
    pub fn of_kind(kind: &str) -> Self {
        if matches!(kind, "sweep" | "optimise" | "tolerance") { WorkClass::Sweep } else { WorkClass::Single }
    }
}

/// Whether a job is of the class [`WorkClass::Sweep`], as its index has it. A literal for `concat!`.
macro_rules! has_rows {
    () => {
        "(kind IN ('sweep', 'optimise', 'tolerance'))"
    };
}

/// The reason for returning a running job to the queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReleaseReason {
    /// The service stops.
    Shutdown,
    /// Its turn is over, and other jobs wait.
    Turn,
}

/// The jobs that were running or queued at the start of the process.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Recovery {
    /// Running jobs that were queued again.
    pub requeued: u64,
    /// Running jobs whose cancellation had been requested.
    pub canceled: u64,
    /// Running jobs that failed because they were lost as often as allowed.
    pub given_up: u64,
    /// Queued jobs, including those that were queued again.
    pub queued: u64,
}

/// Whether other machines compute a running job: its attempt has chunks. A literal for `concat!`.
macro_rules! is_distributed {
    () => {
        "EXISTS (SELECT 1 FROM chunks WHERE chunks.job_id = jobs.id AND chunks.attempt = jobs.attempt)"
    };
}

impl Store {
    /// Claims the next job of this class (queued → running): by priority, then by the number of its turns, then by age.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn claim_next(&self, class: WorkClass, now: Timestamp) -> Result<Option<Claim>, StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        let row = sqlx::query(concat!(
            "UPDATE jobs SET state = 'running', attempt = attempt + 1, revision = revision + 1, \
             started_at_us = MAX($1, submitted_at_us), \
             progress = CASE WHEN ",
            has_rows!(),
            " THEN progress ELSE 0 END, stage = NULL WHERE state = 'queued' AND id = \
             (SELECT id FROM jobs WHERE state = 'queued' AND ",
            has_rows!(),
            " = $2 ORDER BY priority DESC, turns, id LIMIT 1) RETURNING input, computed_us, ",
            job_columns!()
        ))
        .bind(now.as_microsecond())
        .bind(class == WorkClass::Sweep)
        .fetch_optional(&mut *transaction)
        .await?;
        let Some(row) = row else { return Ok(None) };
        let computed = Duration::from_micros(row.try_get::<i64, _>("computed_us")?.unsigned_abs());
        let claim = Claim { job: FromRow::from_row(&row)?, input: row.try_get("input")?, computed };
        record_event(&mut transaction, &claim.job, now).await?;
        transaction.commit().await?;
        self.queued_count.add(-1);
        Ok(Some(claim))
    }

    /// Whether a job of this class is queued.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn has_queued(&self, class: WorkClass) -> Result<bool, StoreError> {
        let row = sqlx::query(concat!("SELECT 1 FROM jobs WHERE state = 'queued' AND ", has_rows!(), " = $1 LIMIT 1"))
            .bind(class == WorkClass::Sweep)
            .fetch_optional(&self.reader)
            .await?;
        Ok(row.is_some())
    }

    /// Stores the progress of a running job, and points that were solved. `None`, and nothing stored, when the job no
    /// longer belongs to this attempt.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn progress(
        &self,
        id: JobId,
        attempt: i64,
        stage: &str,
        fraction: f64,
        points: &PointBatch,
    ) -> Result<Option<JobRecord>, StoreError> {
        let mut transaction = self.begin().await?;
        let job: Option<JobRecord> = sqlx::query_as(concat!(
            "UPDATE jobs SET progress = $3, stage = $4, revision = revision + 1 \
             WHERE id = $1 AND attempt = $2 AND state = 'running' RETURNING ",
            job_columns!()
        ))
        .bind(id.to_string())
        .bind(attempt)
        .bind(fraction.clamp(0.0, 1.0))
        .bind(stage)
        .fetch_optional(&mut *transaction)
        .await?;
        if job.is_some() {
            insert_points(&mut transaction, id, points).await?;
        }
        transaction.commit().await?;
        Ok(job)
    }

    /// Returns a job that was stopped after the time `computed`: running → canceled if that was requested, else
    /// running → queued. `None` when the job no longer belongs to this attempt.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn release(
        &self,
        id: JobId,
        attempt: i64,
        reason: ReleaseReason,
        computed: Duration,
        now: Timestamp,
    ) -> Result<Option<JobRecord>, StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        sqlx::query(
            "UPDATE jobs SET computed_us = computed_us + $3, turns = turns + $4 \
             WHERE id = $1 AND attempt = $2 AND state = 'running'",
        )
        .bind(id.to_string())
        .bind(attempt)
        .bind(i64::try_from(computed.as_micros()).unwrap_or(i64::MAX))
        .bind(i64::from(reason == ReleaseReason::Turn))
        .execute(&mut *transaction)
        .await?;
        let released = release_in(&mut transaction, id, attempt, now).await?;
        let added = i64::from(released.as_ref().is_some_and(|job| job.state == JobState::Queued));
        self.queued_count.add(added);
        if let Err(error) = transaction.commit().await {
            self.queued_count.add(-added);
            return Err(error.into());
        }
        Ok(released)
    }

    /// Queues the jobs that were running when the last process ended, unless they were lost `max_losses` times. Those
    /// that other machines compute go on where `keep_distributed` says so; else they are queued too, and that does not
    /// count as a loss.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn recover(
        &self,
        max_losses: u32,
        keep_distributed: bool,
        now: Timestamp,
    ) -> Result<Recovery, StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        let lost = sqlx::query(concat!(
            "UPDATE jobs SET losses = losses + 1 - ",
            is_distributed!(),
            " WHERE state = 'running' AND NOT ($1 AND cancel_requested_at_us IS NULL AND ",
            is_distributed!(),
            ") RETURNING losses, ",
            job_columns!()
        ))
        .bind(keep_distributed)
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
                fail_lost_job(&mut transaction, &job, losses, now).await?;
                recovery.given_up += 1;
            } else {
                release_in(&mut transaction, job.id, job.attempt, now).await?;
                recovery.requeued += 1;
            }
        }
        let row =
            sqlx::query("SELECT COUNT(*) AS n FROM jobs WHERE state = 'queued'").fetch_one(&mut *transaction).await?;
        recovery.queued = row.try_get::<i64, _>("n")?.unsigned_abs();
        transaction.commit().await?;
        self.queued_count.add(recovery.requeued as i64);
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
         ended_at_us = CASE WHEN cancel_requested_at_us IS NULL THEN NULL \
         ELSE MAX($3, COALESCE(started_at_us, submitted_at_us)) END, \
         started_at_us = CASE WHEN cancel_requested_at_us IS NULL THEN NULL ELSE started_at_us END, \
         progress = CASE WHEN cancel_requested_at_us IS NULL AND NOT ",
        has_rows!(),
        " THEN 0 ELSE progress END, \
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
        drop_samples(transaction, id).await?;
        drop_chunks(transaction, id).await?;
    }
    Ok(released)
}

async fn fail_lost_job(
    transaction: &mut Transaction<'static, Sqlite>,
    job: &JobRecord,
    losses: i64,
    now: Timestamp,
) -> Result<(), StoreError> {
    let detail = format!("the process ended while the job ran, {losses} times; it is not started again");
    super::finish::fail_in(transaction, job.id, job.attempt, &Failure::new("worker-lost", detail), now).await?;
    Ok(())
}
