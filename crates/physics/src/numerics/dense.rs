//! Small dense linear algebra on flat row-major slices: what the tooth contact needs, without allocation.

use crate::simd::vectorised;
use crate::watch::{Canceled, Meter};

/// Solves the n×n system by Gaussian elimination with partial pivoting; `a` is destroyed, `rhs` becomes the solution.
pub(crate) fn solve_dense(a: &mut [f64], rhs: &mut [f64], n: usize) {
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs())).unwrap_or(k);
        if pivot != k {
            for j in 0..n {
                a.swap(k * n + j, pivot * n + j);
            }
            rhs.swap(k, pivot);
        }
        let d = a[k * n + k];
        for i in k + 1..n {
            let f = a[i * n + k] / d;
            if f != 0.0 {
                for j in k..n {
                    a[i * n + j] -= f * a[k * n + j];
                }
                rhs[i] -= f * rhs[k];
            }
        }
    }
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|j| a[k * n + j] * rhs[j]).sum();
        rhs[k] = (rhs[k] - sum) / a[k * n + k];
    }
}

/// Solves A X = B for several right-hand sides, which follow one another in `sides`, by LU with partial pivoting; `a`
/// is destroyed. `false` when a pivot vanishes.
///
/// # Errors
/// [`Canceled`].
pub(crate) fn lu_solve(a: &mut [f64], sides: &mut [f64], n: usize, meter: &mut Meter) -> Result<bool, Canceled> {
    vectorised(
        #[inline(always)]
        || lu_solve_inlined(a, sides, n, meter),
    )
}

#[inline(always)]
fn lu_solve_inlined(a: &mut [f64], sides: &mut [f64], n: usize, meter: &mut Meter) -> Result<bool, Canceled> {
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i * n + k].abs().total_cmp(&a[j * n + k].abs())).unwrap_or(k);
        if pivot != k {
            let (upper, lower) = a.split_at_mut(pivot * n);
            upper[k * n..(k + 1) * n].swap_with_slice(&mut lower[..n]);
            sides.chunks_exact_mut(n).for_each(|side| side.swap(k, pivot));
        }
        let (upper, lower) = a.split_at_mut((k + 1) * n);
        let head = &upper[k * n..];
        let d = head[k];
        if d == 0.0 || !d.is_finite() {
            return Ok(false);
        }
        for rows in lower.chunks_mut(n * Meter::pieces(n - k)) {
            meter.count(rows.len() / n * (n - k))?;
            for row in rows.chunks_exact_mut(n) {
                let factor = row[k] / d;
                row[k] = factor;
                row[k + 1..].iter_mut().zip(&head[k + 1..]).for_each(|(r, h)| *r -= factor * h);
            }
        }
    }
    for group in sides.chunks_mut(GROUP * n.max(1)) {
        if group.len() >= LEAST_GROUP * n {
            let mut rows = by_rows(group, n);
            for i in 1..n {
                meter.count(i * GROUP)?;
                let (done, rest) = rows.split_at_mut(i);
                subtract_products(&a[i * n..i * n + i], done, &mut rest[0]);
            }
            for i in (0..n).rev() {
                meter.count((n - i) * GROUP)?;
                let (rest, done) = rows.split_at_mut(i + 1);
                subtract_products(&a[i * n + i + 1..(i + 1) * n], done, &mut rest[i]);
                rest[i].iter_mut().for_each(|value| *value /= a[i * n + i]);
            }
            from_rows(&rows, group, n);
            continue;
        }
        for side in group.chunks_exact_mut(n) {
            for i in 1..n {
                meter.count(i)?;
                let (done, rest) = side.split_at_mut(i);
                rest[0] -= dot(&a[i * n..i * n + i], done);
            }
            for i in (0..n).rev() {
                meter.count(n - i)?;
                let (rest, done) = side.split_at_mut(i + 1);
                rest[i] = (rest[i] - dot(&a[i * n + i + 1..(i + 1) * n], done)) / a[i * n + i];
            }
        }
    }
    Ok(true)
}

/// Vectors that are worked on together, and from how many on.
const GROUP: usize = 12;
const LEAST_GROUP: usize = 4;

/// Up to [`GROUP`] vectors of length n that follow one another, row by row.
#[inline(always)]
fn by_rows(vectors: &[f64], n: usize) -> Vec<[f64; GROUP]> {
    let mut rows = vec![[0.0; GROUP]; n];
    for (k, vector) in vectors.chunks_exact(n).enumerate() {
        rows.iter_mut().zip(vector).for_each(|(row, value)| row[k] = *value);
    }
    rows
}

#[inline(always)]
fn from_rows(rows: &[[f64; GROUP]], vectors: &mut [f64], n: usize) {
    for (k, vector) in vectors.chunks_exact_mut(n).enumerate() {
        vector.iter_mut().zip(rows).for_each(|(value, row)| *value = row[k]);
    }
}

/// `out` −= Σ_j factors_j rows_j.
#[inline(always)]
fn subtract_products(factors: &[f64], rows: &[[f64; GROUP]], out: &mut [f64; GROUP]) {
    let mut sum = *out;
    for (factor, row) in factors.iter().zip(rows) {
        for k in 0..GROUP {
            sum[k] -= factor * row[k];
        }
    }
    *out = sum;
}

/// Multiplies vectors that follow one another by the square row-major matrix `a`.
///
/// # Errors
/// [`Canceled`].
pub(crate) fn multiply_vectors(a: &[f64], vectors: &mut [f64], n: usize, meter: &mut Meter) -> Result<(), Canceled> {
    vectorised(
        #[inline(always)]
        || {
            for group in vectors.chunks_mut(GROUP * n.max(1)) {
                meter.count(n)?;
                let mut rows = by_rows(group, n);
                rows.iter_mut().flatten().for_each(|value| *value = -*value);
                let mut products = vec![[0.0; GROUP]; n];
                for (product, row) in products.iter_mut().zip(a.chunks_exact(n)) {
                    meter.count(n * GROUP)?;
                    subtract_products(row, &rows, product);
                }
                from_rows(&products, group, n);
            }
            Ok(())
        },
    )
}

/// Cholesky factor L (lower triangle, in place) of a symmetric positive definite n×n matrix given by its lower
/// triangle. `false` when a pivot is not positive.
///
/// # Errors
/// [`Canceled`].
pub(crate) fn cholesky(a: &mut [f64], n: usize, meter: &mut Meter) -> Result<bool, Canceled> {
    vectorised(
        #[inline(always)]
        || {
            for i in 0..n {
                meter.count(i * i / 2)?;
                if !cholesky_row(a, n, i) {
                    return Ok(false);
                }
            }
            Ok(true)
        },
    )
}

/// [`cholesky`] of a small matrix, to be inlined into something vectorised.
#[inline(always)]
pub(crate) fn cholesky_inlined(a: &mut [f64], n: usize) -> bool {
    for i in 0..n {
        if !cholesky_row(a, n, i) {
            return false;
        }
    }
    true
}

/// Row `i` of a factor whose rows above are done.
#[inline(always)]
fn cholesky_row(a: &mut [f64], n: usize, i: usize) -> bool {
    let (above, row) = a.split_at_mut(i * n);
    for j in 0..i {
        let other = &above[j * n..j * n + j + 1];
        row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
    }
    let d = row[i] - dot(&row[..i], &row[..i]);
    if d.is_nan() || d <= 0.0 {
        return false;
    }
    row[i] = d.sqrt();
    true
}

/// Solves L Lᵀ x = b in place with the factor of [`cholesky`].
pub(crate) fn cholesky_solve(l: &[f64], b: &mut [f64], n: usize) {
    forward_solve(l, b, n);
    for i in (0..n).rev() {
        b[i] /= l[i * n + i];
        let x = b[i];
        for j in 0..i {
            b[j] -= l[i * n + j] * x;
        }
    }
}

/// Solves L x = b in place.
pub(crate) fn forward_solve(l: &[f64], b: &mut [f64], n: usize) {
    for i in 0..n {
        b[i] = (b[i] - dot(&l[i * n..i * n + i], &b[..i])) / l[i * n + i];
    }
}

/// Solves L X = B in place, all columns of the row-major `b` at once.
#[inline(always)]
pub(crate) fn forward_solve_columns(l: &[f64], b: &mut [f64], n: usize) {
    let columns = b.len() / n;
    for i in 0..n {
        let (done, rest) = b.split_at_mut(i * columns);
        let row = &mut rest[..columns];
        for (factor, other) in l[i * n..i * n + i].iter().zip(done.chunks_exact(columns)) {
            row.iter_mut().zip(other).for_each(|(x, y)| *x -= factor * y);
        }
        let scale = 1.0 / l[i * n + i];
        row.iter_mut().for_each(|x| *x *= scale);
    }
}

/// `out += factor aᵀ b` for row-major matrices with `rows` rows.
#[inline(always)]
pub(crate) fn add_product(out: &mut [f64], factor: f64, a: &[f64], b: &[f64], rows: usize) {
    let (m, n) = (a.len() / rows, b.len() / rows);
    for (left, right) in a.chunks_exact(m).zip(b.chunks_exact(n)) {
        for (value, target) in left.iter().zip(out.chunks_exact_mut(n)) {
            let scale = factor * value;
            target.iter_mut().zip(right).for_each(|(t, r)| *t += scale * r);
        }
    }
}

/// Scalar product, eight sums at a time so that it vectorises.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut acc = [0.0; 8];
    let (ca, cb) = (a.chunks_exact(8), b.chunks_exact(8));
    let tail: f64 = ca.remainder().iter().zip(cb.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in ca.zip(cb) {
        for k in 0..8 {
            acc[k] += x[k] * y[k];
        }
    }
    (acc[0] + acc[4]) + (acc[1] + acc[5]) + (acc[2] + acc[6]) + (acc[3] + acc[7]) + tail
}
