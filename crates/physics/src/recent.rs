//! Values of a calculation by its inputs, for calculations in a row that have inputs in common.

use std::collections::VecDeque;

/// The values of the inputs seen last. Inputs are compared as a whole, so that a value is that of its inputs.
#[derive(Debug)]
pub struct Recent<K, V> {
    kept: VecDeque<(K, V)>,
    most: usize,
}

impl<K: PartialEq, V: Clone> Recent<K, V> {
    /// Nothing yet; at most `most` values, one at least.
    pub const fn new(most: usize) -> Self {
        Self { kept: VecDeque::new(), most }
    }

    /// The value of these inputs, if it is remembered.
    pub fn get(&self, inputs: &K) -> Option<V> {
        self.kept.iter().find(|(known, _)| known == inputs).map(|(_, value)| value.clone())
    }

    /// Remembers a value, and forgets the oldest one where there are too many.
    pub fn put(&mut self, inputs: K, value: V) {
        self.kept.truncate(self.most.saturating_sub(1));
        self.kept.push_front((inputs, value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_is_forgotten() {
        let mut recent = Recent::new(16);
        for i in 0..=16 {
            recent.put(i, 10 * i);
        }
        assert_eq!(recent.get(&0), None);
        for i in 1..=16 {
            assert_eq!(recent.get(&i), Some(10 * i));
        }
    }
}
