//! What a connection does now, and until when it may go on so.

use super::config::{ConnectionConfig, LINGER};
use super::crowd::{Crowd, Ticket};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::time::Instant;
use tokio_util::sync::CancellationToken;

/// The state of one connection, shared by its stream (bytes), its service (requests) and its task (deadlines).
#[derive(Clone)]
pub struct Pulse(Arc<Shared>);

struct Shared {
    crowd: Arc<Crowd>,
    /// Cancelled when the connection has to make room, or the service stops.
    leave: CancellationToken,
    config: ConnectionConfig,
    state: Mutex<State>,
}

struct State {
    phase: Phase,
    /// Since when the client takes nothing.
    blocked_since: Option<Instant>,
    /// Its turn among those that wait without a request.
    ticket: Option<Ticket>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// A request's head is due: the connection was opened, or the first byte came.
    Head { since: Instant },
    /// Between requests.
    Idle { since: Instant },
    /// A request is in progress, up to the end of its answer's body.
    Busy,
    /// The last answer was sent; what the client still sends is thrown away.
    Lingering { since: Instant },
}

/// A request in progress; its end when dropped.
pub struct Busy(Pulse);

impl Pulse {
    /// A connection that was opened just now.
    pub fn new(crowd: Arc<Crowd>, leave: CancellationToken, config: ConnectionConfig) -> Self {
        let ticket = Some(crowd.wait(&leave));
        let state = State { phase: Phase::Head { since: Instant::now() }, blocked_since: None, ticket };
        Self(Arc::new(Shared { crowd, leave, config, state: Mutex::new(state) }))
    }

    /// The head of a request is complete.
    pub fn begin(&self) -> Busy {
        let mut state = self.state();
        state.phase = Phase::Busy;
        if let Some(ticket) = state.ticket.take() {
            self.0.crowd.forget(ticket);
        }
        Busy(self.clone())
    }

    /// Bytes came in.
    pub fn heard(&self) {
        let mut state = self.state();
        if let Phase::Idle { .. } = state.phase {
            state.phase = Phase::Head { since: Instant::now() };
        }
    }

    /// Bytes went out, or could not.
    pub fn wrote(&self, blocked: bool) {
        let mut state = self.state();
        match blocked {
            true => _ = state.blocked_since.get_or_insert_with(Instant::now),
            false => state.blocked_since = None,
        }
    }

    /// The last answer was sent.
    pub fn linger(&self) {
        if !matches!(self.state().phase, Phase::Lingering { .. }) {
            self.wait(Phase::Lingering { since: Instant::now() });
        }
    }

    /// Whether the connection has to go as soon as it can.
    pub fn is_leaving(&self) -> bool {
        self.0.leave.is_cancelled()
    }

    /// Whether an answer is ready that the client does not take.
    pub fn is_blocked(&self) -> bool {
        self.state().blocked_since.is_some()
    }

    /// Nothing is lost when the connection is cut off now: no request is in progress and no answer on its way.
    pub fn is_dispensable(&self) -> bool {
        let state = self.state();
        state.phase != Phase::Busy && state.blocked_since.is_none()
    }

    /// When the connection is cut off, if nothing else happens.
    pub fn deadline(&self) -> Option<Instant> {
        let (state, config) = (self.state(), &self.0.config);
        let blocked = state.blocked_since.map(|since| since + config.write_timeout);
        match state.phase {
            Phase::Head { since } => Some(since + config.header_timeout),
            Phase::Lingering { since } => Some(since + LINGER),
            // The end of an answer may still be on its way.
            Phase::Idle { since } => blocked.or(Some(since + config.idle_timeout)),
            Phase::Busy => blocked,
        }
    }

    fn wait(&self, phase: Phase) {
        let mut state = self.state();
        state.phase = phase;
        if let Some(ticket) = state.ticket.take() {
            self.0.crowd.forget(ticket);
        }
        state.ticket = Some(self.0.crowd.wait(&self.0.leave));
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.0.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        self.0.wait(Phase::Idle { since: Instant::now() });
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        let state = self.state.get_mut().unwrap_or_else(PoisonError::into_inner);
        if let Some(ticket) = state.ticket.take() {
            self.crowd.forget(ticket);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn pulse() -> Pulse {
        Pulse::new(Arc::new(Crowd::new(2)), CancellationToken::new(), ConnectionConfig::default())
    }

    /// Whole seconds, rounded up: the deadline was set a moment ago.
    fn left(pulse: &Pulse) -> Option<u64> {
        pulse.deadline().map(|deadline| (deadline - Instant::now() + Duration::from_millis(999)).as_secs())
    }

    #[test]
    fn each_phase_has_its_deadline() {
        let pulse = pulse();
        assert_eq!(left(&pulse), Some(10), "the first head");
        let busy = pulse.begin();
        assert_eq!(left(&pulse), None, "a request in progress");
        assert!(!pulse.is_dispensable());
        pulse.wrote(true);
        assert_eq!(left(&pulse), Some(30), "a client that does not read");
        let first = pulse.deadline();
        pulse.wrote(true);
        assert_eq!(pulse.deadline(), first, "blocked since the first time");
        pulse.wrote(false);
        assert_eq!(left(&pulse), None);
        drop(busy);
        assert_eq!(left(&pulse), Some(75), "between requests");
        pulse.heard();
        assert_eq!(left(&pulse), Some(10), "a head has begun");
        let first = pulse.deadline();
        pulse.heard();
        assert_eq!(pulse.deadline(), first, "more bytes of a head gain no time");
        assert!(pulse.is_dispensable());
    }

    #[test]
    fn an_answer_on_its_way_is_not_cut_off_as_idle() {
        let pulse = pulse();
        let busy = pulse.begin();
        pulse.wrote(true);
        drop(busy);
        assert_eq!(left(&pulse), Some(30));
        assert!(!pulse.is_dispensable());
        pulse.wrote(false);
        assert_eq!(left(&pulse), Some(75));
    }

    #[test]
    fn a_connection_that_ends_leaves_no_trace_in_the_crowd() {
        let crowd = Arc::new(Crowd::new(2));
        let pulse = Pulse::new(crowd.clone(), CancellationToken::new(), ConnectionConfig::default());
        let busy = pulse.begin();
        assert_eq!(crowd.len(), 0);
        drop(busy);
        pulse.linger();
        assert_eq!(crowd.len(), 1);
        drop(pulse);
        assert_eq!(crowd.len(), 0);
    }
}
