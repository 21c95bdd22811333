//! Complex modes of a train, closed with its reference mesh stiffnesses and its mesh dampers.

use nalgebra::{Complex, DMatrix, DVector};

use super::train_equations::TrainEquations;
use crate::numerics::eigen::eigenpairs;

/// Terms of the power series of the free motion over a step.
pub(super) const TERMS: usize = 32;
/// Product of the norms of the eigenvectors and of their inverse beyond which they are not used.
const WORST_CONDITION: f64 = 1e8;

/// One real eigenvalue, or a pair α ± iω of the matrix A.
#[derive(Debug, Clone, Copy)]
enum Block {
    Real { rate: f64 },
    Pair { rate: f64, omega: f64 },
}

/// An eigenvalue of the matrix A.
#[derive(Debug, Clone, Copy)]
pub(super) struct Pole {
    pub value: Complex<f64>,
    /// Whether its conjugate is an eigenvalue too.
    pub paired: bool,
}

/// Complex modes of a train closed with its reference stiffnesses and mesh dampers, in scaled time, over (elastic
/// displacements, velocities).
#[derive(Debug, Clone)]
pub(crate) struct TrainModes {
    blocks: Vec<Block>,
    /// Real and imaginary parts of the eigenvectors as columns, and the inverse.
    pub(super) vectors: DMatrix<f64>,
    pub(super) inverse: DMatrix<f64>,
    /// Magnitude of the largest eigenvalue.
    pub(super) fastest: f64,
    /// Row 2 n + j: s_j of A^n/n!, in the eigenvectors; row n of the transposed columns of B_j likewise.
    pub(super) outputs: DMatrix<f64>,
    pub(super) inputs: DMatrix<f64>,
    /// Coefficients n of s_j per unit impulse of g_k.
    pub(super) responses: [[[f64; TERMS + 1]; 2]; 2],
    pub(super) reference_stiffness: [f64; 2],
}

impl TrainModes {
    /// The modes; None where the eigenvectors are nearly dependent. `mesh_damping`: of each mesh in scaled time, N/m.
    pub(super) fn new<const D: usize>(train: &TrainEquations<D>, mesh_damping: [f64; 2]) -> Option<Self> {
        let n = train.elastic;
        let mut matrix = DMatrix::<f64>::zeros(2 * n, 2 * n);
        for c in 0..n {
            let mut unit = [0.0; D];
            unit[c] = 1.0;
            let springs = train.stiffness_product(&unit);
            let mut dampers = train.damping_product(&unit);
            for j in 0..2 {
                let force = mesh_damping[j] * train.mesh[j][c];
                dampers.iter_mut().zip(&train.mesh_acceleration[j]).for_each(|(d, a)| *d += a * force);
            }
            matrix[(c, n + c)] = 1.0;
            for r in 0..n {
                matrix[(n + r, c)] = -springs[r];
                matrix[(n + r, n + c)] = -dampers[r];
            }
        }
        let (blocks, vectors) = eigenvectors(&matrix)?;
        let inverse = vectors.clone().try_inverse()?;
        let condition = vectors.norm() * inverse.norm() / (2 * n) as f64;
        if condition.is_nan() || condition > WORST_CONDITION {
            return None;
        }
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
            let mut row: Vec<f64> = (output(j) * &vectors).iter().copied().collect();
            let mut vector: Vec<f64> = (&inverse * input(j)).iter().copied().collect();
            for term in 0..=TERMS {
                for c in 0..2 * n {
                    outputs[(2 * term + j, c)] = row[c];
                    inputs[(c, 2 * term + j)] = vector[c];
                }
                let factor = 1.0 / (term + 1) as f64;
                multiply(&blocks, &mut vector, factor, false);
                multiply(&blocks, &mut row, factor, true);
            }
        }
        let responses = [0, 1].map(|j| {
            [0, 1].map(|k| {
                std::array::from_fn(|term| (0..2 * n).map(|c| outputs[(j, c)] * inputs[(c, 2 * term + k)]).sum())
            })
        });
        let reference_stiffness = train.reference_stiffness;
        Some(Self { blocks, vectors, inverse, fastest, outputs, inputs, responses, reference_stiffness })
    }

    /// Number of elastic coordinates.
    pub(super) fn elastic(&self) -> usize {
        self.vectors.nrows() / 2
    }

    /// Derivative of the state after `tau` by the state, with the reference stiffnesses alone, over (displacements,
    /// velocities).
    pub(super) fn free_motion(&self, tau: f64) -> DMatrix<f64> {
        let mut z = self.inverse.clone();
        self.advance(tau, &mut z);
        &self.vectors * z
    }

    /// Eigenvalues, of each conjugate pair the one above the real axis.
    pub(super) fn poles(&self) -> Vec<Pole> {
        let pole = |block: &Block| match *block {
            Block::Real { rate } => Pole { value: Complex::new(rate, 0.0), paired: false },
            Block::Pair { rate, omega } => Pole { value: Complex::new(rate, omega), paired: true },
        };
        self.blocks.iter().map(pole).collect()
    }

    /// Rates in the eigenvectors, one per pole, due to accelerations of the elastic coordinates.
    pub(super) fn excitation(&self, accelerations: &[f64]) -> Vec<Complex<f64>> {
        let n = self.elastic();
        let force = DVector::from_fn(2 * n, |r, _| if r < n { 0.0 } else { accelerations[r - n] });
        self.complex_components((&self.inverse * force).as_slice())
    }

    /// Components in the eigenvectors, one per pole, of a state (displacements, velocities) of the elastic coordinates.
    pub(super) fn components(&self, displacements: &[f64], velocities: &[f64]) -> Vec<Complex<f64>> {
        let n = self.elastic();
        let state = DVector::from_fn(2 * n, |r, _| if r < n { displacements[r] } else { velocities[r - n] });
        self.complex_components((&self.inverse * state).as_slice())
    }

    /// A component a + b i of the eigenvectors is stored as (a, −b): see [`multiply`].
    fn complex_components(&self, real: &[f64]) -> Vec<Complex<f64>> {
        let mut at = 0;
        let component = |block: &Block| match block {
            Block::Real { .. } => {
                at += 1;
                Complex::new(real[at - 1], 0.0)
            }
            Block::Pair { .. } => {
                at += 2;
                Complex::new(real[at - 2], -real[at - 1])
            }
        };
        self.blocks.iter().map(component).collect()
    }

    /// Factors of the components in a displacement or acceleration of the elastic coordinates along `row`; the value is
    /// the real part of the sum of the products.
    pub(super) fn observation(&self, row: &[f64]) -> Vec<Complex<f64>> {
        let n = self.elastic();
        let value = |c: usize| (0..n).map(|r| row[r] * self.vectors[(r, c)]).sum::<f64>();
        let mut at = 0;
        let factor = |block: &Block| match block {
            Block::Real { .. } => {
                at += 1;
                Complex::new(value(at - 1), 0.0)
            }
            Block::Pair { .. } => {
                at += 2;
                Complex::new(value(at - 2), value(at - 1))
            }
        };
        self.blocks.iter().map(factor).collect()
    }

    /// State (displacements, velocities) of the elastic coordinates from components.
    pub(super) fn state(&self, components: &[Complex<f64>]) -> DVector<f64> {
        let mut real = Vec::with_capacity(2 * self.elastic());
        for (block, component) in self.blocks.iter().zip(components) {
            real.push(component.re);
            if let Block::Pair { .. } = block {
                real.push(-component.im);
            }
        }
        &self.vectors * DVector::from_vec(real)
    }

    /// Advances free perturbations in the eigenvectors by `h`.
    pub(super) fn advance(&self, h: f64, z: &mut DMatrix<f64>) {
        let turns: Vec<(f64, f64)> = self
            .blocks
            .iter()
            .map(|block| match *block {
                Block::Real { rate } => ((rate * h).exp(), 0.0),
                Block::Pair { rate, omega } => {
                    let (sin, cos) = (omega * h).sin_cos();
                    let decay = (rate * h).exp();
                    (decay * cos, decay * sin)
                }
            })
            .collect();
        let rows = z.nrows();
        for column in z.as_mut_slice().chunks_exact_mut(rows) {
            let mut r = 0;
            for (block, (cos, sin)) in self.blocks.iter().zip(&turns) {
                match block {
                    Block::Real { .. } => {
                        column[r] *= cos;
                        r += 1;
                    }
                    Block::Pair { .. } => {
                        let (a, b) = (column[r], column[r + 1]);
                        column[r] = cos * a + sin * b;
                        column[r + 1] = cos * b - sin * a;
                        r += 2;
                    }
                }
            }
        }
    }
}

/// Eigenvalues of a matrix and the real and imaginary parts of their eigenvectors as columns; None where they are not
/// found.
fn eigenvectors(matrix: &DMatrix<f64>) -> Option<(Vec<Block>, DMatrix<f64>)> {
    let size = matrix.nrows();
    let pairs = eigenpairs(matrix)?;
    let blocks = pairs
        .iter()
        .map(|pair| match pair.value.im {
            0.0 => Block::Real { rate: pair.value.re },
            omega => Block::Pair { rate: pair.value.re, omega },
        })
        .collect();
    let columns: Vec<f64> = pairs.into_iter().flat_map(|pair| pair.vector).flatten().collect();
    Some((blocks, DMatrix::from_vec(size, size, columns)))
}

/// Multiplies a vector in the eigenvectors by A (from the right: a row) and `factor`.
fn multiply(blocks: &[Block], vector: &mut [f64], factor: f64, row: bool) {
    let mut r = 0;
    for block in blocks {
        match *block {
            Block::Real { rate } => {
                vector[r] *= rate * factor;
                r += 1;
            }
            Block::Pair { rate, omega } => {
                let omega = if row { -omega } else { omega };
                let (a, b) = (vector[r], vector[r + 1]);
                vector[r] = (rate * a + omega * b) * factor;
                vector[r + 1] = (rate * b - omega * a) * factor;
                r += 2;
            }
        }
    }
}
