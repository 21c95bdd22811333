//! Small dense linear algebra on flat row-major slices: what the tooth contact needs, without allocation.

use pulp::{Arch, Simd, WithSimd};

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

/// Columns in which the rows of an [`Augmented`] matrix are worked on.
const LANES: usize = 4;
/// Numbers of a cache line.
const LINE: usize = 8;

/// The rows of a linear system side by side with its right-hand sides, padded so that the inner loops have whole
/// vectors: for small systems that are solved many times.
#[derive(Debug, Clone, Default)]
pub(crate) struct Augmented {
    n: usize,
    /// Columns of the right-hand sides, which come first, and of all.
    sides: usize,
    stride: usize,
    rows: Vec<f64>,
    /// Where the first row begins.
    start: usize,
    /// Of the pivot's row in the rows below.
    factors: Vec<f64>,
}

impl Augmented {
    /// Makes room for `n` rows and `sides` right-hand sides; entries keep what was there.
    pub(crate) fn resize(&mut self, n: usize, sides: usize) {
        self.n = n;
        self.sides = sides.next_multiple_of(LANES);
        self.stride = (self.sides + n).next_multiple_of(LINE);
        self.rows.resize(n * self.stride + LINE, 0.0);
        // No vector lies across two cache lines.
        self.start = self.rows.as_ptr().align_offset(LINE * size_of::<f64>()).min(LINE);
    }

    /// Right-hand sides, padded, and the n entries of row `i`.
    #[inline(always)]
    pub(crate) fn row_mut(&mut self, i: usize) -> (&mut [f64], &mut [f64]) {
        let at = self.start + i * self.stride;
        let (sides, row) = self.rows[at..at + self.stride].split_at_mut(self.sides);
        (sides, &mut row[..self.n])
    }

    /// Solution of a right-hand side, row by row, after [`Augmented::solve`].
    pub(crate) fn solution(&self, side: usize) -> impl Iterator<Item = f64> {
        self.rows.iter().skip(self.start + side).step_by(self.stride.max(1)).take(self.n).copied()
    }

    /// Solves by elimination with partial pivoting; the solutions take the place of the right-hand sides. `false` when
    /// a pivot vanishes.
    ///
    /// # Errors
    /// [`Canceled`].
    pub(crate) fn solve(&mut self, meter: &mut Meter) -> Result<bool, Canceled> {
        Arch::new().dispatch(Elimination { system: self, meter })
    }
}

/// Elimination of an [`Augmented`] system with vector instructions.
struct Elimination<'a, 'm, 'w> {
    system: &'a mut Augmented,
    meter: &'m mut Meter<'w>,
}

impl WithSimd for Elimination<'_, '_, '_> {
    type Output = Result<bool, Canceled>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { system, meter } = self;
        let Augmented { n, sides, stride, start, ref mut rows, ref mut factors } = *system;
        let rows = &mut rows[start..start + n * stride];
        rows.chunks_exact_mut(stride.max(1)).for_each(|row| row[sides + n..].fill(0.0));
        for k in 0..n {
            let at = sides + k;
            let mut pivot = k;
            let mut largest = rows[k * stride + at].abs();
            for i in k + 1..n {
                let size = rows[i * stride + at].abs();
                if size > largest {
                    (pivot, largest) = (i, size);
                }
            }
            let (upper, lower) = rows.split_at_mut((k + 1) * stride);
            let head = &mut upper[k * stride..];
            if pivot != k {
                head.swap_with_slice(&mut lower[(pivot - k - 1) * stride..(pivot - k) * stride]);
            }
            let inverse = 1.0 / head[at];
            if !inverse.is_finite() || inverse == 0.0 {
                return Ok(false);
            }
            // Whole vectors: columns before the pivot's are not read any more.
            let first = sides + k / LANES * LANES;
            factors.clear();
            factors.extend(lower.chunks_exact(stride).map(|row| row[at] * inverse));
            let width = stride - first + sides;
            let pieces = Meter::pieces(width);
            for (rows, factors) in lower.chunks_mut(stride * pieces).zip(factors.chunks(pieces)) {
                meter.count(factors.len() * width)?;
                for (from, to) in [(0, sides), (first, stride)] {
                    let mut from = from;
                    while from < to {
                        let part = (to - from).min(MOST_VECTORS * S::F64_LANES);
                        let head = &head[from..from + part];
                        subtract_multiples(simd, head, &mut rows[from..], (stride, factors));
                        from += part;
                    }
                }
            }
        }
        for i in (0..n).rev() {
            meter.count((n - i) * sides)?;
            let (upper, below) = rows.split_at_mut((i + 1) * stride);
            let (own, row) = upper[i * stride..].split_at_mut(sides);
            for (factor, done) in row[i + 1..n].iter().zip(below.chunks_exact(stride)) {
                subtract_multiple(simd, own, *factor, &done[..sides]);
            }
            let inverse = 1.0 / row[i];
            own.iter_mut().for_each(|value| *value *= inverse);
        }
        Ok(true)
    }
}

/// `out` −= factor · row. Not fused, so that the result does not depend on the instructions.
#[inline(always)]
fn subtract_multiple<S: Simd>(simd: S, out: &mut [f64], factor: f64, row: &[f64]) {
    let (out, out_tail) = S::as_mut_simd_f64s(out);
    let (row, row_tail) = S::as_simd_f64s(row);
    let factors = simd.splat_f64s(factor);
    for (out, row) in out.iter_mut().zip(row) {
        *out = simd.sub_f64s(*out, simd.mul_f64s(factors, *row));
    }
    for (out, row) in out_tail.iter_mut().zip(row_tail) {
        *out -= factor * row;
    }
}

/// Vectors of a row that stay in the registers.
const MOST_VECTORS: usize = 12;

/// Subtracts multiples of `head` from the beginnings of rows that follow one another in `stride`: its length is that of
/// whole vectors, at most [`MOST_VECTORS`].
#[inline(always)]
fn subtract_multiples<S: Simd>(simd: S, head: &[f64], rows: &mut [f64], (stride, factors): (usize, &[f64])) {
    macro_rules! of_width {
        ($($width:literal),*) => {
            match head.len() / S::F64_LANES {
                $($width => subtract_of_width::<S, $width>(simd, head, rows, (stride, factors)),)*
                _ => {}
            }
        };
    }
    of_width!(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12);
}

/// [`subtract_multiples`] of a row of `N` vectors.
#[inline(always)]
fn subtract_of_width<S: Simd, const N: usize>(
    simd: S,
    head: &[f64],
    rows: &mut [f64],
    (stride, factors): (usize, &[f64]),
) {
    let Ok(head) = <[S::f64s; N]>::try_from(S::as_simd_f64s(head).0) else { return };
    for (row, factor) in rows.chunks_mut(stride).zip(factors) {
        let factor = simd.splat_f64s(*factor);
        let (row, _) = S::as_mut_simd_f64s(&mut row[..N * S::F64_LANES]);
        for (out, head) in row.iter_mut().zip(&head) {
            *out = simd.sub_f64s(*out, simd.mul_f64s(factor, *head));
        }
    }
}

/// `out` = Σ_k weights_k · rows_k; all rows have its length.
pub(crate) fn combine_rows<const N: usize>(weights: &[f64; N], rows: &[&[f64]; N], out: &mut [f64]) {
    Arch::new().dispatch(RowCombination { weights, rows, out });
}

struct RowCombination<'a, const N: usize> {
    weights: &'a [f64; N],
    rows: &'a [&'a [f64]; N],
    out: &'a mut [f64],
}

impl<const N: usize> WithSimd for RowCombination<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { weights, rows, out } = self;
        let weights_of = weights.map(|weight| simd.splat_f64s(weight));
        let parts = rows.map(|row| S::as_simd_f64s(row));
        let (out, tail) = S::as_mut_simd_f64s(out);
        for (i, out) in out.iter_mut().enumerate() {
            let mut sum = simd.splat_f64s(0.0);
            for k in 0..N {
                sum = simd.add_f64s(sum, simd.mul_f64s(weights_of[k], parts[k].0[i]));
            }
            *out = sum;
        }
        for (i, out) in tail.iter_mut().enumerate() {
            *out = (0..N).fold(0.0, |sum, k| sum + weights[k] * parts[k].1[i]);
        }
    }
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
