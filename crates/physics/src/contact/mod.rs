//! Loaded tooth contact of one helix half and of both: tooth and body compliance, load distribution over all tooth pairs
//! in mesh, mesh stiffness, transmission error and load shares over one mesh period.
//!
//! The model (fidelity `analytic`), per member: the tooth (`tooth`) is a clamped plate of its true profile with free end
//! faces (`plate`); the reactions of its root load a three-dimensional elastic ring with free end faces, held at rim or
//! bore (`body`, `ring_influence`); short waves at the root come from a plane-strain annulus (`annulus`); the corners of the
//! end faces give as elastic wedges do (`edge`). `bulk` puts these together over Legendre functions of the
//! face; the contact itself is Hertzian (`hertz`). Fidelity `fe` takes the flexibilities of [`crate::fe`] instead, with the indentation
//! of half-spaces (`half_space`).
//!
//! Either way there is a `compliance`: a table of bulk flexibility (`influence`) and a law of local indentation (`local`). `lines` and `position` put
//! the contact lines of one position together, `distribution` shares the force out by Newton steps of the `system`, `refine` chooses the positions,
//! `cycle` and `halves` run over the mesh period.
//!
//! Everything is SI and along the transverse base tangent unless a name says otherwise; coordinates are those of
//! [`crate::gear`].

mod annulus;
mod body;
mod bulk;
mod coast;
mod compliance;
mod curve;
mod cycle;
mod distribution;
mod edge;
mod equivalent;
mod flank;
mod force_table;
mod half;
mod half_space;
mod halves;
mod hertz;
mod influence;
pub mod iso6336;
mod linalg;
mod lines;
mod local;
mod plate;
mod position;
mod refine;
mod ring_influence;
mod settings;
mod short_face;
mod spline;
mod system;
mod tooth;

pub use coast::solve_coast_halves;
pub use compliance::Compliance;
pub use cycle::{EntryDeflection, Extent, FlankMap, HalfCycle, MESH_IN_PHASE, harmonics};
pub use equivalent::equivalent_stiffness;
pub use flank::{BodyHold, hold_radius_m};
pub use force_table::ForceTable;
pub use half::HalfContact;
pub use halves::{LoadedContact, same_gaps, solve_half, solve_pair_of_halves};
pub use lines::Point;
pub use position::Loaded;
pub use settings::{ContactError, Settings};
pub use short_face::{SHORT_FACE_NOTICE, stiffness_excess};
pub use spline::SplineKnots;

#[cfg(test)]
mod tests;
