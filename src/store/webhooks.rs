//! The outbox of webhooks: a row for each address and end of a job, written in the transaction of the job's event.

use super::connect::{Store, StoreError};
use super::lifecycle::JobState;
use super::record::{JobRecord, parse_column};
use super::{JobId, record};
use jiff::Timestamp;
use sqlx::sqlite::SqliteRow;
use sqlx::{FromRow, Row, Sqlite, Transaction};
use uuid::Uuid;

/// Rows that a list of deliveries has at most.
const MAX_LISTED: u32 = 100;

/// The end of a job that an address is to be told of.
#[derive(Debug, Clone, PartialEq)]
pub struct Delivery {
    /// The same in every try.
    pub id: String,
    pub url: String,
    pub job: JobId,
    pub kind: String,
    pub name: Option<String>,
    pub label: Option<String>,
    pub job_state: JobState,
    /// Time of the event.
    pub at: Timestamp,
    pub state: DeliveryState,
    /// Number of tries made.
    pub tries: u32,
    /// Time of the next try, while it waits.
    pub due_at: Timestamp,
    pub last_try: Option<Timestamp>,
    /// HTTP status of the last answer.
    pub last_status: Option<u16>,
    /// Why the last try was no success.
    pub last_error: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeliveryState {
    Waiting,
    Delivered,
    Failed,
}

impl DeliveryState {
    const ALL: [DeliveryState; 3] = [DeliveryState::Waiting, DeliveryState::Delivered, DeliveryState::Failed];

    pub fn as_str(self) -> &'static str {
        match self {
            DeliveryState::Waiting => "waiting",
            DeliveryState::Delivered => "delivered",
            DeliveryState::Failed => "failed",
        }
    }
}

/// The outcome of a try.
#[derive(Debug, Clone, PartialEq)]
pub struct DeliveryTry {
    pub at: Timestamp,
    pub status: Option<u16>,
    /// None after a success.
    pub error: Option<String>,
    /// Time of the next try; none after the last one.
    pub again_at: Option<Timestamp>,
    /// The address is not to be told of anything any more.
    pub disables: bool,
}

impl<'r> FromRow<'r, SqliteRow> for Delivery {
    fn from_row(row: &'r SqliteRow) -> Result<Self, sqlx::Error> {
        let state: String = row.try_get("state")?;
        let known = DeliveryState::ALL.into_iter().find(|known| known.as_str() == state);
        let job_state: String = row.try_get("job_state")?;
        let time = |name: &'static str| row.try_get(name).and_then(|value| record::timestamp(name, value));
        Ok(Self {
            id: row.try_get("id")?,
            url: row.try_get("url")?,
            job: parse_column("job_id", row.try_get("job_id")?)?,
            kind: row.try_get("kind")?,
            name: row.try_get("name")?,
            label: row.try_get("label")?,
            job_state: job_state.parse().map_err(|()| record::column_error("job_state", "unknown state"))?,
            at: time("at_us")?,
            state: known.ok_or_else(|| record::column_error("state", "unknown state"))?,
            tries: row.try_get("tries")?,
            due_at: time("due_at_us")?,
            last_try: record::optional_timestamp(row, "last_try_us")?,
            last_status: row.try_get("last_status")?,
            last_error: row.try_get("last_error")?,
        })
    }
}

/// Writes what is to be told of the end of a job, for each active address.
pub(super) async fn record_end(
    transaction: &mut Transaction<'static, Sqlite>,
    job: &JobRecord,
    now: Timestamp,
) -> Result<(), StoreError> {
    if !job.state.is_ended() {
        return Ok(());
    }
    let urls: Vec<(String,)> = sqlx::query_as("SELECT url FROM webhooks WHERE active = 1 AND disabled_at_us IS NULL")
        .fetch_all(&mut **transaction)
        .await?;
    for (url,) in urls {
        sqlx::query(
            "INSERT INTO webhook_deliveries (id, url, job_id, kind, name, label, job_state, at_us, state, due_at_us) \
             VALUES ($1, $2, $3, $4, $5, $6, $7, $8, 'waiting', $8)",
        )
        .bind(format!("msg_{}", Uuid::now_v7().simple()))
        .bind(url)
        .bind(job.id.to_string())
        .bind(&job.kind)
        .bind(&job.name)
        .bind(&job.label)
        .bind(job.state.as_str())
        .bind(now.as_microsecond())
        .execute(&mut **transaction)
        .await?;
    }
    Ok(())
}

impl Store {
    /// Sets the addresses that are told of the ends of jobs. What waits for another address is given up; an address
    /// that was disabled is told again.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn set_webhooks(&self, urls: &[String]) -> Result<(), StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        sqlx::query("UPDATE webhooks SET active = 0").execute(&mut *transaction).await?;
        for url in urls {
            sqlx::query(
                "INSERT INTO webhooks (url, active) VALUES ($1, 1) \
                 ON CONFLICT (url) DO UPDATE SET active = 1, disabled_at_us = NULL",
            )
            .bind(url)
            .execute(&mut *transaction)
            .await?;
        }
        sqlx::query(
            "UPDATE webhook_deliveries SET state = 'failed', last_error = 'the address is not configured any more' \
             WHERE state = 'waiting' AND url IN (SELECT url FROM webhooks WHERE active = 0)",
        )
        .execute(&mut *transaction)
        .await?;
        transaction.commit().await?;
        Ok(())
    }

    /// Reads what is due to be delivered, the oldest first.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn due_deliveries(&self, now: Timestamp, most: u32) -> Result<Vec<Delivery>, StoreError> {
        Ok(sqlx::query_as(
            "SELECT * FROM webhook_deliveries WHERE state = 'waiting' AND due_at_us <= $1 ORDER BY due_at_us, id LIMIT $2",
        )
        .bind(now.as_microsecond())
        .bind(most)
        .fetch_all(&self.reader)
        .await?)
    }

    /// Reads the newest deliveries: a hundred at most.
    ///
    /// # Errors
    /// The database cannot be read.
    pub async fn deliveries(&self) -> Result<Vec<Delivery>, StoreError> {
        Ok(sqlx::query_as("SELECT * FROM webhook_deliveries ORDER BY at_us DESC, id DESC LIMIT $1")
            .bind(MAX_LISTED)
            .fetch_all(&self.reader)
            .await?)
    }

    /// Stores the outcome of a try.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn record_try(&self, delivery: &Delivery, outcome: &DeliveryTry) -> Result<(), StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        let state = match (&outcome.error, outcome.again_at) {
            (None, _) => DeliveryState::Delivered,
            (Some(_), Some(_)) => DeliveryState::Waiting,
            (Some(_), None) => DeliveryState::Failed,
        };
        sqlx::query(
            "UPDATE webhook_deliveries SET state = $2, tries = tries + 1, due_at_us = $3, last_try_us = $4, \
             last_status = $5, last_error = $6 WHERE id = $1 AND state = 'waiting'",
        )
        .bind(&delivery.id)
        .bind(state.as_str())
        .bind(outcome.again_at.unwrap_or(delivery.due_at).as_microsecond())
        .bind(outcome.at.as_microsecond())
        .bind(outcome.status)
        .bind(&outcome.error)
        .execute(&mut *transaction)
        .await?;
        if outcome.disables {
            sqlx::query("UPDATE webhooks SET disabled_at_us = $2 WHERE url = $1")
                .bind(&delivery.url)
                .bind(outcome.at.as_microsecond())
                .execute(&mut *transaction)
                .await?;
            sqlx::query(
                "UPDATE webhook_deliveries SET state = 'failed', last_error = 'the address is gone' \
                 WHERE url = $1 AND state = 'waiting'",
            )
            .bind(&delivery.url)
            .execute(&mut *transaction)
            .await?;
        }
        transaction.commit().await?;
        Ok(())
    }

    /// Deletes deliveries of events before a time that do not wait.
    ///
    /// # Errors
    /// The database cannot be written.
    pub async fn forget_deliveries(&self, before: Timestamp) -> Result<(), StoreError> {
        let mut transaction = self.begin_with_reserve().await?;
        sqlx::query("DELETE FROM webhook_deliveries WHERE state <> 'waiting' AND at_us < $1")
            .bind(before.as_microsecond())
            .execute(&mut *transaction)
            .await?;
        transaction.commit().await?;
        Ok(())
    }
}
