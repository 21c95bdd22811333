//! Query parameters. All violations are reported at once; unknown parameters are violations.

use crate::api::problem::{ApiError, Problem, ProblemCode};
use axum::extract::{FromRequestParts, Query};
use axum::http::request::Parts;
use herringbone_job::Violation;
use jiff::Timestamp;
use jiff::civil::Date;
use jiff::tz::TimeZone;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// The query parameters of a request: each known one is read by a method, then [`QueryParameters::finish`] is called.
#[derive(Debug)]
pub(crate) struct QueryParameters {
    pairs: Vec<(String, String)>,
    known: Vec<&'static str>,
    violations: Vec<Violation>,
}

impl<S: Send + Sync> FromRequestParts<S> for QueryParameters {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _state: &S) -> Result<Self, ApiError> {
        let pairs = Query::<Vec<(String, String)>>::try_from_uri(&parts.uri)
            .map_err(|error| ApiError::new(ProblemCode::InvalidParameter, error.body_text()))?;
        Ok(Self { pairs: pairs.0, known: Vec::new(), violations: Vec::new() })
    }
}

impl QueryParameters {
    /// A text of at most `max_chars` characters; `None` when it is empty or absent.
    pub(crate) fn short_text(&mut self, name: &'static str, max_chars: usize) -> Option<String> {
        let text = self.text(name)?;
        let length = text.chars().count();
        if length > max_chars {
            let detail = format!("has {length} characters; permitted: at most {max_chars}");
            let violation = Violation::new(format!("/{name}"), "too-long", detail);
            self.violations.push(Violation { maximum: Some(max_chars as f64), ..violation });
            return None;
        }
        Some(text)
    }

    /// A text; `None` when it is empty or absent.
    pub(crate) fn text(&mut self, name: &'static str) -> Option<String> {
        self.value(name).filter(|value| !value.is_empty())
    }

    /// The value of a parameter, which may occur once.
    fn value(&mut self, name: &'static str) -> Option<String> {
        self.known.push(name);
        let mut values = self.pairs.iter().filter(|(key, _)| key == name).map(|(_, value)| value);
        let value = values.next().cloned();
        if values.next().is_some() {
            self.violations.push(Violation::new(format!("/{name}"), "conflict", "is given more than once"));
        }
        value
    }

    /// An integer of at least `minimum`. A value above `maximum` is reduced to `maximum` if `capped`, else a violation.
    pub(crate) fn integer(&mut self, name: &'static str, minimum: u64, maximum: u64, capped: bool) -> Option<u64> {
        let text = self.value(name)?;
        // More digits than 64 bits hold are still a large integer.
        let is_integer = text.bytes().all(|byte| byte.is_ascii_digit());
        match u64::from_str(&text).or(if is_integer { Ok(u64::MAX) } else { Err(()) }) {
            Ok(value) if value > maximum && capped => return Some(maximum),
            Ok(value) if (minimum..=maximum).contains(&value) => return Some(value),
            _ => {}
        }
        let detail = format!("is \"{}\"; permitted: whole numbers, {minimum} to {maximum}", truncate(&text));
        self.violations.push(Violation {
            minimum: Some(minimum as f64),
            maximum: Some(maximum as f64),
            ..Violation::new(format!("/{name}"), "out-of-range", detail)
        });
        None
    }

    /// A finite number; `unit` is named in the violation.
    pub(crate) fn number(&mut self, name: &'static str, unit: &str) -> Option<f64> {
        let text = self.value(name)?;
        let value = f64::from_str(&text).ok().filter(|value| value.is_finite());
        if value.is_none() {
            let detail = format!("is \"{}\"; a finite number is needed, in {unit}", truncate(&text));
            let violation = Violation::new(format!("/{name}"), "wrong-type", detail);
            self.violations.push(Violation { unit: Some(unit.to_owned()), ..violation });
        }
        value
    }

    /// A finite number in a range; `unit` is named in the violation.
    pub(crate) fn number_within(&mut self, name: &'static str, unit: &str, range: RangeInclusive<f64>) -> Option<f64> {
        let value = self.number(name, unit)?;
        if range.contains(&value) {
            return Some(value);
        }
        let (minimum, maximum) = (*range.start(), *range.end());
        let detail = format!("is {value}; permitted: {minimum} to {maximum}, in {unit}");
        self.violations.push(Violation {
            minimum: Some(minimum),
            maximum: Some(maximum),
            unit: Some(unit.to_owned()),
            ..Violation::new(format!("/{name}"), "out-of-range", detail)
        });
        None
    }

    /// A time: RFC 3339, or a date, which stands for its start in UTC.
    pub(crate) fn time(&mut self, name: &'static str) -> Option<Timestamp> {
        let text = self.value(name)?;
        let start_of = |date: Date| date.to_zoned(TimeZone::UTC).map(|start| start.timestamp());
        let time = Timestamp::from_str(&text).or_else(|_| Date::from_str(&text).and_then(start_of)).ok();
        if time.is_none() {
            let detail = format!("is \"{}\"; needed: a time such as 2026-01-31T08:00:00Z, or a date", truncate(&text));
            self.violations.push(Violation::new(format!("/{name}"), "wrong-type", detail));
        }
        time
    }

    /// One of a closed list of names.
    pub(crate) fn choice<T: Copy>(&mut self, name: &'static str, choices: &[(&'static str, T)]) -> Option<T> {
        let text = self.value(name)?;
        self.look_up(name, &text, choices)
    }

    /// Any number of names of a closed list, separated by commas.
    pub(crate) fn choices<T: Copy>(&mut self, name: &'static str, choices: &[(&'static str, T)]) -> Vec<T> {
        let Some(text) = self.value(name) else { return Vec::new() };
        text.split(',').filter_map(|value| self.look_up(name, value, choices)).collect()
    }

    fn look_up<T: Copy>(&mut self, name: &str, text: &str, choices: &[(&'static str, T)]) -> Option<T> {
        let choice = choices.iter().find(|(known, _)| *known == text).map(|(_, value)| *value);
        if choice.is_none() {
            let names: Vec<_> = choices.iter().map(|(name, _)| *name).collect();
            let detail = format!("is \"{}\"; permitted: {}", truncate(text), names.join(", "));
            self.violations.push(Violation::new(format!("/{name}"), "not-one-of", detail));
        }
        choice
    }

    /// Adds a violation found by the caller.
    pub(crate) fn add_violation(&mut self, violation: Violation) {
        self.violations.push(violation);
    }

    /// Ends the reading.
    ///
    /// # Errors
    /// 400 with all violations, if there are any, including parameters that were not read.
    pub(crate) fn finish(mut self) -> Result<(), ApiError> {
        for (key, _) in &self.pairs {
            if !self.known.contains(&key.as_str()) {
                let known = if self.known.is_empty() { "none".to_owned() } else { self.known.join(", ") };
                let detail = format!("is not a parameter of this path; permitted: {known}");
                self.violations.push(Violation::new(format!("/{}", truncate(key)), "unknown-field", detail));
            }
        }
        if self.violations.is_empty() {
            return Ok(());
        }
        let detail = format!("{} query parameter(s) are invalid", self.violations.len());
        Err(Problem::new(ProblemCode::InvalidParameter, detail).with_errors(self.violations).into())
    }
}

/// The first 60 characters.
fn truncate(text: &str) -> String {
    if text.chars().count() <= 60 { text.to_owned() } else { text.chars().take(60).chain(['…']).collect() }
}
