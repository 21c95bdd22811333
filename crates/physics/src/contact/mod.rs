//! Loaded tooth contact of one helix half and of both: load distribution over all tooth pairs in mesh, mesh stiffness,
//! transmission error and load shares over one mesh period, on a [`Compliance`](crate::compliance::Compliance).
//!
//! `lines` and `position` put the contact lines of one position together, `distribution` shares the force out by Newton
//! steps of the `system`, `refine` chooses the positions, `cycle` and `halves` run over the mesh period; `shafts` does
//! all that for both halves together on elastic shafts.
//!
//! Everything is SI and along the transverse base tangent unless a name says otherwise; coordinates are those of
//! [`crate::gear`].

mod coast;
mod cycle;
mod distribution;
mod equivalent;
mod error;
mod force_table;
mod half;
mod halves;
mod lines;
mod memory;
mod point_contacts;
mod position;
mod refine;
mod shafts;
mod short_face;
mod system;

pub use coast::solve_coast_halves;
pub use cycle::{CurveStatistics, EntryDeflection, FlankMap, HalfCycle, MESH_IN_PHASE, harmonics};
pub use equivalent::equivalent_stiffness;
pub use error::ContactError;
pub use force_table::ForceTable;
pub use half::HalfContact;
pub use halves::{LoadedContact, same_gaps, solve_half, solve_pair_of_halves};
pub use lines::ContactPoint;
pub use memory::{ComplianceModel, ContactMemory, ContactSizes};
pub use position::LoadedPosition;
pub use shafts::{
    AxialFreedom, ContactShafts, DisplacementField, FaceLoad, HalfOnShafts, Hand, HelixModification, LoadOnShafts,
    LoadedContactOnShafts, MeshFrame, MeshSection, ShaftState, evening_modification, helix_modification,
    load_on_shafts, sense_of_rotation, solve_on_shafts, with_helix_modification,
};
pub use short_face::{SHORT_FACE_NOTICE, stiffness_excess};

#[cfg(test)]
mod tests;
