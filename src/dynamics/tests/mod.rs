//! Tests of the equations and methods against independent answers.

pub(crate) mod reference;
mod variation;
