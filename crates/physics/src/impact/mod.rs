//! The impact with which a tooth pair enters the mesh: where the deflected teeth meet before the path of contact starts, how
//! fast they meet, and the force that follows from the energy balance.
//!
//! Forces, stiffness and displacements are those of **one helix half**, in the base plane along the transverse base tangent.
//! SI throughout.

mod corner;
mod energy;
mod pulse;

pub use corner::{Entrance, FirstContact, NoEarlyContact, first_contact};
pub use energy::{Entry, Impact, ImpactError, Inertia, mesh_in};
pub use pulse::HalfSine;

#[cfg(test)]
mod tests;
