//! Stands in for the writers of Parquet files in a program without them.

use super::missing;
use crate::api::problem::ApiError;
use crate::api::series_file::SeriesSource;
use crate::api::table::Table;
use crate::store::JobRecord;
use axum::body::Body;
use tokio::sync::OwnedSemaphorePermit;

/// # Errors
/// 406, always: content negotiation does not come here.
pub(in crate::api) fn table_bytes(_: &Table, _: &JobRecord, _: &str) -> Result<Vec<u8>, ApiError> {
    Err(missing(&[]))
}

/// # Errors
/// As [`table_bytes`].
pub(in crate::api) async fn series_body(
    _: SeriesSource,
    _: &JobRecord,
    _: Option<OwnedSemaphorePermit>,
) -> Result<Body, ApiError> {
    Err(missing(&[]))
}
