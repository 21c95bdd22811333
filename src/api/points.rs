//! Rows of sweeps on their way out: a page of the table at a time, so that a large sweep takes no memory.

use super::columns;
use super::config::MAX_ROWS;
use super::csv::{Decimal, Field};
use crate::store::{JobId, PointRow, PointsOfResult, Store, StoreError};
use axum::body::{Body, Bytes};
use futures_util::stream::{self, Stream, StreamExt};
use herringbone_job::result::{BranchDirection, Cell, SweepPoint};

/// Up to `limit` rows of a job from position `from` on and before `to`, and the position of the next one, if there is one.
pub async fn page(
    store: &Store,
    id: JobId,
    from: u64,
    to: u64,
    limit: u32,
) -> Result<(Vec<PointRow>, Option<u64>), StoreError> {
    // One more tells whether something follows.
    let mut rows = store.points(id, from, to, limit + 1).await?;
    let next_position = rows.get(limit as usize).map(|row| row.position);
    rows.truncate(limit as usize);
    Ok((rows, next_position))
}

/// The body of a result with its rows put in. When some are missing (the job is deleted meanwhile) the answer breaks off.
pub fn within(store: Store, id: JobId, body: String, place: &PointsOfResult) -> Body {
    let expected = place.n;
    let Some((head, tail)) = body.split_at_checked(place.at) else { return Body::from(body) };
    let (head, tail) = (Bytes::copy_from_slice(head.as_bytes()), Bytes::copy_from_slice(tail.as_bytes()));
    let mut sent = 0;
    let rows = pages(store, id, 0).map(move |page| {
        let mut text = String::new();
        let rows = page?;
        for row in &rows {
            sent += 1;
            if row.position > 0 {
                text.push(',');
            }
            text.push_str(&row.body);
        }
        if rows.len() < MAX_ROWS as usize && sent != expected {
            return Err(StoreError::Corrupt { what: "points", detail: format!("{sent} of {expected} rows") });
        }
        Ok(Bytes::from(text))
    });
    let before = stream::iter([Ok(head)]);
    let after = stream::iter([Ok(tail)]);
    Body::from_stream(before.chain(rows).chain(after))
}

/// All rows as CSV, from position `from` on, `limit` at most: a header with a column for each of `axes`, then a line for each point.
pub fn csv(store: Store, id: JobId, axes: &[String], (from, limit): (u64, u64), decimal: Decimal) -> Body {
    let head = Ok(Bytes::from(header(axes, decimal)));
    let end = from.saturating_add(limit);
    let lines = pages(store, id, from).map(move |page| {
        let mut text = String::new();
        for row in page?.into_iter().filter(|row| row.position < end) {
            let point: SweepPoint = serde_json::from_str(&row.body)
                .map_err(|error| StoreError::Corrupt { what: "point", detail: error.to_string() })?;
            push_line(&mut text, row.position, &point, decimal);
        }
        Ok::<_, StoreError>(Bytes::from(text))
    });
    Body::from_stream(stream::iter([head]).chain(lines))
}

/// The rows of a job, page after page; the last page has fewer than the others, perhaps none. An error ends the connection: the
/// answer is then not complete.
fn pages(store: Store, id: JobId, from: u64) -> impl Stream<Item = Result<Vec<PointRow>, StoreError>> {
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

fn header(axes: &[String], decimal: Decimal) -> String {
    let names = columns::usual().into_iter().map(|column| column.name);
    let columns = ["position", "branch"].into_iter().chain(axes.iter().map(String::as_str)).chain(names);
    let mut text = decimal.start().to_owned();
    decimal.push_line(&mut text, columns.map(Field::Text));
    text
}

fn push_line(text: &mut String, position: u64, point: &SweepPoint, decimal: Decimal) {
    let cells: Vec<_> = columns::usual().into_iter().map(|column| (column.cell)(point)).collect();
    let fields = cells.iter().map(|cell| match cell {
        Cell::Number(Some(number)) => Field::Number(*number),
        Cell::Word(Some(word)) => Field::Text(word),
        _ => Field::Nothing,
    });
    let values = point.values.iter().map(|value| Field::Number(*value));
    let branch = Field::Text(point.branch.map_or("", BranchDirection::as_str));
    decimal.push_line(text, [Field::Whole(position), branch].into_iter().chain(values).chain(fields));
}
