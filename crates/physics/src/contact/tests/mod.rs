//! Tests of the whole module on real pairs.

mod coast;
mod fidelities;
mod invariants;
mod members;
mod published;
mod reference_pair;
mod robustness;

use crate::compliance::fixtures::{pair, spec};
