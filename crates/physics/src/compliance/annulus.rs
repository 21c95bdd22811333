//! Plane-strain annulus loaded on its outer circle, held on its inner one: exact Fourier series.
//!
//! A tooth loads the root circle on the arc |θ| ≤ θ_f with a uniform tangential traction, a uniform radial traction,
//! and a moment: a radial traction linear in θ plus the tangential force 1/r_f that cancels the net tangential force of
//! that traction. Work-conjugate displacements make the flexibility symmetric. The harmonics are Michell's, from the
//! Kolosov–Muskhelishvili potentials φ = zⁿ⁺¹, z¹⁻ⁿ, ψ = zⁿ⁻¹, z⁻ⁿ⁻¹.
//!
//! With u_r = U e^{inθ}, u_θ = iV e^{inθ} every harmonic is a real symmetric 2×2 flexibility.

use crate::numerics::dense::solve_dense;

/// Displacements that have fallen to this part of their value at the outer circle do not reach the inner one.
const NEGLIGIBLE: f64 = 1e-6;

/// Harmonic n ≥ 0 of a ring with unit outer radius and unit Young's modulus: displacement (U, V) of the outer circle
/// per traction (t_r, t_θ/i) of the same harmonic. Inner radius `inner` in (0, 1), held.
pub(super) fn harmonic_flexibility(n: u32, inner: f64, nu: f64) -> [[f64; 2]; 2] {
    let mu = 0.5 / (1.0 + nu);
    let lame = 2.0 * mu * nu / (1.0 - 2.0 * nu);
    if n == 0 {
        // U = A (r - q²/r): σ_r = (λ+2μ) U' + λ U/r; V likewise: τ = μ (V' - V/r).
        let q2 = inner * inner;
        let radial = (1.0 - q2) / ((lame + 2.0 * mu) * (1.0 + q2) + lame * (1.0 - q2));
        let hoop = (1.0 - q2) / (mu * 2.0 * q2);
        return [[radial, 0.0], [0.0, hoop]];
    }
    // Basis: displacement and derivative of (U, V) at r, scaled to stay of order one: growing ones by r = 1, decaying
    // ones by r = inner.
    let kappa = 3.0 - 4.0 * nu;
    let m = n as f64;
    let basis = |r: f64| -> [[f64; 4]; 4] {
        let power = |s: f64, scale: f64, u: f64, v: f64| {
            let p = (r / scale).powf(s);
            [u * p, v * p, u * s * p / r, v * s * p / r]
        };
        let growing_a = power(m + 1.0, 1.0, (kappa - m - 1.0) / m, -(kappa + m + 1.0) / m);
        let growing_b = power(m - 1.0, 1.0, 1.0, 1.0);
        let decaying_a = power(-m - 1.0, inner, 1.0, -1.0);
        let decaying_b = if n == 1 {
            let l = 2.0 * kappa * r.ln();
            [l - 1.0, l + 1.0, 2.0 * kappa / r, 2.0 * kappa / r]
        } else {
            power(1.0 - m, inner, (kappa - 1.0 + m) / m, (kappa + 1.0 - m) / m)
        };
        [growing_a, growing_b, decaying_a, decaying_b]
    };
    if m * inner.ln() < NEGLIGIBLE.ln() {
        // The held circle is out of reach: the growing functions alone, two conditions.
        let [traction_a, traction_b] = [0, 1].map(|j| {
            let (u, v) = [((kappa - m - 1.0) / m, -(kappa + m + 1.0) / m), (1.0, 1.0)][j];
            let s = [m + 1.0, m - 1.0][j];
            [u, v, (lame + 2.0 * mu) * s * u + lame * (u - m * v), mu * (s * v - v + m * u)]
        });
        let det = traction_a[2] * traction_b[3] - traction_b[2] * traction_a[3];
        let answer = |i: usize, load: [f64; 2]| {
            let a = (load[0] * traction_b[3] - traction_b[2] * load[1]) / det;
            let b = (traction_a[2] * load[1] - load[0] * traction_a[3]) / det;
            a * traction_a[i] + b * traction_b[i]
        };
        let cross = answer(0, [0.0, 1.0]);
        return [[answer(0, [1.0, 0.0]), cross], [cross, answer(1, [0.0, 1.0])]];
    }
    let (out, inn) = (basis(1.0), basis(inner));
    let mut columns = [[0.0; 2]; 2];
    for (load, column) in columns.iter_mut().enumerate() {
        let mut a = [0.0; 16];
        let mut rhs = [0.0; 4];
        for j in 0..4 {
            let [u, v, du, dv] = out[j];
            a[j] = (lame + 2.0 * mu) * du + lame * (u - m * v);
            a[4 + j] = mu * (dv - v + m * u);
            a[8 + j] = inn[j][0];
            a[12 + j] = inn[j][1];
        }
        rhs[load] = 1.0;
        solve_dense(&mut a, &mut rhs, 4);
        column[0] = (0..4).map(|j| out[j][0] * rhs[j]).sum();
        column[1] = (0..4).map(|j| out[j][1] * rhs[j]).sum();
    }
    [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]]
}

/// Fourier shapes of the arc loads for harmonic `n` and half arc `theta`: (uniform, linear), both tending to a unit
/// resultant: sin(nθ)/(nθ) and 3 [sin(nθ)/n² - θ cos(nθ)/n] / θ³.
pub(super) fn arc_shapes(n: f64, theta: f64) -> (f64, f64) {
    let x = n * theta;
    if x.abs() < 1e-3 {
        return (1.0 - x * x / 6.0, n * (1.0 - x * x / 10.0));
    }
    (x.sin() / x, 3.0 * (x.sin() / (n * n) - theta * x.cos() / n) / theta.powi(3))
}

/// Flexibility between the arc loads of two teeth of a plane-strain annulus, times Young's modulus and face width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ArcFlexibility {
    /// Rows and columns: tangential force, moment / r_f, radial force. Row: response at angle ψ, column: load at 0.
    pub matrix: [[f64; 3]; 3],
}

/// Sums harmonics `0..=terms`, each weighted by `weight(n)`, for an annulus of outer radius 1 and inner radius `inner`,
/// loaded on arcs of half angle `theta`, `psi` apart.
pub(super) fn arc_flexibility(
    inner: f64,
    theta: f64,
    psi: f64,
    nu: f64,
    terms: u32,
    weight: impl Fn(u32) -> f64,
) -> ArcFlexibility {
    let mut s = [[0.0; 3]; 3];
    for n in 0..=terms {
        let factor = weight(n) * if n == 0 { 0.5 } else { 1.0 } / std::f64::consts::PI;
        if factor == 0.0 {
            continue;
        }
        let g = harmonic_flexibility(n, inner, nu);
        let (uniform, linear) = arc_shapes(n as f64, theta);
        let q = [[0.0, uniform], [-linear, uniform], [uniform, 0.0]];
        let (sin, cos) = (n as f64 * psi).sin_cos();
        for a in 0..3 {
            for b in 0..3 {
                let value: f64 =
                    (0..2).map(|i| (0..2).map(|j| q[a][i] * g[i][j] * q[b][j]).sum::<f64>()).sum::<f64>() * factor;
                let phase = match (a < 2, b < 2) {
                    (true, false) => -sin,
                    (false, true) => sin,
                    _ => cos,
                };
                s[a][b] += value * phase;
            }
        }
    }
    ArcFlexibility { matrix: s }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_oracle::check_worst;

    const TOPIC: &str = "Contact: body under a tooth, annulus";

    /// Exact centre values, from an independent summation: h = r_f/r_inner, θ_f, L*, M*, P*, radial.
    const TABLE: [(f64, f64, [f64; 4]); 10] = [
        (1.2, 0.05, [4.9993, 0.8117, 1.5908, 0.9040]),
        (1.2, 0.18, [3.4292, 0.6116, 0.9106, 0.3345]),
        (1.4, 0.05, [5.1749, 1.0117, 2.0717, 1.2194]),
        (1.4, 0.08, [5.0821, 1.0006, 1.8048, 0.9597]),
        (1.4, 0.12, [4.8937, 0.9972, 1.5775, 0.7465]),
        (2.0, 0.05, [5.2413, 1.2131, 2.9497, 1.5882]),
        (2.0, 0.12, [5.2398, 1.4569, 2.4485, 1.0951]),
        (2.0, 0.18, [5.2066, 1.6679, 2.2167, 0.8751]),
        (3.0, 0.08, [5.3043, 1.7026, 3.9799, 1.5580]),
        (3.0, 0.18, [5.4884, 2.5283, 3.5129, 1.1020]),
    ];

    #[test]
    fn flexibility_matches_the_reference_table() {
        let mut errors = Vec::new();
        for (h, theta, expected) in TABLE {
            let s = arc_flexibility(1.0 / h, theta, 0.0, 0.3, 4000, |_| 1.0).matrix;
            let sf = 2.0 * theta;
            let got = [s[1][1] * sf * sf, 2.0 * s[0][1] * sf, s[0][0], s[2][2]];
            errors.push([0, 1, 2, 3].map(|i| got[i] / expected[i] - 1.0));
        }
        for (i, what) in ["L*, moment", "M*, moment and force", "P*, force", "radial force"].into_iter().enumerate() {
            check_worst(
                TOPIC,
                &format!("{what}, ten combinations of bore and root arc"),
                errors.iter().map(|e| e[i]),
                3e-3,
            );
        }
    }

    #[test]
    fn high_harmonics_do_not_reach_the_held_circle() {
        let mut errors = Vec::new();
        // The last two harmonics of one form and the first of the other: n times flexibility runs on straight.
        let last = (NEGLIGIBLE.ln() / 0.6f64.ln()).floor() as u32;
        let [before, now, after] =
            [last - 1, last, last + 1].map(|n| harmonic_flexibility(n, 0.6, 0.3).map(|r| r.map(|f| f64::from(n) * f)));
        for i in 0..2 {
            for j in 0..2 {
                errors.push((after[i][j] - 2.0 * now[i][j] + before[i][j]) / now[0][0]);
            }
        }
        check_worst(TOPIC, "n times flexibility, from one form to the other", errors, 2e-4);
    }

    #[test]
    fn maxwell_symmetry_holds() {
        let mut errors = Vec::new();
        for psi in [0.0, 0.1, -0.3] {
            let a = arc_flexibility(0.6, 0.1, psi, 0.3, 300, |_| 1.0).matrix;
            let b = arc_flexibility(0.6, 0.1, -psi, 0.3, 300, |_| 1.0).matrix;
            for i in 0..3 {
                for j in 0..3 {
                    errors.push((a[i][j] - b[j][i]) / a[0][0]);
                }
            }
        }
        check_worst(TOPIC, "symmetry: i by j against j by i", errors, 1e-12);
    }
}
