//! A job: the document that goes in, and the result that comes out. No physics, no I/O.

#[cfg(test)]
pub(crate) mod arbitrary;
pub mod document;
pub mod drawing;
mod encoding;
mod fields;
mod finite;
pub mod grid;
mod hints;
mod json;
mod reader;
pub mod result;
pub mod schema;
mod shape;
pub mod study;
#[cfg(test)]
mod tests;
mod violation;
mod warning;

pub use encoding::{EncodingError, utf8_text, without_mark};
pub use fields::{MAX_SERIES_SAMPLES, MAX_SWEEP_POINTS, parse, parse_value};
pub use finite::not_finite;
pub use shape::SweepShape;
pub use violation::{DocumentError, Violation};
pub use warning::Warning;
