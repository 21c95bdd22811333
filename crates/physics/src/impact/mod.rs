//! Mesh-in impact: first contact of the deflected teeth before the path of contact starts, velocity of approach there,
//! and the force that follows from the energy balance.
//!
//! Forces, stiffness and displacements are those of **one helix half**, in the base plane along the transverse base
//! tangent. SI throughout.

mod corner;
mod energy;

pub use corner::{EntryContact, FirstContact, NoEarlyContact, first_contact};
pub use energy::{ImpactError, Inertia, MeshInConditions, MeshInImpact, mesh_in};

#[cfg(test)]
mod tests;
