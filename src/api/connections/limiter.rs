//! The bound on open connections, and the eviction of idle ones in favour of new ones.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio_util::sync::CancellationToken;

/// Sequence number of an idle connection; the smallest has been idle longest.
pub(crate) type IdleNumber = u64;

/// Bounds the number of open connections.
pub(crate) struct ConnectionLimiter {
    permits: Arc<Semaphore>,
    idle: Mutex<IdleQueue>,
}

/// Connections without a request in progress, in the order in which they became idle.
#[derive(Default)]
struct IdleQueue {
    last_number: IdleNumber,
    close_tokens: BTreeMap<IdleNumber, CancellationToken>,
    /// Set when a new connection found none to evict: the next one that becomes idle is evicted.
    eviction_due: bool,
}

impl ConnectionLimiter {
    pub(crate) fn new(max_connections: u32) -> Self {
        Self { permits: Arc::new(Semaphore::new(max_connections as usize)), idle: Mutex::default() }
    }

    /// Waits for the permit of a new connection, evicting an idle one where the bound is reached. Not for concurrent
    /// callers. `None` only if the semaphore is closed, which never happens.
    pub(crate) async fn acquire(&self) -> Option<OwnedSemaphorePermit> {
        if let Ok(permit) = self.permits.clone().try_acquire_owned() {
            return Some(permit);
        }
        self.evict();
        let permit = self.permits.clone().acquire_owned().await.ok();
        self.idle().eviction_due = false;
        permit
    }

    /// Closes the connection that has been idle longest. False when none is idle; the next one that becomes idle is
    /// closed then.
    pub(crate) fn evict(&self) -> bool {
        let mut idle = self.idle();
        let longest = idle.close_tokens.pop_first();
        match &longest {
            Some((_, close)) => close.cancel(),
            None => idle.eviction_due = true,
        }
        longest.is_some()
    }

    /// Registers a connection that became idle; `close` is cancelled when it is evicted.
    pub(crate) fn register_idle(&self, close: &CancellationToken) -> IdleNumber {
        let mut idle = self.idle();
        idle.last_number += 1;
        let number = idle.last_number;
        match std::mem::take(&mut idle.eviction_due) {
            true => close.cancel(),
            false => _ = idle.close_tokens.insert(number, close.clone()),
        }
        number
    }

    /// Removes a connection that is no longer idle, or closed.
    pub(crate) fn unregister_idle(&self, number: IdleNumber) {
        self.idle().close_tokens.remove(&number);
    }

    #[cfg(test)]
    pub(crate) fn idle_count(&self) -> usize {
        self.idle().close_tokens.len()
    }

    fn idle(&self) -> MutexGuard<'_, IdleQueue> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures_util::FutureExt;

    #[tokio::test]
    async fn the_connection_idle_longest_is_evicted() {
        let limiter = ConnectionLimiter::new(2);
        let (first, second) = (CancellationToken::new(), CancellationToken::new());
        let permits = (limiter.acquire().await.unwrap(), limiter.acquire().await.unwrap());
        let number = limiter.register_idle(&first);
        limiter.register_idle(&second);
        limiter.unregister_idle(number);
        limiter.register_idle(&first);
        let mut third = Box::pin(limiter.acquire());
        assert!(third.as_mut().now_or_never().is_none());
        assert!(second.is_cancelled() && !first.is_cancelled(), "the first had a request in between");
        drop(permits.1);
        assert!(third.await.is_some());
    }

    #[tokio::test]
    async fn a_busy_connection_is_not_evicted_but_the_first_to_become_idle_is() {
        let limiter = ConnectionLimiter::new(1);
        let close = CancellationToken::new();
        let permit = limiter.acquire().await.unwrap();
        let mut second = Box::pin(limiter.acquire());
        assert!(second.as_mut().now_or_never().is_none());
        assert!(!close.is_cancelled());
        limiter.register_idle(&close);
        assert!(close.is_cancelled());
        drop(permit);
        assert!(second.await.is_some());
        let other = CancellationToken::new();
        limiter.register_idle(&other);
        assert!(!other.is_cancelled(), "one eviction per new connection");
    }
}
