//! Tests of the whole room; `examples/fe_validation.rs` has the long ones.

mod invariants;
mod plane_strain;
mod reference_pair;
mod robustness;
