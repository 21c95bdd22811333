//! Tests of the whole module on real pairs.

mod coast;
mod fidelities;
mod invariants;
mod members;
mod published;
mod reference_pair;
mod robustness;
mod shafts;

use crate::compliance::fixtures::{pair, spec};
