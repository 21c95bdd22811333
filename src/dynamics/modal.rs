//! Natural frequencies and static deflection with the mean mesh stiffness, in the source's twelve displacements.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde::{Deserialize, Serialize};

use super::error::DynamicsError;
use super::parameters::{Parameters, Spring};

/// Natural frequencies and mode shapes of the undamped system with mean mesh stiffness and closed contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NaturalModes {
    /// Ascending, Hz; motions that nothing holds have 0.
    pub frequencies_hz: Vec<f64>,
    /// One per frequency, in the source's order of displacements, normalised to φᵀ M φ = 1.
    pub shapes: Vec<[f64; 12]>,
}

/// Squared frequencies below this fraction of the largest are motions that nothing holds: far above rounding (1e-15), far
/// below any spring that matters.
const RIGID: f64 = 1e-12;

impl NaturalModes {
    /// Solves K φ = ω² M φ by the eigenvalues of M^-½ K M^-½.
    pub fn new(p: &Parameters) -> Result<Self, DynamicsError> {
        p.validate()?;
        let k = stiffness_matrix(p);
        let root = masses(p).map(|m| 1.0 / m.sqrt());
        let scaled = DMatrix::from_fn(12, 12, |r, c| k[(r, c)] * root[r] * root[c]);
        let eigen = SymmetricEigen::try_new(scaled, f64::EPSILON, 10_000).ok_or(DynamicsError::InvalidParameter {
            name: "stiffness matrix",
            value: k.amax(),
            reason: "its eigenvalues cannot be computed",
        })?;
        let mut order: Vec<usize> = (0..12).collect();
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let largest = eigen.eigenvalues.amax();
        let frequencies_hz = order
            .iter()
            .map(|&i| eigen.eigenvalues[i])
            .map(|l| if l > RIGID * largest { l.sqrt() / std::f64::consts::TAU } else { 0.0 })
            .collect();
        let shapes = order.iter().map(|&i| std::array::from_fn(|c| eigen.eigenvectors[(c, i)] * root[c])).collect();
        Ok(Self { frequencies_hz, shapes })
    }

    /// The shapes of the motions that nothing holds.
    pub fn free_motions(&self) -> impl Iterator<Item = &[f64; 12]> {
        self.shapes.iter().zip(&self.frequencies_hz).filter(|(_, f)| **f == 0.0).map(|(shape, _)| shape)
    }

    /// Deflection under the mean torques with the mean mesh stiffness, no impact, each half pressed to the flank its torque asks
    /// for; nothing moved along free motions.
    pub fn static_deflection(&self, p: &Parameters) -> [f64; 12] {
        let mut force = torques(p);
        for j in 0..2 {
            let side = if p.halves[j].pinion_torque_nm < 0.0 { -1.0 } else { 1.0 };
            let seat = p.halves[j].mesh_stiffness.mean_n_per_m() * side * p.half_backlash_m;
            force += mesh_direction(p, j) * seat;
        }
        let mut q = [0.0; 12];
        for (shape, f) in self.shapes.iter().zip(&self.frequencies_hz) {
            if *f > 0.0 {
                let omega = f * std::f64::consts::TAU;
                let amount = (0..12).map(|c| shape[c] * force[c]).sum::<f64>() / (omega * omega);
                for c in 0..12 {
                    q[c] += amount * shape[c];
                }
            }
        }
        q
    }
}

/// s_j as a row over the twelve displacements.
pub(super) fn mesh_direction(p: &Parameters, j: usize) -> DVector<f64> {
    let (sin, cos) = p.helix_angle_rad.sin_cos();
    let sin = if j == 0 { sin } else { -sin };
    let mut e = DVector::zeros(12);
    let half = [cos, sin, cos * p.pinion_radius_m, -cos, -sin, -cos * p.gear_radius_m];
    for (c, value) in half.into_iter().enumerate() {
        e[6 * j + c] = value;
    }
    e
}

fn torques(p: &Parameters) -> DVector<f64> {
    let mut f = DVector::zeros(12);
    for (j, h) in p.halves.iter().enumerate() {
        f[6 * j + 2] = h.pinion_torque_nm;
        f[6 * j + 5] = -h.pinion_torque_nm * p.gear_radius_m / p.pinion_radius_m;
    }
    f
}

fn masses(p: &Parameters) -> [f64; 12] {
    std::array::from_fn(|i| {
        let h = &p.halves[i / 6];
        match i % 6 {
            0 | 1 => h.pinion_mass_kg,
            2 => h.pinion_inertia_kg_m2,
            3 | 4 => h.gear_mass_kg,
            _ => h.gear_inertia_kg_m2,
        }
    })
}

fn stiffness_matrix(p: &Parameters) -> DMatrix<f64> {
    let mut k = DMatrix::zeros(12, 12);
    let between = |k: &mut DMatrix<f64>, c: usize, spring: Spring| {
        k[(c, c)] += spring.stiffness;
        k[(c + 6, c + 6)] += spring.stiffness;
        k[(c, c + 6)] -= spring.stiffness;
        k[(c + 6, c)] -= spring.stiffness;
    };
    for (j, h) in p.halves.iter().enumerate() {
        let i = 6 * j;
        k[(i, i)] += h.pinion_lateral.stiffness;
        k[(i + 1, i + 1)] += h.pinion_axial.stiffness;
        k[(i + 3, i + 3)] += h.gear_lateral.stiffness;
        k[(i + 4, i + 4)] += h.gear_axial.stiffness;
        let e = mesh_direction(p, j);
        k += &e * e.transpose() * h.mesh_stiffness.mean_n_per_m();
    }
    let c = &p.couplings;
    between(&mut k, 0, c.pinion_lateral);
    between(&mut k, 1, c.pinion_axial);
    between(&mut k, 2, c.pinion_torsion);
    between(&mut k, 3, c.gear_lateral);
    between(&mut k, 4, c.gear_axial);
    between(&mut k, 5, c.gear_torsion);
    k
}
