//! Looking up one job, and counting them.

use super::connect::{Store, StoreError};
use super::lifecycle::{JobId, State};
use super::record::{JobRecord, job_columns};
use sqlx::Row;
use std::str::FromStr;

/// How many jobs are in each state.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    pub queued: u64,
    pub running: u64,
    pub succeeded: u64,
    pub failed: u64,
    pub canceled: u64,
}

impl Store {
    pub async fn job(&self, id: JobId) -> Result<Option<JobRecord>, StoreError> {
        Ok(sqlx::query_as(concat!("SELECT ", job_columns!(), " FROM jobs WHERE id = $1"))
            .bind(id.to_string())
            .fetch_optional(&self.reader)
            .await?)
    }

    /// The document as accepted, every default filled in (JSON).
    pub async fn input(&self, id: JobId) -> Result<Option<String>, StoreError> {
        let row = sqlx::query("SELECT input FROM jobs WHERE id = $1")
            .bind(id.to_string())
            .fetch_optional(&self.reader)
            .await?;
        Ok(row.map(|row| row.try_get("input")).transpose()?)
    }

    /// How many jobs are in each state.
    pub async fn counts(&self) -> Result<Counts, StoreError> {
        let rows = sqlx::query("SELECT state, COUNT(*) AS n FROM jobs GROUP BY state").fetch_all(&self.reader).await?;
        let mut counts = Counts::default();
        for row in rows {
            let n = row.try_get::<i64, _>("n")?.unsigned_abs();
            match State::from_str(row.try_get("state")?) {
                Ok(State::Queued) => counts.queued = n,
                Ok(State::Running) => counts.running = n,
                Ok(State::Succeeded) => counts.succeeded = n,
                Ok(State::Failed) => counts.failed = n,
                Ok(State::Canceled) => counts.canceled = n,
                Err(()) => {}
            }
        }
        Ok(counts)
    }

    /// Revision and state of every transition of a job, oldest first.
    pub async fn history(&self, id: JobId) -> Result<Vec<(i64, State)>, StoreError> {
        let rows = sqlx::query("SELECT revision, state FROM job_events WHERE job_id = $1 ORDER BY revision")
            .bind(id.to_string())
            .fetch_all(&self.reader)
            .await?;
        rows.iter()
            .map(|row| {
                let word: String = row.try_get("state")?;
                let state = State::from_str(&word)
                    .map_err(|()| StoreError::Corrupt { what: "event", detail: format!("state {word}") })?;
                Ok((row.try_get("revision")?, state))
            })
            .collect()
    }
}
