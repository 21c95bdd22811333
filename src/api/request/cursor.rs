//! Where a page of a list ends: opaque to clients, versioned, bound to the filters of the list.

use crate::store::{JobFilter, JobId};
use sha2::{Digest, Sha256};

/// Changes when the meaning of the bytes does.
const VERSION: u8 = 1;
/// Version, job, digest of the filters.
const LENGTH: usize = 1 + 16 + 8;

/// The last job of a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cursor(pub JobId);

impl Cursor {
    pub fn encode(self, filter: &JobFilter) -> String {
        let mut bytes = vec![VERSION];
        bytes.extend_from_slice(self.0.as_bytes());
        bytes.extend_from_slice(&digest(filter));
        bytes.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// `None` for what [`Cursor::encode`] did not make with the same filter.
    pub fn decode(text: &str, filter: &JobFilter) -> Option<Self> {
        if text.len() != 2 * LENGTH || !text.is_ascii() {
            return None;
        }
        let bytes: Vec<u8> = (0..LENGTH)
            .map(|index| u8::from_str_radix(text.get(2 * index..2 * index + 2)?, 16).ok())
            .collect::<Option<_>>()?;
        let (head, filters) = bytes.split_at(17);
        let id: [u8; 16] = head.get(1..)?.try_into().ok()?;
        (head.first() == Some(&VERSION) && filters == digest(filter)).then(|| Self(JobId::from_bytes(id)))
    }
}

fn digest(filter: &JobFilter) -> [u8; 8] {
    let mut states: Vec<_> = filter.states.iter().map(|state| state.word()).collect();
    states.sort_unstable();
    states.dedup();
    let text = format!("{states:?} {:?} {:?}", filter.kind, filter.label);
    let mut short = [0; 8];
    short.iter_mut().zip(Sha256::digest(text)).for_each(|(slot, byte)| *slot = byte);
    short
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::State;
    use proptest::prelude::*;

    #[test]
    fn bound_to_version_and_filters() {
        let id = JobId::new();
        let filter = JobFilter { states: vec![State::Failed, State::Queued], ..JobFilter::default() };
        let same = JobFilter { states: vec![State::Queued, State::Failed], ..JobFilter::default() };
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
