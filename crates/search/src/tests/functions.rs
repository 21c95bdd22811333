//! Test functions with known optima.

use crate::Score;

/// A function of several variables, each within the same bounds, with its least value.
pub(super) struct Problem {
    pub name: &'static str,
    pub dimensions: usize,
    pub bounds: [f64; 2],
    pub least: f64,
    pub function: fn(&[f64]) -> f64,
}

impl Problem {
    pub(super) fn score(&self, point: &[f64]) -> Score {
        let [low, high] = self.bounds;
        let x: Vec<f64> = point.iter().map(|part| low + part * (high - low)).collect();
        Score::feasible((self.function)(&x))
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// Charalambous and Bandler 1976, second problem.
fn cb2(x: &[f64]) -> f64 {
    let (a, b) = (x[0], x[1]);
    largest(&[a * a + b.powi(4), (2.0 - a).powi(2) + (2.0 - b).powi(2), 2.0 * (b - a).exp()])
}

/// Their third problem.
fn cb3(x: &[f64]) -> f64 {
    let (a, b) = (x[0], x[1]);
    largest(&[a.powi(4) + b * b, (2.0 - a).powi(2) + (2.0 - b).powi(2), 2.0 * (b - a).exp()])
}

/// Rosen and Suzuki 1965 as a minimax problem (Charalambous 1977): the objective, and it with ten times each
/// constraint.
fn rosen_suzuki(x: &[f64]) -> f64 {
    let [a, b, c, d] = [x[0], x[1], x[2], x[3]];
    let f = a * a + b * b + 2.0 * c * c + d * d - 5.0 * a - 5.0 * b - 21.0 * c + 7.0 * d;
    let constraints = [
        a * a + b * b + c * c + d * d + a - b + c - d - 8.0,
        a * a + 2.0 * b * b + c * c + 2.0 * d * d - a - d - 10.0,
        2.0 * a * a + b * b + c * c + 2.0 * a - b - d - 5.0,
    ];
    f + 10.0 * largest(&constraints).max(0.0)
}

/// Wong's first problem (Asaadi 1973) as a minimax problem.
fn wong_1(x: &[f64]) -> f64 {
    let [a, b, c, d, e, f, g] = [x[0], x[1], x[2], x[3], x[4], x[5], x[6]];
    let objective = (a - 10.0).powi(2)
        + 5.0 * (b - 12.0).powi(2)
        + c.powi(4)
        + 3.0 * (d - 11.0).powi(2)
        + 10.0 * e.powi(6)
        + 7.0 * f * f
        + g.powi(4)
        - 4.0 * f * g
        - 10.0 * f
        - 8.0 * g;
    let constraints = [
        2.0 * a * a + 3.0 * b.powi(4) + c + 4.0 * d * d + 5.0 * e - 127.0,
        7.0 * a + 3.0 * b + 10.0 * c * c + d - e - 282.0,
        23.0 * a + b * b + 6.0 * f * f - 8.0 * g - 196.0,
        4.0 * a * a + b * b - 3.0 * a * b + 2.0 * c * c + 5.0 * f - 11.0 * g,
    ];
    objective + 10.0 * largest(&constraints).max(0.0)
}

/// Wong's second problem as a minimax problem.
fn wong_2(x: &[f64]) -> f64 {
    let [a, b, c, d, e, f, g, h, i, j] = [x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], x[8], x[9]];
    let objective = a * a + b * b + a * b - 14.0 * a - 16.0 * b
        + (c - 10.0).powi(2)
        + 4.0 * (d - 5.0).powi(2)
        + (e - 3.0).powi(2)
        + 2.0 * (f - 1.0).powi(2)
        + 5.0 * g * g
        + 7.0 * (h - 11.0).powi(2)
        + 2.0 * (i - 10.0).powi(2)
        + (j - 7.0).powi(2)
        + 45.0;
    let constraints = [
        3.0 * (a - 2.0).powi(2) + 4.0 * (b - 3.0).powi(2) + 2.0 * c * c - 7.0 * d - 120.0,
        5.0 * a * a + 8.0 * b + (c - 6.0).powi(2) - 2.0 * d - 40.0,
        0.5 * (a - 8.0).powi(2) + 2.0 * (b - 4.0).powi(2) + 3.0 * e * e - f - 30.0,
        a * a + 2.0 * (b - 2.0).powi(2) - 2.0 * a * b + 14.0 * e - 6.0 * f,
        4.0 * a + 5.0 * b - 3.0 * g + 9.0 * h - 105.0,
        10.0 * a - 8.0 * b - 17.0 * g + 2.0 * h,
        -3.0 * a + 6.0 * b + 12.0 * (i - 8.0).powi(2) - 7.0 * j,
        -8.0 * a + 2.0 * b + 5.0 * i - 2.0 * j - 12.0,
    ];
    objective + 10.0 * largest(&constraints).max(0.0)
}

/// Non-smooth problems with kinks at the optimum.
pub(super) const MINIMAX: [Problem; 5] = [
    Problem { name: "CB2", dimensions: 2, bounds: [-5.0, 5.0], least: 1.952_224_5, function: cb2 },
    Problem { name: "CB3", dimensions: 2, bounds: [-5.0, 5.0], least: 2.0, function: cb3 },
    Problem { name: "Rosen-Suzuki", dimensions: 4, bounds: [-5.0, 5.0], least: -44.0, function: rosen_suzuki },
    Problem { name: "Wong 1", dimensions: 7, bounds: [-10.0, 10.0], least: 680.630_057_3, function: wong_1 },
    Problem { name: "Wong 2", dimensions: 10, bounds: [-10.0, 10.0], least: 24.306_209_1, function: wong_2 },
];

/// Rosenbrock's function.
pub(super) fn rosenbrock(x: &[f64]) -> f64 {
    x.windows(2).map(|pair| 100.0 * (pair[1] - pair[0] * pair[0]).powi(2) + (1.0 - pair[0]).powi(2)).sum()
}

/// Ishigami's function, a = 7, b = 0.1, of three variables in \[−π, π\] given as parts of that range.
pub(super) fn ishigami(point: &[f64]) -> f64 {
    let angle = |part: f64| std::f64::consts::PI * (2.0 * part - 1.0);
    let [a, b, c] = [angle(point[0]), angle(point[1]), angle(point[2])];
    a.sin() + 7.0 * b.sin().powi(2) + 0.1 * c.powi(4) * a.sin()
}
