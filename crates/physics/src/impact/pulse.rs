//! The impact as a force over time: one half sine per mesh period.

use std::f64::consts::{FRAC_PI_2, PI};

/// A half sine of positive duration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSine {
    force_n: f64,
    duration_s: f64,
    start_s: f64,
}

impl HalfSine {
    /// `None` unless the duration is positive and all values are finite.
    pub fn new(force_n: f64, duration_s: f64, start_s: f64) -> Option<HalfSine> {
        let good = duration_s > 0.0 && [force_n, duration_s, start_s].iter().all(|v| v.is_finite());
        good.then_some(HalfSine { force_n, duration_s, start_s })
    }

    /// Peak force.
    pub fn force_n(&self) -> f64 {
        self.force_n
    }

    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    pub fn start_s(&self) -> f64 {
        self.start_s
    }

    /// Force of the single pulse at time `t_s`.
    pub fn at_n(&self, t_s: f64) -> f64 {
        self.after_start_n(t_s - self.start_s)
    }

    fn after_start_n(&self, u_s: f64) -> f64 {
        if u_s > 0.0 && u_s < self.duration_s { self.force_n * (PI * u_s / self.duration_s).sin() } else { 0.0 }
    }

    /// Force at `t_s` when the pulse repeats every `period_s` > 0; pulses longer than the period add up.
    pub fn periodic_n(&self, t_s: f64, period_s: f64) -> f64 {
        let first = (t_s - self.start_s).rem_euclid(period_s);
        let pulses = (self.duration_s / period_s).ceil();
        let mut sum = 0.0;
        let mut pulse = 0.0;
        while pulse < pulses {
            sum += self.after_start_n(first + pulse * period_s);
            pulse += 1.0;
        }
        sum
    }

    /// Impulse of one pulse, `2 F t / pi`.
    pub fn impulse_n_s(&self) -> f64 {
        2.0 * self.force_n * self.duration_s / PI
    }

    /// Mean force when repeated every `period_s`.
    pub fn mean_n(&self, period_s: f64) -> f64 {
        self.impulse_n_s() / period_s
    }

    /// Fourier coefficients `(a, b)` of harmonic `n >= 1` of the repeated pulse: `F(t) = mean + Σ a_n cos(2 pi n t/period) +
    /// b_n sin(2 pi n t/period)`.
    ///
    /// The transform of a half sine of length `t` is `exp(-i q) (pi t/2) sin(d)/(d (pi/2 + q))`, `q = pi n t/period`,
    /// `d = pi/2 - q`: written so, it has no singular harmonic.
    pub fn harmonic_n(&self, n: u32, period_s: f64) -> (f64, f64) {
        let q = PI * f64::from(n) * self.duration_s / period_s;
        let d = FRAC_PI_2 - q;
        let sinc = if d.abs() < 1e-8 { 1.0 } else { d.sin() / d };
        let size = self.force_n * FRAC_PI_2 * self.duration_s * sinc / (FRAC_PI_2 + q);
        let angle = 2.0 * PI * f64::from(n) * self.start_s / period_s + q;
        (2.0 / period_s * size * angle.cos(), 2.0 / period_s * size * angle.sin())
    }

    /// Times within `[0, period_s)` at which the repeated pulse starts and ends, where its slope jumps.
    pub fn kinks_s(&self, period_s: f64) -> [f64; 2] {
        [self.start_s.rem_euclid(period_s), (self.start_s + self.duration_s).rem_euclid(period_s)]
    }
}
