//! Job documents, their results, and the stages of a calculation between them. No physics, no I/O.

#[cfg(test)]
pub(crate) mod arbitrary;
pub mod document;
pub mod drawing;
mod encoding;
mod field;
mod finite;
pub mod gear_data;
pub mod grid;
mod hints;
mod json;
mod path;
mod reader;
pub mod result;
pub mod schema;
mod shape;
pub mod study;
#[cfg(test)]
mod tests;
pub mod unit;
mod violation;
mod warning;

pub use document::{MAX_EVALUATIONS, MAX_SERIES_SAMPLES, MAX_SWEEP_POINTS, parse, parse_json, parse_value};
pub use encoding::{EncodingError, utf8_text, without_mark};
pub use finite::not_finite;
pub use shape::SweepShape;
pub use violation::{DocumentError, Violation};
pub use warning::Warning;
