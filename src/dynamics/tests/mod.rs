//! Tests of the equations and methods against independent answers.

mod reference;
