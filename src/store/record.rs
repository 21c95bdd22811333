//! Rows of the table `jobs`.

use super::connect::StoreError;
use super::failure::Failure;
use super::headline::Headline;
use super::lifecycle::{JobId, JobState};
use super::webhooks::record_end;
use jiff::Timestamp;
use sqlx::sqlite::SqliteRow;
use sqlx::{FromRow, Row, Sqlite, Transaction};
use std::str::FromStr;

/// A job without its document.
#[derive(Debug, Clone, PartialEq)]
pub struct JobRecord {
    pub id: JobId,
    pub kind: String,
    pub name: Option<String>,
    pub label: Option<String>,
    pub notes: Option<String>,
    pub state: JobState,
    /// Number that increases with every visible change.
    pub revision: i64,
    /// Number of starts.
    pub attempt: i64,
    /// Completed fraction of the whole job, 0 to 1.
    pub progress: f64,
    /// Current or last stage.
    pub stage: Option<String>,
    pub input_hash: String,
    pub solver_version: String,
    pub submitted_at: Timestamp,
    pub started_at: Option<Timestamp>,
    pub ended_at: Option<Timestamp>,
    pub cancel_requested_at: Option<Timestamp>,
    pub error: Option<Failure>,
    /// Job whose result was reused.
    pub reused_from: Option<JobId>,
    /// Id of the request that submitted it.
    pub request_id: Option<String>,
    /// Trace of that request (W3C Trace Context).
    pub traceparent: Option<String>,
    /// Numbers of the result, if it has one.
    pub headline: Headline,
}

/// The columns of a [`JobRecord`], as a literal for `concat!`.
macro_rules! job_columns {
    () => {
        "id, kind, name, label, notes, state, revision, attempt, progress, stage, input_hash, solver_version, \
         submitted_at_us, started_at_us, ended_at_us, cancel_requested_at_us, error, reused_from, request_id, \
         traceparent, mesh_acceleration_rms_m_s2, dynamic_factor, transmission_error_pp_um"
    };
}
pub(super) use job_columns;

impl<'r> FromRow<'r, SqliteRow> for JobRecord {
    fn from_row(row: &'r SqliteRow) -> Result<Self, sqlx::Error> {
        let state: String = row.try_get("state")?;
        let error: Option<String> = row.try_get("error")?;
        Ok(Self {
            id: parse_column("id", row.try_get("id")?)?,
            kind: row.try_get("kind")?,
            name: row.try_get("name")?,
            label: row.try_get("label")?,
            notes: row.try_get("notes")?,
            state: JobState::from_str(&state).map_err(|()| column_error("state", "unknown state"))?,
            revision: row.try_get("revision")?,
            attempt: row.try_get("attempt")?,
            progress: row.try_get("progress")?,
            stage: row.try_get("stage")?,
            input_hash: row.try_get("input_hash")?,
            solver_version: row.try_get("solver_version")?,
            submitted_at: timestamp("submitted_at_us", row.try_get("submitted_at_us")?)?,
            started_at: optional_timestamp(row, "started_at_us")?,
            ended_at: optional_timestamp(row, "ended_at_us")?,
            cancel_requested_at: optional_timestamp(row, "cancel_requested_at_us")?,
            error: error
                .map(|text| serde_json::from_str(&text).map_err(|error| column_error("error", error)))
                .transpose()?,
            reused_from: row
                .try_get::<Option<String>, _>("reused_from")?
                .map(|text| parse_column("reused_from", text))
                .transpose()?,
            request_id: row.try_get("request_id")?,
            traceparent: row.try_get("traceparent")?,
            headline: Headline {
                mesh_acceleration_rms_m_s2: row.try_get("mesh_acceleration_rms_m_s2")?,
                dynamic_factor: row.try_get("dynamic_factor")?,
                transmission_error_pp_um: row.try_get("transmission_error_pp_um")?,
            },
        })
    }
}

pub(super) fn parse_column<T: FromStr>(column: &'static str, text: String) -> Result<T, sqlx::Error>
where
    T::Err: std::fmt::Display,
{
    text.parse().map_err(|error| column_error(column, error))
}

pub(super) fn optional_timestamp(row: &SqliteRow, column: &'static str) -> Result<Option<Timestamp>, sqlx::Error> {
    row.try_get::<Option<i64>, _>(column)?.map(|value| timestamp(column, value)).transpose()
}

pub(super) fn timestamp(column: &'static str, microseconds: i64) -> Result<Timestamp, sqlx::Error> {
    Timestamp::from_microsecond(microseconds).map_err(|error| column_error(column, error))
}

pub(super) fn column_error(column: &'static str, detail: impl std::fmt::Display) -> sqlx::Error {
    sqlx::Error::ColumnDecode { index: column.to_owned(), source: detail.to_string().into() }
}

/// Stores a transition in the history of the job, and of an end what webhooks are to tell. Its time is that of the
/// clock, which may have been set back since the last transition; the times of the job itself never decrease (`MAX` in
/// the statements).
pub(super) async fn record_event(
    transaction: &mut Transaction<'static, Sqlite>,
    job: &JobRecord,
    now: Timestamp,
) -> Result<(), StoreError> {
    sqlx::query("INSERT INTO job_events (job_id, revision, at_us, state, attempt) VALUES ($1, $2, $3, $4, $5)")
        .bind(job.id.to_string())
        .bind(job.revision)
        .bind(now.as_microsecond())
        .bind(job.state.as_str())
        .bind(job.attempt)
        .execute(&mut **transaction)
        .await?;
    record_end(transaction, job, now).await
}
