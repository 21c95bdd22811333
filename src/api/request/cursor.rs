//! Cursors of paged lists: opaque to clients, versioned, bound to the filters of the list.

use crate::store::{JobFilter, JobId};
use sha2::{Digest, Sha256};

/// Version of the encoding.
const VERSION: u8 = 1;
/// Bytes of an encoded cursor: version, job id, digest of the filters.
const LENGTH: usize = 1 + 16 + 8;

/// The position after a page: the id of its last job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Cursor(pub JobId);

impl Cursor {
    /// The cursor as text, for a list with this filter.
    pub(crate) fn encode(self, filter: &JobFilter) -> String {
        let mut bytes = vec![VERSION];
        bytes.extend_from_slice(self.0.as_bytes());
        bytes.extend_from_slice(&digest(filter));
        hex::encode(bytes)
    }

    /// Parses a cursor; `None` for text that [`Cursor::encode`] did not make with the same filter.
    pub(crate) fn decode(text: &str, filter: &JobFilter) -> Option<Self> {
        let mut bytes = [0; LENGTH];
        hex::decode_to_slice(text, &mut bytes).ok()?;
        let (head, filters) = bytes.split_at(17);
        let id: [u8; 16] = head.get(1..)?.try_into().ok()?;
        (head.first() == Some(&VERSION) && filters == digest(filter)).then(|| Self(JobId::from_bytes(id)))
    }
}

fn digest(filter: &JobFilter) -> [u8; 8] {
    let mut states: Vec<_> = filter.states.iter().map(|state| state.as_str()).collect();
    states.sort_unstable();
    states.dedup();
    let text = format!("{states:?} {:?} {:?}", filter.kind, filter.label);
    let mut short = [0; 8];
    short.iter_mut().zip(Sha256::digest(text)).for_each(|(target, byte)| *target = byte);
    short
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::JobState;
    use proptest::prelude::*;

    #[test]
    fn bound_to_version_and_filters() {
        let id = JobId::new();
        let filter = JobFilter { states: vec![JobState::Failed, JobState::Queued], ..JobFilter::default() };
        let same = JobFilter { states: vec![JobState::Queued, JobState::Failed], ..JobFilter::default() };
        let text = Cursor(id).encode(&filter);
        assert_eq!(Cursor::decode(&text, &same), Some(Cursor(id)));
        assert_eq!(Cursor::decode(&text, &JobFilter::default()), None);
        assert_eq!(Cursor::decode(&text.replacen("01", "02", 1), &filter), None);
    }

    proptest! {
        #[test]
        fn any_text_is_refused_without_panic(text in ".{0,60}") {
            assert_eq!(Cursor::decode(&text, &JobFilter::default()), None);
        }
    }
}
