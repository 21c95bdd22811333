//! The wish that a calculation stops, and whose it is.

use std::sync::atomic::{AtomicU8, Ordering};

/// Why a calculation is to stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Reason {
    Cancel = 1,
    Shutdown,
    /// Others wait, and it has had its turn.
    Turn,
    TimeLimit,
}

/// Set once; the calculation looks at it at every checkpoint. The first reason stays.
#[derive(Debug, Default)]
pub struct Stop(AtomicU8);

impl Stop {
    pub fn ask(&self, reason: Reason) {
        let _ = self.0.compare_exchange(0, reason as u8, Ordering::Relaxed, Ordering::Relaxed);
    }

    pub fn is_asked(&self) -> bool {
        self.0.load(Ordering::Relaxed) != 0
    }

    pub fn reason(&self) -> Option<Reason> {
        [Reason::Cancel, Reason::Shutdown, Reason::Turn, Reason::TimeLimit]
            .into_iter()
            .find(|reason| *reason as u8 == self.0.load(Ordering::Relaxed))
    }
}
