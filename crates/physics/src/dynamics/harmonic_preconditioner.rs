//! Preconditioner of the linear systems of harmonic balance: the equation of the amplitudes of s with the low orders
//! and the first harmonics of the tangent stiffness alone, solved by elimination.

use nalgebra::Complex;

type C64 = Complex<f64>;

/// Loop gain of the orders that are left out, at most.
const SMALL_GAIN: f64 = 0.05;
/// Harmonics of the tangent stiffness that are kept: those above this part of its largest deviation, and at most so
/// many.
const SMALL_HARMONIC: f64 = 0.05;
const MOST_HARMONICS: usize = 8;

/// Factors of the restricted equation; amplitudes of the orders beyond it are returned as they are.
pub(super) enum Preconditioner {
    Identity,
    OneMesh(BandFactors<2>),
    TwoMeshes(BandFactors<4>),
}

/// Response of s of the first mesh of the pair to the force of the second, by order.
pub(super) type Gain<'a> = &'a dyn Fn((usize, usize)) -> &'a [C64];

impl Preconditioner {
    /// `gains`: responses of s to the normal forces; `stiffness`: amplitudes by order of the deviation of the tangent
    /// stiffness of each mesh, N/m, and its largest value.
    pub(super) fn new<'a>(gains: Gain<'a>, stiffness: &[(&[C64], f64)]) -> Self {
        let halves = stiffness.len();
        let deviation = stiffness.iter().fold(0.0f64, |m, (_, largest)| m.max(*largest));
        let pairs: Vec<(usize, usize)> = (0..halves).flat_map(|j| (0..halves).map(move |k| (j, k))).collect();
        let large = |order: &usize| pairs.iter().any(|at| gains(*at)[*order].norm() * deviation > SMALL_GAIN);
        let Some(last) = (0..gains((0, 0)).len()).rev().find(large) else { return Self::Identity };
        let kept = |harmonic: &usize| stiffness.iter().any(|(k, _)| k[*harmonic].norm() > SMALL_HARMONIC * deviation);
        let width = (1..=MOST_HARMONICS.min(last)).rev().find(kept).unwrap_or(0);
        let factors = match halves {
            1 => BandFactors::new(gains, stiffness, last + 1, width).map(Self::OneMesh),
            _ => BandFactors::new(gains, stiffness, last + 1, width).map(Self::TwoMeshes),
        };
        factors.unwrap_or(Self::Identity)
    }

    /// Solves for amplitudes given as real and imaginary part by order, one mesh after the other.
    pub(super) fn solve(&self, amplitudes: &mut [f64]) {
        match self {
            Self::Identity => {}
            Self::OneMesh(factors) => factors.solve(amplitudes),
            Self::TwoMeshes(factors) => factors.solve(amplitudes),
        }
    }
}

/// Factors of a matrix of B × B blocks, a row of blocks for each order, with `width` blocks on both sides of the
/// diagonal. A block has the real and the imaginary part for each mesh. Orders are eliminated from the highest, whose
/// diagonal blocks are close to the identity.
pub(super) struct BandFactors<const B: usize> {
    orders: usize,
    width: usize,
    /// Row by row; on the diagonal the inverse of what the elimination left.
    blocks: Vec<[[f64; B]; B]>,
}

impl<const B: usize> BandFactors<B> {
    fn new<'a>(gains: Gain<'a>, stiffness: &[(&[C64], f64)], orders: usize, width: usize) -> Option<Self> {
        let mut factors = Self { orders, width, blocks: vec![[[0.0; B]; B]; orders * (2 * width + 1)] };
        for (k, (harmonics, _)) in stiffness.iter().enumerate() {
            for (j, gain) in (0..B / 2).map(|j| (j, gains((j, k)))) {
                for (n, gain) in gain[..orders].iter().enumerate() {
                    for m in n.saturating_sub(width)..=(n + width).min(orders - 1) {
                        // Force by the amplitude of the order m, and by its conjugate, that of the order −m.
                        let own = if m > n { harmonics[m - n].conj() } else { harmonics[n - m] };
                        let mirrored = if m > 0 && n + m <= width { harmonics[n + m] } else { C64::ZERO };
                        let (own, mirrored) = (gain * own, gain * mirrored);
                        let block = factors.block_mut(n, m);
                        block[2 * j][2 * k] -= own.re + mirrored.re;
                        block[2 * j][2 * k + 1] += own.im - mirrored.im;
                        block[2 * j + 1][2 * k] -= own.im + mirrored.im;
                        block[2 * j + 1][2 * k + 1] -= own.re - mirrored.re;
                    }
                }
            }
        }
        for n in 0..orders {
            let diagonal = factors.block_mut(n, n);
            (0..B).for_each(|i| diagonal[i][i] += 1.0);
        }
        factors.eliminate().then_some(factors)
    }

    fn index(&self, row: usize, column: usize) -> usize {
        row * (2 * self.width + 1) + column + self.width - row
    }

    fn block_mut(&mut self, row: usize, column: usize) -> &mut [[f64; B]; B] {
        let at = self.index(row, column);
        &mut self.blocks[at]
    }

    /// False where a diagonal block is singular.
    fn eliminate(&mut self) -> bool {
        for n in (0..self.orders).rev() {
            let at = self.index(n, n);
            let Some(pivot) = inverse(self.blocks[at]) else { return false };
            self.blocks[at] = pivot;
            let first = n.saturating_sub(self.width);
            for row in first..n {
                let at = self.index(row, n);
                let factor = product(&self.blocks[at], &pivot);
                self.blocks[at] = factor;
                let (to, from) = (self.index(row, first), self.index(n, first));
                for column in 0..n - first {
                    let change = product(&factor, &self.blocks[from + column]);
                    let block = &mut self.blocks[to + column];
                    for (row, change) in block.iter_mut().zip(&change) {
                        row.iter_mut().zip(change).for_each(|(value, change)| *value -= change);
                    }
                }
            }
        }
        true
    }

    fn solve(&self, amplitudes: &mut [f64]) {
        let per_mesh = amplitudes.len() / (B / 2);
        let place = |n: usize, i: usize| per_mesh * (i / 2) + 2 * n + i % 2;
        let read = |amplitudes: &[f64], n: usize| -> [f64; B] { std::array::from_fn(|i| amplitudes[place(n, i)]) };
        let subtract = |block: &[[f64; B]; B], from: &[f64; B], to: &mut [f64; B]| {
            for (to, row) in to.iter_mut().zip(block) {
                *to -= row.iter().zip(from).map(|(a, b)| a * b).sum::<f64>();
            }
        };
        let mut values: Vec<[f64; B]> = (0..self.orders).map(|n| read(amplitudes, n)).collect();
        for n in (0..self.orders).rev() {
            let (rows, pivot) = values.split_at_mut(n);
            let first = n.saturating_sub(self.width);
            for (row, value) in rows.iter_mut().enumerate().skip(first) {
                subtract(&self.blocks[self.index(row, n)], &pivot[0], value);
            }
        }
        for n in 0..self.orders {
            let (solved, rest) = values.split_at_mut(n);
            for (column, value) in solved.iter().enumerate().skip(n.saturating_sub(self.width)) {
                subtract(&self.blocks[self.index(n, column)], value, &mut rest[0]);
            }
            let pivot = &self.blocks[self.index(n, n)];
            let right = rest[0];
            rest[0] = std::array::from_fn(|i| pivot[i].iter().zip(&right).map(|(a, b)| a * b).sum());
        }
        for (n, value) in values.iter().enumerate() {
            value.iter().enumerate().for_each(|(i, value)| amplitudes[place(n, i)] = *value);
        }
    }
}

#[inline(always)]
fn product<const B: usize>(a: &[[f64; B]; B], b: &[[f64; B]; B]) -> [[f64; B]; B] {
    let mut out = [[0.0; B]; B];
    for (out, a) in out.iter_mut().zip(a) {
        for (a, b) in a.iter().zip(b) {
            out.iter_mut().zip(b).for_each(|(out, b)| *out += a * b);
        }
    }
    out
}

/// Inverse by elimination with the largest pivot of each column; None of a singular block.
fn inverse<const B: usize>(mut a: [[f64; B]; B]) -> Option<[[f64; B]; B]> {
    let mut out: [[f64; B]; B] = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    for c in 0..B {
        let best = (c..B).max_by(|r, s| a[*r][c].abs().total_cmp(&a[*s][c].abs()))?;
        a.swap(c, best);
        out.swap(c, best);
        let pivot = a[c][c];
        if !(pivot.abs() > f64::MIN_POSITIVE && pivot.is_finite()) {
            return None;
        }
        a[c] = a[c].map(|value| value / pivot);
        out[c] = out[c].map(|value| value / pivot);
        for r in (0..B).filter(|r| *r != c) {
            let factor = a[r][c];
            for k in 0..B {
                a[r][k] -= factor * a[c][k];
                out[r][k] -= factor * out[c][k];
            }
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With all orders and harmonics kept, solving undoes the product with the matrix of the equation, written out over
    /// positive and negative orders.
    #[test]
    fn solving_undoes_the_product() {
        const ORDERS: usize = 7;
        let gains = |halves: usize| -> Vec<Vec<C64>> {
            let gain = |at: usize, n: usize| {
                let re = 0.4 / (1.0 + n as f64) - 0.2 * at as f64;
                C64::new(re, if n == 0 { 0.0 } else { 0.3 - 0.05 * (n + at) as f64 })
            };
            (0..halves * halves).map(|at| (0..ORDERS).map(|n| gain(at, n)).collect()).collect()
        };
        let harmonics = |k: usize| -> Vec<C64> {
            let harmonic = |n: usize| C64::new(0.5 - 0.1 * (n + k) as f64, if n == 0 { 0.0 } else { 0.2 * n as f64 });
            (0..ORDERS).map(|n| if n <= 3 { harmonic(n) } else { C64::ZERO }).collect()
        };
        for halves in [1, 2] {
            let gains = gains(halves);
            let stiffness: Vec<Vec<C64>> = (0..halves).map(harmonics).collect();
            let largest: Vec<(&[C64], f64)> = stiffness.iter().map(|k| (k.as_slice(), 1.0)).collect();
            let factors = Preconditioner::new(&|(j, k)| &gains[halves * j + k], &largest);
            assert!(!matches!(factors, Preconditioner::Identity));
            let value = |j: usize, n: usize| {
                C64::new(1.0 - 0.3 * n as f64, if n == 0 { 0.0 } else { 0.7 * j as f64 - 0.2 * n as f64 })
            };
            let amplitude = |j: usize, n: i64| {
                let found = value(j, n.unsigned_abs() as usize);
                if n < 0 { found.conj() } else { found }
            };
            let harmonic = |k: usize, n: i64| {
                let found = stiffness[k].get(n.unsigned_abs() as usize).copied().unwrap_or_default();
                if n < 0 { found.conj() } else { found }
            };
            let highest = ORDERS as i64 - 1;
            let mut out = Vec::new();
            for j in 0..halves {
                for n in 0..=highest {
                    let force =
                        |k: usize| -> C64 { (-highest..=highest).map(|m| harmonic(k, n - m) * amplitude(k, m)).sum() };
                    let caused: C64 = (0..halves).map(|k| gains[halves * j + k][n as usize] * force(k)).sum();
                    let row = amplitude(j, n) - caused;
                    out.extend([row.re, row.im]);
                }
            }
            factors.solve(&mut out);
            let expected = (0..halves).flat_map(|j| (0..ORDERS).map(move |n| value(j, n)));
            for (found, expected) in out.chunks(2).zip(expected) {
                let error = (C64::new(found[0], found[1]) - expected).norm();
                assert!(error < 1e-11, "{found:?} for {expected}");
            }
        }
    }
}
