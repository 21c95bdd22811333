//! Positional command line arguments of the programs.

use crate::Failure;
use herringbone_physics::fe::Resolution;
use std::str::FromStr;

/// The arguments of the process, without its name.
#[derive(Debug)]
pub struct Arguments(Vec<String>);

impl Arguments {
    /// Those of this process.
    pub fn of_process() -> Self {
        Self(std::env::args().skip(1).collect())
    }

    /// The argument at a place, counted from 0.
    pub fn word(&self, place: usize) -> Option<&str> {
        self.0.get(place).map(String::as_str)
    }

    /// The argument at a place as a number.
    ///
    /// # Errors
    /// If it is there and cannot be read as one.
    pub fn number<T: FromStr>(&self, place: usize) -> Result<Option<T>, Failure> {
        let parse = |word: &str| word.parse().map_err(|_| format!("{word}: not a number that fits").into());
        self.word(place).map(parse).transpose()
    }

    /// The arguments from a place on.
    pub fn from(&self, place: usize) -> impl Iterator<Item = &str> {
        self.0.iter().skip(place).map(String::as_str)
    }

    /// Whether a part of a program was asked for by its name; without arguments all are.
    pub fn choose(&self, name: &str) -> bool {
        self.0.is_empty() || self.0.iter().any(|word| word == name)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// The resolutions of the finite elements and their words, coarse to fine.
pub const RESOLUTIONS: [(&str, Resolution); 4] = [
    ("coarse", Resolution::Coarse),
    ("medium", Resolution::Medium),
    ("standard", Resolution::Standard),
    ("fine", Resolution::Fine),
];

/// The resolution of a word.
///
/// # Errors
/// If there is none.
pub fn resolution(word: &str) -> Result<Resolution, Failure> {
    let found = RESOLUTIONS.into_iter().find(|(name, _)| *name == word);
    Ok(found.ok_or_else(|| format!("{word} is no resolution: coarse, medium, standard, fine"))?.1)
}
