//! Tests of the algorithms on functions with known answers.

mod functions;
mod methods;
mod minimax;
mod random;
mod sets;
mod statistics;
