//! Motions that nothing holds, set apart from the rest: the free rotations, and the screw motion of a floating pinion.
//!
//! They neither decay nor grow nor act on anything: their momentum is conserved, so a motion that is not started with just
//! the right share of it drifts at a constant speed for ever, and a perturbation along them stays or grows in proportion to time. Whether
//! a motion repeats and whether its neighbours leave it is a question to what remains when they are taken out.

use super::equations::{PER_HALF, U, YG, YP};
use super::error::DynamicsError;
use super::model::Model;
use super::shooting::rigid_body_modes;
use super::variation::Perturbation;

/// The free motions of a model, normalised to nᵀ M n = 1.
#[derive(Debug, Clone)]
pub(crate) struct RigidBodyModes<const D: usize> {
    shapes: Vec<[f64; D]>,
    masses: [f64; D],
}

impl<const D: usize> RigidBodyModes<D> {
    /// Which motions nothing holds does not depend on how stiff the mesh is, only on that it is stiff: it is taken so stiff that it
    /// is no slower than the fastest spring.
    ///
    /// # Errors
    /// [`DynamicsError::InvalidParameter`] when the stiffness matrix has no eigenvalues that can be computed.
    pub fn new(model: &Model<D>) -> Result<Self, DynamicsError> {
        let active: Vec<usize> = model.active().collect();
        let masses = model.masses_kg();
        let mesh = |j: usize| {
            let m = &masses[(j * PER_HALF).min(D - PER_HALF)..];
            model.omega_ref * model.omega_ref / (1.0 / m[YP] + 1.0 / m[YG] + 1.0 / m[U])
        };
        Ok(Self { shapes: rigid_body_modes(model, &active, &masses, [mesh(0), mesh(1)])?, masses })
    }

    /// No free motion is taken out.
    pub fn none() -> Self {
        Self { shapes: Vec::new(), masses: [0.0; D] }
    }

    /// What remains of a displacement or velocity without its part along free motions.
    pub fn project_out_of(&self, mut q: [f64; D]) -> [f64; D] {
        for n in &self.shapes {
            let along: f64 = (0..D).map(|c| n[c] * self.masses[c] * q[c]).sum();
            for c in 0..D {
                q[c] -= along * n[c];
            }
        }
        q
    }

    /// The same of displacements and velocities.
    pub fn project_out(&self, d: &Perturbation<D>) -> Perturbation<D> {
        (self.project_out_of(d.0), self.project_out_of(d.1))
    }
}
