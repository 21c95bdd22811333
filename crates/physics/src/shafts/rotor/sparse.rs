//! Sparse matrices, their Cholesky factor within the envelope, and banded complex systems.

use nalgebra::Complex;

use crate::simd::vectorised;

/// Entries (column, value) of a sparse row.
pub(super) type SparseRow = Vec<(usize, f64)>;

/// Product of a sparse row with a vector.
pub(super) fn dot(row: &[(usize, f64)], x: &[f64]) -> f64 {
    row.iter().map(|&(i, value)| value * x[i]).sum()
}

/// Entries of a matrix in any order; equal places add up.
#[derive(Debug, Clone, Default)]
pub(super) struct SparseBuilder {
    entries: Vec<(usize, usize, f64)>,
}

impl SparseBuilder {
    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        if value != 0.0 {
            self.entries.push((row, column, value));
        }
    }

    /// Adds `factor` · rowᵀ column.
    pub(super) fn add_outer(&mut self, factor: f64, row: &[(usize, f64)], column: &[(usize, f64)]) {
        for &(i, a) in row {
            for &(j, b) in column {
                self.add(i, j, factor * a * b);
            }
        }
    }

    pub(super) fn build(mut self, size: usize) -> SparseMatrix {
        // Stable: equal places are added in the order of their arrival.
        self.entries.sort_by_key(|&(row, column, _)| (row, column));
        let mut matrix = SparseMatrix { starts: vec![0; size + 1], columns: Vec::new(), values: Vec::new() };
        let mut last = None;
        for (row, column, value) in self.entries {
            if last == Some((row, column)) {
                if let Some(sum) = matrix.values.last_mut() {
                    *sum += value;
                }
                continue;
            }
            last = Some((row, column));
            matrix.columns.push(column);
            matrix.values.push(value);
            matrix.starts[row + 1] += 1;
        }
        for row in 0..size {
            matrix.starts[row + 1] += matrix.starts[row];
        }
        matrix
    }
}

/// A square matrix in compressed rows.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SparseMatrix {
    starts: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
}

impl SparseMatrix {
    pub(super) fn size(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[row]..self.starts[row + 1];
        self.columns[range.clone()].iter().copied().zip(self.values[range].iter().copied())
    }

    pub(super) fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.size()).flat_map(|row| self.row(row).map(move |(column, value)| (row, column, value)))
    }

    pub(super) fn is_zero(&self) -> bool {
        self.values.iter().all(|&value| value == 0.0)
    }

    /// The matrix times a block of `width` vectors, stored by rows.
    pub(super) fn multiply(&self, x: &[f64], width: usize, out: &mut [f64]) {
        for (row, out) in out.chunks_exact_mut(width).enumerate() {
            out.fill(0.0);
            for (column, value) in self.row(row) {
                out.iter_mut().zip(&x[column * width..]).for_each(|(out, x)| *out += value * x);
            }
        }
    }

    /// The matrix times a vector.
    pub(super) fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; x.len()];
        self.multiply(x, 1, &mut out);
        out
    }

    /// xᵀ A x.
    pub(super) fn quadratic(&self, x: &[f64]) -> f64 {
        self.entries().map(|(row, column, value)| x[row] * value * x[column]).sum()
    }

    /// Largest distance of an entry from the diagonal.
    pub(super) fn bandwidth(&self) -> usize {
        self.entries().map(|(row, column, _)| row.abs_diff(column)).max().unwrap_or(0)
    }
}

/// Lower triangle of a symmetric matrix, each row from its first entry to the diagonal.
#[derive(Debug, Clone)]
pub(super) struct Envelope {
    first: Vec<usize>,
    starts: Vec<usize>,
    values: Vec<f64>,
}

impl Envelope {
    /// The sum of multiples of symmetric matrices.
    pub(super) fn sum(terms: &[(f64, &SparseMatrix)]) -> Envelope {
        let size = terms.iter().map(|(_, matrix)| matrix.size()).max().unwrap_or(0);
        let mut first: Vec<usize> = (0..size).collect();
        let entries = || terms.iter().flat_map(|&(factor, matrix)| matrix.entries().map(move |e| (factor, e)));
        for (_, (row, column, _)) in entries() {
            first[row] = first[row].min(column);
        }
        let mut starts = vec![0; size + 1];
        for row in 0..size {
            starts[row + 1] = starts[row] + row + 1 - first[row];
        }
        let mut values = vec![0.0; starts[size]];
        for (factor, (row, column, value)) in entries() {
            if column <= row {
                values[starts[row] + column - first[row]] += factor * value;
            }
        }
        Envelope { first, starts, values }
    }

    fn size(&self) -> usize {
        self.first.len()
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.values[self.starts[row]..self.starts[row + 1]]
    }

    /// The Cholesky factor L, A = L Lᵀ; `None` if the matrix is not positive definite.
    pub(super) fn cholesky(mut self) -> Option<CholeskyFactor> {
        for i in 0..self.size() {
            let (done, rest) = self.values.split_at_mut(self.starts[i]);
            let (from, row) = (self.first[i], &mut rest[..i + 1 - self.first[i]]);
            for j in from..i {
                let other = &done[self.starts[j]..self.starts[j + 1]];
                let start = from.max(self.first[j]);
                let sum = product(&row[start - from..j - from], &other[start - self.first[j]..]);
                row[j - from] = (row[j - from] - sum) / other[other.len() - 1];
            }
            let (diagonal, left) = row.split_last_mut()?;
            *diagonal -= product(left, left);
            if !(*diagonal > 0.0 && diagonal.is_finite()) {
                return None;
            }
            *diagonal = diagonal.sqrt();
        }
        Some(CholeskyFactor { factor: self })
    }

    /// Number of negative eigenvalues, by the signs of the pivots of L D Lᵀ (Sylvester's law of inertia).
    pub(super) fn negative_eigenvalues(mut self) -> usize {
        let mut pivots = vec![0.0f64; self.size()];
        let mut scaled = Vec::new();
        for i in 0..self.size() {
            let (done, rest) = self.values.split_at_mut(self.starts[i]);
            let (from, row) = (self.first[i], &mut rest[..i + 1 - self.first[i]]);
            scaled.clear();
            for j in from..i {
                let other = &done[self.starts[j]..self.starts[j + 1]];
                let start = from.max(self.first[j]);
                let sum = product(&scaled[start - from..], &other[start - self.first[j]..]);
                let value = row[j - from] - sum;
                scaled.push(value);
                row[j - from] = value / pivots[j];
            }
            let sum = product(&scaled, row);
            let before = row[i - from].abs();
            let pivot = row[i - from] - sum;
            // A pivot that vanishes is an eigenvalue of a leading block at the shift: moved off it by rounding.
            pivots[i] = if pivot == 0.0 { f64::EPSILON * before.max(f64::MIN_POSITIVE) } else { pivot };
        }
        pivots.iter().filter(|&&pivot| pivot < 0.0).count()
    }
}

/// Sum of products over the shorter of two slices.
fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A Cholesky factor.
#[derive(Debug, Clone)]
pub(super) struct CholeskyFactor {
    factor: Envelope,
}

impl CholeskyFactor {
    /// Solves A X = B for a block of `width` vectors, stored by rows; `x` is B before and X after.
    pub(super) fn solve(&self, x: &mut [f64], width: usize) {
        vectorised(
            #[inline(always)]
            || self.solve_inlined(x, width),
        );
    }

    #[inline(always)]
    fn solve_inlined(&self, x: &mut [f64], width: usize) {
        let size = self.factor.size();
        for i in 0..size {
            let row = self.factor.row(i);
            let (done, rest) = x.split_at_mut(i * width);
            let own = &mut rest[..width];
            let from = self.factor.first[i];
            for (l, other) in row.iter().zip(done[from * width..].chunks_exact(width)) {
                own.iter_mut().zip(other).for_each(|(own, other)| *own -= l * other);
            }
            let diagonal = row[row.len() - 1];
            own.iter_mut().for_each(|own| *own /= diagonal);
        }
        for i in (0..size).rev() {
            let row = self.factor.row(i);
            let (rest, done) = x.split_at_mut(i * width);
            let own = &mut done[..width];
            let diagonal = row[row.len() - 1];
            own.iter_mut().for_each(|own| *own /= diagonal);
            let from = self.factor.first[i];
            for (l, other) in row.iter().zip(rest[from * width..].chunks_exact_mut(width)) {
                other.iter_mut().zip(&*own).for_each(|(other, own)| *other -= l * own);
            }
        }
    }
}

/// A complex matrix whose entries lie within a band around the diagonal.
#[derive(Debug, Clone)]
pub(super) struct ComplexBand {
    size: usize,
    /// Largest distance of an entry from the diagonal.
    half: usize,
    /// Rows with the columns i − half … i + 2 half; the last `half` columns take the fill of row exchanges.
    values: Vec<Complex<f64>>,
}

impl ComplexBand {
    pub(super) fn new(size: usize, half: usize) -> ComplexBand {
        ComplexBand { size, half, values: vec![Complex::new(0.0, 0.0); size * (3 * half + 1)] }
    }

    /// Adds a multiple of a matrix within the band.
    pub(super) fn add(&mut self, factor: Complex<f64>, matrix: &SparseMatrix) {
        let width = 3 * self.half + 1;
        for (row, column, value) in matrix.entries() {
            self.values[row * width + column + self.half - row] += factor * value;
        }
    }

    /// Solves A X = B by elimination with partial pivoting; `x` holds `columns` vectors by rows, B before and X after.
    /// `false` when a pivot vanishes.
    pub(super) fn solve(mut self, x: &mut [Complex<f64>], columns: usize) -> bool {
        let (n, half) = (self.size, self.half);
        let width = 3 * half + 1;
        for k in 0..n {
            let below = (k + half).min(n - 1);
            let entry = |row: usize| row * width + k + half - row;
            let largest = |values: &[Complex<f64>], row: usize| values[entry(row)].norm_sqr();
            let pivot =
                (k..=below).max_by(|&a, &b| largest(&self.values, a).total_cmp(&largest(&self.values, b))).unwrap_or(k);
            let reach = (2 * half).min(n - 1 - k) + 1;
            if pivot != k {
                for column in 0..reach {
                    self.values.swap(entry(k) + column, entry(pivot) + column);
                }
                for column in 0..columns {
                    x.swap(k * columns + column, pivot * columns + column);
                }
            }
            let diagonal = self.values[entry(k)];
            if diagonal.norm_sqr() == 0.0 || !diagonal.re.is_finite() || !diagonal.im.is_finite() {
                return false;
            }
            let inverse = diagonal.inv();
            for row in k + 1..=below {
                let at = entry(row);
                let factor = self.values[at] * inverse;
                if factor == Complex::new(0.0, 0.0) {
                    continue;
                }
                let (upper, lower) = self.values.split_at_mut(at);
                let head = &upper[entry(k) + 1..entry(k) + reach];
                lower[1..reach].iter_mut().zip(head).for_each(|(own, head)| *own -= factor * head);
                let (done, rest) = x.split_at_mut(row * columns);
                let head = &done[k * columns..(k + 1) * columns];
                rest[..columns].iter_mut().zip(head).for_each(|(own, head)| *own -= factor * head);
            }
        }
        for k in (0..n).rev() {
            let at = k * width + half;
            let reach = (2 * half).min(n - 1 - k);
            let (rest, done) = x.split_at_mut((k + 1) * columns);
            let own = &mut rest[k * columns..];
            for (value, other) in self.values[at + 1..=at + reach].iter().zip(done.chunks_exact(columns)) {
                own.iter_mut().zip(other).for_each(|(own, other)| *own -= value * other);
            }
            let inverse = self.values[at].inv();
            own.iter_mut().for_each(|own| *own *= inverse);
        }
        true
    }
}
