//! Cursors of paged lists: opaque to clients, versioned, bound to the filters and the order of the list.

use crate::store::{JobFilter, JobId, JobOrder, ListPlace, SortValue};
use sha2::{Digest, Sha256};

/// Version of the encoding.
const VERSION: u8 = 2;

/// Tags of the encoded value.
const NONE: u8 = 0;
const INTEGER: u8 = 1;
const REAL: u8 = 2;
const TEXT: u8 = 3;

/// The position after a page: the place of its last job. Encoded as version, job id, digest of filters and order, tag
/// of the value, value.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Cursor(pub ListPlace);

impl Cursor {
    /// The cursor as text, for a list with this filter and order.
    pub(crate) fn encode(&self, filter: &JobFilter, order: JobOrder) -> String {
        let mut bytes = vec![VERSION];
        bytes.extend_from_slice(self.0.id.as_bytes());
        bytes.extend_from_slice(&digest(filter, order));
        match &self.0.value {
            SortValue::None => bytes.push(NONE),
            SortValue::Integer(value) => {
                bytes.push(INTEGER);
                bytes.extend_from_slice(&value.to_be_bytes());
            }
            SortValue::Real(value) => {
                bytes.push(REAL);
                bytes.extend_from_slice(&value.to_be_bytes());
            }
            SortValue::Text(value) => {
                bytes.push(TEXT);
                bytes.extend_from_slice(value.as_bytes());
            }
        }
        hex::encode(bytes)
    }

    /// Parses a cursor; `None` for text that [`Cursor::encode`] did not make with the same filter and order.
    pub(crate) fn decode(text: &str, filter: &JobFilter, order: JobOrder) -> Option<Self> {
        let bytes = hex::decode(text).ok()?;
        let (version, rest) = bytes.split_first()?;
        let (id, rest) = rest.split_first_chunk::<16>()?;
        let (filters, rest) = rest.split_first_chunk::<8>()?;
        let (tag, value) = rest.split_first()?;
        let value = match *tag {
            NONE if value.is_empty() => SortValue::None,
            INTEGER => SortValue::Integer(i64::from_be_bytes(value.try_into().ok()?)),
            REAL => SortValue::Real(f64::from_be_bytes(value.try_into().ok()?)),
            TEXT => SortValue::Text(String::from_utf8(value.to_vec()).ok()?),
            _ => return None,
        };
        let is_valid = *version == VERSION && *filters == digest(filter, order);
        is_valid.then(|| Self(ListPlace { id: JobId::from_bytes(*id), value }))
    }
}

fn digest(filter: &JobFilter, order: JobOrder) -> [u8; 8] {
    let JobFilter { states, kind, label, search, from, to } = filter;
    let mut states: Vec<_> = states.iter().map(|state| state.as_str()).collect();
    states.sort_unstable();
    states.dedup();
    let text = format!("{states:?} {kind:?} {label:?} {search:?} {from:?} {to:?} {order:?}");
    let mut short = [0; 8];
    short.iter_mut().zip(Sha256::digest(text)).for_each(|(target, byte)| *target = byte);
    short
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{JobSort, JobState};
    use proptest::prelude::*;

    #[test]
    fn bound_to_version_filters_and_order() {
        let cursor = |value| Cursor(ListPlace { id: JobId::new(), value });
        let filter = JobFilter { states: vec![JobState::Failed, JobState::Queued], ..JobFilter::default() };
        let same = JobFilter { states: vec![JobState::Queued, JobState::Failed], ..JobFilter::default() };
        let other = JobFilter { search: Some("a".into()), ..same.clone() };
        let by_name = JobOrder { sort: JobSort::Name, descending: false };
        for value in
            [SortValue::None, SortValue::Integer(-7), SortValue::Real(0.1), SortValue::Text("Ritzel é".to_owned())]
        {
            let cursor = cursor(value);
            let text = cursor.encode(&filter, by_name);
            assert_eq!(Cursor::decode(&text, &same, by_name), Some(cursor));
            assert_eq!(Cursor::decode(&text, &other, by_name), None);
            assert_eq!(Cursor::decode(&text, &same, JobOrder { descending: true, ..by_name }), None);
            assert_eq!(Cursor::decode(&text, &same, JobOrder::default()), None);
            assert_eq!(Cursor::decode(&text.replacen("02", "01", 1), &same, by_name), None);
        }
    }

    proptest! {
        #[test]
        fn any_text_is_refused_without_panic(text in ".{0,60}") {
            assert_eq!(Cursor::decode(&text, &JobFilter::default(), JobOrder::default()), None);
        }
    }
}
