//! Gauss–Legendre quadrature over one step.

use std::sync::LazyLock;

/// Nodes per segment: exact for powers up to 2·24 − 1 = 47 in time, so for the square of any step's series.
pub(super) const NODES: usize = 24;

/// Nodes and weights over 0 … 1.
pub(super) static GAUSS: LazyLock<[(f64, f64); NODES]> = LazyLock::new(gauss_legendre);

/// Gauss–Legendre quadrature: the roots of P_n by Newton's method from Tricomi's estimate, weights 2/((1 − x²) P_n'²).
fn gauss_legendre() -> [(f64, f64); NODES] {
    let n = NODES as f64;
    std::array::from_fn(|i| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..10 {
            let (mut before, mut p) = (1.0, x);
            for k in 2..=NODES {
                let k = k as f64;
                (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
            }
            slope = n * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
    })
}
