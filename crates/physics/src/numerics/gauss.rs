//! Gauss–Legendre quadrature (Abramowitz and Stegun, Handbook of Mathematical Functions, 25.4.29 and 25.4.30).

use std::f64::consts::PI;

/// Two-point rule on [-1, 1]: abscissae and weights.
pub(crate) const GAUSS_2: [(f64, f64); 2] = [(-0.577_350_269_189_625_8, 1.0), (0.577_350_269_189_625_8, 1.0)];

/// Three-point rule on [-1, 1]: abscissae and weights.
pub(crate) const GAUSS_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Positive abscissae of the twelve-point rule on [-1, 1] and their weights (Abramowitz and Stegun, table 25.4).
const POSITIVE_12: [(f64, f64); 6] = [
    (0.125_233_408_511_469, 0.249_147_045_813_403),
    (0.367_831_498_998_180, 0.233_492_536_538_355),
    (0.587_317_954_286_617, 0.203_167_426_723_066),
    (0.769_902_674_194_305, 0.160_078_328_543_346),
    (0.904_117_256_370_475, 0.106_939_325_995_318),
    (0.981_560_634_246_719, 0.047_175_336_386_512),
];

/// Twelve-point rule on [-1, 1], in pairs of opposite abscissae from the middle outwards.
pub(crate) fn gauss_12() -> impl Iterator<Item = (f64, f64)> {
    POSITIVE_12.into_iter().flat_map(|(x, w)| [(x, w), (-x, w)])
}

/// Abscissae and weights of the rule of `points` points on [-1, 1], abscissae descending; exact for polynomials up to
/// degree 2 `points` - 1.
pub(crate) fn gauss_legendre(points: usize) -> Vec<(f64, f64)> {
    gauss_legendre_nodes(points).collect()
}

/// [`gauss_legendre`] one after the other: each costs some steps over all points.
pub(crate) fn gauss_legendre_nodes(points: usize) -> impl Iterator<Item = (f64, f64)> {
    let n = points.max(1);
    (0..n).map(move |i| node(n, i, 100, 1e-15))
}

/// The rule of N points on [0, 1], abscissae ascending.
pub(crate) fn gauss_legendre_unit<const N: usize>() -> [(f64, f64); N] {
    std::array::from_fn(|i| {
        let (x, weight) = node(N, i, 10, 0.0);
        (0.5 * (1.0 - x), 0.5 * weight)
    })
}

/// The rule `rule` of [-1, 1] on [a, b].
pub(crate) fn on_interval(rule: &[(f64, f64)], a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    rule.iter().map(move |&(x, w)| (middle + half * x, half * w))
}

/// Root `i` of the Legendre polynomial P_n, counted from the largest, and its weight 2/((1 - x²) P_n'(x)²): Newton's
/// method from Tricomi's estimate, until a step is below `tolerance` or `most_steps` are made.
fn node(n: usize, i: usize, most_steps: usize, tolerance: f64) -> (f64, f64) {
    let mut x = (PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
    let mut slope = 1.0;
    for _ in 0..most_steps {
        let (mut before, mut value) = (1.0, x);
        for k in 2..=n {
            let k = k as f64;
            (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
        }
        slope = n as f64 * (x * value - before) / (x * x - 1.0);
        let step = value / slope;
        x -= step;
        if step.abs() < tolerance {
            break;
        }
    }
    (x, 2.0 / ((1.0 - x * x) * slope * slope))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest error of a rule over the powers that it integrates exactly, on [0, 1].
    fn worst(rule: &[(f64, f64)]) -> f64 {
        (0..2 * rule.len() as i32)
            .map(|degree| {
                let sum: f64 = rule.iter().map(|(x, w)| w * x.powi(degree)).sum();
                (sum * (f64::from(degree) + 1.0) - 1.0).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn rules_are_exact_to_their_degree() {
        for n in 1..=16 {
            let rule = gauss_legendre(n);
            for degree in 0..2 * n {
                let got: f64 = on_interval(&rule, 0.0, 1.0).map(|(x, w)| w * x.powi(degree as i32)).sum();
                assert!((got - 1.0 / (degree as f64 + 1.0)).abs() < 1e-14, "{n} points, degree {degree}: {got}");
            }
        }
        let error = worst(&gauss_legendre_unit::<24>());
        assert!(error < 1e-12, "24 points on [0, 1]: {error}");
    }

    #[test]
    fn tabulated_rules_are_exact_to_their_degree() {
        for rule in [GAUSS_2.to_vec(), GAUSS_3.to_vec(), gauss_12().collect()] {
            let on_unit: Vec<(f64, f64)> = on_interval(&rule, 0.0, 1.0).collect();
            let error = worst(&on_unit);
            assert!(error < 1e-12, "{} points: {error}", rule.len());
        }
    }
}
