//! Gauss–Legendre rules.

/// Abscissas and weights on [-1, 1], by Newton's method on the Legendre polynomial.
pub(super) fn gauss(points: usize) -> Vec<(f64, f64)> {
    let n = points.max(1);
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..100 {
                let (mut p0, mut p1) = (1.0, x);
                for k in 2..=n {
                    let k = k as f64;
                    (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
                }
                slope = n as f64 * (x * p1 - p0) / (x * x - 1.0);
                let step = p1 / slope;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

/// The same rule on [a, b].
pub(super) fn gauss_on(rule: &[(f64, f64)], a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    rule.iter().map(move |&(x, w)| (middle + half * x, half * w))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_exact_to_their_degree() {
        for n in 1..=16 {
            let rule = gauss(n);
            for degree in 0..2 * n {
                let got: f64 = gauss_on(&rule, 0.0, 1.0).map(|(x, w)| w * x.powi(degree as i32)).sum();
                assert!((got - 1.0 / (degree as f64 + 1.0)).abs() < 1e-14, "{n} points, degree {degree}: {got}");
            }
        }
    }
}
