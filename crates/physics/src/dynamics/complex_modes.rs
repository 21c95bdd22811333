//! Complex modes of a damped linear system with constant coefficients, and its free motion by them.

use nalgebra::{Complex, DMatrix, DVector};

use crate::numerics::eigen::eigenpairs;

/// Product of the norms of the eigenvectors and of their inverse beyond which they are not used.
const WORST_CONDITION: f64 = 1e8;

/// One real eigenvalue, or a pair α ± iω of the matrix A.
#[derive(Debug, Clone, Copy)]
pub(super) enum Block {
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

/// Complex modes of q″ = −stiffness q − damping q′, in scaled time, over (displacements, velocities).
#[derive(Debug, Clone)]
pub(crate) struct ComplexModes {
    pub(super) blocks: Vec<Block>,
    /// Real and imaginary parts of the eigenvectors as columns, and the inverse.
    pub(super) vectors: DMatrix<f64>,
    pub(super) inverse: DMatrix<f64>,
}

impl ComplexModes {
    /// The modes of `n` coordinates; None where the eigenvectors are nearly dependent. `column(c)`: products of the
    /// stiffness and of the damping matrix with the unit vector c.
    pub(super) fn new(n: usize, column: impl Fn(usize) -> [Vec<f64>; 2]) -> Option<Self> {
        let mut matrix = DMatrix::<f64>::zeros(2 * n, 2 * n);
        for c in 0..n {
            let [springs, dampers] = column(c);
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
        Some(Self { blocks, vectors, inverse })
    }

    /// Number of coordinates.
    pub(super) fn coordinates(&self) -> usize {
        self.vectors.nrows() / 2
    }

    /// Derivative of the state after `tau` by the state, over (displacements,
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

    /// Rates in the eigenvectors, one per pole, due to accelerations of the coordinates.
    pub(super) fn excitation(&self, accelerations: &[f64]) -> Vec<Complex<f64>> {
        let n = self.coordinates();
        let force = DVector::from_fn(2 * n, |r, _| if r < n { 0.0 } else { accelerations[r - n] });
        self.complex_components((&self.inverse * force).as_slice())
    }

    /// Components in the eigenvectors, one per pole, of a state (displacements, velocities) of the coordinates.
    pub(super) fn components(&self, displacements: &[f64], velocities: &[f64]) -> Vec<Complex<f64>> {
        let n = self.coordinates();
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

    /// Factors of the components in a displacement or acceleration of the coordinates along `row`; the value is
    /// the real part of the sum of the products.
    pub(super) fn observation(&self, row: &[f64]) -> Vec<Complex<f64>> {
        let n = self.coordinates();
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

    /// State (displacements, velocities) of the coordinates from components.
    pub(super) fn state(&self, components: &[Complex<f64>]) -> DVector<f64> {
        let mut real = Vec::with_capacity(2 * self.coordinates());
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
pub(super) fn multiply(blocks: &[Block], vector: &mut [f64], factor: f64, row: bool) {
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
