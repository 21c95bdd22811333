//! Tests of the equations and methods against independent answers.

mod contact_force;
mod cost;
mod drift;
mod lanes;
mod order;
mod oscillator;
mod physics;
pub(crate) mod reference;
mod variation;
