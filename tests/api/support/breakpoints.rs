//! Named points at which a scripted calculation stops until the test lets it go on: order without sleeping.

use std::collections::{HashMap, HashSet};
use std::sync::{Condvar, Mutex};
use std::time::Duration;
use tokio::sync::Notify;

/// A canceled calculation looks whether it is at least this often, as a real one does.
const LOOK_EVERY: Duration = Duration::from_millis(2);

#[derive(Default)]
pub(crate) struct Breakpoints {
    state: Mutex<State>,
    released: Condvar,
    reached: Notify,
}

#[derive(Default)]
struct State {
    held: HashSet<String>,
    reached: HashMap<String, u32>,
}

impl Breakpoints {
    /// Calculations will stop at this point.
    pub(crate) fn hold(&self, point: &str) {
        self.state.lock().expect("no panic while locked").held.insert(point.to_owned());
    }

    /// Lets go on whoever stopped at this point, and all that come later.
    pub(crate) fn release(&self, point: &str) {
        self.state.lock().expect("no panic while locked").held.remove(point);
        self.released.notify_all();
    }

    /// Number of times that the point was reached.
    pub(crate) fn count(&self, point: &str) -> u32 {
        self.state.lock().expect("no panic while locked").reached.get(point).copied().unwrap_or(0)
    }

    /// Waits until the point was reached so many times.
    pub(crate) async fn reached(&self, point: &str, times: u32) {
        let waiting = async {
            loop {
                let notified = self.reached.notified();
                if self.count(point) >= times {
                    return;
                }
                notified.await;
            }
        };
        let in_time = tokio::time::timeout(Duration::from_secs(30), waiting).await;
        assert!(in_time.is_ok(), "{point} was reached {} times, not {times}", self.count(point));
    }

    /// Called by the calculation: false when it was canceled while it stood here.
    pub(crate) fn pass(&self, point: &str, canceled: &dyn Fn() -> bool) -> bool {
        let mut state = self.state.lock().expect("no panic while locked");
        *state.reached.entry(point.to_owned()).or_default() += 1;
        self.reached.notify_waiters();
        while state.held.contains(point) {
            if canceled() {
                return false;
            }
            state = self.released.wait_timeout(state, LOOK_EVERY).expect("no panic while locked").0;
        }
        !canceled()
    }
}
