//! The result of a job with rows as a response: the stored result with the stored rows as `sweep.points`
//! (`optimise.points`, `tolerance.points`).
//!
//! The rows are stored apart from the result and sent as they were written. Serde walks through the members of the
//! result and so finds the place of the rows; every other member is copied unparsed ([`RawValue`]).

use super::points::{self, RowRange, RowsError};
use super::text_body::TextBody;
use crate::store::{JobId, Store, StoreError};
use axum::body::{Body, Bytes};
use futures_util::stream::{self, StreamExt};
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde::ser::{Error as _, Serialize, SerializeMap, SerializeSeq, Serializer};
use serde_json::value::RawValue;
use std::cell::RefCell;
use std::fmt;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Streams a stored `result` with the `count` rows of the job in `sweep.points`. When rows are missing (the job is
/// deleted meanwhile), the body ends with an error, and the response is incomplete.
///
/// # Errors
/// The stored result is not the JSON of a sweep's result, or the database cannot be read.
pub(super) async fn result_body(store: &Store, id: JobId, result: &str, count: u64) -> Result<Body, RowsError> {
    let (head, tail) =
        split_at_rows(result).map_err(|error| StoreError::Corrupt { what: "result", detail: error.to_string() })?;
    let sent = Arc::new(AtomicU64::new(0));
    let sent_at_end = Arc::clone(&sent);
    let rows = points::pages(store, id, RowRange::ALL).await?.map(move |page| {
        let mut text = String::new();
        for row in page? {
            if sent.fetch_add(1, Ordering::Relaxed) > 0 {
                text.push(',');
            }
            text.push_str(&row.body);
        }
        Ok(Bytes::from(text))
    });
    let all_sent = stream::once(async move {
        match sent_at_end.load(Ordering::Relaxed) {
            sent if sent == count => Ok(Bytes::new()),
            sent => {
                Err(RowsError::from(StoreError::Corrupt { what: "points", detail: format!("{sent} of {count} rows") }))
            }
        }
    });
    let text = |text| stream::iter(TextBody::new(text).map(Ok));
    Ok(Body::from_stream(text(head).chain(rows).chain(all_sent).chain(text(tail))))
}

/// The JSON text before and after the elements of `sweep.points`.
fn split_at_rows(result: &str) -> serde_json::Result<(Vec<u8>, Vec<u8>)> {
    let parts = Parts::default();
    let result = serde_json::from_str(result)?;
    ResultWithRows { result, parts: &parts }.serialize(&mut serde_json::Serializer::new(&parts))?;
    match parts.0.into_inner() {
        (head, Some(tail)) => Ok((head, tail)),
        (_, None) => Err(serde_json::Error::custom("there is no list of rows")),
    }
}

/// A writer that collects its output in two parts; the second begins with [`Parts::split`].
#[derive(Default)]
struct Parts(RefCell<(Vec<u8>, Option<Vec<u8>>)>);

impl Parts {
    fn split(&self) {
        self.0.borrow_mut().1 = Some(Vec::new());
    }
}

impl Write for &Parts {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let (head, tail) = &mut *self.0.borrow_mut();
        tail.as_mut().unwrap_or(head).extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// A result whose `sweep.points` is split.
struct ResultWithRows<'a> {
    result: RawObject<'a>,
    parts: &'a Parts,
}

/// The member `sweep` of a result, whose `points` is split.
struct SweepWithRows<'a> {
    sweep: RawObject<'a>,
    parts: &'a Parts,
}

/// The list of rows: empty here, split between its brackets.
struct Rows<'a>(&'a Parts);

impl Serialize for ResultWithRows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (name, value) in &self.result.0 {
            match name.as_str() {
                "sweep" | "optimise" | "tolerance" => {
                    let sweep = serde_json::from_str(value.get()).map_err(S::Error::custom)?;
                    map.serialize_entry(name, &SweepWithRows { sweep, parts: self.parts })?;
                }
                _ => map.serialize_entry(name, value)?,
            }
        }
        map.end()
    }
}

impl Serialize for SweepWithRows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for (name, value) in &self.sweep.0 {
            match name.as_str() {
                "points" => map.serialize_entry(name, &Rows(self.parts))?,
                _ => map.serialize_entry(name, value)?,
            }
        }
        map.end()
    }
}

impl Serialize for Rows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // Without a length the opening bracket is written now and the closing one at the end.
        let list = serializer.serialize_seq(None)?;
        self.0.split();
        list.end()
    }
}

/// The members of a JSON object in their order, with the text of each value.
struct RawObject<'a>(Vec<(String, &'a RawValue)>);

impl<'de: 'a, 'a> Deserialize<'de> for RawObject<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(RawObjectVisitor)
    }
}

struct RawObjectVisitor;

impl<'de> Visitor<'de> for RawObjectVisitor {
    type Value = RawObject<'de>;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("an object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut members = Vec::new();
        while let Some(member) = map.next_entry()? {
            members.push(member);
        }
        Ok(RawObject(members))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_job::result::{JobResult, SweepPoint, SweepResult};

    #[test]
    fn the_result_with_rows_put_in_is_the_result_as_serde_writes_it() {
        let points = vec![SweepPoint { values: vec![1.5], ..SweepPoint::default() }; 3];
        let mut result = JobResult {
            sweep: Some(SweepResult { points: Vec::new(), ..SweepResult::default() }),
            ..JobResult::default()
        };
        // A text that looks like the place of the rows.
        result.numerics.solver_version = "\"points\":[]".to_owned();
        let (head, tail) = split_at_rows(&serde_json::to_string(&result).unwrap()).unwrap();
        let rows: Vec<_> = points.iter().map(|point| serde_json::to_string(point).unwrap()).collect();
        if let Some(sweep) = &mut result.sweep {
            sweep.points = points;
        }
        let whole = [head, rows.join(",").into_bytes(), tail].concat();
        assert_eq!(String::from_utf8(whole).unwrap(), serde_json::to_string(&result).unwrap());
    }

    #[test]
    fn a_result_without_a_list_of_rows_is_refused() {
        for text in ["", "[]", "{}", "{\"sweep\":null}", "{\"sweep\":{}}", "{\"points\":[]}"] {
            assert!(split_at_rows(text).is_err(), "{text}");
        }
    }
}
