//! Equations of motion of a double-helical gear pair: parameters, natural modes, numerical integration.
//!
//! The model is that of the source paper, *Effect of Contact Ratio on Dynamic Behavior of a Herringbone Gear Nonlinear
//! System*, section 2: twelve coupled bending, torsional and axial degrees of freedom. All quantities are in SI units.
//!
//! # Degrees of freedom
//! Each helix half has six displacements: y (m, lateral, along the mesh in the transverse plane),
//! z (m, axial) and θ (rad) of the pinion, then of the gear. Vectors of 12 hold, in this order, y_p, z_p,
//! θ_p, y_g, z_g, θ_g of the left half, then those of the right half; vectors of 24 hold the displacements, then the
//! velocities.
//!
//! # Equations
//! For half j, with β_1 = β and β_2 = −β:
//!
//! ```text
//! x_j = y_pj − y_gj + R_p θ_pj − R_g θ_gj         s_j = cosβ x_j + sinβ_j (z_pj − z_gj)
//! F_n = c_m ds_j/dt + k_m(t) f(s_j)               F_y = cosβ F_n    F_z = sinβ_j F_n
//! f(s) = s − b (s > b),  0 (|s| ≤ b),  s + b (s < −b)
//! ```
//!
//! The mesh force acts on y, z and θ. The impact force F_s acts on the two torsional equations of its half, as in the
//! source paper, or on y, z and θ like the mesh force ([`ImpactActsOn`]). Options beyond the source paper: no mesh
//! damping in the gap, springs between the halves of a shaft, an axial support of the pinion, and a mesh force
//! tabulated by the contact analysis ([`ContactForce`]). The reference plane (pitch plane: R pitch radius, β; base
//! plane: R_b, β_b) is set by the radii and the helix angle of [`Parameters`].
//!
//! # Reduced trains
//! With [`Parameters::train`] the linear part is that of a [`ModalTrain`]: shafts, bearings and bodies in modal
//! coordinates. Mesh forces, impacts, damping in the gap and displacement excitations act as above, along the rows of s
//! that the train gives. Vectors of 12 and 24 are then those of the mid-face sections.
//!
//! # Validation
//! Three reference cases solved event-exact in 113-bit arithmetic (`tests/reference.rs`): states after 1, 5 and 20 mesh
//! periods within 1e-13 (contact kept; period-2 motion) and 1e-11 (chaotic motion), RMS within 1e-13, by the Taylor
//! method at its finest tolerance. Amplitudes and jumps of the clearance oscillator (`tests/oscillator.rs`); twelve
//! coupled natural frequencies to five digits, energy, symmetry and scaling (`tests/physics.rs`); measured orders of
//! convergence (`tests/order.rs`); the monodromy matrix against differences of motions (`tests/variation.rs`); the
//! twelve equations as a train, and trains against closed forms (`tests/train.rs`).

// Loops over coordinates and Taylor orders are written with an index, as the formulas are.
#![allow(clippy::needless_range_loop)]

mod broyden;
mod complex_modes;
mod contact_force;
mod crossing;
mod elastic_system;
mod equations;
mod error;
mod excitation;
mod expansion;
mod frequency_response;
mod harmonic_balance;
mod harmonic_grid;
mod harmonic_preconditioner;
mod integrate;
mod lane_batch;
mod lanes;
mod modal;
mod modal_train;
mod model;
mod parameters;
mod recurrence;
mod rigid_body;
mod runge_kutta;
mod segment;
mod shooting;
mod taylor;
mod train_equations;
mod train_modes;
mod train_variation;
mod trajectory;
mod variation;

pub use contact_force::{ContactForce, FlankForce};
pub use error::DynamicsError;
pub use excitation::{Harmonic, ImpactExcitation, Stiffness, StiffnessCurve};
pub use integrate::{Integrator, StepCounts};
pub use modal::{Mode, NaturalModes, SpringGroup};
pub use modal_train::{
    LinearOutput, MAX_ELASTIC_MODES, MAX_LINEAR_OUTPUTS, MAX_RIGID_BODY_MODES, ModalTrain, OUTPUT_UNITS,
};
pub use model::ContactSide;
pub use parameters::{
    Couplings, HalfParameters, ImpactActsOn, Parameters, Spring, equivalent_mass_kg, mesh_damping_n_s_per_m,
};
pub use trajectory::{FinalState, advance, advance_many};

pub(crate) use broyden::BroydenSteps;
pub(crate) use equations::{PER_HALF, U, W, YG, YP, ZG, ZP, is_rigid_rotation, is_train, solved_halves};
pub(crate) use excitation::MAX_ORDER;
pub(crate) use harmonic_balance::{HarmonicBalance, HarmonicOrbit};
pub(crate) use integrate::{DIVERGENCE_LIMIT_M, Motion};
pub(crate) use lane_batch::{POINTS_PER_TASK, TrajectoryObserver, integrate_trajectories, integrate_trajectory};
pub(crate) use model::{DynamicModel, MotionState};
pub(crate) use rigid_body::RigidBodyModes;
pub(crate) use segment::{Observer, Segment, Unobserved};
pub(crate) use shooting::{IntegrationLimits, Shooting};
pub(crate) use train_equations::{TrainEquations, dot as row_product};
pub(crate) use trajectory::{is_mirrored, number_of_coordinates};
pub(crate) use variation::{ObserverPair, Perturbation, Variation, state_difference};

#[cfg(test)]
pub(crate) mod tests;
