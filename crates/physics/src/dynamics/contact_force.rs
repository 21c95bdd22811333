//! The mesh force as the loaded contact gives it: a function of approach and phase, in place of a stiffness over the phase.
//!
//! On each flank F(e, φ), e the displacement along s beyond the place where the first point of the teeth touches at the phase φ. Between knots of the phase and levels of e
//! it is a bicubic polynomial (Hermite's), continuous with its first derivatives everywhere; beyond the last level it goes on in a straight line.
//! The Taylor method follows the polynomials exactly and stops at knots and levels; separation is the lowest level.

use super::error::DynamicsError;
use super::lanes::Real;
use super::model::ContactSide;

/// Force of one flank over phase and displacement, at the knots of a [`ContactForce`].
#[derive(Debug, Clone, PartialEq)]
pub struct FlankForce {
    /// Displacement beyond the free one at the levels, ascending from 0, m.
    pub level_m: Vec<f64>,
    /// Displacement along s, less the backlash, at which the first point touches: value and slope per phase at every knot, m.
    pub free_m: Vec<[f64; 2]>,
    /// Level by level and knot by knot: force, its derivative with the displacement, with the phase, and with both; N, N/m.
    pub nodes: Vec<Vec<[f64; 4]>>,
}

/// Normal mesh force of one half as a function of displacement and phase, on both flanks.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactForce {
    /// Ascending in [0, 1).
    knots: Vec<f64>,
    driving: FlankSurface,
    back: FlankSurface,
}

/// One flank, ready for evaluation.
#[derive(Debug, Clone, PartialEq)]
struct FlankSurface {
    level_m: Vec<f64>,
    /// Interval by interval: cubic in the place within the interval.
    free: Vec<[f64; 4]>,
    /// Level by level, interval by interval: coefficient [a][b] belongs to e^a u^b, e in m above the level, u the place within the interval.
    cells: Vec<Vec<[[f64; 4]; 4]>>,
}

/// The highest number of levels, no contact apart: a level is kept in a [`Contact`].
const MAX_LEVELS: usize = 100;

impl ContactForce {
    /// From the nodes of both flanks (driving, back) at `knots`, ascending phases in [0, 1).
    ///
    /// # Errors
    /// [`DynamicsError::InvalidParameter`] where a number is not finite, knots or levels do not ascend, or a force falls with the displacement.
    pub fn new(knots: Vec<f64>, [driving, back]: [&FlankForce; 2]) -> Result<Self, DynamicsError> {
        let wrong =
            |value: f64, reason: &'static str| DynamicsError::InvalidParameter { name: "mesh force", value, reason };
        let ascend = |row: &[f64]| row.windows(2).all(|pair| pair[0] < pair[1]);
        if knots.len() < 3 || !ascend(&knots) || knots[0] < 0.0 || knots[knots.len() - 1] >= 1.0 {
            return Err(wrong(knots.len() as f64, "its phases must ascend from 0 to below 1, at least three"));
        }
        for flank in [driving, back] {
            let levels = flank.level_m.len();
            if !(2..=MAX_LEVELS).contains(&levels) || flank.level_m[0] != 0.0 || !ascend(&flank.level_m) {
                return Err(wrong(levels as f64, "its levels must ascend from 0, 2 to 100"));
            }
            let sizes = flank.free_m.len() == knots.len()
                && flank.nodes.len() == levels
                && flank.nodes.iter().all(|row| row.len() == knots.len());
            if !sizes {
                return Err(wrong(knots.len() as f64, "it needs values at every level and knot"));
            }
            let mut numbers = flank.free_m.iter().flatten().chain(flank.nodes.iter().flatten().flatten());
            if let Some(bad) = numbers.find(|v| !v.is_finite()) {
                return Err(wrong(*bad, "must be finite"));
            }
            let falls =
                flank.nodes.windows(2).any(|pair| pair[0].iter().zip(&pair[1]).any(|(low, high)| low[0] > high[0]));
            if falls {
                return Err(wrong(0.0, "must not fall with the displacement"));
            }
        }
        let [driving, back] = [driving, back].map(|flank| FlankSurface::new(&knots, flank));
        Ok(Self { knots, driving, back })
    }

    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    fn flank(&self, contact: ContactSide) -> &FlankSurface {
        if contact < 0 { &self.back } else { &self.driving }
    }

    /// The interval that holds `interior`, and the place of `phase` in it.
    fn interval(&self, phase: f64, interior: f64) -> (usize, f64, f64) {
        let n = self.knots.len();
        let first = self.knots[0];
        let wrapped = first + (interior - first).rem_euclid(1.0);
        let i = self.knots.partition_point(|&k| k <= wrapped).max(1) - 1;
        let width = if i + 1 < n { self.knots[i + 1] - self.knots[i] } else { first + 1.0 - self.knots[i] };
        // Phase and the phase interior may stand on either side of the turn of the period.
        let at = wrapped + (phase - interior) - self.knots[i];
        (i, at / width, width)
    }

    /// Displacement beyond the backlash at which the first point of a flank (1 driving, −1 back) touches, m.
    pub fn free_m(&self, side: ContactSide, phase: f64) -> f64 {
        let (i, u, _) = self.interval(phase, phase);
        cubic(&self.flank(side).free[i], u)
    }

    /// A displacement below all of it over the mesh period, by no more than a hundredth of its range, m.
    pub fn min_free_m(&self, side: ContactSide) -> f64 {
        const POINTS: u32 = 16;
        const MARGIN: f64 = 0.01;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        for c in &self.flank(side).free {
            for i in 0..POINTS {
                let free = cubic(c, f64::from(i) / f64::from(POINTS));
                (least, most) = (least.min(free), most.max(free));
            }
        }
        least - MARGIN * (most - least)
    }

    /// Its slope per mesh period.
    pub(super) fn free_rate_m(&self, side: ContactSide, phase: f64) -> f64 {
        let (i, u, width) = self.interval(phase, phase);
        let c = &self.flank(side).free[i];
        (c[1] + u * (2.0 * c[2] + u * 3.0 * c[3])) / width
    }

    /// Force and stiffness on a flank at the displacement `e` beyond its free one.
    fn at(&self, side: ContactSide, e: f64, phase: f64, interior: f64) -> (f64, f64) {
        if e <= 0.0 {
            return (0.0, 0.0);
        }
        let (i, u, _) = self.interval(phase, interior);
        let flank = self.flank(side);
        let level = flank.level(e);
        let above = e - flank.level_m[level];
        let c = flank.cells[level][i].map(|row| cubic(&row, u));
        (c[0] + above * (c[1] + above * (c[2] + above * c[3])), c[1] + above * (2.0 * c[2] + above * 3.0 * c[3]))
    }

    /// Force (signed as s) and stiffness at the displacement `s` with half the backlash `b`.
    pub fn force(&self, s: f64, b: f64, phase: f64, interior: f64) -> (f64, f64) {
        let (i, u, _) = self.interval(phase, interior);
        let e = s - b - cubic(&self.driving.free[i], u);
        if e > 0.0 {
            return self.at(1, e, phase, interior);
        }
        let e = -s - b - cubic(&self.back.free[i], u);
        let (force, stiffness) = self.at(-1, e, phase, interior);
        (-force, stiffness)
    }

    /// The displacement along s at which the mesh carries `force` (of either sign) at a phase, m.
    pub fn displacement_under(&self, force: f64, b: f64, phase: f64) -> f64 {
        let side: ContactSide = if force < 0.0 { -1 } else { 1 };
        let flank = self.flank(side);
        let load = force.abs();
        let top = flank.level_m[flank.level_m.len() - 1];
        let (at_top, slope) = self.at(side, top, phase, phase);
        let e = if load >= at_top {
            top + (load - at_top) / slope.max(f64::MIN_POSITIVE)
        } else {
            let (mut low, mut high) = (0.0, top);
            let mut e = 0.5 * top;
            for _ in 0..200 {
                let (f, k) = self.at(side, e, phase, phase);
                if f < load {
                    low = e
                } else {
                    high = e
                }
                let newton = e + (load - f) / k;
                let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
                if (next - e).abs() <= 1e-15 * top {
                    break;
                }
                e = next;
            }
            e
        };
        f64::from(side) * (b + self.free_m(side, phase) + e)
    }

    /// The side and level of a displacement: 0 apart, ±(1 + level) on a flank.
    pub fn contact_of(&self, s: f64, b: f64, phase: f64) -> ContactSide {
        let driving = s - b - self.free_m(1, phase);
        if driving > 0.0 {
            return 1 + self.driving.level(driving) as ContactSide;
        }
        let back = -s - b - self.free_m(-1, phase);
        if back > 0.0 { -1 - self.back.level(back) as ContactSide } else { 0 }
    }

    /// Largest stiffness of a flank (1 driving, −1 back) at any knot and level, N/m.
    pub fn largest_stiffness_n_per_m(&self, side: ContactSide) -> f64 {
        self.flank(side).cells.iter().flatten().fold(0.0f64, |m, c| m.max(c[1][0]))
    }

    /// What the Taylor method needs of the cell a motion is in: polynomials in scaled time about `phase`.
    #[inline(always)]
    pub(super) fn cell(&self, contact: ContactSide, b: f64, phase: f64, interior: f64, period_tau: f64) -> ForceCell {
        let (i, u, width) = self.interval(phase, interior);
        let rate = 1.0 / (width * period_tau);
        let shifted = |c: &[f64; 4]| shifted(c, u, rate);
        if contact == 0 {
            let (mut lower, mut upper) = (shifted(&self.driving.free[i]), shifted(&self.back.free[i]));
            lower[0] += b;
            upper[0] += b;
            return ForceCell { side: -1.0, lower, upper, coefficients: [[0.0; 4]; 4] };
        }
        let flank = self.flank(contact);
        let level = (usize::from(contact.unsigned_abs()) - 1).min(flank.level_m.len() - 1);
        let mut upper = shifted(&flank.free[i]);
        let mut lower = upper.map(|c| -c);
        lower[0] -= b + flank.level_m[level];
        upper[0] += b + flank.level_m.get(level + 1).copied().unwrap_or(UNREACHABLE_M);
        let side = if contact < 0 { -1.0 } else { 1.0 };
        ForceCell { side, lower, upper, coefficients: flank.cells[level][i].map(|row| shifted(&row)) }
    }

    /// The contact beyond the end of a cell through its near end (false) or its far one.
    #[inline(always)]
    pub(super) fn adjacent(contact: ContactSide, upper: bool) -> ContactSide {
        match (contact, upper) {
            (0, false) => 1,
            (0, true) => -1,
            (c, false) => c - c.signum(),
            (c, true) => c + c.signum(),
        }
    }
}

/// A level that no motion reaches, m.
const UNREACHABLE_M: f64 = 1e300;

/// The cell of one half that a motion is in, polynomials in scaled time: the force is side Σ_a coefficients[a](τ) e^a with e = side s + near(τ); the cell is left
/// where side s + near(τ) or −side s + far(τ) falls below zero.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForceCell {
    pub side: f64,
    pub lower: [f64; 4],
    pub upper: [f64; 4],
    pub coefficients: [[f64; 4]; 4],
}

/// The cells of both halves in all lanes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForceCells<R> {
    /// The mesh force of a half comes from its cell.
    pub in_use: bool,
    pub side: R,
    pub lower: [R; 4],
    pub upper: [R; 4],
    pub coefficients: [[R; 4]; 4],
}

impl<R: Real> ForceCells<R> {
    pub fn none() -> Self {
        let zero = R::splat(0.0);
        Self { in_use: false, side: zero, lower: [zero; 4], upper: [zero; 4], coefficients: [[zero; 4]; 4] }
    }

    #[inline(always)]
    pub fn set(&mut self, lane: usize, cell: &ForceCell) {
        self.side.set(lane, cell.side);
        for k in 0..4 {
            self.lower[k].set(lane, cell.lower[k]);
            self.upper[k].set(lane, cell.upper[k]);
            for a in 0..4 {
                self.coefficients[a][k].set(lane, cell.coefficients[a][k]);
            }
        }
    }
}

#[inline(always)]
fn cubic(c: &[f64; 4], u: f64) -> f64 {
    c[0] + u * (c[1] + u * (c[2] + u * c[3]))
}

/// The cubic about the place `u`, over a variable of which one unit is `rate` units of u.
#[inline(always)]
fn shifted(c: &[f64; 4], u: f64, rate: f64) -> [f64; 4] {
    [
        cubic(c, u),
        (c[1] + u * (2.0 * c[2] + u * 3.0 * c[3])) * rate,
        (c[2] + 3.0 * u * c[3]) * rate * rate,
        c[3] * rate * rate * rate,
    ]
}

/// Hermite's cubic over a place 0 … 1 from values and derivatives by the place at both ends.
fn hermite(v0: f64, v1: f64, m0: f64, m1: f64) -> [f64; 4] {
    let rise = v1 - v0;
    [v0, m0, 3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise]
}

impl FlankSurface {
    fn new(knots: &[f64], flank: &FlankForce) -> Self {
        let n = knots.len();
        let width = |i: usize| if i + 1 < n { knots[i + 1] - knots[i] } else { knots[0] + 1.0 - knots[i] };
        let over_phase = |row: &dyn Fn(usize) -> [f64; 2], i: usize| {
            let ([v0, m0], [v1, m1]) = (row(i), row((i + 1) % n));
            hermite(v0, v1, m0 * width(i), m1 * width(i))
        };
        let free = (0..n).map(|i| over_phase(&|j| flank.free_m[j], i)).collect();
        let levels = flank.level_m.len();
        let cells = (0..levels)
            .map(|level| {
                (0..n)
                    .map(|i| {
                        // Cubics over the phase: force and stiffness at this level and the next.
                        let force = |l: usize| over_phase(&|j| [flank.nodes[l][j][0], flank.nodes[l][j][2]], i);
                        let slope = |l: usize| over_phase(&|j| [flank.nodes[l][j][1], flank.nodes[l][j][3]], i);
                        let (f0, k0) = (force(level), slope(level));
                        if level + 1 == levels {
                            return [f0, k0, [0.0; 4], [0.0; 4]];
                        }
                        let (f1, k1) = (force(level + 1), slope(level + 1));
                        let h = flank.level_m[level + 1] - flank.level_m[level];
                        let mut cell = [[0.0; 4]; 4];
                        for b in 0..4 {
                            let over_level = hermite(f0[b], f1[b], k0[b] * h, k1[b] * h);
                            for a in 0..4 {
                                cell[a][b] = over_level[a] / h.powi(a as i32);
                            }
                        }
                        cell
                    })
                    .collect()
            })
            .collect();
        Self { level_m: flank.level_m.clone(), free, cells }
    }

    fn level(&self, e: f64) -> usize {
        self.level_m.partition_point(|&l| l < e).max(1) - 1
    }
}
