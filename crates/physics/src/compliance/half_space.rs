//! Line contact on half-spaces: the surface displacement under a narrow Hertzian band, along the band and outside it.
//!
//! Used with a bulk flexibility from which the half-space part has been taken: no depth has to be chosen. A segment of
//! the contact line of length l, loaded by w per length with an elliptic pressure over the width 2b, presses its own
//! middle in by
//!
//! ```text
//! u = 2 (1-ν²)/(πE) w G(l / 2b),   G(r) = (4/π) ∫₀^{π/2} cos²θ asinh(r / sinθ) dθ
//! (G(r) → ln 4r + 1/2 + 1/(16 r²) for r >> 1)
//! ```
//!
//! and a point on the line at the distances η₁ < η₂ from its ends by (1-ν²)/(πE) w [G(η₂/b) - G(η₁/b)] (ln(η₂/η₁) where
//! the band is narrow).

use std::f64::consts::{FRAC_PI_2, LN_2, PI};

/// Ratio beyond which the asymptotic form is exact to 1e-5.
const FAR: f64 = 4.0;
/// Abscissae of the midpoint rule over θ: the integrand is smooth and periodic, so that the rule converges
/// exponentially.
const ABSCISSAE: usize = 24;

/// G(r) and its derivative.
pub(super) fn own(r: f64) -> (f64, f64) {
    if r > FAR {
        let r2 = r * r;
        return ((4.0 * r).ln() + 0.5 + 1.0 / (16.0 * r2), 1.0 / r - 1.0 / (8.0 * r2 * r));
    }
    // asinh(r / sinθ) = ln(r + √(r² + sin²θ)) - ln sinθ, and ∫ cos²θ ln sinθ dθ = -π/4 (ln 2 + 1/2).
    let r = r.max(1e-3);
    let (mut value, mut slope) = (0.0, 0.0);
    for k in 0..ABSCISSAE {
        let (sin, cos) = (FRAC_PI_2 * (k as f64 + 0.5) / ABSCISSAE as f64).sin_cos();
        let root = (r * r + sin * sin).sqrt();
        value += cos * cos * (r + root).ln();
        slope += cos * cos / root;
    }
    let weight = 4.0 / PI * FRAC_PI_2 / ABSCISSAE as f64;
    (LN_2 + 0.5 + weight * value, weight * slope)
}

/// G(η₂/b) - G(η₁/b) of a segment `[from, to]` with the half width `b`, seen from `at` outside it.
pub(super) fn beside(at: f64, (from, to): (f64, f64), b: f64) -> f64 {
    let (near, far) = if at < from { (from - at, to - at) } else { (at - to, at - from) };
    if near > FAR * b { (far / near).ln() } else { own(far / b).0 - own(near / b).0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_oracle::check_worst;

    const TOPIC: &str = "Contact: line contact on a half-space";

    /// The integral by the substitution θ = t³, which takes the logarithm out, on a fine grid.
    fn direct(r: f64) -> f64 {
        let n = 20_000;
        let end = FRAC_PI_2.cbrt();
        let sum: f64 = (0..n)
            .map(|k| {
                let t = end * (k as f64 + 0.5) / n as f64;
                let theta = t.powi(3);
                theta.cos().powi(2) * (r / theta.sin()).asinh() * 3.0 * t * t
            })
            .sum();
        4.0 / PI * sum * end / n as f64
    }

    #[test]
    fn own_displacement_is_the_integral() {
        let ratios = [0.1, 0.3, 1.0, 3.0, 3.999, 4.001, 10.0, 100.0];
        check_worst(TOPIC, "G(r) against direct integration", ratios.map(|r| own(r).0 / direct(r) - 1.0), 1e-4);
        let slopes = ratios.map(|r| {
            let step = 1e-4 * r;
            (own(r + step).0 - own(r - step).0) / (2.0 * step * own(r).1) - 1.0
        });
        check_worst(TOPIC, "slope of G against differences", slopes, 1e-2);
    }

    /// A line cut into ever shorter segments has the same displacement in its middle as one segment.
    #[test]
    fn segments_add_up_to_the_whole_line() {
        let (length, half_width) = (20.0, 0.05);
        let whole = 2.0 * own(length / (2.0 * half_width)).0;
        let errors = [5usize, 11, 41, 201].map(|count| {
            let step = length / count as f64;
            let middle = 0.5 * length;
            let sum: f64 = (0..count)
                .map(|k| {
                    let (from, to) = (step * k as f64, step * (k + 1) as f64);
                    if k == count / 2 {
                        2.0 * own(step / (2.0 * half_width)).0
                    } else {
                        beside(middle, (from, to), half_width)
                    }
                })
                .sum();
            sum / whole - 1.0
        });
        check_worst(TOPIC, "middle of a line in 5, 11, 41 and 201 segments against the whole", errors, 2e-3);
    }
}
