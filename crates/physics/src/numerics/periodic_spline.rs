//! Periodic cubic splines through unequally spaced phases.

/// The knots of periodic cubic splines, with the factored system that gives their slopes (continuous second derivative;
/// C. de Boor, A Practical Guide to Splines, chapter IV).
#[derive(Debug, Clone)]
pub struct PeriodicSpline {
    /// Ascending within one period.
    phase: Vec<f64>,
    /// Width of every interval; the last one leads to the first knot of the next period.
    width: Vec<f64>,
    /// Thomas factors of the system without its corners, and the solution that carries the corners (Sherman and
    /// Morrison).
    pivot: Vec<f64>,
    corner: Vec<f64>,
    gamma: f64,
}

impl PeriodicSpline {
    /// Knots at `phase`, ascending within [φ₀, φ₀ + 1); at least three.
    pub fn new(phase: Vec<f64>) -> PeriodicSpline {
        let n = phase.len();
        let width: Vec<f64> =
            (0..n).map(|i| if i + 1 < n { phase[i + 1] - phase[i] } else { phase[0] + 1.0 - phase[i] }).collect();
        // Row i: slope[i-1]/h[i-1] + 2 (1/h[i-1] + 1/h[i]) slope[i] + slope[i+1]/h[i].
        let before = |i: usize| 1.0 / width[(i + n - 1) % n];
        let after = |i: usize| 1.0 / width[i];
        let gamma = -2.0 * (before(0) + after(0));
        let mut diagonal: Vec<f64> = (0..n).map(|i| 2.0 * (before(i) + after(i))).collect();
        diagonal[0] -= gamma;
        diagonal[n - 1] -= before(0) * before(0) / gamma;
        let mut pivot = diagonal;
        for i in 1..n {
            pivot[i] -= before(i) * before(i) / pivot[i - 1];
        }
        let mut knots = PeriodicSpline { phase, width, pivot, corner: vec![0.0; n], gamma };
        let mut corner = vec![0.0; n];
        corner[0] = gamma;
        corner[n - 1] = 1.0 / knots.width[n - 1];
        knots.solve(&mut corner);
        knots.corner = corner;
        knots
    }

    /// Phases of the knots, ascending.
    pub fn phase(&self) -> &[f64] {
        &self.phase
    }

    /// Widths of the intervals.
    pub fn width(&self) -> &[f64] {
        &self.width
    }

    /// Solves the system without its corners in place.
    fn solve(&self, x: &mut [f64]) {
        let n = x.len();
        let between = |i: usize| 1.0 / self.width[i - 1];
        for i in 1..n {
            x[i] -= between(i) / self.pivot[i - 1] * x[i - 1];
        }
        x[n - 1] /= self.pivot[n - 1];
        for i in (0..n - 1).rev() {
            x[i] = (x[i] - between(i + 1) * x[i + 1]) / self.pivot[i];
        }
    }

    /// Slopes per phase of the spline through `value` at the knots.
    pub fn slopes(&self, value: &[f64]) -> Vec<f64> {
        let n = value.len();
        let rate = |i: usize| (value[(i + 1) % n] - value[i]) / self.width[i] / self.width[i];
        let mut slope: Vec<f64> = (0..n).map(|i| 3.0 * (rate((i + n - 1) % n) + rate(i))).collect();
        self.solve(&mut slope);
        let corner = 1.0 / self.width[n - 1];
        let along = |x: &[f64]| x[0] + corner * x[n - 1] / self.gamma;
        let factor = along(&slope) / (1.0 + along(&self.corner));
        slope.iter_mut().zip(&self.corner).for_each(|(s, c)| *s -= factor * c);
        slope
    }

    /// The interval that holds `phase`, and the place in it, 0 … 1.
    pub fn interval(&self, phase: f64) -> (usize, f64) {
        let phase = self.phase[0] + (phase - self.phase[0]).rem_euclid(1.0);
        let i = self.phase.partition_point(|&p| p <= phase).max(1) - 1;
        (i, (phase - self.phase[i]) / self.width[i])
    }

    /// The spline with these values and slopes at `phase`.
    pub fn value(&self, value: &[f64], slope: &[f64], phase: f64) -> f64 {
        self.value_and_slope(value, slope, phase).0
    }

    /// The same with its slope per phase.
    pub fn value_and_slope(&self, value: &[f64], slope: &[f64], phase: f64) -> (f64, f64) {
        let (i, u) = self.interval(phase);
        let c = self.cubic(value, slope, i);
        (c[0] + u * (c[1] + u * (c[2] + u * c[3])), (c[1] + u * (2.0 * c[2] + u * 3.0 * c[3])) / self.width[i])
    }

    /// The cubic of interval `i` over the place in it.
    pub fn cubic(&self, value: &[f64], slope: &[f64], i: usize) -> [f64; 4] {
        let next = (i + 1) % value.len();
        let (m0, m1) = (slope[i] * self.width[i], slope[next] * self.width[i]);
        let rise = value[next] - value[i];
        [value[i], m0, 3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_oracle::check_worst;
    use std::f64::consts::TAU;

    fn unequal(n: usize) -> Vec<f64> {
        (0..n).map(|i| (i as f64 + 0.3 * (2.4 * i as f64).sin()) / n as f64 + 0.02).collect()
    }

    #[test]
    fn smooth_curves_converge_with_the_fourth_power_of_the_step() {
        let curve = |p: f64| (TAU * p).sin() + 0.3 * (3.0 * TAU * p).cos();
        let worst = |n: usize| {
            let knots = PeriodicSpline::new(unequal(n));
            let value: Vec<f64> = knots.phase().iter().map(|&p| curve(p)).collect();
            let slope = knots.slopes(&value);
            (0..997)
                .map(|i| f64::from(i) / 997.0)
                .map(|p| knots.value(&value, &slope, p) - curve(p))
                .fold(0.0f64, |m, e| m.max(e.abs()))
        };
        let (coarse, fine) = (worst(40), worst(160));
        assert!(fine < 1e-5 && fine < coarse / 150.0, "{coarse} {fine}");
    }

    #[test]
    fn second_derivatives_are_continuous_around_the_period() {
        let knots = PeriodicSpline::new(unequal(9));
        let value: Vec<f64> = (0..9).map(|i| (1.7 * f64::from(i)).sin()).collect();
        let slope = knots.slopes(&value);
        let jumps = (0..9).map(|i| {
            let (left, right) = (knots.cubic(&value, &slope, i), knots.cubic(&value, &slope, (i + 1) % 9));
            let (h, k) = (knots.width()[i], knots.width()[(i + 1) % 9]);
            (2.0 * left[2] + 6.0 * left[3]) / (h * h) - 2.0 * right[2] / (k * k)
        });
        check_worst("Contact: periodic spline", "jump of the second derivative", jumps, 1e-9);
    }
}
