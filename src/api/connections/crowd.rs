//! All connections together: a bounded number of places, and who makes room for a newcomer.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio_util::sync::CancellationToken;

/// Number of a connection's turn among those without a request in progress.
pub type Ticket = u64;

pub struct Crowd {
    places: Arc<Semaphore>,
    waiting: Mutex<Waiting>,
}

/// Connections without a request in progress, the longest waiting first.
#[derive(Default)]
struct Waiting {
    next: Ticket,
    line: BTreeMap<Ticket, CancellationToken>,
    /// A newcomer found nobody to make room: the next one that begins to wait does.
    room_wanted: bool,
}

impl Crowd {
    pub fn new(places: u32) -> Self {
        Self { places: Arc::new(Semaphore::new(places as usize)), waiting: Mutex::default() }
    }

    /// A place for a newcomer; for one caller at a time.
    pub async fn place(&self) -> Option<OwnedSemaphorePermit> {
        if let Ok(place) = self.places.clone().try_acquire_owned() {
            return Some(place);
        }
        self.make_room();
        let place = self.places.clone().acquire_owned().await.ok();
        self.waiting().room_wanted = false;
        place
    }

    /// Sends away the connection that has waited longest (true), or the next one that begins to (false).
    pub fn make_room(&self) -> bool {
        let mut waiting = self.waiting();
        let longest = waiting.line.pop_first();
        match &longest {
            Some((_, leave)) => leave.cancel(),
            None => waiting.room_wanted = true,
        }
        longest.is_some()
    }

    /// A connection begins to wait.
    pub fn wait(&self, leave: &CancellationToken) -> Ticket {
        let mut waiting = self.waiting();
        waiting.next += 1;
        let ticket = waiting.next;
        match std::mem::take(&mut waiting.room_wanted) {
            true => leave.cancel(),
            false => _ = waiting.line.insert(ticket, leave.clone()),
        }
        ticket
    }

    /// It waits no longer.
    pub fn forget(&self, ticket: Ticket) {
        self.waiting().line.remove(&ticket);
    }

    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.waiting().line.len()
    }

    fn waiting(&self) -> MutexGuard<'_, Waiting> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures_util::FutureExt;

    #[tokio::test]
    async fn the_longest_waiting_makes_room() {
        let crowd = Crowd::new(2);
        let (first, second) = (CancellationToken::new(), CancellationToken::new());
        let places = (crowd.place().await.unwrap(), crowd.place().await.unwrap());
        let ticket = crowd.wait(&first);
        crowd.wait(&second);
        crowd.forget(ticket);
        crowd.wait(&first);
        let mut third = Box::pin(crowd.place());
        assert!(third.as_mut().now_or_never().is_none());
        assert!(second.is_cancelled() && !first.is_cancelled(), "the first had a request in between");
        drop(places.1);
        assert!(third.await.is_some());
    }

    #[tokio::test]
    async fn nobody_with_a_request_is_sent_away_but_the_first_to_end_one_is() {
        let crowd = Crowd::new(1);
        let leave = CancellationToken::new();
        let place = crowd.place().await.unwrap();
        let mut newcomer = Box::pin(crowd.place());
        assert!(newcomer.as_mut().now_or_never().is_none());
        assert!(!leave.is_cancelled());
        crowd.wait(&leave);
        assert!(leave.is_cancelled());
        drop(place);
        assert!(newcomer.await.is_some());
        let other = CancellationToken::new();
        crowd.wait(&other);
        assert!(!other.is_cancelled(), "room is wanted once");
    }
}
