//! Exact time means and extremes of piecewise polynomials.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use crate::dynamics::MAX_ORDER;
use crate::numerics::gauss::gauss_legendre_unit;

/// Gauss–Legendre nodes per segment: exact for powers up to 2·24 − 1 = 47 in time, so for the square of any step's
/// series.
pub(super) const NODES: usize = 24;

/// Nodes and weights over 0 … 1.
pub(super) static GAUSS: LazyLock<[(f64, f64); NODES]> = LazyLock::new(gauss_legendre_unit);

/// Statistics of a channel over the recorded periods. Means are exact time means of the solution's polynomials, not of
/// samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Statistics {
    /// Time mean, in the unit of the channel.
    pub mean: f64,
    /// Root mean square: of displacements, velocities and forces without the mean; of accelerations with it, because
    /// their mean is zero over a periodic motion and part of the motion over a transient.
    pub rms: f64,
    /// Minimum.
    pub min: f64,
    /// Maximum.
    pub max: f64,
}

/// A rule of N nodes, exact for the square of a polynomial of degree N − 1: nodes and weights, and the powers of the
/// nodes, τ_q^n in row n.
struct Rule<const N: usize> {
    nodes: [(f64, f64); N],
    powers: [[f64; N]; MAX_ORDER + 1],
}

impl<const N: usize> Rule<N> {
    fn new() -> Self {
        let nodes: [(f64, f64); N] = gauss_legendre_unit();
        Self { powers: std::array::from_fn(|n| std::array::from_fn(|q| nodes[q].0.powi(n as i32))), nodes }
    }
}

/// Rules for the degrees of the usual orders, and for any.
static RULE_16: LazyLock<Rule<16>> = LazyLock::new(Rule::new);
static RULE_20: LazyLock<Rule<20>> = LazyLock::new(Rule::new);
static RULE: LazyLock<Rule<NODES>> = LazyLock::new(Rule::new);

/// Integrals and extremes of one channel, accumulated by segment.
#[derive(Debug, Clone, Copy)]
pub(super) struct MomentAccumulator {
    /// Subtracted before squaring, so that a large mean costs no digits.
    offset: Option<f64>,
    integral: f64,
    square_integral: f64,
    length: f64,
    min: f64,
    max: f64,
    includes_mean: bool,
}

impl MomentAccumulator {
    /// `includes_mean`: whether the mean square includes the mean.
    pub(crate) fn new(includes_mean: bool) -> Self {
        Self {
            includes_mean,
            offset: None,
            integral: 0.0,
            square_integral: 0.0,
            length: 0.0,
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
        }
    }

    /// Adds the polynomial `c` over [0, h].
    #[inline(always)]
    pub(crate) fn add(&mut self, c: &[f64], h: f64, extremes: bool) {
        // Fewer nodes for a lower degree; in lanes the highest coefficients of one can be zeros.
        match c.iter().rposition(|c| *c != 0.0).unwrap_or(0) {
            0..16 => _ = self.add_by(&RULE_16, c, h, extremes),
            16..20 => _ = self.add_by(&RULE_20, c, h, extremes),
            _ => _ = self.add_by(&RULE, c, h, extremes),
        }
    }

    /// As [`MomentAccumulator::add`]. Returns the values at the nodes of [`GAUSS`], less a constant that is the same
    /// for all segments.
    #[inline(always)]
    pub(crate) fn add_with_values(&mut self, c: &[f64], h: f64, extremes: bool) -> [f64; NODES] {
        self.add_by(&RULE, c, h, extremes)
    }

    #[inline(always)]
    fn add_by<const N: usize>(&mut self, rule: &Rule<N>, c: &[f64], h: f64, extremes: bool) -> [f64; N] {
        let offset = *self.offset.get_or_insert(c[0]);
        let mut b = [0.0; MAX_ORDER + 1];
        let mut power = 1.0;
        for (b, c) in b.iter_mut().zip(c) {
            *b = c * power;
            power *= h;
        }
        b[0] -= offset;
        let b = &b[..c.len()];
        let mut values = [0.0; N];
        for (bi, row) in b.iter().zip(&rule.powers) {
            for (value, power) in values.iter_mut().zip(row) {
                *value += bi * power;
            }
        }
        let (mut mean, mut square) = (0.0, 0.0);
        for (value, (_, weight)) in values.iter().zip(&rule.nodes) {
            mean += weight * value;
            square += weight * value * value;
        }
        self.integral += h * mean;
        self.square_integral += h * square;
        self.length += h;
        if extremes {
            self.add_extremes(b, (&rule.nodes, &values), offset);
        }
        values
    }

    /// Extremes over the unit interval: nodes and both ends, then Newton's method for the derivative from the best of
    /// them.
    fn add_extremes<const N: usize>(&mut self, b: &[f64], (nodes, values): (&[(f64, f64); N], &[f64; N]), offset: f64) {
        let count = N + 2;
        let mut room = [(0.0, b[0]); NODES + 2];
        let points = &mut room[..count];
        for (point, (value, (node, _))) in points[1..].iter_mut().zip(values.iter().zip(nodes)) {
            *point = (*node, *value);
        }
        points[count - 1] = (1.0, b.iter().sum());
        for sign in [1.0, -1.0] {
            let best = if sign > 0.0 { self.max - offset } else { offset - self.min };
            let mut at = 0;
            for i in 1..count {
                if sign * points[i].1 > sign * points[at].1 {
                    at = i;
                }
            }
            let mut top = sign * points[at].1;
            // The vertex of a parabola through neighbouring points exceeds the middle one by less than the larger
            // difference.
            let neighbour = |i: usize| (points[i].1 - points[at].1).abs();
            let margin = neighbour(at.saturating_sub(1)).max(neighbour((at + 1).min(count - 1)));
            if top + margin > best {
                let (low, high) = (points[at.saturating_sub(1)].0, points[(at + 1).min(count - 1)].0);
                let mut t = points[at].0;
                for _ in 0..8 {
                    let (d1, d2) = derivatives(b, t);
                    if d2 * sign >= 0.0 {
                        break;
                    }
                    let next = (t - d1 / d2).clamp(low, high);
                    if (next - t).abs() < 1e-12 {
                        break;
                    }
                    t = next;
                }
                top = top.max(sign * horner(b, t));
            }
            if sign > 0.0 {
                self.max = self.max.max(top + offset);
            } else {
                self.min = self.min.min(offset - top);
            }
        }
    }

    /// Mean, and mean square about the mean unless the mean is included.
    pub(crate) fn mean_and_square(&self) -> (f64, f64) {
        let first = self.integral / self.length;
        let mean = self.offset.unwrap_or(0.0) + first;
        let variance = (self.square_integral / self.length - first * first).max(0.0);
        (mean, if self.includes_mean { variance + mean * mean } else { variance })
    }

    /// Mean square, mean included, of the part after the snapshot `earlier`.
    pub(crate) fn square_since(&self, earlier: &MomentAccumulator) -> f64 {
        let (first, second) = (self.integral - earlier.integral, self.square_integral - earlier.square_integral);
        let length = self.length - earlier.length;
        let offset = self.offset.unwrap_or(0.0);
        second / length + offset * (2.0 * first / length + offset)
    }

    pub(crate) fn finish(&self) -> Statistics {
        let (mean, square) = self.mean_and_square();
        Statistics { mean, rms: square.sqrt(), min: self.min, max: self.max }
    }
}

pub(super) fn horner(c: &[f64], t: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

/// First and second derivative.
fn derivatives(c: &[f64], t: f64) -> (f64, f64) {
    let (mut g, mut d1, mut d2) = (0.0, 0.0, 0.0);
    for &cn in c.iter().rev() {
        d2 = d2 * t + d1;
        d1 = d1 * t + g;
        g = g * t + cn;
    }
    (d1, 2.0 * d2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_and_extremes_of_a_parabola() {
        // 5 + t - t² over [0, 1], in two pieces: mean 5 + 1/6, variance 1/180, maximum 5.25 inside.
        let mut g = MomentAccumulator::new(false);
        g.add(&[5.0, 1.0, -1.0], 0.25, true);
        g.add(&[5.1875, 0.5, -1.0], 0.75, true);
        let s = g.finish();
        assert!((s.mean - (5.0 + 1.0 / 6.0)).abs() < 1e-15);
        assert!((s.rms * s.rms - 1.0 / 180.0).abs() < 1e-16);
        let mut kept = MomentAccumulator::new(true);
        kept.add(&[5.0, 1.0, -1.0], 1.0, false);
        assert!((kept.finish().rms.powi(2) - (31.0_f64 / 6.0).powi(2) - 1.0 / 180.0).abs() < 1e-13);
        assert!((s.max - 5.25).abs() < 1e-15 && (s.min - 5.0).abs() < 1e-15, "{s:?}");
    }
}
