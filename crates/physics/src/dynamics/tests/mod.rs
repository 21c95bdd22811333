//! Tests of the equations and the integrators against independent results.

mod allocations;
mod contact_force;
mod drift;
mod harmonic_balance;
mod lanes;
mod order;
mod oscillator;
mod physics;
pub(crate) mod reference;
mod train;
mod variation;
