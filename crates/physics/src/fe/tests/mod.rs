//! Tests of the whole module; `tools/src/bin/fe_validation.rs` has the long ones.

mod invariants;
mod plane_strain;
mod reference_pair;
mod robustness;
