//! Query parameters, read so that every violation is found at once and unknown ones are errors.

use crate::api::problem::{Problem, ProblemCode, Refusal};
use axum::extract::{FromRequestParts, Query};
use axum::http::request::Parts;
use herringbone_job::Violation;
use std::str::FromStr;

/// The parameters of a request. Take each known one, then [`Parameters::finish`].
#[derive(Debug)]
pub struct Parameters {
    pairs: Vec<(String, String)>,
    known: Vec<&'static str>,
    violations: Vec<Violation>,
}

impl<S: Send + Sync> FromRequestParts<S> for Parameters {
    type Rejection = Refusal;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, Refusal> {
        let pairs = Query::<Vec<(String, String)>>::try_from_uri(&parts.uri)
            .map_err(|error| Refusal::new(ProblemCode::InvalidParameter, error.body_text()))?;
        Ok(Self { pairs: pairs.0, known: Vec::new(), violations: Vec::new() })
    }
}

impl Parameters {
    /// A text; an empty one counts as left out.
    pub fn text(&mut self, name: &'static str) -> Option<String> {
        self.value(name).filter(|value| !value.is_empty())
    }

    /// The value of a parameter, which may be given once.
    fn value(&mut self, name: &'static str) -> Option<String> {
        self.known.push(name);
        let mut values = self.pairs.iter().filter(|(key, _)| key == name).map(|(_, value)| value);
        let value = values.next().cloned();
        if values.next().is_some() {
            self.violations.push(Violation::new(format!("/{name}"), "conflict", "is given more than once"));
        }
        value
    }

    /// A whole number of at least `minimum`; what lies above `maximum` is taken for `maximum` or refused.
    pub fn whole(&mut self, name: &'static str, minimum: u64, maximum: u64, capped: bool) -> Option<u64> {
        let text = self.value(name)?;
        // More digits than 64 bits hold are a large number all the same.
        let is_whole = text.bytes().all(|byte| byte.is_ascii_digit());
        match u64::from_str(&text).or(if is_whole { Ok(u64::MAX) } else { Err(()) }) {
            Ok(value) if value > maximum && capped => return Some(maximum),
            Ok(value) if (minimum..=maximum).contains(&value) => return Some(value),
            _ => {}
        }
        let detail = format!("is \"{}\"; permitted: whole numbers, {minimum} to {maximum}", clip(&text));
        self.violations.push(Violation {
            minimum: Some(minimum as f64),
            maximum: Some(maximum as f64),
            ..Violation::new(format!("/{name}"), "out-of-range", detail)
        });
        None
    }

    /// A finite number.
    pub fn number(&mut self, name: &'static str, unit: &str) -> Option<f64> {
        let text = self.value(name)?;
        let value = f64::from_str(&text).ok().filter(|value| value.is_finite());
        if value.is_none() {
            let detail = format!("is \"{}\"; a finite number is needed, in {unit}", clip(&text));
            let violation = Violation::new(format!("/{name}"), "wrong-type", detail);
            self.violations.push(Violation { unit: Some(unit.to_owned()), ..violation });
        }
        value
    }

    /// One of a closed list of words.
    pub fn choice<T: Copy>(&mut self, name: &'static str, choices: &[(&'static str, T)]) -> Option<T> {
        let text = self.value(name)?;
        self.word(name, &text, choices)
    }

    /// Any of a closed list of words, separated by commas.
    pub fn choices<T: Copy>(&mut self, name: &'static str, choices: &[(&'static str, T)]) -> Vec<T> {
        let Some(text) = self.value(name) else { return Vec::new() };
        text.split(',').filter_map(|word| self.word(name, word, choices)).collect()
    }

    fn word<T: Copy>(&mut self, name: &str, word: &str, choices: &[(&'static str, T)]) -> Option<T> {
        let found = choices.iter().find(|(known, _)| *known == word).map(|(_, value)| *value);
        if found.is_none() {
            let words: Vec<_> = choices.iter().map(|(word, _)| *word).collect();
            let detail = format!("is \"{}\"; permitted: {}", clip(word), words.join(", "));
            self.violations.push(Violation::new(format!("/{name}"), "not-one-of", detail));
        }
        found
    }

    /// Notes a violation that the caller found.
    pub fn violate(&mut self, violation: Violation) {
        self.violations.push(violation);
    }

    /// Refuses when anything was wrong or a parameter was not known.
    pub fn finish(mut self) -> Result<(), Refusal> {
        for (key, _) in &self.pairs {
            if !self.known.contains(&key.as_str()) {
                let known = if self.known.is_empty() { "none".to_owned() } else { self.known.join(", ") };
                let detail = format!("is not a parameter of this path; permitted: {known}");
                self.violations.push(Violation::new(format!("/{}", clip(key)), "unknown-field", detail));
            }
        }
        if self.violations.is_empty() {
            return Ok(());
        }
        let detail = format!("{} query parameter(s) are invalid", self.violations.len());
        Err(Problem::new(ProblemCode::InvalidParameter, detail).with_errors(self.violations).into())
    }
}

fn clip(text: &str) -> String {
    if text.chars().count() <= 60 { text.to_owned() } else { text.chars().take(60).chain(['…']).collect() }
}
