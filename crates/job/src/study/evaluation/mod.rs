//! Evaluations of a document with values put in: what an optimisation and a tolerance study are made of.
//!
//! A job is a list of rows in a fixed order, and each row follows from those before it. A job that was stopped goes
//! through the same list again and takes the rows that are stored: so it continues to the last bit, without any other
//! state.

mod check;
mod evaluator;
mod inputs;
mod measure;
mod rows;
mod shortfall;
mod task;

pub(super) use check::{Found, check_measure, check_pointers};
pub(super) use evaluator::{Evaluator, Outcome, SEARCH_ACCURACY, SEARCH_POSITIONS};
pub(super) use inputs::Inputs;
pub(super) use measure::{Level, Measure, reduce};
pub(super) use rows::{Evaluate, Rows};

pub use inputs::{document_at, document_of_input};
pub use measure::is_measure;
pub use task::{EvaluationBatch, EvaluationSettings, EvaluationTask};
