//! A periodic curve through unequally spaced phases that keeps its jumps in slope where they are.

/// Piecewise cubic through the samples, monotone between them (Fritsch and Butland's slopes): a jump in slope is felt
/// in the two intervals beside it only, and nothing overshoots.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PeriodicMonotoneCubic {
    phase: Vec<f64>,
    value: Vec<f64>,
    slope: Vec<f64>,
}

impl PeriodicMonotoneCubic {
    /// Through `value` at `phase`, which ascends within one period [φ₀, φ₀ + 1); at least two samples.
    pub(crate) fn new(phase: Vec<f64>, value: Vec<f64>) -> PeriodicMonotoneCubic {
        let n = phase.len();
        let width = |i: usize| if i + 1 < n { phase[i + 1] - phase[i] } else { phase[0] + 1.0 - phase[n - 1] };
        let rise = |i: usize| (value[(i + 1) % n] - value[i]) / width(i);
        let slope = (0..n)
            .map(|i| {
                let before = (i + n - 1) % n;
                let (left, right) = (rise(before), rise(i));
                if left * right <= 0.0 {
                    return 0.0;
                }
                // Brodlie's weights of unequal steps.
                let (h0, h1) = (width(before), width(i));
                let weight = (h0 + 2.0 * h1) / (3.0 * (h0 + h1));
                left * right / (weight * right + (1.0 - weight) * left)
            })
            .collect();
        PeriodicMonotoneCubic { phase, value, slope }
    }

    /// Value at any phase.
    pub(crate) fn at(&self, phase: f64) -> f64 {
        let n = self.phase.len();
        let phase = self.phase[0] + (phase - self.phase[0]).rem_euclid(1.0);
        let i = self.phase.partition_point(|&p| p <= phase).max(1) - 1;
        let next = (i + 1) % n;
        let width = if i + 1 < n { self.phase[next] - self.phase[i] } else { self.phase[0] + 1.0 - self.phase[i] };
        let u = (phase - self.phase[i]) / width;
        let (v0, v1) = (self.value[i], self.value[next]);
        let (m0, m1) = (self.slope[i] * width, self.slope[next] * width);
        let rise = v1 - v0;
        v0 + u * (m0 + u * (3.0 * rise - 2.0 * m0 - m1 + u * (m0 + m1 - 2.0 * rise)))
    }

    /// Values at `count` equally spaced phases from `from`.
    pub(crate) fn samples(&self, from: f64, count: usize) -> Vec<f64> {
        (0..count).map(|i| self.at(from + i as f64 / count as f64)).collect()
    }
}

/// Coefficients of the periodic monotone cubics through `values` at equal steps of one period: c0 + c1 u + c2 u² + c3
/// u³ with u = 0 … 1 from each value to the next. The slopes are Brodlie's harmonic means, within the limits of Fritsch
/// and Carlson (SIAM J. Numer. Anal. 17 (1980) 238, doi:10.1137/0717021).
pub(crate) fn monotone_cubics(values: &[f64]) -> Vec<[f64; 4]> {
    let n = values.len();
    let rise = |i: usize| values[(i + 1) % n] - values[i % n];
    let slope = |i: usize| {
        let (before, after) = (rise(i + n - 1), rise(i));
        if before * after > 0.0 { 2.0 * before * after / (before + after) } else { 0.0 }
    };
    (0..n)
        .map(|i| {
            let (d, m0, m1) = (rise(i), slope(i), slope(i + 1));
            [values[i], m0, 3.0 * d - 2.0 * m0 - m1, m0 + m1 - 2.0 * d]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_oracle::check_worst;

    #[test]
    fn a_kinked_curve_is_kept_between_unequal_samples() {
        let exact = |p: f64| {
            let p = p.rem_euclid(1.0);
            if p < 0.3 { p / 0.3 } else { (1.0 - p) / 0.7 }
        };
        let phase = vec![0.0, 0.1, 0.15, 0.3, 0.4, 0.7, 0.9];
        let curve = PeriodicMonotoneCubic::new(phase.clone(), phase.iter().map(|&p| exact(p)).collect());
        let topic = "Contact: periodic interpolation";
        let far = (0..200).map(|i| f64::from(i) / 100.0 - 0.5).filter(|p| {
            let p = p.rem_euclid(1.0);
            (0.1..0.15).contains(&p) || (0.4..0.9).contains(&p)
        });
        check_worst(topic, "a triangle away from its corners", far.map(|p| curve.at(p) - exact(p)), 1e-12);
        let outside = (0..200).map(|i| curve.at(f64::from(i) / 200.0)).map(|v| (v - 1.0).max(-v).max(0.0));
        check_worst(topic, "overshoot of a triangle", outside, 1e-12);
    }

    #[test]
    fn smooth_curves_converge() {
        let worst = |n: usize| {
            let phase: Vec<f64> = (0..n).map(|i| i as f64 / n as f64).collect();
            let value = phase.iter().map(|p| (std::f64::consts::TAU * p).sin()).collect();
            let curve = PeriodicMonotoneCubic::new(phase, value);
            let error = |i: usize| {
                let p = i as f64 / 1000.0;
                (curve.at(p) - (std::f64::consts::TAU * p).sin()).abs()
            };
            (0..1000).map(error).fold(0.0, f64::max)
        };
        assert!(worst(32) < 6e-3 && worst(128) < worst(32) / 10.0, "{} {}", worst(32), worst(128));
    }
}
