//! The workers that are known by their beats.

use super::message::Beat;
use crate::work::queue::{Member, MemberChunk};
use jiff::Timestamp;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Silence after which a worker counts as gone.
const GONE_AFTER: Duration = Duration::from_secs(15);
/// Silence after which a lost worker is forgotten: so long an operator may look for it.
const FORGOTTEN_AFTER: Duration = Duration::from_secs(600);
/// Workers that are listed; further ones are not taken up, as their names come from outside.
const MOST_MEMBERS: usize = 10_000;

/// The workers by their names.
#[derive(Debug, Default)]
pub(super) struct Members(BTreeMap<String, Known>);

#[derive(Debug)]
struct Known {
    beat: Beat,
    seen: Instant,
    at: Timestamp,
}

impl Members {
    /// Takes up a beat; one without slots is the last of a worker that ends. Whether the worker is new.
    pub(super) fn beat(&mut self, beat: Beat, now: Instant, at: Timestamp) -> bool {
        self.0.retain(|_, known| now.saturating_duration_since(known.seen) < FORGOTTEN_AFTER);
        if beat.slots == 0 {
            self.0.remove(&beat.worker);
            return false;
        }
        if self.0.len() >= MOST_MEMBERS && !self.0.contains_key(&beat.worker) {
            return false;
        }
        let before = self.0.insert(beat.worker.clone(), Known { beat, seen: now, at });
        before.is_none_or(|before| now.saturating_duration_since(before.seen) >= GONE_AFTER)
    }

    /// Chunks that all workers of a kind compute at once.
    pub(super) fn slots(&self, solver: &str, now: Instant) -> usize {
        let live = self.live(now).filter(|known| known.beat.solvers.iter().any(|own| own == solver));
        live.map(|known| known.beat.slots as usize).sum()
    }

    /// The class of processors of most slots, for work that depends on it: the names of workers that begin with this.
    pub(super) fn largest_class(&self, solver: &str, now: Instant) -> Option<String> {
        let mut slots: BTreeMap<&str, usize> = BTreeMap::new();
        for known in self.live(now) {
            for own in known
                .beat
                .solvers
                .iter()
                .filter(|own| own.strip_prefix(solver).is_some_and(|rest| rest.starts_with('-')))
            {
                *slots.entry(own).or_default() += known.beat.slots as usize;
            }
        }
        slots.into_iter().max_by_key(|(_, slots)| *slots).map(|(name, _)| name.to_owned())
    }

    /// All slots, and the chunks that are computed.
    pub(super) fn totals(&self, now: Instant) -> (usize, usize) {
        self.live(now).fold((0, 0), |(slots, running), known| {
            (slots + known.beat.slots as usize, running + known.beat.running.len())
        })
    }

    /// The workers, also lost ones.
    pub(super) fn list(&self, now: Instant) -> Vec<Member> {
        let silence = |known: &Known| now.saturating_duration_since(known.seen);
        let member = |known: &Known| Member {
            id: known.beat.worker.clone(),
            host: known.beat.host.clone(),
            version: known.beat.version.clone(),
            solver_version: known.beat.solver_version.clone(),
            slots: known.beat.slots,
            last_beat_at: known.at,
            silence: silence(known),
            is_lost: silence(known) >= GONE_AFTER,
            running: known
                .beat
                .running
                .iter()
                .map(|chunk| MemberChunk {
                    job: chunk.job.clone(),
                    chunk: chunk.chunk,
                    stage: chunk.stage.clone(),
                    fraction: chunk.fraction,
                })
                .collect(),
        };
        self.0.values().filter(|known| silence(known) < FORGOTTEN_AFTER).map(member).collect()
    }

    fn live(&self, now: Instant) -> impl Iterator<Item = &Known> {
        self.0.values().filter(move |known| now.saturating_duration_since(known.seen) < GONE_AFTER)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn beat(worker: &str, solvers: &[&str], slots: u32) -> Beat {
        Beat {
            schema: 1,
            worker: worker.into(),
            host: "host".into(),
            version: "0.1.0".into(),
            solver_version: solvers[0].into(),
            solvers: solvers.iter().map(|&solver| solver.into()).collect(),
            slots,
            running: Vec::new(),
        }
    }

    #[test]
    fn silent_workers_are_gone_and_others_count_by_their_version() {
        let (start, at) = (Instant::now(), Timestamp::UNIX_EPOCH);
        let mut members = Members::default();
        assert!(members.beat(beat("a", &["1", "1-v3"], 2), start, at));
        assert!(!members.beat(beat("a", &["1", "1-v3"], 2), start, at));
        members.beat(beat("b", &["1", "1-v4"], 3), start, at);
        members.beat(beat("c", &["2"], 8), start, at);
        assert_eq!((members.slots("1", start), members.slots("1-v3", start), members.slots("3", start)), (5, 2, 0));
        assert_eq!(members.largest_class("1", start).as_deref(), Some("1-v4"));
        assert_eq!(members.totals(start), (13, 0));
        let later = start + GONE_AFTER;
        assert_eq!((members.slots("1", later), members.totals(later)), (0, (0, 0)));
        assert!(members.list(later).iter().all(|member| member.is_lost && member.silence == GONE_AFTER));
        assert!(members.beat(beat("a", &["1"], 2), later, at), "it is back");
        assert_eq!(members.list(later).iter().filter(|member| !member.is_lost).count(), 1);
        // One that ends says so.
        assert!(!members.beat(beat("a", &["1"], 0), later, at));
        assert_eq!(members.list(later).len(), 2);
        assert_eq!(members.list(start + FORGOTTEN_AFTER).len(), 0);
    }
}
