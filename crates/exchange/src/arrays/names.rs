//! Names of arrays.

use std::collections::HashSet;

/// Makes the names of the arrays of a file: letters, digits and underscores, a letter first, each once.
#[derive(Debug)]
pub struct ArrayNames {
    longest: usize,
    taken: HashSet<String>,
}

impl ArrayNames {
    pub(super) fn new(longest: usize) -> Self {
        Self { longest, taken: HashSet::new() }
    }

    /// The name of an array that is called `text` elsewhere: a channel, a column, a pointer of a field.
    pub fn name(&mut self, text: &str) -> String {
        let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
        let mut name: String = text.trim_start_matches('/').chars().map(plain).collect();
        if !name.starts_with(|letter: char| letter.is_ascii_alphabetic()) {
            name.insert_str(0, "v_");
        }
        name.truncate(self.longest);
        let base = name.clone();
        let mut number = 2;
        while self.taken.contains(&name) {
            let ending = format!("_{number}");
            name.clone_from(&base);
            name.truncate(self.longest.saturating_sub(ending.len()));
            name += &ending;
            number += 1;
        }
        self.taken.insert(name.clone());
        name
    }
}
