//! The lowest natural modes of a large sparse system.

use nalgebra::{ComplexField, DMatrix, SymmetricEigen};

use super::sparse::{CholeskyFactor, Envelope, SparseMatrix};
use crate::numerics::dense::dot;
use crate::shafts::error::ShaftError;
use crate::simd::vectorised;
use crate::watch::Watch;

/// Vectors that are treated together; more than the multiplicity of any natural frequency of axisymmetric shafts.
const BLOCK: usize = 8;
/// Residual of a mode, relative to its eigenvalue of the inverse problem.
const RESIDUAL: f64 = 1e-9;
/// Shift of the inverse, over the limit of the eigenvalues: makes the stiffness of free shafts definite.
const SHIFT: f64 = 1e-4;
/// Least shift, over the rounding of the eigenvalues.
const SHIFT_OVER_ROUNDING: f64 = 1e4;
/// Residual of a mode over the rounding of its eigenvalue.
const RESIDUAL_OVER_ROUNDING: f64 = 10.0;

/// Modes of K φ = λ M φ.
#[derive(Debug, Clone)]
pub(super) struct Eigenmodes {
    /// λ, rad²/s², ascending.
    pub(super) eigenvalues: Vec<f64>,
    /// φ in columns, φᵀ M φ = 1.
    pub(super) vectors: DMatrix<f64>,
}

/// The shifted stiffness K + αM, factored.
pub(super) struct ShiftedStiffness<'a> {
    factor: CholeskyFactor,
    mass: &'a SparseMatrix,
    shift: f64,
    rounding: f64,
}

impl<'a> ShiftedStiffness<'a> {
    /// K + αM with a shift that is small against the eigenvalue `limit`, but above the `rounding` of the eigenvalues.
    ///
    /// # Errors
    /// The shift, if the sum is not positive definite.
    pub(super) fn new(
        stiffness: &SparseMatrix,
        mass: &'a SparseMatrix,
        limit: f64,
        rounding: f64,
    ) -> Result<Self, f64> {
        let shift = (SHIFT * limit).max(SHIFT_OVER_ROUNDING * rounding);
        let factor = Envelope::sum(&[(1.0, stiffness), (shift, mass)]).cholesky().ok_or(shift)?;
        Ok(ShiftedStiffness { factor, mass, shift, rounding })
    }

    /// α, rad²/s².
    pub(super) fn shift(&self) -> f64 {
        self.shift
    }

    /// (K + αM)⁻¹ of a block of vectors, stored by rows.
    pub(super) fn solve(&self, block: &mut [f64], width: usize) {
        self.factor.solve(block, width);
    }

    /// The `wanted` lowest modes, by a block Krylov space of (K + αM)⁻¹M with full orthogonalisation (Golub and Van
    /// Loan, Matrix Computations, 2013, chapter 10.3).
    ///
    /// # Errors
    /// [`ShaftError::ModesNotConverged`], [`ShaftError::Canceled`].
    pub(super) fn lowest_modes(&self, wanted: usize, watch: Watch<'_>) -> Result<Eigenmodes, ShaftError> {
        let n = self.mass.size();
        let wanted = wanted.min(n);
        if wanted == 0 {
            return Ok(Eigenmodes { eigenvalues: Vec::new(), vectors: DMatrix::zeros(n, 0) });
        }
        let mut space = KrylovSpace::new(self);
        let mut next_check = (wanted + wanted / 2 + 2 * BLOCK).min(n);
        loop {
            watch.checkpoint_quietly()?;
            space.grow();
            let size = space.projected.len();
            if size < next_check && size < n {
                continue;
            }
            let exhausted = size >= n || size >= 6 * wanted + 30 * BLOCK;
            let projected = DMatrix::from_fn(size, size, |i, j| space.projected[i.max(j)][i.min(j)]);
            let Some(ritz) = symmetric_eigen(projected) else {
                return Err(ShaftError::ModesNotConverged { converged: 0, wanted });
            };
            let mut order: Vec<usize> = (0..size).collect();
            order.sort_by(|&a, &b| ritz.eigenvalues[b].total_cmp(&ritz.eigenvalues[a]));
            order.truncate(wanted);
            let accepted = |&i: &usize| {
                let theta = ritz.eigenvalues[i];
                let tolerance = RESIDUAL.max(RESIDUAL_OVER_ROUNDING * self.rounding * theta);
                theta > 0.0 && space.residual(&ritz.eigenvectors.column(i)) <= tolerance * theta
            };
            let converged = order.iter().filter(|i| accepted(i)).count();
            if converged == wanted {
                let selected = DMatrix::from_fn(size, wanted, |i, j| ritz.eigenvectors[(i, order[j])]);
                let basis = DMatrix::from_column_slice(n, size, &space.basis[..n * size]);
                let eigenvalues = order.iter().map(|&i| 1.0 / ritz.eigenvalues[i] - self.shift).collect();
                return Ok(Eigenmodes { eigenvalues, vectors: basis * selected });
            }
            if exhausted {
                return Err(ShaftError::ModesNotConverged { converged, wanted });
            }
            next_check = (size + 2 * BLOCK).min(n);
        }
    }
}

/// Eigenvalues and vectors of a symmetric or Hermitian matrix; `None` if it is not finite or the method does not
/// converge.
pub(super) fn symmetric_eigen<T: ComplexField<RealField = f64>>(
    matrix: DMatrix<T>,
) -> Option<SymmetricEigen<T, nalgebra::Dyn>> {
    if !matrix.iter().all(|value| value.clone().is_finite()) {
        return None;
    }
    SymmetricEigen::try_new(matrix, f64::EPSILON, 100_000)
}

/// Number of eigenvalues of K φ = λ M φ below `limit`.
pub(super) fn count_below(stiffness: &SparseMatrix, mass: &SparseMatrix, limit: f64) -> usize {
    Envelope::sum(&[(1.0, stiffness), (-limit, mass)]).negative_eigenvalues()
}

/// An M-orthonormal basis and the operator (K + αM)⁻¹M projected on it.
struct KrylovSpace<'a, 'b> {
    system: &'a ShiftedStiffness<'b>,
    /// Basis vectors one after the other.
    basis: Vec<f64>,
    /// The newest vectors, to which the operator was not yet applied.
    block: Vec<Vec<f64>>,
    /// Lower triangle of the projected operator, by rows.
    projected: Vec<Vec<f64>>,
    /// The newest vectors' part of the operator's image of the vectors before: rows of the newest, columns of the ones
    /// before.
    remainder: Vec<Vec<f64>>,
    random: u64,
}

impl<'a, 'b> KrylovSpace<'a, 'b> {
    fn new(system: &'a ShiftedStiffness<'b>) -> Self {
        let mut space = KrylovSpace {
            system,
            basis: Vec::new(),
            block: Vec::new(),
            projected: Vec::new(),
            remainder: Vec::new(),
            random: 0x9e37_79b9_7f4a_7c15,
        };
        let n = system.mass.size();
        let start = (0..BLOCK.min(n)).map(|_| space.random_vector()).collect();
        space.block = space.orthonormal(start).0;
        space
    }

    /// A deterministic vector without structure (xorshift64*, Vigna, DOI 10.1145/2845077).
    fn random_vector(&mut self) -> Vec<f64> {
        (0..self.system.mass.size())
            .map(|_| {
                self.random ^= self.random >> 12;
                self.random ^= self.random << 25;
                self.random ^= self.random >> 27;
                let bits = self.random.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
                bits as f64 / (1u64 << 52) as f64 - 1.0
            })
            .collect()
    }

    /// Takes the newest block into the basis and makes the next one of its image.
    fn grow(&mut self) {
        let n = self.system.mass.size();
        let width = self.block.len();
        let before = self.projected.len();
        for vector in &self.block {
            self.basis.extend_from_slice(vector);
        }
        let mut block = vec![0.0; n * width];
        for (j, vector) in self.block.iter().enumerate() {
            vector.iter().enumerate().for_each(|(i, value)| block[i * width + j] = *value);
        }
        let mut images = vec![0.0; n * width];
        self.system.mass.multiply(&block, width, &mut images);
        self.system.solve(&mut images, width);
        let mut images: Vec<Vec<f64>> = (0..width).map(|j| (0..n).map(|i| images[i * width + j]).collect()).collect();
        // Twice is enough (Kahan and Parlett).
        let coefficients = self.project_out(&mut images);
        let corrections = self.project_out(&mut images);
        for (j, (first, second)) in coefficients.iter().zip(&corrections).enumerate() {
            self.projected.push((0..=before + j).map(|i| first[i] + second[i]).collect());
        }
        let (next, remainder) = self.orthonormal(images);
        self.block = next;
        self.remainder = remainder;
        if self.block.is_empty() && self.projected.len() < n {
            // The space is invariant: it goes on in another direction.
            let mut fresh: Vec<_> = (0..BLOCK.min(n - self.projected.len())).map(|_| self.random_vector()).collect();
            self.project_out(&mut fresh);
            self.project_out(&mut fresh);
            self.block = self.orthonormal(fresh).0;
        }
    }

    /// Subtracts from each vector its part within the basis; returns the coefficients.
    fn project_out(&self, vectors: &mut [Vec<f64>]) -> Vec<Vec<f64>> {
        let n = self.system.mass.size();
        let weighted: Vec<Vec<f64>> = vectors.iter().map(|vector| self.system.mass.times(vector)).collect();
        let mut coefficients = vec![Vec::with_capacity(self.basis.len() / n); vectors.len()];
        vectorised(
            #[inline(always)]
            || {
                for b in self.basis.chunks_exact(n) {
                    for (weighted, coefficients) in weighted.iter().zip(&mut coefficients) {
                        coefficients.push(dot(b, weighted));
                    }
                }
                for (i, b) in self.basis.chunks_exact(n).enumerate() {
                    for (vector, coefficients) in vectors.iter_mut().zip(&coefficients) {
                        let c = coefficients[i];
                        vector.iter_mut().zip(b).for_each(|(v, b)| *v -= c * b);
                    }
                }
            },
        );
        coefficients
    }

    /// An M-orthonormal basis of vectors that are orthogonal to the basis, and the coefficients of the vectors in it
    /// (rows: new vectors). Vectors within the span of the others are left out.
    fn orthonormal(&mut self, vectors: Vec<Vec<f64>>) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
        let count = vectors.len();
        let mut block: Vec<Vec<f64>> = Vec::with_capacity(count);
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(count);
        for (j, mut vector) in vectors.into_iter().enumerate() {
            let original = dot(&vector, &self.system.mass.times(&vector)).sqrt();
            for _ in 0..2 {
                let weighted = self.system.mass.times(&vector);
                for (b, row) in block.iter().zip(&mut rows) {
                    let c = dot(b, &weighted);
                    row[j] += c;
                    vector.iter_mut().zip(b).for_each(|(v, b)| *v -= c * b);
                }
            }
            let norm = dot(&vector, &self.system.mass.times(&vector)).sqrt();
            if norm > 1e-10 * original && norm > f64::MIN_POSITIVE {
                vector.iter_mut().for_each(|v| *v /= norm);
                let mut row = vec![0.0; count];
                row[j] = norm;
                block.push(vector);
                rows.push(row);
            }
        }
        (block, rows)
    }

    /// Norm of the residual of a Ritz vector.
    fn residual(&self, ritz: &nalgebra::DVectorView<'_, f64>) -> f64 {
        let width = self.remainder.first().map_or(0, Vec::len);
        let tail = ritz.len() - width;
        self.remainder
            .iter()
            .map(|row| row.iter().enumerate().map(|(j, r)| r * ritz[tail + j]).sum::<f64>().powi(2))
            .sum::<f64>()
            .sqrt()
    }
}
