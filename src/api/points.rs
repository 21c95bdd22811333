//! Stored rows of sweeps in responses, read and sent a page at a time, so that the memory used does not grow with their
//! number.

use super::columns;
use super::csv::{CsvField, CsvWriter, Decimal};
use super::problem::ApiError;
use super::text_body::PIECE_BYTES;
use crate::store::{JobId, PointRow, Store, StoreError};
use axum::body::{Body, Bytes};
use futures_util::stream::{self, BoxStream, StreamExt};
use herringbone_job::SweepShape;
use herringbone_job::result::{BranchDirection, Cell, SweepPoint};
use serde::Serialize;
use std::io;

/// Rows in the first page that is read, whose length is not known, and the most in any other.
const FIRST_PAGE_ROWS: u64 = 16;
const MAX_PAGE_ROWS: u64 = 1000;

/// Failure to read the rows of a sweep.
#[derive(Debug, thiserror::Error)]
pub(super) enum RowsError {
    #[error(transparent)]
    Store(#[from] StoreError),
    #[error("the sweep was deleted while its rows were read")]
    Deleted,
}

impl From<RowsError> for ApiError {
    fn from(error: RowsError) -> Self {
        match error {
            RowsError::Store(error) => error.into(),
            RowsError::Deleted => ApiError::not_found("There is no such job."),
        }
    }
}

/// Rows of a sweep: those of a job with positions in `from..to`, `limit` at most.
#[derive(Debug, Clone, Copy)]
pub(super) struct RowRange {
    pub from: u64,
    pub to: u64,
    pub limit: u64,
}

impl RowRange {
    /// Every row.
    pub(super) const ALL: Self = Self { from: 0, to: u64::MAX, limit: u64::MAX };
}

/// The number of a sweep's points that are solved, and where its rows go on.
#[derive(Debug, Serialize)]
pub(super) struct ListEnd {
    pub next_position: Option<u64>,
    pub n_solved: u64,
    pub n_points: u64,
}

/// Rows in pages of about [`PIECE_BYTES`].
pub(super) type Pages = BoxStream<'static, Result<Vec<PointRow>, RowsError>>;

/// Reads rows of a job a page at a time, the first one now. When the job is deleted meanwhile, the stream ends with an
/// error, and with it the connection of a response made from it.
///
/// # Errors
/// The database cannot be read.
pub(super) async fn pages(store: &Store, id: JobId, range: RowRange) -> Result<Pages, RowsError> {
    let store = store.clone();
    let rest = Some((range, FIRST_PAGE_ROWS));
    let mut pages = Box::pin(stream::try_unfold(rest, move |rest| {
        let store = store.clone();
        async move {
            let Some((range, page_rows)) = rest else { return Ok(None) };
            let limit = page_rows.min(range.limit);
            let rows = store.points(id, range.from, range.to, limit as u32).await?;
            let left = range.limit - rows.len() as u64;
            let last = rows.last().filter(|_| rows.len() as u64 == limit && left > 0);
            let rest =
                last.map(|row| (RowRange { from: row.position + 1, limit: left, ..range }, next_page_rows(&rows)));
            if rest.is_none() {
                check_exists(&store, id).await?;
            }
            Ok(Some((rows, rest)))
        }
    }));
    let first = pages.next().await.transpose()?;
    Ok(stream::iter(first.map(Ok)).chain(pages).boxed())
}

/// The number of rows of a page of about [`PIECE_BYTES`], if rows are as long as these.
fn next_page_rows(rows: &[PointRow]) -> u64 {
    let bytes: usize = rows.iter().map(|row| row.body.len()).sum();
    (PIECE_BYTES * rows.len() / bytes.max(1)).clamp(1, MAX_PAGE_ROWS as usize) as u64
}

/// Fails when a job is gone: then rows that were not read may be missing.
async fn check_exists(store: &Store, id: JobId) -> Result<(), RowsError> {
    store.job(id).await?.map(drop).ok_or(RowsError::Deleted)
}

/// What follows the rows of a range that was read up to `next`.
///
/// # Errors
/// The database cannot be read, or the job is gone.
pub(super) async fn list_end(
    store: &Store,
    id: JobId,
    (next, to): (u64, u64),
    n_points: u64,
) -> Result<ListEnd, RowsError> {
    let next_position = store.points(id, next, to, 1).await?.first().map(|row| row.position);
    let n_solved = store.point_count(id).await?;
    check_exists(store, id).await?;
    Ok(ListEnd { next_position, n_solved, n_points })
}

/// A response body with rows as JSON: `items`, and the members of [`ListEnd`].
///
/// # Errors
/// The database cannot be read.
pub(super) async fn json_body(store: Store, id: JobId, range: RowRange, n_points: u64) -> Result<Body, RowsError> {
    let state = (Some(pages(&store, id, range).await?), range.from, "", store);
    let pieces = stream::try_unfold(state, move |(pages, next, separator, store)| async move {
        let Some(mut pages) = pages else { return Ok(None) };
        let Some(rows) = pages.next().await.transpose()? else {
            let end = list_end(&store, id, (next, range.to), n_points).await?;
            let end = serde_json::to_string(&end).map_err(unreadable)?;
            let text = "],".to_owned() + end.trim_start_matches('{');
            return Ok::<_, RowsError>(Some((text, (None, next, separator, store))));
        };
        let (mut text, mut next, mut separator) = (String::new(), next, separator);
        for row in rows {
            text += &format!("{separator}{{\"position\":{},\"point\":{}}}", row.position, row.body);
            next = row.position + 1;
            separator = ",";
        }
        Ok(Some((text, (Some(pages), next, separator, store))))
    });
    let head = stream::iter([Ok("{\"items\":[".to_owned())]);
    Ok(Body::from_stream(head.chain(pieces)))
}

/// A response body with rows as CSV: a header with a column for each input that varies, then a record for each row.
///
/// # Errors
/// The database cannot be read.
pub(super) async fn csv_body(
    store: &Store,
    id: JobId,
    range: RowRange,
    shape: SweepShape,
    decimal: Decimal,
) -> Result<Body, RowsError> {
    let header = header(&shape, decimal).map_err(unreadable)?;
    let records = pages(store, id, range).await?.map(move |page| {
        let mut writer = CsvWriter::new(Vec::new(), decimal);
        for row in page? {
            let point: SweepPoint = serde_json::from_str(&row.body).map_err(unreadable)?;
            write_row(&mut writer, row.position, &point, &shape).map_err(unreadable)?;
        }
        writer.into_inner().map(Bytes::from).map_err(unreadable)
    });
    Ok(Body::from_stream(stream::iter([Ok(Bytes::from(header))]).chain(records)))
}

fn unreadable(error: impl std::fmt::Display) -> RowsError {
    StoreError::Corrupt { what: "point", detail: error.to_string() }.into()
}

fn header(shape: &SweepShape, decimal: Decimal) -> io::Result<Vec<u8>> {
    let names = columns::default_columns().into_iter().map(|column| column.name);
    let (axes, further) = (shape.pointers().iter().map(String::as_str), shape.further().iter().map(String::as_str));
    let columns = ["position", "branch"].into_iter().chain(axes).chain(names).chain(further);
    let mut writer = CsvWriter::with_mark(Vec::new(), decimal)?;
    writer.write_record(columns.map(CsvField::Text))?;
    writer.into_inner()
}

fn write_row(writer: &mut CsvWriter<Vec<u8>>, position: u64, point: &SweepPoint, shape: &SweepShape) -> io::Result<()> {
    let values = point.values.iter().map(|value| CsvField::Number(*value));
    let cells = columns::default_columns().into_iter().map(|column| (column.cell)(point));
    let cells: Vec<_> = cells.chain(shape.cells(point)).collect();
    let fields = cells.iter().map(|cell| match cell {
        Cell::Number(Some(number)) => CsvField::Number(*number),
        Cell::Word(Some(word)) => CsvField::Text(word),
        _ => CsvField::Empty,
    });
    let branch = CsvField::Text(point.branch.map_or("", BranchDirection::as_str));
    writer.write_record([CsvField::Integer(position), branch].into_iter().chain(values).chain(fields))
}
