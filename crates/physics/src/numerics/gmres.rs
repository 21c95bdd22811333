//! Solution of linear systems of which only products with vectors are known.

/// Solves A x = `rhs` by the generalised minimal residual method without restarts, `product(v, out)` being A v; None
/// where the residual is not below `tolerance` times the right side within `most` products. For systems close to the
/// identity, with as many products as the accuracy has digits (Y. Saad, M. H. Schultz: GMRES, SIAM J. Sci. Stat.
/// Comput. 7 (1986) 856, doi:10.1137/0907058).
pub(crate) fn gmres(
    mut product: impl FnMut(&[f64], &mut [f64]),
    rhs: &[f64],
    tolerance: f64,
    most: usize,
) -> Option<Vec<f64>> {
    let size = norm(rhs);
    if size == 0.0 {
        return Some(vec![0.0; rhs.len()]);
    }
    let mut basis: Vec<Vec<f64>> = vec![rhs.iter().map(|r| r / size).collect()];
    // Columns of the triangular factor of the Hessenberg matrix, and the rotations that make it so.
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut rotations: Vec<(f64, f64)> = Vec::new();
    let mut reduced = vec![size];
    for k in 0..most {
        let mut next = vec![0.0; rhs.len()];
        product(&basis[k], &mut next);
        let mut column = Vec::with_capacity(k + 2);
        for vector in &basis {
            let part = dot(vector, &next);
            next.iter_mut().zip(vector).for_each(|(n, v)| *n -= part * v);
            column.push(part);
        }
        let length = norm(&next);
        for (i, (cos, sin)) in rotations.iter().enumerate() {
            let (a, b) = (column[i], column[i + 1]);
            column[i] = cos * a + sin * b;
            column[i + 1] = cos * b - sin * a;
        }
        let radius = column[k].hypot(length);
        if !(radius.is_finite() && radius > 0.0) {
            return None;
        }
        let (cos, sin) = (column[k] / radius, length / radius);
        column[k] = radius;
        rotations.push((cos, sin));
        reduced.push(-sin * reduced[k]);
        reduced[k] *= cos;
        columns.push(column);
        if reduced[k + 1].abs() <= tolerance * size || length <= f64::EPSILON * radius {
            return Some(combination(&basis, &columns, &reduced[..=k]));
        }
        next.iter_mut().for_each(|n| *n /= length);
        basis.push(next);
    }
    None
}

/// The combination of the basis whose coefficients solve the triangular system.
fn combination(basis: &[Vec<f64>], columns: &[Vec<f64>], reduced: &[f64]) -> Vec<f64> {
    let mut y = reduced.to_vec();
    for i in (0..y.len()).rev() {
        y[i] /= columns[i][i];
        for j in 0..i {
            y[j] -= columns[i][j] * y[i];
        }
    }
    let mut x = vec![0.0; basis[0].len()];
    for (vector, y) in basis.iter().zip(&y) {
        x.iter_mut().zip(vector).for_each(|(x, v)| *x += y * v);
    }
    x
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Euclidean norm.
pub(crate) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    #[test]
    fn the_solution_is_that_of_elimination() {
        let n = 40;
        let matrix = DMatrix::from_fn(n, n, |r, c| {
            let part = ((7 * r + 3 * c * c) % 11) as f64 / 11.0 - 0.5;
            if r == c { 1.0 } else { 0.3 * part }
        });
        let rhs = DVector::from_fn(n, |r, _| (r as f64).sin());
        let exact = matrix.clone().lu().solve(&rhs).expect("regular");
        let product = |v: &[f64], out: &mut [f64]| {
            out.copy_from_slice((&matrix * DVector::from_row_slice(v)).as_slice());
        };
        let found = gmres(product, rhs.as_slice(), 1e-13, n).expect("converges");
        let error = (DVector::from_vec(found) - &exact).amax() / exact.amax();
        assert!(error < 1e-11, "{error}");
    }

    #[test]
    fn too_few_products_are_said() {
        // A cyclic shift: no progress before the last product.
        let shift = |v: &[f64], out: &mut [f64]| {
            for (i, o) in out.iter_mut().enumerate() {
                *o = v[(i + v.len() - 1) % v.len()];
            }
        };
        let mut rhs = vec![0.0; 8];
        rhs[0] = 1.0;
        assert_eq!(gmres(shift, &rhs, 1e-10, 7), None);
        assert!(gmres(shift, &rhs, 1e-10, 8).is_some());
        assert_eq!(gmres(shift, &[0.0; 8], 1e-10, 1), Some(vec![0.0; 8]));
    }
}
