//! First zero crossing of a polynomial, for the location of contact events.

use super::lanes::Real;

/// First τ in (0, h] at which the polynomial Σ c_n τ^n, not negative at 0, becomes negative; infinite where there is
/// none or `active` is 0.
///
/// The search advances by d with g + g' d − ½ A d² = 0, where A bounds −g'' over d. It cannot pass a zero, including
/// minima below zero between the ends of the step, and it converges to a simple zero from below as fast as Newton's
/// method. A is the bound over [0, h] or, where the step becomes longer by it, the bound over d that follows from the
/// third derivative. A minimum that is negative by less than rounding (1e-16 of A h²) is not detected.
#[inline(always)]
pub(super) fn first_crossing<R: Real>(c: &[R], h: R, active: R) -> R {
    let zero = R::splat(0.0);
    let (mut reach, mut second, mut third) = (zero, zero, zero);
    let mut power = R::splat(1.0);
    for (n, &cn) in c.iter().enumerate().skip(1) {
        let n = n as f64;
        let size = cn.map(f64::abs) * power;
        reach += size * h;
        second += size * R::splat(n * (n - 1.0));
        third += size * R::splat(n * (n - 1.0) * (n - 2.0));
        power = power * h;
    }
    let mut at = R::splat(f64::INFINITY);
    // 1 in lanes that are still searching.
    let mut open = R::from_fn(|l| if active.get(l) != 0.0 && c[0].get(l) <= reach.get(l) { 1.0 } else { 0.0 });
    if !open.any(|o| o != 0.0) {
        return at;
    }
    let second = second / h;
    let third = third / (h * h);
    let mut floor = h * R::splat(1e-9);
    let (mut here, mut previous) = (zero, zero);
    // Value and slope at `previous`.
    let (mut g_before, mut dg_before) = (zero, zero);
    for iteration in 0.. {
        let (g, dg, half_ddg) = evaluate(c, here);
        let g = g.zip(here, |g, here| if here == 0.0 { g.max(0.0) } else { g });
        for l in 0..R::LANES {
            if open.get(l) != 0.0 && g.get(l) < 0.0 {
                // Steps shrink with the distance to a simple zero, so the last point before it is close enough for one
                // Newton step. Near a minimum it is not: there bisection brackets Newton's method.
                let (low, high) = (previous.get(l), here.get(l));
                let newton = -g_before.get(l) / dg_before.get(l);
                let simple = high - low <= 2e-9 * h.get(l) && newton >= 0.0 && newton < high - low;
                at.set(l, if simple { low + newton } else { bisected_newton(c, l, low, high) });
                open.set(l, 0.0);
            }
        }
        open = R::from_fn(|l| if here.get(l) < h.get(l) { open.get(l) } else { 0.0 });
        if !open.any(|o| o != 0.0) {
            break;
        }
        let left = h - here;
        let mut step = safe_step(g, dg, second, left);
        // Steps over which g'' has tighter bounds, from the whole remaining interval down.
        for part in [1.0, 0.2] {
            let length = left * R::splat(part);
            let local = (third * length * R::splat(1.0 / 3.0) - half_ddg * R::splat(2.0)).map(|a| a.max(0.0));
            step = step.zip(safe_step(g, dg, local, length), f64::max);
        }
        if iteration > 60 {
            // Reached only where the polynomial stays close to zero over a long interval. The resolution is reduced so
            // that the search ends.
            floor = floor * R::splat(1.5);
        }
        (previous, g_before, dg_before) = (here, g, dg);
        here = (here + step.zip(floor, f64::max)).zip(h, f64::min);
    }
    at
}

/// Largest d up to `most` with g + g' d − ½ A d² > 0, where A = `bound` ≥ 0 bounds −g'' up to `most`.
#[inline(always)]
fn safe_step<R: Real>(g: R, dg: R, bound: R, most: R) -> R {
    let root = (dg * dg + R::splat(2.0) * bound * g).map(f64::sqrt);
    let falling = g * R::splat(2.0) / (root - dg);
    let rising = (dg + root) / bound;
    R::from_fn(|l| {
        let safe = if dg.get(l) < 0.0 { falling.get(l) } else { rising.get(l) };
        // A bound of zero: a straight line that rises, or a constant.
        if safe.is_nan() { most.get(l) } else { safe.min(most.get(l)) }
    })
}

/// Value, derivative and half the second derivative.
#[inline(always)]
fn evaluate<R: Real>(c: &[R], t: R) -> (R, R, R) {
    let zero = R::splat(0.0);
    let (mut g, mut dg, mut half_ddg) = (zero, zero, zero);
    for &cn in c.iter().rev() {
        half_ddg = half_ddg * t + dg;
        dg = dg * t + g;
        g = g * t + cn;
    }
    (g, dg, half_ddg)
}

/// Zero of one lane's polynomial between `low` (not negative) and `high` (negative), to rounding.
fn bisected_newton<R: Real>(c: &[R], lane: usize, mut low: f64, mut high: f64) -> f64 {
    let value = |t: f64| {
        let (mut g, mut dg) = (0.0, 0.0);
        for cn in c.iter().rev() {
            dg = dg * t + g;
            g = g * t + cn.get(lane);
        }
        (g, dg)
    };
    // Steps shrink with the distance to the zero, so the last point before it is a good start.
    let mut at = low;
    for _ in 0..80 {
        let (g, dg) = value(at);
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
    use super::super::lanes::Lanes;
    use super::*;

    fn first(c: &[f64], h: f64) -> Option<f64> {
        let alone = first_crossing(c, h, 1.0);
        // The same in one of several lanes, beside another polynomial.
        let lanes: Vec<Lanes<2>> = c.iter().map(|c| Lanes::from_fn(|l| if l == 1 { *c } else { 1.0 - c })).collect();
        let beside = first_crossing(&lanes, Lanes::splat(h), Lanes::splat(1.0)).get(1);
        assert_eq!(alone.to_bits(), beside.to_bits());
        alone.is_finite().then_some(alone)
    }

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
        // Positive, negative between 0.5 and 0.5 + 1e-6, positive again.
        let c = polynomial(&[0.5, 0.5 + 1e-6, -2.0], 1.0);
        let root = first(&c, 1.0).unwrap();
        assert!((root - 0.5).abs() < 1e-9, "{root}");
    }

    #[test]
    fn does_not_see_a_near_miss() {
        let mut c = polynomial(&[0.5, 0.5], 1.0);
        c[0] += 1e-12;
        assert_eq!(first(&c, 1.0), None);
    }

    #[test]
    fn starts_at_zero_and_moves_away() {
        assert_eq!(first(&[0.0, 1.0, -0.5], 1.0), None);
        let root = first(&[0.0, 1.0, -2.0], 1.0).unwrap();
        assert!((root - 0.5).abs() < 1e-15);
    }

    #[test]
    fn leaves_at_once_when_it_starts_downwards() {
        assert!(first(&[0.0, -1.0, 0.1], 1.0).unwrap() < 1e-15);
    }

    #[test]
    fn handles_constants() {
        assert_eq!(first(&[1.0, 0.0, 0.0], 1.0), None);
        assert_eq!(first(&[0.0, 0.0, 0.0], 1.0), None);
    }
}
