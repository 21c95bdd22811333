//! The first zero of a polynomial that starts positive: where a tooth changes the side of its backlash.

/// First τ in (0, h] at which the polynomial Σ c_n τ^n, not negative at 0, passes below zero.
///
/// The search advances by d with g + g' d − ½ A d² = 0, where A bounds |g''| on [0, h]: no zero can be passed over, minima
/// that dip below zero between the ends of the step included, and towards a simple zero it converges as Newton's method
/// does, from the near side. A dip shallower than rounding (1e-16 of A h²) is not seen.
pub(super) fn first_crossing(c: &[f64], h: f64) -> Option<f64> {
    let mut bound = 0.0;
    let mut reach = 0.0;
    let mut power = 1.0;
    for (n, &cn) in c.iter().enumerate().skip(1) {
        let size = cn.abs() * power;
        reach += size * h;
        if n >= 2 {
            bound += (n * (n - 1)) as f64 * size / h;
        }
        power *= h;
    }
    if c[0] > reach {
        return None;
    }
    let mut floor = 1e-9 * h;
    let mut at = 0.0;
    let mut previous = 0.0;
    for iteration in 0.. {
        let (g, dg) = evaluate(c, at);
        let g = if at == 0.0 { g.max(0.0) } else { g };
        if g < 0.0 {
            return Some(bisected_newton(c, previous, at));
        }
        let root = (dg * dg + 2.0 * bound * g).sqrt();
        let safe = if dg < 0.0 { 2.0 * g / (root - dg) } else { (dg + root) / bound };
        // A bound of zero: a straight line, or a constant.
        let advance = if safe.is_nan() { h } else { safe.max(floor) };
        if at >= h {
            return None;
        }
        if iteration > 60 {
            // Only a long stretch that nearly touches comes here; the resolution is lowered so that the search ends.
            floor *= 1.5;
        }
        previous = at;
        at = (at + advance).min(h);
    }
    None
}

/// Value and derivative.
#[inline(always)]
pub(super) fn evaluate(c: &[f64], t: f64) -> (f64, f64) {
    let (mut g, mut dg) = (0.0, 0.0);
    for &cn in c.iter().rev() {
        dg = dg * t + g;
        g = g * t + cn;
    }
    (g, dg)
}

/// The zero between `low` (not negative) and `high` (negative), to rounding.
fn bisected_newton(c: &[f64], mut low: f64, mut high: f64) -> f64 {
    let mut at = low;
    for _ in 0..80 {
        let (g, dg) = evaluate(c, at);
        if g < 0.0 {
            high = at;
        } else {
            low = at;
        }
        let newton = at - g / dg;
        let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
        if next == at || (high - low) <= f64::EPSILON * high {
            break;
        }
        if (next - at).abs() <= 0.5 * f64::EPSILON * next {
            at = next;
            break;
        }
        at = next;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients of (τ − r)·(…) products.
    fn polynomial(roots: &[f64], lead: f64) -> Vec<f64> {
        roots.iter().fold(vec![lead], |p, r| {
            let mut q = vec![0.0; p.len() + 1];
            for (i, c) in p.iter().enumerate() {
                q[i + 1] += c;
                q[i] -= r * c;
            }
            q
        })
    }

    #[test]
    fn finds_the_first_of_two_close_roots() {
        // Positive, dips below zero between 0.5 and 0.5 + 1e-6, comes back.
        let c = polynomial(&[0.5, 0.5 + 1e-6, -2.0], 1.0);
        let root = first_crossing(&c, 1.0).unwrap();
        assert!((root - 0.5).abs() < 1e-9, "{root}");
    }

    #[test]
    fn does_not_see_a_near_miss() {
        let mut c = polynomial(&[0.5, 0.5], 1.0);
        c[0] += 1e-12;
        assert_eq!(first_crossing(&c, 1.0), None);
    }

    #[test]
    fn starts_at_zero_and_moves_away() {
        assert_eq!(first_crossing(&[0.0, 1.0, -0.5], 1.0), None);
        let root = first_crossing(&[0.0, 1.0, -2.0], 1.0).unwrap();
        assert!((root - 0.5).abs() < 1e-15);
    }

    #[test]
    fn leaves_at_once_when_it_starts_downwards() {
        assert!(first_crossing(&[0.0, -1.0, 0.1], 1.0).unwrap() < 1e-15);
    }

    #[test]
    fn handles_constants() {
        assert_eq!(first_crossing(&[1.0, 0.0, 0.0], 1.0), None);
        assert_eq!(first_crossing(&[0.0, 0.0, 0.0], 1.0), None);
    }
}
