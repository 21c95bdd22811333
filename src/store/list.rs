//! Lists of jobs in pages, in several orders.

use super::connect::{Store, StoreError};
use super::lifecycle::{JobId, JobState};
use super::record::{JobRecord, job_columns};
use jiff::Timestamp;
use sqlx::{QueryBuilder, Row, Sqlite};

/// A filter of jobs; the empty filter permits all.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct JobFilter {
    /// Any of these states; all when empty.
    pub states: Vec<JobState>,
    pub kind: Option<String>,
    pub label: Option<String>,
    /// Part of the name, the label or the notes, in upper or lower case.
    pub search: Option<String>,
    /// Submitted at this time or later.
    pub from: Option<Timestamp>,
    /// Submitted before this time.
    pub to: Option<Timestamp>,
}

/// What jobs are sorted by; jobs with equal values by the time of their submission, in the same direction.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum JobSort {
    #[default]
    Submitted,
    Ended,
    Name,
    Label,
    MeshAcceleration,
    DynamicFactor,
    TransmissionError,
}

/// An order of jobs. Those without a value of what they are sorted by come last in either direction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct JobOrder {
    pub sort: JobSort,
    pub descending: bool,
}

/// A place in a list: after a job with this value of what the list is sorted by.
#[derive(Debug, Clone, PartialEq)]
pub struct ListPlace {
    pub id: JobId,
    pub value: SortValue,
}

/// A value of what a list is sorted by.
#[derive(Debug, Clone, PartialEq)]
pub enum SortValue {
    /// None, or the list is sorted by submission, which is the order of the ids.
    None,
    Integer(i64),
    Real(f64),
    Text(String),
}

/// A page of jobs.
#[derive(Debug, Clone, PartialEq)]
pub struct JobListPage {
    pub jobs: Vec<JobRecord>,
    /// The end of the page, if further jobs follow.
    pub next: Option<ListPlace>,
}

impl Default for JobOrder {
    /// Newest first.
    fn default() -> Self {
        Self { sort: JobSort::Submitted, descending: true }
    }
}

impl JobOrder {
    /// The expression of the value by which jobs are sorted; none for the ids alone.
    fn expression(self) -> Option<&'static str> {
        Some(match self.sort {
            JobSort::Submitted => return None,
            JobSort::Ended => "ended_at_us",
            JobSort::Name => "name COLLATE NOCASE",
            JobSort::Label => "label COLLATE NOCASE",
            JobSort::MeshAcceleration => "mesh_acceleration_rms_m_s2",
            JobSort::DynamicFactor => "dynamic_factor",
            JobSort::TransmissionError => "transmission_error_pp_um",
        })
    }

    fn place_after(self, job: &JobRecord) -> ListPlace {
        let text = |text: &Option<String>| text.clone().map_or(SortValue::None, SortValue::Text);
        let real = |number: Option<f64>| number.map_or(SortValue::None, SortValue::Real);
        let value = match self.sort {
            JobSort::Submitted => SortValue::None,
            JobSort::Ended => job.ended_at.map_or(SortValue::None, |time| SortValue::Integer(time.as_microsecond())),
            JobSort::Name => text(&job.name),
            JobSort::Label => text(&job.label),
            JobSort::MeshAcceleration => real(job.headline.mesh_acceleration_rms_m_s2),
            JobSort::DynamicFactor => real(job.headline.dynamic_factor),
            JobSort::TransmissionError => real(job.headline.transmission_error_pp_um),
        };
        ListPlace { id: job.id, value }
    }

    fn push_order(self, query: &mut QueryBuilder<Sqlite>) {
        let direction = if self.descending { " DESC" } else { " ASC" };
        query.push(" ORDER BY ");
        if let Some(expression) = self.expression() {
            query.push(expression).push(" IS NULL, ").push(expression).push(direction).push(", ");
        }
        query.push("id").push(direction);
    }

    /// The condition that a job comes after a place.
    fn push_after(self, query: &mut QueryBuilder<Sqlite>, place: &ListPlace) {
        let beyond = if self.descending { " < " } else { " > " };
        let id = place.id.to_string();
        let Some(expression) = self.expression() else {
            query.push(" AND id").push(beyond).push_bind(id);
            return;
        };
        if place.value == SortValue::None {
            query.push(" AND ").push(expression).push(" IS NULL AND id").push(beyond).push_bind(id);
            return;
        }
        query
            .push(" AND (")
            .push(expression)
            .push(" IS NULL OR (")
            .push(expression)
            .push(", id)")
            .push(beyond)
            .push("(");
        match &place.value {
            SortValue::None => query.push("NULL"),
            SortValue::Integer(value) => query.push_bind(*value),
            SortValue::Real(value) => query.push_bind(*value),
            SortValue::Text(value) => query.push_bind(value.clone()),
        };
        query.push(", ").push_bind(id).push("))");
    }
}

impl JobFilter {
    /// Whether the filter compares values that only the index `jobs_listing` has beside the rows.
    fn needs_listing(&self) -> bool {
        self.search.is_some() || self.from.is_some() || self.to.is_some()
    }

    /// The conditions on everything but the state.
    fn push(&self, query: &mut QueryBuilder<Sqlite>) {
        if let Some(kind) = &self.kind {
            query.push(" AND kind = ").push_bind(kind.clone());
        }
        if let Some(label) = &self.label {
            query.push(" AND label = ").push_bind(label.clone());
        }
        if let Some(from) = self.from {
            query.push(" AND submitted_at_us >= ").push_bind(from.as_microsecond());
        }
        if let Some(to) = self.to {
            query.push(" AND submitted_at_us < ").push_bind(to.as_microsecond());
        }
        if let Some(search) = &self.search {
            let pattern = glob_pattern(search);
            query.push(" AND (name GLOB ").push_bind(pattern.clone());
            query.push(" OR label GLOB ").push_bind(pattern.clone());
            query
                .push(" OR id IN (SELECT id FROM jobs WHERE notes IS NOT NULL AND notes GLOB ")
                .push_bind(pattern)
                .push("))");
        }
    }

    fn push_states(&self, query: &mut QueryBuilder<Sqlite>) {
        if self.states.is_empty() {
            return;
        }
        query.push(" AND state IN (");
        let mut states = query.separated(", ");
        for state in &self.states {
            states.push_bind(state.as_str());
        }
        query.push(")");
    }
}

/// The pattern of `GLOB` for texts that contain a part, in upper or lower case. (`LIKE` disregards the case of ASCII
/// letters only.)
fn glob_pattern(part: &str) -> String {
    let mut pattern = "*".to_owned();
    for letter in part.chars() {
        let upper = single(letter.to_uppercase()).unwrap_or(letter);
        // The lower case of the upper case too: σ and ς have one upper case.
        let lower = [letter, upper].map(|letter| single(letter.to_lowercase()).unwrap_or(letter));
        let mut variants = vec![letter];
        for variant in [upper, lower[0], lower[1]] {
            if !variants.contains(&variant) {
                variants.push(variant);
            }
        }
        match variants.len() {
            1 if !['*', '?', '['].contains(&letter) => pattern.push(letter),
            _ => {
                pattern.push('[');
                pattern.extend(variants);
                pattern.push(']');
            }
        }
    }
    pattern + "*"
}

/// The only item.
fn single(mut letters: impl Iterator<Item = char>) -> Option<char> {
    letters.next().filter(|_| letters.next().is_none())
}

impl Store {
    /// Up to `limit` jobs after a place, in an order (keyset pagination: later pages shift by nothing that is submitted
    /// meanwhile).
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn list(
        &self,
        filter: &JobFilter,
        order: JobOrder,
        after: Option<&ListPlace>,
        limit: u32,
    ) -> Result<JobListPage, StoreError> {
        let limit_and_one = i64::from(limit) + 1;
        let mut query: QueryBuilder<Sqlite> =
            QueryBuilder::new(concat!("SELECT ", job_columns!(), " FROM jobs WHERE id IN ("));
        if order.sort == JobSort::Submitted && !filter.needs_listing() {
            push_newest(&mut query, filter, order, after, limit_and_one);
        } else {
            // The index has every value that is compared, so that no row is read.
            query.push("SELECT id FROM jobs INDEXED BY jobs_listing WHERE 1 = 1");
            filter.push_states(&mut query);
            filter.push(&mut query);
            if let Some(after) = after {
                order.push_after(&mut query, after);
            }
            order.push_order(&mut query);
            query.push(" LIMIT ").push_bind(limit_and_one);
        }
        query.push(")");
        order.push_order(&mut query);
        let mut jobs: Vec<JobRecord> = query.build_query_as().fetch_all(&self.reader).await?;
        let more = jobs.len() > limit as usize;
        jobs.truncate(limit as usize);
        let next = jobs.last().filter(|_| more).map(|job| order.place_after(job));
        Ok(JobListPage { jobs, next })
    }

    /// Counts the jobs that a filter permits.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn count(&self, filter: &JobFilter) -> Result<u64, StoreError> {
        let mut query: QueryBuilder<Sqlite> = QueryBuilder::new("SELECT COUNT(*) AS n FROM jobs");
        query.push(if filter.needs_listing() { " INDEXED BY jobs_listing WHERE 1 = 1" } else { " WHERE 1 = 1" });
        filter.push_states(&mut query);
        filter.push(&mut query);
        let row = query.build().fetch_one(&self.reader).await?;
        Ok(row.try_get::<i64, _>("n")?.unsigned_abs())
    }
}

/// The ids of a page of jobs sorted by submission: one index scan for each state, merged, so that the time of a page
/// does not depend on the number of jobs.
fn push_newest(
    query: &mut QueryBuilder<Sqlite>,
    filter: &JobFilter,
    order: JobOrder,
    after: Option<&ListPlace>,
    limit: i64,
) {
    let states: Vec<_> = JobState::ALL.into_iter().filter(|state| filter.states.contains(state)).map(Some).collect();
    let scans = if states.is_empty() { vec![None] } else { states };
    for (index, state) in scans.into_iter().enumerate() {
        query.push(if index == 0 { "SELECT * FROM (" } else { " UNION ALL SELECT * FROM (" });
        query.push("SELECT id FROM jobs WHERE 1 = 1");
        if let Some(state) = state {
            query.push(" AND state = ").push_bind(state.as_str());
        }
        filter.push(query);
        if let Some(after) = after {
            order.push_after(query, after);
        }
        order.push_order(query);
        query.push(" LIMIT ").push_bind(limit).push(")");
    }
    order.push_order(query);
    query.push(" LIMIT ").push_bind(limit);
}
