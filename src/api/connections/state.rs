//! The state of one connection and its deadline.

use super::config::{ConnectionConfig, LINGER};
use super::limiter::{ConnectionLimiter, IdleNumber};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

/// The state of one connection, shared by its stream (bytes), its service (requests) and its task (deadlines).
#[derive(Clone)]
pub(crate) struct ConnectionState(Arc<ConnectionShared>);

struct ConnectionShared {
    limiter: Arc<ConnectionLimiter>,
    /// Cancelled when the connection is evicted, or when the service stops.
    close: CancellationToken,
    config: ConnectionConfig,
    activity: Mutex<Activity>,
}

struct Activity {
    phase: ConnectionPhase,
    /// Start of the time in which the client has accepted no bytes; `None` while it does.
    blocked_since: Option<Instant>,
    /// Registration as idle at the limiter; `None` while a request is in progress.
    idle_number: Option<IdleNumber>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ConnectionPhase {
    /// The head of a request is due: the connection was opened, or the first byte was received.
    Head { since: Instant },
    /// Between requests.
    Idle { since: Instant },
    /// A request is in progress, up to the end of its response's body.
    Busy,
    /// The last response was sent; bytes that the client still sends are discarded.
    Lingering { since: Instant },
}

/// A request in progress; dropping it ends the request.
pub(crate) struct RequestGuard(ConnectionState);

impl ConnectionState {
    /// The state of a connection that was just opened.
    pub(crate) fn new(limiter: Arc<ConnectionLimiter>, close: CancellationToken, config: ConnectionConfig) -> Self {
        let idle_number = Some(limiter.register_idle(&close));
        let phase = ConnectionPhase::Head { since: Instant::now() };
        let activity = Mutex::new(Activity { phase, blocked_since: None, idle_number });
        Self(Arc::new(ConnectionShared { limiter, close, config, activity }))
    }

    /// Notes that the head of a request is complete.
    pub(crate) fn begin_request(&self) -> RequestGuard {
        let mut activity = self.activity();
        activity.phase = ConnectionPhase::Busy;
        if let Some(number) = activity.idle_number.take() {
            self.0.limiter.unregister_idle(number);
        }
        RequestGuard(self.clone())
    }

    /// Notes that bytes were received.
    pub(crate) fn record_read(&self) {
        let mut activity = self.activity();
        if let ConnectionPhase::Idle { .. } = activity.phase {
            activity.phase = ConnectionPhase::Head { since: Instant::now() };
        }
    }

    /// Notes that a write succeeded, or was `blocked` by the client.
    pub(crate) fn record_write(&self, blocked: bool) {
        let mut activity = self.activity();
        match blocked {
            true => _ = activity.blocked_since.get_or_insert_with(Instant::now),
            false => activity.blocked_since = None,
        }
    }

    /// Notes that the last response was sent.
    pub(crate) fn begin_linger(&self) {
        if !matches!(self.activity().phase, ConnectionPhase::Lingering { .. }) {
            self.enter_idle(ConnectionPhase::Lingering { since: Instant::now() });
        }
    }

    /// Whether the connection is to close as soon as it can.
    pub(crate) fn is_closing(&self) -> bool {
        self.0.close.is_cancelled()
    }

    /// Whether a response is ready that the client does not accept.
    pub(crate) fn is_blocked(&self) -> bool {
        self.activity().blocked_since.is_some()
    }

    /// Whether nothing is lost by closing the connection now: no request is in progress and no response is being sent.
    pub(crate) fn can_close(&self) -> bool {
        let activity = self.activity();
        activity.phase != ConnectionPhase::Busy && activity.blocked_since.is_none()
    }

    /// The time at which the connection is closed if its state does not change; `None` without a deadline.
    pub(crate) fn deadline(&self) -> Option<Instant> {
        let (activity, config) = (self.activity(), &self.0.config);
        let blocked = activity.blocked_since.map(|since| since + config.write_timeout);
        match activity.phase {
            ConnectionPhase::Head { since } => Some(since + config.header_timeout),
            ConnectionPhase::Lingering { since } => Some(since + LINGER),
            // The end of a response may still be in the buffers.
            ConnectionPhase::Idle { since } => blocked.or(Some(since + config.idle_timeout)),
            ConnectionPhase::Busy => blocked,
        }
    }

    fn enter_idle(&self, phase: ConnectionPhase) {
        let mut activity = self.activity();
        activity.phase = phase;
        if let Some(number) = activity.idle_number.take() {
            self.0.limiter.unregister_idle(number);
        }
        activity.idle_number = Some(self.0.limiter.register_idle(&self.0.close));
    }

    fn activity(&self) -> MutexGuard<'_, Activity> {
        self.0.activity.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for RequestGuard {
    fn drop(&mut self) {
        self.0.enter_idle(ConnectionPhase::Idle { since: Instant::now() });
    }
}

impl Drop for ConnectionShared {
    fn drop(&mut self) {
        let activity = self.activity.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Some(number) = activity.idle_number.take() {
            self.limiter.unregister_idle(number);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn new_state() -> ConnectionState {
        let limiter = Arc::new(ConnectionLimiter::new(2));
        ConnectionState::new(limiter, CancellationToken::new(), ConnectionConfig::default())
    }

    /// Whole seconds to the deadline, rounded up: it was set a moment ago.
    fn seconds_left(state: &ConnectionState) -> Option<u64> {
        state.deadline().map(|deadline| (deadline - Instant::now() + Duration::from_millis(999)).as_secs())
    }

    #[test]
    fn each_phase_has_its_deadline() {
        let state = new_state();
        assert_eq!(seconds_left(&state), Some(10), "the first head");
        let request = state.begin_request();
        assert_eq!(seconds_left(&state), None, "a request in progress");
        assert!(!state.can_close());
        state.record_write(true);
        assert_eq!(seconds_left(&state), Some(30), "a client that does not read");
        let first = state.deadline();
        state.record_write(true);
        assert_eq!(state.deadline(), first, "blocked since the first time");
        state.record_write(false);
        assert_eq!(seconds_left(&state), None);
        drop(request);
        assert_eq!(seconds_left(&state), Some(75), "between requests");
        state.record_read();
        assert_eq!(seconds_left(&state), Some(10), "a head has begun");
        let first = state.deadline();
        state.record_read();
        assert_eq!(state.deadline(), first, "more bytes of a head do not extend the deadline");
        assert!(state.can_close());
    }

    #[test]
    fn a_response_being_sent_is_not_closed_as_idle() {
        let state = new_state();
        let request = state.begin_request();
        state.record_write(true);
        drop(request);
        assert_eq!(seconds_left(&state), Some(30));
        assert!(!state.can_close());
        state.record_write(false);
        assert_eq!(seconds_left(&state), Some(75));
    }

    #[test]
    fn a_dropped_connection_is_no_longer_registered_as_idle() {
        let limiter = Arc::new(ConnectionLimiter::new(2));
        let state = ConnectionState::new(limiter.clone(), CancellationToken::new(), ConnectionConfig::default());
        let request = state.begin_request();
        assert_eq!(limiter.idle_count(), 0);
        drop(request);
        state.begin_linger();
        assert_eq!(limiter.idle_count(), 1);
        drop(state);
        assert_eq!(limiter.idle_count(), 0);
    }
}
