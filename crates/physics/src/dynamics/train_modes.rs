//! Complex modes of a train, closed with its reference mesh stiffnesses and its mesh dampers.

use std::ops::Deref;
use std::sync::Arc;

use nalgebra::DMatrix;

use super::complex_modes::{Block, ComplexModes, multiply};
use super::train_equations::TrainEquations;

/// Terms of the power series of the free motion over a step.
pub(super) const TERMS: usize = 32;

/// Complex modes of a train closed with its reference stiffnesses and mesh dampers, in scaled time, over (elastic
/// displacements, velocities).
#[derive(Debug, Clone)]
pub(crate) struct TrainModes {
    modes: Arc<ComplexModes>,
    /// Magnitude of the largest eigenvalue.
    pub(super) fastest: f64,
    /// Row 2 n + j: s_j of A^n/n!, in the eigenvectors; row n of the transposed columns of B_j likewise.
    pub(super) outputs: DMatrix<f64>,
    pub(super) inputs: DMatrix<f64>,
    /// Coefficients n of s_j per unit impulse of g_k.
    pub(super) responses: [[[f64; TERMS + 1]; 2]; 2],
    pub(super) reference_stiffness: [f64; 2],
}

impl Deref for TrainModes {
    type Target = ComplexModes;

    fn deref(&self) -> &ComplexModes {
        &self.modes
    }
}

impl TrainModes {
    /// The complex modes alone.
    pub(super) fn complex(&self) -> &Arc<ComplexModes> {
        &self.modes
    }

    /// The modes; None where the eigenvectors are nearly dependent. `mesh_damping`: of each mesh in scaled time, N/m.
    pub(super) fn new<const D: usize>(train: &TrainEquations<D>, mesh_damping: [f64; 2]) -> Option<Self> {
        let n = train.elastic;
        let modes = ComplexModes::new(n, |c| {
            let mut unit = [0.0; D];
            unit[c] = 1.0;
            let springs = train.stiffness_product(&unit);
            let mut dampers = train.damping_product(&unit);
            for j in 0..2 {
                let force = mesh_damping[j] * train.mesh[j][c];
                dampers.iter_mut().zip(&train.mesh_acceleration[j]).for_each(|(d, a)| *d += a * force);
            }
            [springs, dampers].map(|product| product[..n].to_vec())
        })?;
        let ComplexModes { blocks, vectors, inverse } = &modes;
        let fastest = blocks.iter().fold(0.0f64, |m, block| match *block {
            Block::Real { rate } => m.max(rate.abs()),
            Block::Pair { rate, omega } => m.max(rate.hypot(omega)),
        });
        let output = |j: usize| DMatrix::from_fn(1, 2 * n, |_, c| if c < n { train.mesh[j][c] } else { 0.0 });
        let input =
            |j: usize| DMatrix::from_fn(2 * n, 1, |r, _| if r < n { 0.0 } else { -train.mesh_acceleration[j][r - n] });
        let mut outputs = DMatrix::zeros(2 * (TERMS + 1), 2 * n);
        let mut inputs = DMatrix::zeros(2 * n, 2 * (TERMS + 1));
        for j in 0..2 {
            let mut row: Vec<f64> = (output(j) * vectors).iter().copied().collect();
            let mut vector: Vec<f64> = (inverse * input(j)).iter().copied().collect();
            for term in 0..=TERMS {
                for c in 0..2 * n {
                    outputs[(2 * term + j, c)] = row[c];
                    inputs[(c, 2 * term + j)] = vector[c];
                }
                let factor = 1.0 / (term + 1) as f64;
                multiply(blocks, &mut vector, factor, false);
                multiply(blocks, &mut row, factor, true);
            }
        }
        let responses = [0, 1].map(|j| {
            [0, 1].map(|k| {
                std::array::from_fn(|term| (0..2 * n).map(|c| outputs[(j, c)] * inputs[(c, 2 * term + k)]).sum())
            })
        });
        let reference_stiffness = train.reference_stiffness;
        Some(Self { modes: Arc::new(modes), fastest, outputs, inputs, responses, reference_stiffness })
    }
}
