//! Reading single jobs, and counting jobs.

use super::connect::{Store, StoreError};
use super::lifecycle::{JobId, JobState};
use super::record::{JobRecord, job_columns};
use sqlx::Row;
use std::str::FromStr;

/// Numbers of jobs by state.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct JobCounts {
    pub queued: u64,
    pub running: u64,
    pub succeeded: u64,
    pub failed: u64,
    pub canceled: u64,
}

impl Store {
    /// Reads a job.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn job(&self, id: JobId) -> Result<Option<JobRecord>, StoreError> {
        Ok(sqlx::query_as(concat!("SELECT ", job_columns!(), " FROM jobs WHERE id = $1"))
            .bind(id.to_string())
            .fetch_optional(&self.reader)
            .await?)
    }

    /// Reads the document of a job as accepted, with every default filled in (JSON).
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn input(&self, id: JobId) -> Result<Option<String>, StoreError> {
        let row = sqlx::query("SELECT input FROM jobs WHERE id = $1")
            .bind(id.to_string())
            .fetch_optional(&self.reader)
            .await?;
        Ok(row.map(|row| row.try_get("input")).transpose()?)
    }

    /// Counts the jobs by state.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn counts(&self) -> Result<JobCounts, StoreError> {
        let rows = sqlx::query("SELECT state, COUNT(*) AS n FROM jobs GROUP BY state").fetch_all(&self.reader).await?;
        let mut counts = JobCounts::default();
        for row in rows {
            let n = row.try_get::<i64, _>("n")?.unsigned_abs();
            match JobState::from_str(row.try_get("state")?) {
                Ok(JobState::Queued) => counts.queued = n,
                Ok(JobState::Running) => counts.running = n,
                Ok(JobState::Succeeded) => counts.succeeded = n,
                Ok(JobState::Failed) => counts.failed = n,
                Ok(JobState::Canceled) => counts.canceled = n,
                Err(()) => {}
            }
        }
        Ok(counts)
    }

    /// Reads revision and state of every transition of a job, oldest first.
    ///
    /// # Errors
    /// The database cannot be read, or contains an unknown state.
    pub async fn history(&self, id: JobId) -> Result<Vec<(i64, JobState)>, StoreError> {
        let rows = sqlx::query("SELECT revision, state FROM job_events WHERE job_id = $1 ORDER BY revision")
            .bind(id.to_string())
            .fetch_all(&self.reader)
            .await?;
        rows.iter()
            .map(|row| {
                let name: String = row.try_get("state")?;
                let state = JobState::from_str(&name)
                    .map_err(|()| StoreError::Corrupt { what: "event", detail: format!("state {name}") })?;
                Ok((row.try_get("revision")?, state))
            })
            .collect()
    }
}
