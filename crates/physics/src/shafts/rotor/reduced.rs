//! The reduced rotor: its matrices, the equations of motion that it hands over, its response to harmonic excitations.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector, Matrix2};

use super::RotorBearing;
use super::modes::RotorModes;
use super::reduction::{LOSS_FACTOR, ReductionReport, projected_row};
use super::response::{FrequencyResponse, Harmonics};
use crate::dynamics::{LinearOutput, ModalTrain};
use crate::shafts::error::ShaftError;

/// A rotor reduced to modal coordinates.
#[derive(Debug, Clone)]
pub struct ReducedRotor {
    /// The natural modes kept.
    pub modes: RotorModes,
    /// What was kept, and its accuracy.
    pub report: ReductionReport,
    pub(super) projection: Projection,
    /// Modal forces per torque on the pinion.
    pub(super) load_per_nm: DVector<f64>,
    /// Modal forces of the constant tilting moments of the meshes.
    pub(super) tilting_load: DVector<f64>,
    pub(super) displacements: [Vec<f64>; 12],
    pub(super) outputs: Vec<LinearOutput>,
}

/// The matrices of the rotor over the vectors of a basis.
#[derive(Debug, Clone)]
pub(super) struct Projection {
    pub(super) vectors: DMatrix<f64>,
    /// ω² of the coordinates, meshes closed.
    pub(super) eigenvalues: Vec<f64>,
    pub(super) damping: DMatrix<f64>,
    /// Per angular velocity of the pinion.
    pub(super) gyroscopic: DMatrix<f64>,
    pub(super) cross_stiffness: DMatrix<f64>,
    pub(super) mesh: [DVector<f64>; 2],
    pub(super) mesh_stiffness_n_per_m: [f64; 2],
    pub(super) mesh_damping_n_s_per_m: [f64; 2],
    pub(super) bearings: [Vec<ReducedBearing>; 2],
}

/// Rows of the six forces of a bearing over displacements and velocities of the coordinates.
#[derive(Debug, Clone)]
pub(super) struct ReducedBearing {
    pub(super) displacement: DMatrix<f64>,
    pub(super) velocity: DMatrix<f64>,
}

/// Receptances at one frequency: the meshes' displacements and all bearing forces per mesh force, meshes open.
#[derive(Debug, Clone)]
pub(super) struct Receptance {
    pub(super) meshes: Matrix2<Complex<f64>>,
    pub(super) bearings: DMatrix<Complex<f64>>,
}

impl ReducedBearing {
    pub(super) fn new(bearing: &RotorBearing, vectors: &DMatrix<f64>) -> ReducedBearing {
        let section = bearing.section.each_ref().map(|row| projected_row(row, vectors));
        let forces = |matrix: &[[f64; 6]; 6]| {
            DMatrix::from_fn(6, vectors.ncols(), |i, j| -(0..6).map(|u| matrix[i][u] * section[u][j]).sum::<f64>())
        };
        ReducedBearing { displacement: forces(&bearing.stiffness), velocity: forces(&bearing.damping) }
    }
}

impl ReducedRotor {
    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.projection.coordinates()
    }

    /// Equations of motion at a speed of the pinion (rad/s, sign about z), under a torque on the pinion (N m, positive:
    /// the pinion drives).
    pub fn train(&self, pinion_speed_rad_s: f64, pinion_torque_nm: f64) -> ModalTrain {
        let by_rows = |matrix: &DMatrix<f64>| matrix.transpose().as_slice().to_vec();
        let cross = self.projection.cross_stiffness.iter().any(|&value| value != 0.0);
        ModalTrain {
            eigenvalues_rad2_s2: self.projection.eigenvalues.clone(),
            damping_per_s: by_rows(&(&self.projection.damping + &self.projection.gyroscopic * pinion_speed_rad_s)),
            cross_stiffness_per_s2: cross.then(|| by_rows(&self.projection.cross_stiffness)),
            mesh: self.projection.mesh.each_ref().map(|row| row.as_slice().to_vec()),
            reference_stiffness_n_per_m: self.projection.mesh_stiffness_n_per_m,
            load_n: (&self.load_per_nm * pinion_torque_nm + &self.tilting_load).as_slice().to_vec(),
            displacements: self.displacements.clone(),
            outputs: self.outputs.clone(),
        }
    }

    /// Response of the reduced rotor to a harmonic displacement excitation, meshes closed.
    ///
    /// # Errors
    /// As [`GearedRotor::frequency_response`](super::GearedRotor::frequency_response).
    pub fn frequency_response(&self, excitation: &Harmonics) -> Result<FrequencyResponse, ShaftError> {
        let omega = excitation.omega()?;
        let impedance = [0, 1].map(|half| {
            Complex::new(
                self.projection.mesh_stiffness_n_per_m[half],
                omega * self.projection.mesh_damping_n_s_per_m[half],
            )
        });
        let mut dynamic = self.projection.open_dynamic_stiffness(omega, excitation.pinion_speed_rad_s, 0.0);
        let mut force = DVector::from_element(self.coordinates(), Complex::new(0.0, 0.0));
        for ((row, k), e) in self.projection.mesh.iter().zip(impedance).zip(excitation.excitation_m) {
            let row = row.map(|h| Complex::new(h, 0.0));
            dynamic += &row * row.transpose() * k;
            force += row * (k * e);
        }
        let Some(q) = dynamic.lu().solve(&force) else {
            return Err(ShaftError::IllConditioned { reason: "the excitation meets an undamped natural frequency" });
        };
        Ok(FrequencyResponse {
            mesh_force_n: [0, 1].map(|half| {
                let approach: Complex<f64> = self.projection.mesh[half].iter().zip(&q).map(|(h, q)| q * *h).sum();
                impedance[half] * (approach - excitation.excitation_m[half])
            }),
            bearings: self
                .projection
                .bearings
                .each_ref()
                .map(|bearings| bearings.iter().map(|bearing| bearing.force(q.as_slice(), omega)).collect()),
        })
    }
}

impl Projection {
    pub(super) fn coordinates(&self) -> usize {
        self.eigenvalues.len()
    }

    pub(super) fn report(&self, modes: usize, estimated_error: f64) -> ReductionReport {
        let highest = |values: &[f64]| values.iter().fold(0.0f64, |highest, l| highest.max(*l)).sqrt() / TAU;
        ReductionReport {
            modes,
            residual_vectors: self.coordinates() - modes,
            highest_mode_hz: highest(&self.eigenvalues[..modes]),
            highest_coordinate_hz: highest(&self.eigenvalues),
            estimated_error,
            steps: Vec::new(),
        }
    }

    /// Λ(1 + iη) − Σ k_ref hᵀh (1 + iη) + K_x + iωD − ω²I.
    fn open_dynamic_stiffness(&self, omega: f64, pinion_speed_rad_s: f64, loss_factor: f64) -> DMatrix<Complex<f64>> {
        let elastic = Complex::new(1.0, loss_factor);
        DMatrix::from_fn(self.coordinates(), self.coordinates(), |i, j| {
            let damping = self.damping[(i, j)] + pinion_speed_rad_s * self.gyroscopic[(i, j)];
            let meshes: f64 = (0..2).map(|m| self.mesh_stiffness_n_per_m[m] * self.mesh[m][i] * self.mesh[m][j]).sum();
            let diagonal = if i == j { self.eigenvalues[i] } else { 0.0 };
            let inertia = if i == j { omega * omega } else { 0.0 };
            elastic * (diagonal - meshes) + Complex::new(self.cross_stiffness[(i, j)] - inertia, omega * damping)
        })
    }

    /// Relative error against the receptances of the full model.
    pub(super) fn error(&self, exact: &Receptance, omega: f64, pinion_speed_rad_s: f64) -> f64 {
        let dynamic = self.open_dynamic_stiffness(omega, pinion_speed_rad_s, LOSS_FACTOR);
        let inputs = DMatrix::from_fn(self.coordinates(), 2, |i, j| Complex::new(self.mesh[j][i], 0.0));
        let Some(motion) = dynamic.lu().solve(&inputs) else {
            return f64::INFINITY;
        };
        let meshes =
            Matrix2::from_fn(|i, j| self.mesh[i].iter().zip(motion.column(j).iter()).map(|(h, q)| q * *h).sum());
        let columns = [0, 1].map(|j| motion.column(j).iter().copied().collect::<Vec<_>>());
        let all: Vec<&ReducedBearing> = self.bearings.iter().flatten().collect();
        let forces = columns.each_ref().map(|motion| {
            all.iter().flat_map(|bearing| bearing.force(motion, omega).into_iter().take(3)).collect::<Vec<_>>()
        });
        let reduced = Receptance { meshes, bearings: DMatrix::from_fn(3 * all.len(), 2, |i, j| forces[j][i]) };
        let parts = [
            (reduced.meshes - exact.meshes).norm() / exact.meshes.norm(),
            (reduced.bearings.clone() - &exact.bearings).norm() / exact.bearings.norm(),
        ];
        let closed = |receptance: &Receptance| {
            let stiffness = Matrix2::from_diagonal(&self.mesh_stiffness_n_per_m.map(|k| Complex::new(k, 0.0)).into());
            let closing = (Matrix2::identity() + stiffness * receptance.meshes).try_inverse()?;
            let bearings = &receptance.bearings * DMatrix::from_fn(2, 2, |i, j| closing[(i, j)]);
            Some((receptance.meshes * closing, bearings))
        };
        let (Some(own), Some(other)) = (closed(&reduced), closed(exact)) else {
            return f64::INFINITY;
        };
        let closed_parts = [(own.0 - other.0).norm() / other.0.norm(), (own.1 - &other.1).norm() / other.1.norm()];
        parts
            .into_iter()
            .chain(closed_parts)
            .fold(0.0, |worst: f64, e| if e.is_nan() { f64::NAN } else { worst.max(e) })
    }
}

impl ReducedBearing {
    /// Force and moment on the shaft of a harmonic motion of the coordinates.
    fn force(&self, motion: &[Complex<f64>], omega: f64) -> [Complex<f64>; 6] {
        std::array::from_fn(|i| {
            let rows = self.displacement.row(i).into_owned();
            let velocity = self.velocity.row(i).into_owned();
            rows.iter().zip(velocity.iter()).zip(motion).map(|((k, c), q)| Complex::new(*k, omega * c) * q).sum()
        })
    }
}
