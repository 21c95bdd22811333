//! Values of a stage by its inputs, for points of a sweep that have them in common.

use herringbone_physics::recent;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Inputs that are remembered: those of the lines of a sweep that are solved side by side, with room.
const KEPT: usize = 16;

/// The values of the inputs seen last by any thread.
pub(super) struct Recent<K, T>(Mutex<recent::Recent<K, Arc<T>>>);

impl<K: PartialEq, T> Default for Recent<K, T> {
    fn default() -> Self {
        Self(Mutex::new(recent::Recent::new(KEPT)))
    }
}

impl<K: PartialEq, T> Recent<K, T> {
    /// The value of these inputs, if it is remembered.
    pub(super) fn get(&self, inputs: &K) -> Option<Arc<T>> {
        self.lock().get(inputs)
    }

    pub(super) fn put(&self, inputs: K, value: Arc<T>) {
        self.lock().put(inputs, value);
    }

    fn lock(&self) -> MutexGuard<'_, recent::Recent<K, Arc<T>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
