//! Lists of jobs in pages, newest first.

use super::connect::{Store, StoreError};
use super::lifecycle::{JobId, JobState};
use super::record::{JobRecord, job_columns};
use sqlx::{QueryBuilder, Sqlite};

/// A filter of jobs; the empty filter permits all.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct JobFilter {
    /// Any of these states; all when empty.
    pub states: Vec<JobState>,
    pub kind: Option<String>,
    pub label: Option<String>,
}

/// A page of jobs, newest first.
#[derive(Debug, Clone, PartialEq)]
pub struct JobListPage {
    pub jobs: Vec<JobRecord>,
    /// Whether older jobs follow.
    pub more: bool,
}

impl Store {
    /// Up to `limit` jobs older than `before` (keyset pagination: ids sort by time), newest first.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn list(&self, filter: &JobFilter, before: Option<JobId>, limit: u32) -> Result<JobListPage, StoreError> {
        let limit_and_one = i64::from(limit) + 1;
        // One index scan for each state, merged, so that the time of a page does not depend on the number of jobs.
        let states: Vec<_> =
            JobState::ALL.into_iter().filter(|state| filter.states.contains(state)).map(Some).collect();
        let scans = if states.is_empty() { vec![None] } else { states };
        let mut query: QueryBuilder<Sqlite> = QueryBuilder::new("");
        for (index, state) in scans.into_iter().enumerate() {
            query.push(if index == 0 { "SELECT * FROM (" } else { " UNION ALL SELECT * FROM (" });
            query.push(concat!("SELECT ", job_columns!(), " FROM jobs WHERE 1 = 1"));
            if let Some(state) = state {
                query.push(" AND state = ").push_bind(state.as_str());
            }
            if let Some(kind) = &filter.kind {
                query.push(" AND kind = ").push_bind(kind.clone());
            }
            if let Some(label) = &filter.label {
                query.push(" AND label = ").push_bind(label.clone());
            }
            if let Some(before) = before {
                query.push(" AND id < ").push_bind(before.to_string());
            }
            query.push(" ORDER BY id DESC LIMIT ").push_bind(limit_and_one).push(")");
        }
        query.push(" ORDER BY id DESC LIMIT ").push_bind(limit_and_one);
        let mut jobs: Vec<JobRecord> = query.build_query_as().fetch_all(&self.reader).await?;
        let more = jobs.len() > limit as usize;
        jobs.truncate(limit as usize);
        Ok(JobListPage { jobs, more })
    }
}
