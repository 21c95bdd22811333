//! Drive train reduced to modal coordinates: shafts, bearings and bodies of any number of degrees of freedom.

use super::error::DynamicsError;
use super::modal::RIGID_BODY_EIGENVALUE;

/// Largest number of coordinates that are no rigid-body modes.
pub const MAX_ELASTIC_MODES: usize = 96;
/// Largest number of rigid-body modes.
pub const MAX_RIGID_BODY_MODES: usize = 4;
/// Largest number of further quantities of a train.
pub const MAX_LINEAR_OUTPUTS: usize = 1000;

/// Units of the further quantities.
pub const OUTPUT_UNITS: [&str; 8] = ["m", "m/s", "m/s2", "rad", "rad/s", "rad/s2", "N", "N m"];

/// Equations of motion of a drive train reduced to coordinates q (m √kg) of unit modal mass (1 kg):
///
/// ```text
/// q̈ + D q̇ + diag(λ) q + K_x q = load + Σ_j mesh_j (k_ref,j s_j − F_j)        s_j = mesh_j · q
/// ```
///
/// F_j is the normal mesh force of half j, with its damper. λ are the eigenvalues of the undamped train closed with the
/// reference mesh stiffnesses k_ref; they choose the coordinates and have no influence on the exact solution.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalTrain {
    /// λ, rad²/s²; 0 (or below 1e-12 of the largest) for rigid-body modes, in any order.
    pub eigenvalues_rad2_s2: Vec<f64>,
    /// D, n×n by rows, 1/s: dampers and gyroscopic terms, without the mesh dampers.
    pub damping_per_s: Vec<f64>,
    /// K_x, n×n by rows, 1/s²: stiffness of bearings with unequal cross terms that is not in λ.
    pub cross_stiffness_per_s2: Option<Vec<f64>>,
    /// Rows of s_j of the left and the right half, 1/√kg: displacement of the flanks along the tooth normal. Positive s
    /// closes the driving flanks.
    pub mesh: [Vec<f64>; 2],
    /// k_ref of the left and the right half, N/m.
    pub reference_stiffness_n_per_m: [f64; 2],
    /// Modal forces of the torques, N/√kg.
    pub load_n: Vec<f64>,
    /// Rows of the twelve displacements y_p, z_p, θ_p, y_g, z_g, θ_g of the mid-face sections, left half, then right
    /// half (y along the mesh in the transverse plane).
    pub displacements: [Vec<f64>; 12],
    /// Further quantities that are linear in the state, for example bearing forces.
    pub outputs: Vec<LinearOutput>,
}

/// A quantity that is linear in the coordinates and their velocities: `displacement · q + velocity · q̇`.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearOutput {
    /// Name of the channel.
    pub name: String,
    /// SI unit, one of [`OUTPUT_UNITS`].
    pub unit: String,
    /// Row of the coordinates, unit per (m √kg).
    pub displacement: Vec<f64>,
    /// Row of the velocities, unit per (m √kg/s). Empty: zero.
    pub velocity: Vec<f64>,
}

impl ModalTrain {
    /// Number of coordinates.
    pub fn len(&self) -> usize {
        self.eigenvalues_rad2_s2.len()
    }

    /// Whether there are no coordinates; such a train is not valid.
    pub fn is_empty(&self) -> bool {
        self.eigenvalues_rad2_s2.is_empty()
    }

    /// Whether a coordinate is a rigid-body mode.
    pub fn is_rigid_body_mode(&self, coordinate: usize) -> bool {
        let largest = self.eigenvalues_rad2_s2.iter().fold(0.0f64, |m, l| m.max(*l));
        self.eigenvalues_rad2_s2[coordinate] <= RIGID_BODY_EIGENVALUE * largest
    }

    /// Natural frequencies of the undamped train closed with the reference mesh stiffnesses, ascending, Hz; 0 for
    /// rigid-body modes.
    pub fn frequencies_hz(&self) -> Vec<f64> {
        let mut out: Vec<f64> = (0..self.len())
            .map(|i| if self.is_rigid_body_mode(i) { 0.0 } else { self.eigenvalues_rad2_s2[i].sqrt() })
            .map(|omega| omega / std::f64::consts::TAU)
            .collect();
        out.sort_by(f64::total_cmp);
        out
    }

    /// Whether the meshes open together without strain, so that an unloaded train can rest with its flanks touching.
    pub(crate) fn opens_freely(&self) -> bool {
        const STRAINED: f64 = 1e-6;
        // q without forces at s = 1 on both meshes: λ q = Σ mesh k_ref.
        let [left, right] = &self.mesh;
        let [k_left, k_right] = self.reference_stiffness_n_per_m;
        let s = |row: &[f64]| {
            (0..self.len())
                .filter(|&i| !self.is_rigid_body_mode(i))
                .map(|i| row[i] * (left[i] * k_left + right[i] * k_right) / self.eigenvalues_rad2_s2[i])
                .sum::<f64>()
        };
        self.cross_stiffness_per_s2.is_none() && self.mesh.iter().all(|row| (s(row) - 1.0).abs() < STRAINED)
    }

    /// Checks sizes and numbers.
    ///
    /// # Errors
    /// [`DynamicsError::InvalidParameter`] for the first invalid one.
    pub fn validate(&self) -> Result<(), DynamicsError> {
        let invalid = |name, value, reason| Err(DynamicsError::InvalidParameter { name, value, reason });
        let n = self.len();
        if let Some(bad) = self.eigenvalues_rad2_s2.iter().find(|l| !l.is_finite()) {
            return invalid("eigenvalue of the train", *bad, "must be finite");
        }
        let largest = self.eigenvalues_rad2_s2.iter().fold(0.0f64, |m, l| m.max(*l));
        if largest <= 0.0 {
            return invalid("eigenvalue of the train", largest, "at least one must be positive");
        }
        // Rounding of the eigenvalues of a semidefinite matrix; a negative one beyond it is no passive train.
        if let Some(bad) = self.eigenvalues_rad2_s2.iter().find(|l| **l < -1e-9 * largest) {
            return invalid("eigenvalue of the train", *bad, "must not be negative");
        }
        let rigid = (0..n).filter(|&i| self.is_rigid_body_mode(i)).count();
        if rigid > MAX_RIGID_BODY_MODES {
            return invalid("rigid-body modes of the train", rigid as f64, "more than four");
        }
        if n - rigid > MAX_ELASTIC_MODES {
            return invalid("modes of the train", n as f64, "more than 96 besides rigid-body modes");
        }
        let matrix = |name: &'static str, values: &[f64], len: usize| {
            if values.len() != len {
                return invalid(name, values.len() as f64, "wrong number of values");
            }
            values.iter().find(|v| !v.is_finite()).map_or(Ok(()), |bad| invalid(name, *bad, "must be finite"))
        };
        matrix("damping of the train", &self.damping_per_s, n * n)?;
        if let Some(cross) = &self.cross_stiffness_per_s2 {
            matrix("cross stiffness of the train", cross, n * n)?;
        }
        for row in &self.mesh {
            matrix("mesh row of the train", row, n)?;
            if row.iter().all(|c| *c == 0.0) {
                return invalid("mesh row of the train", 0.0, "no coordinate moves the mesh");
            }
        }
        for k in self.reference_stiffness_n_per_m {
            if !(k.is_finite() && k > 0.0) {
                return invalid("reference mesh stiffness", k, "must be positive and finite");
            }
        }
        matrix("load of the train", &self.load_n, n)?;
        for row in &self.displacements {
            matrix("displacement row of the train", row, n)?;
        }
        if self.outputs.len() > MAX_LINEAR_OUTPUTS {
            return invalid("outputs of the train", self.outputs.len() as f64, "more than 1000");
        }
        for output in &self.outputs {
            if !OUTPUT_UNITS.contains(&output.unit.as_str()) {
                return invalid(
                    "unit of an output of the train",
                    f64::NAN,
                    "must be m, rad, N or N m, or a rate of m or rad",
                );
            }
            matrix("output row of the train", &output.displacement, n)?;
            if !output.velocity.is_empty() {
                matrix("output row of the train", &output.velocity, n)?;
            }
        }
        Ok(())
    }
}
