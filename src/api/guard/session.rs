//! Sessions of browsers, in memory; a restart ends them.

use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::time::{Duration, Instant};
use uuid::Uuid;

/// Duration of a session.
pub(super) const SESSION_LIFETIME: Duration = Duration::from_secs(12 * 60 * 60);
/// Largest number of open sessions; a further one ends the oldest.
const MAX_SESSIONS: usize = 1000;

/// Open sessions: end time by the SHA-256 digest of the id. The time of looking up a digest reveals nothing about the
/// id.
#[derive(Debug, Default)]
pub(crate) struct Sessions(HashMap<[u8; 32], Instant>);

impl Sessions {
    /// Opens a session and returns its id (244 random bits of the system's generator).
    pub(crate) fn open(&mut self, now: Instant) -> String {
        self.0.retain(|_, end| *end > now);
        if self.0.len() >= MAX_SESSIONS {
            let oldest = self.0.iter().min_by_key(|(_, end)| **end).map(|(digest, _)| *digest);
            oldest.map(|digest| self.0.remove(&digest));
        }
        let id = format!("{}{}", Uuid::new_v4().simple(), Uuid::new_v4().simple());
        self.0.insert(digest(&id), now + SESSION_LIFETIME);
        id
    }

    pub(crate) fn is_open(&self, id: &str, now: Instant) -> bool {
        self.0.get(&digest(id)).is_some_and(|end| *end > now)
    }

    pub(crate) fn end(&mut self, id: &str) {
        self.0.remove(&digest(id));
    }
}

fn digest(id: &str) -> [u8; 32] {
    Sha256::digest(id).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_lasts_until_its_end() {
        let (mut sessions, now) = (Sessions::default(), Instant::now());
        let id = sessions.open(now);
        assert!(sessions.is_open(&id, now + SESSION_LIFETIME - Duration::from_secs(1)));
        assert!(!sessions.is_open(&id, now + SESSION_LIFETIME));
        let other = sessions.open(now);
        assert_ne!(id, other);
        sessions.end(&id);
        assert!(!sessions.is_open(&id, now) && sessions.is_open(&other, now) && !sessions.is_open("", now));
    }

    #[test]
    fn their_number_is_bounded_and_the_oldest_gives_way() {
        let (mut sessions, now) = (Sessions::default(), Instant::now());
        let at = |second| now + Duration::from_secs(second);
        let ids: Vec<_> = (0..MAX_SESSIONS as u64 + 2).map(|second| sessions.open(at(second))).collect();
        assert_eq!(sessions.0.len(), MAX_SESSIONS);
        let open: Vec<_> = ids.iter().map(|id| sessions.is_open(id, at(2000))).collect();
        assert_eq!(open.iter().position(|open| *open), Some(2));
    }
}
