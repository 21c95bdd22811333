//! Loaded contact of both halves together on elastic shafts.
//!
//! The shafts are beams ([`crate::shafts`]); the teeth and the contact are those of one half. For every point i of a
//! possible contact of either half, with normal force f_i ≥ 0:
//!
//! ```text
//! g_i + Σ_j (C_teeth + C_pinion + C_gear)_ij f_j − cosβ_b δ − n_z,i ζ = 0  where f_i > 0,  ≥ 0 where f_i = 0
//! Σ f_i cosβ_b r_b1 = T,     Σ f_i n_z,i = 0 where a member floats axially
//! ```
//!
//! δ is the base-tangent displacement between the couplings, ζ the axial shift of the floating member. Everything is
//! SI.

mod cycle;
mod face_load;
mod flexibility;
mod frame;
mod mesh_section;
mod modification;
mod position;
mod system;

pub use cycle::{LoadOnShafts, LoadedContactOnShafts, ShaftState, load_on_shafts, solve_on_shafts};
pub use face_load::{FaceLoad, HalfOnShafts};
pub use flexibility::{AxialFreedom, ContactShafts, DisplacementField};
pub use frame::{Hand, MeshFrame, sense_of_rotation};
pub use mesh_section::MeshSection;
pub use modification::{HelixModification, evening_modification, helix_modification, with_helix_modification};

pub(crate) use flexibility::HalfFlexibility;

/// Helix angles below this leave no axial coupling.
const SPUR: f64 = 1e-4;

/// What the teeth of a half stand on.
#[derive(Clone, Copy)]
pub(crate) enum Mount<'a> {
    /// Rigid bodies on rigid shafts.
    Rigid,
    /// Bodies on elastic shafts.
    Shafts(&'a HalfFlexibility),
    /// Bodies displaced as by the shafts under the working load, and held there.
    Displaced(&'a DisplacementField),
}
