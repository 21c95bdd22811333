//! Values of a calculation by its inputs, for points of a sweep that have them in common.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

/// Inputs that are remembered: those of the lines of a sweep that are solved side by side, with room.
const KEPT: usize = 16;

/// The values of the inputs seen last. Inputs are compared as a whole, so that a value is that of its inputs whatever
/// fields of the document they come from.
pub(super) struct Recent<K, T>(Mutex<VecDeque<(K, Arc<T>)>>);

impl<K, T> Default for Recent<K, T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<K: PartialEq, T> Recent<K, T> {
    /// The value of these inputs, if it is remembered.
    pub(super) fn get(&self, inputs: &K) -> Option<Arc<T>> {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.iter().find(|(known, _)| known == inputs).map(|(_, value)| value.clone())
    }

    /// Remembers a value, and forgets the oldest one where there are too many.
    pub(super) fn put(&self, inputs: K, value: Arc<T>) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.truncate(KEPT - 1);
        kept.push_front((inputs, value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_is_forgotten() {
        let recent = Recent::default();
        for i in 0..=KEPT {
            recent.put(i, Arc::new(10 * i));
        }
        assert_eq!(recent.get(&0), None);
        for i in 1..=KEPT {
            assert_eq!(recent.get(&i), Some(Arc::new(10 * i)));
        }
    }
}
