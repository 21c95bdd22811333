//! The twelve equations of motion of a double-helical pair, their natural frequencies and the methods that solve them.
//!
//! Everything is SI. Each helix half has six displacements: y (along the mesh in the transverse plane), z (axial) and θ of pinion and gear.
//! For half j, with β_1 = β and β_2 = −β:
//!
//! ```text
//! x_j = y_pj − y_gj + R_p θ_pj − R_g θ_gj         s_j = cosβ x_j + sinβ_j (z_pj − z_gj)
//! F_n = c_m ds_j/dt + k_m(t) f(s_j)               F_y = cosβ F_n    F_z = sinβ_j F_n
//! f(s) = s − b (s > b),  0 (|s| ≤ b),  s + b (s < −b)
//! ```
//!
//! The mesh forces act on y, z and θ, the impact F_s on the two torsional equations of its half only, as the source paper writes
//! it, or on y, z and θ like a mesh force (an option). Damping in the gap and springs between the halves of a shaft are options. The plane in use (pitch: R pitch radius, β; base: R_b, β_b) is the caller's choice: it passes the radii and the angle.
//!
//! # How it was validated
//! Three reference cases solved event-exact in 113-bit arithmetic (`tests/reference.rs`): states after 1, 5 and 20 mesh periods within
//! 1e-13 (with contact kept, and on a period-2 motion) and 1e-11 (chaotic), RMS within 1e-13, by the Taylor method at its finest.
//! The clearance oscillator's amplitudes and jumps (`tests/oscillator.rs`), twelve coupled natural frequencies to five
//! digits, energy, symmetry and scaling (`tests/physics.rs`), measured orders (`tests/order.rs`), the linear map against
//! differences of motions (`tests/variation.rs`).

// Loops over coordinates and Taylor orders read as the formulas do with an index.
#![allow(clippy::needless_range_loop)]

mod contact_force;
mod crossing;
mod equations;
mod error;
mod excitation;
mod expansion;
mod integrate;
mod lane_batch;
mod lanes;
mod modal;
mod model;
mod parameters;
mod recurrence;
mod rigid_body;
mod runge_kutta;
mod segment;
mod shooting;
mod taylor;
mod trajectory;
mod variation;

pub use contact_force::{ContactForce, FlankForce};
pub use error::DynamicsError;
pub use excitation::{Harmonic, ImpactExcitation, Stiffness};
pub use integrate::{Integrator, StepCounts};
pub use modal::NaturalModes;
pub use model::ContactSide;
pub use parameters::{
    Couplings, HalfParameters, ImpactActsOn, Parameters, Spring, equivalent_mass_kg, mesh_damping_n_s_per_m,
};
pub use trajectory::{FinalState, advance, advance_many};

pub(crate) use equations::{PER_HALF, U, W, YG, YP, ZG, ZP};
pub(crate) use excitation::MAX_ORDER;
pub(crate) use integrate::Motion;
pub(crate) use lane_batch::{TrajectoryObserver, integrate_trajectories, integrate_trajectory};
pub(crate) use model::{DynamicModel, MotionState};
pub(crate) use rigid_body::RigidBodyModes;
pub(crate) use segment::{Observer, Segment, Unobserved};
pub(crate) use shooting::{IntegrationLimits, Shooting};
pub(crate) use trajectory::is_mirrored;
pub(crate) use variation::{ObserverPair, Perturbation, Variation, state_difference};

#[cfg(test)]
pub(crate) mod tests;
