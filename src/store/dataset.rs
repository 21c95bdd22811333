//! Datasets: what a calculation recorded, series and rows of a sweep. A reused result has the dataset of its source,
//! which stays until the last job with it is deleted.

use super::connect::StoreError;
use super::lifecycle::JobId;
use super::record::parse_column;
use sqlx::{Row, Sqlite, Transaction};

/// Whether this attempt of the job is running, and is not to be canceled.
pub(super) async fn is_current(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
    attempt: i64,
) -> Result<bool, StoreError> {
    let row = sqlx::query(
        "SELECT 1 FROM jobs WHERE id = $1 AND attempt = $2 AND state = 'running' AND cancel_requested_at_us IS NULL",
    )
    .bind(id.to_string())
    .bind(attempt)
    .fetch_optional(&mut **transaction)
    .await?;
    Ok(row.is_some())
}

/// Creates the dataset of a running job, unless it exists.
pub(super) async fn ensure_dataset(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
) -> Result<(), StoreError> {
    sqlx::query("INSERT INTO datasets (id) VALUES ($1) ON CONFLICT (id) DO NOTHING")
        .bind(id.to_string())
        .execute(&mut **transaction)
        .await?;
    Ok(())
}

/// The dataset of the result of a job; `None` when it has no result.
pub(super) async fn dataset_of(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
) -> Result<Option<JobId>, StoreError> {
    let row = sqlx::query("SELECT dataset_id FROM results WHERE job_id = $1")
        .bind(id.to_string())
        .fetch_optional(&mut **transaction)
        .await?;
    Ok(row.map(|row| parse_column("dataset_id", row.try_get("dataset_id")?)).transpose()?)
}

/// Deletes a dataset with its content unless it is that of a result. Its own job must have a result or be deleted.
pub(super) async fn drop_unused_dataset(
    transaction: &mut Transaction<'static, Sqlite>,
    dataset: JobId,
) -> Result<(), StoreError> {
    sqlx::query("DELETE FROM datasets WHERE id = $1 AND NOT EXISTS (SELECT 1 FROM results WHERE dataset_id = $1)")
        .bind(dataset.to_string())
        .execute(&mut **transaction)
        .await?;
    Ok(())
}

/// Deletes a job that has ended, with all that no other job shares. False when it has not ended or does not exist.
pub(super) async fn delete_ended(
    transaction: &mut Transaction<'static, Sqlite>,
    id: JobId,
) -> Result<bool, StoreError> {
    let dataset = dataset_of(transaction, id).await?;
    let deleted = sqlx::query("DELETE FROM jobs WHERE id = $1 AND state IN ('succeeded', 'failed', 'canceled')")
        .bind(id.to_string())
        .execute(&mut **transaction)
        .await?;
    if deleted.rows_affected() == 0 {
        return Ok(false);
    }
    // A job that did not succeed has a dataset of its own.
    drop_unused_dataset(transaction, dataset.unwrap_or(id)).await?;
    Ok(true)
}
