//! Rows of sweeps on their way out: a page of the table at a time, so that a large sweep takes no memory.

use super::columns::{Cell, NUMBERS, WORDS};
use super::config::MAX_ROWS;
use crate::job::result::SweepPoint;
use crate::store::{JobId, PointRow, PointsOfResult, Store, StoreError};
use axum::body::{Body, Bytes};
use futures_util::stream::{self, Stream, StreamExt};
use std::fmt::Write;

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
pub fn csv(store: Store, id: JobId, axes: &[String], from: u64, limit: u64) -> Body {
    let head = Ok(Bytes::from(header(axes)));
    let end = from.saturating_add(limit);
    let lines = pages(store, id, from).map(move |page| {
        let mut text = String::new();
        for row in page?.into_iter().filter(|row| row.position < end) {
            let point: SweepPoint = serde_json::from_str(&row.body)
                .map_err(|error| StoreError::Corrupt { what: "point", detail: error.to_string() })?;
            push_line(&mut text, row.position, &point);
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

fn header(axes: &[String]) -> String {
    let axes = axes.iter().map(|pointer| quoted(pointer));
    let names = NUMBERS.iter().chain(&WORDS).map(|column| column.0.to_owned());
    let columns: Vec<String> = ["position", "branch"].map(str::to_owned).into_iter().chain(axes).chain(names).collect();
    columns.join(",") + "\n"
}

/// Numbers are written so that they read back exactly; what is not there is empty.
fn push_line(text: &mut String, position: u64, point: &SweepPoint) {
    // Writing to a string cannot fail.
    let _ = write!(text, "{position},{}", point.branch.as_deref().unwrap_or_default());
    let values = point.values.iter().map(|value| Cell::Number(Some(*value)));
    let cells = NUMBERS.iter().chain(&WORDS).map(|column| (column.1)(point));
    for cell in values.chain(cells) {
        let _ = match cell {
            Cell::Number(Some(number)) => write!(text, ",{number:?}"),
            Cell::Word(Some(word)) => write!(text, ",{}", quoted(word)),
            _ => write!(text, ","),
        };
    }
    text.push('\n');
}

/// A field as RFC 4180 writes it.
fn quoted(field: &str) -> String {
    if field.contains(['"', ',', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
