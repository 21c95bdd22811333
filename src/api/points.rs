//! Stored rows of sweeps in responses, read and sent a page at a time, so that the memory used does not grow with their
//! number.

use super::columns;
use super::config::MAX_ROWS;
use super::csv::{CsvField, CsvWriter, Decimal};
use crate::store::{JobId, PointRow, Store, StoreError};
use axum::body::{Body, Bytes};
use futures_util::stream::{self, Stream, StreamExt};
use herringbone_job::result::{BranchDirection, Cell, SweepPoint};
use std::io;

/// Reads up to `limit` rows of a job with positions in `from..to`. Also returns the position of the next row, if there
/// is one.
///
/// # Errors
/// The database cannot be read.
pub(super) async fn read_page(
    store: &Store,
    id: JobId,
    from: u64,
    to: u64,
    limit: u32,
) -> Result<(Vec<PointRow>, Option<u64>), StoreError> {
    // One row more than requested shows whether another follows.
    let mut rows = store.points(id, from, to, limit + 1).await?;
    let next_position = rows.get(limit as usize).map(|row| row.position);
    rows.truncate(limit as usize);
    Ok((rows, next_position))
}

/// The rows of a job from position `from` on, in pages of [`MAX_ROWS`]; the last page has fewer rows, perhaps none. An
/// error ends the stream, and with it the connection of a response made from it.
pub(super) fn pages(store: Store, id: JobId, from: u64) -> impl Stream<Item = Result<Vec<PointRow>, StoreError>> {
    stream::try_unfold(Some(from), move |from| {
        let store = store.clone();
        async move {
            let Some(from) = from else { return Ok(None) };
            let rows = store.points(id, from, u64::MAX, MAX_ROWS).await?;
            let next = rows.last().filter(|_| rows.len() as u64 == u64::from(MAX_ROWS)).map(|row| row.position + 1);
            Ok(Some((rows, next)))
        }
    })
}

/// A response body with rows as CSV, from position `from` on, `limit` at most: a header with a column for each of
/// `axes`, then a record for each row.
pub(super) fn csv_body(store: Store, id: JobId, axes: &[String], (from, limit): (u64, u64), decimal: Decimal) -> Body {
    let header = header(axes, decimal).map(Bytes::from).map_err(to_store_error);
    let end = from.saturating_add(limit);
    let records = pages(store, id, from).map(move |page| {
        let mut writer = CsvWriter::new(Vec::new(), decimal);
        for row in page?.into_iter().filter(|row| row.position < end) {
            let point: SweepPoint = serde_json::from_str(&row.body).map_err(to_store_error)?;
            write_row(&mut writer, row.position, &point).map_err(to_store_error)?;
        }
        writer.into_inner().map(Bytes::from).map_err(to_store_error)
    });
    Body::from_stream(stream::iter([header]).chain(records))
}

fn to_store_error(error: impl std::fmt::Display) -> StoreError {
    StoreError::Corrupt { what: "point", detail: error.to_string() }
}

fn header(axes: &[String], decimal: Decimal) -> io::Result<Vec<u8>> {
    let names = columns::default_columns().into_iter().map(|column| column.name);
    let columns = ["position", "branch"].into_iter().chain(axes.iter().map(String::as_str)).chain(names);
    let mut writer = CsvWriter::with_mark(Vec::new(), decimal)?;
    writer.write_record(columns.map(CsvField::Text))?;
    writer.into_inner()
}

fn write_row(writer: &mut CsvWriter<Vec<u8>>, position: u64, point: &SweepPoint) -> io::Result<()> {
    let values = point.values.iter().map(|value| CsvField::Number(*value));
    let cells: Vec<_> = columns::default_columns().into_iter().map(|column| (column.cell)(point)).collect();
    let fields = cells.iter().map(|cell| match cell {
        Cell::Number(Some(number)) => CsvField::Number(*number),
        Cell::Word(Some(word)) => CsvField::Text(word),
        _ => CsvField::Empty,
    });
    let branch = CsvField::Text(point.branch.map_or("", BranchDirection::as_str));
    writer.write_record([CsvField::Integer(position), branch].into_iter().chain(values).chain(fields))
}
