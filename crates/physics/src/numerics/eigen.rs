//! Eigenvalues and eigenvectors of real matrices without symmetry.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{ComputeEigenvectors, EvdParams, evd_real, evd_scratch};
use faer::{Mat, Par, Spec};
use nalgebra::{Complex, DMatrix, Schur};

/// An eigenvalue and its eigenvector, of each conjugate pair the one above the real axis.
pub(crate) struct Eigenpair {
    pub value: Complex<f64>,
    /// Real and imaginary part, largest component 1; the latter empty for a real eigenvalue.
    pub vector: [Vec<f64>; 2],
}

/// Size from which the blocked method is the faster one.
const BLOCKED: usize = 48;

/// Eigenvalues of a matrix; None where they are not found.
pub(crate) fn eigenvalues(matrix: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    if matrix.nrows() < BLOCKED {
        let schur = Schur::try_new(matrix, f64::EPSILON, 10_000)?;
        return Some(schur.complex_eigenvalues().iter().copied().collect());
    }
    let (values, _) = decompose(&matrix, ComputeEigenvectors::No)?;
    Some(values)
}

/// Eigenvalues and eigenvectors of a matrix; None where they are not found.
pub(crate) fn eigenpairs(matrix: &DMatrix<f64>) -> Option<Vec<Eigenpair>> {
    let (values, vectors) = decompose(matrix, ComputeEigenvectors::Yes)?;
    let n = matrix.nrows();
    let column = |j: usize| -> Vec<f64> { (0..n).map(|i| vectors[(i, j)]).collect() };
    let mut pairs = Vec::with_capacity(n);
    let mut j = 0;
    while j < n {
        let value = values[j];
        let mut vector = if value.im == 0.0 { [column(j), Vec::new()] } else { [column(j), column(j + 1)] };
        if value.im < 0.0 {
            vector[1].iter_mut().for_each(|part| *part = -*part);
        }
        let imaginary = |i: usize| vector[1].get(i).copied().unwrap_or(0.0);
        let largest = (0..n).fold(0.0f64, |most, i| most.max(vector[0][i].hypot(imaginary(i))));
        if !(largest.is_finite() && largest > 0.0) {
            return None;
        }
        vector.iter_mut().flatten().for_each(|part| *part /= largest);
        pairs.push(Eigenpair { value: Complex::new(value.re, value.im.abs()), vector });
        j += if value.im == 0.0 { 1 } else { 2 };
    }
    Some(pairs)
}

/// Eigenvalues, conjugate ones next to each other, and the real and imaginary parts of the eigenvectors in their
/// columns: multishift QR on this thread.
fn decompose(matrix: &DMatrix<f64>, vectors: ComputeEigenvectors) -> Option<(Vec<Complex<f64>>, Mat<f64>)> {
    if !matrix.iter().all(|value| value.is_finite()) {
        return None;
    }
    let n = matrix.nrows();
    let a = Mat::from_fn(n, n, |i, j| matrix[(i, j)]);
    let (mut re, mut im) = (Diag::<f64>::zeros(n), Diag::<f64>::zeros(n));
    let wanted = vectors == ComputeEigenvectors::Yes;
    let mut right = if wanted { Mat::zeros(n, n) } else { Mat::zeros(0, 0) };
    let parameters: Spec<EvdParams, f64> = Spec::default();
    let scratch = evd_scratch::<f64>(n, ComputeEigenvectors::No, vectors, Par::Seq, parameters);
    let mut memory = MemBuffer::try_new(scratch).ok()?;
    let right_vectors = wanted.then(|| right.as_mut());
    let stack = MemStack::new(&mut memory);
    evd_real(a.as_ref(), re.as_mut(), im.as_mut(), None, right_vectors, Par::Seq, stack, parameters).ok()?;
    let values = (0..n).map(|i| Complex::new(re[i], im[i])).collect();
    Some((values, right))
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_oracle::check_worst;

    /// A matrix without structure, by a linear congruence.
    fn matrix(n: usize) -> DMatrix<f64> {
        let mut state = 1u64;
        DMatrix::from_fn(n, n, |_, _| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        })
    }

    #[test]
    fn eigenpairs_satisfy_their_equation() {
        let mut errors = Vec::new();
        for n in [1, 2, 7, 60, 131] {
            let a = matrix(n);
            let pairs = eigenpairs(&a).expect("eigenvectors");
            let count: usize = pairs.iter().map(|pair| if pair.value.im == 0.0 { 1 } else { 2 }).sum();
            assert_eq!(count, n);
            for Eigenpair { value, vector } in &pairs {
                let v: Vec<Complex<f64>> =
                    (0..n).map(|i| Complex::new(vector[0][i], vector[1].get(i).copied().unwrap_or(0.0))).collect();
                for i in 0..n {
                    let product: Complex<f64> = (0..n).map(|j| v[j] * a[(i, j)]).sum();
                    errors.push((product - value * v[i]).norm());
                }
            }
        }
        check_worst("Dynamics: eigenvectors without symmetry", "A v against λ v", errors, 1e-11);
    }

    #[test]
    fn both_methods_find_the_same_eigenvalues() {
        let a = matrix(90);
        let sorted = |mut values: Vec<Complex<f64>>| {
            values.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
            values
        };
        let blocked = sorted(eigenvalues(a.clone()).expect("eigenvalues"));
        let schur = Schur::try_new(a, f64::EPSILON, 10_000).expect("a Schur form");
        let other = sorted(schur.complex_eigenvalues().iter().copied().collect());
        let errors: Vec<f64> = blocked.iter().zip(&other).map(|(a, b)| (a - b).norm()).collect();
        assert_eq!(errors.len(), 90);
        check_worst("Dynamics: eigenvectors without symmetry", "eigenvalues by both methods", errors, 1e-11);
    }

    #[test]
    fn a_matrix_that_is_not_finite_has_none() {
        let mut a = matrix(60);
        a[(3, 4)] = f64::NAN;
        assert!(eigenvalues(a.clone()).is_none());
        assert!(eigenpairs(&a).is_none());
    }
}
