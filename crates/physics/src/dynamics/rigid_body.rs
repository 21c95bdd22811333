//! Rigid-body modes: rotation of each half, and the screw motion of a floating pinion; those of a train.
//!
//! No spring acts along them and their momentum is conserved, so a motion drifts along them at a constant velocity and
//! a perturbation along them stays constant or grows linearly in time. They are removed before a motion is tested for
//! periodicity or stability.

use super::equations::{PER_HALF, U, YG, YP};
use super::error::DynamicsError;
use super::model::DynamicModel;
use super::shooting::rigid_body_modes;
use super::variation::Perturbation;

/// Rigid-body modes of a model, normalised to nᵀ M n = 1.
#[derive(Debug, Clone)]
pub(crate) struct RigidBodyModes<const D: usize> {
    shapes: Vec<[f64; D]>,
    masses: [f64; D],
}

impl<const D: usize> RigidBodyModes<D> {
    /// The modes do not depend on the value of the mesh stiffness. It is set such that the mesh is no slower than the
    /// fastest spring.
    ///
    /// # Errors
    /// [`DynamicsError::InvalidParameter`] when the eigenvalues of the stiffness matrix cannot be computed.
    pub(crate) fn new(model: &DynamicModel<D>) -> Result<Self, DynamicsError> {
        let active: Vec<usize> = model.active().collect();
        let masses = model.masses_kg();
        if DynamicModel::<D>::IS_TRAIN {
            return Ok(Self { shapes: rigid_body_modes(model, &active, &masses, [0.0; 2])?, masses });
        }
        let mesh = |j: usize| {
            let m = &masses[(j * PER_HALF).min(D - PER_HALF)..];
            model.omega_ref * model.omega_ref / (1.0 / m[YP] + 1.0 / m[YG] + 1.0 / m[U])
        };
        Ok(Self { shapes: rigid_body_modes(model, &active, &masses, [mesh(0), mesh(1)])?, masses })
    }

    /// No modes: projections are the identity.
    pub(crate) fn none() -> Self {
        Self { shapes: Vec::new(), masses: [0.0; D] }
    }

    /// Number of modes.
    pub(super) fn count(&self) -> usize {
        self.shapes.len()
    }

    /// Projection of a displacement or velocity onto the complement of the rigid-body modes.
    pub(crate) fn project_out_of(&self, mut q: [f64; D]) -> [f64; D] {
        for n in &self.shapes {
            let along: f64 = (0..D).map(|c| n[c] * self.masses[c] * q[c]).sum();
            for c in 0..D {
                q[c] -= along * n[c];
            }
        }
        q
    }

    /// The same projection of displacements and velocities.
    pub(crate) fn project_out(&self, d: &Perturbation<D>) -> Perturbation<D> {
        (self.project_out_of(d.0), self.project_out_of(d.1))
    }
}
