//! Mesh force tabulated by the loaded tooth contact analysis, as a function of displacement and phase.
//!
//! On each flank the force is F(e, φ), where e is the displacement along s beyond the first contact of the teeth at the
//! phase φ. Between the knots of the phase and the levels of e it is a bicubic Hermite polynomial with continuous first
//! derivatives; beyond the last level it continues linearly. The Taylor method integrates the polynomials exactly, with
//! events at knots and levels; the lowest level is the separation of the teeth.

use super::error::DynamicsError;
use super::lanes::Real;
use super::model::ContactSide;

/// Nodes of the force of one flank, at the knots of a [`ContactForce`].
#[derive(Debug, Clone, PartialEq)]
pub struct FlankForce {
    /// Levels of e, ascending from 0, m.
    pub level_m: Vec<f64>,
    /// Displacement along s, less half the backlash, at first contact: value (m) and derivative by the phase (m per
    /// mesh period) at every knot.
    pub free_m: Vec<[f64; 2]>,
    /// By level and knot: force in N, its derivatives by displacement (N/m) and phase (N per mesh period), and the
    /// mixed derivative.
    pub nodes: Vec<Vec<[f64; 4]>>,
}

/// Normal mesh force of one half as a function of displacement and phase, on both flanks.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactForce {
    /// Phases, ascending in [0, 1).
    knots: Vec<f64>,
    driving: FlankSurface,
    back: FlankSurface,
}

/// Interpolated force of one flank.
#[derive(Debug, Clone, PartialEq)]
struct FlankSurface {
    level_m: Vec<f64>,
    /// By interval of the phase: cubic of the displacement at first contact in the relative position u within the
    /// interval.
    free: Vec<[f64; 4]>,
    /// By level and interval: coefficient [a][b] belongs to e^a u^b, e in m above the level, u the relative position
    /// within the interval.
    cells: Vec<Vec<[[f64; 4]; 4]>>,
}

/// Place of a phase between the knots.
#[derive(Debug, Clone, Copy)]
pub(super) struct PhasePlace {
    interval: usize,
    /// Relative position within the interval.
    u: f64,
}

/// Largest number of levels; a level is stored in a [`ContactSide`].
const MAX_LEVELS: usize = 100;

impl ContactForce {
    /// Interpolates the nodes of the driving and the back flank at `knots`, ascending phases in [0, 1).
    ///
    /// # Errors
    /// [`DynamicsError::InvalidParameter`] where a number is not finite, knots or levels do not ascend, or a force
    /// decreases with the displacement.
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

    /// Phases of the knots, ascending in [0, 1).
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    fn flank(&self, contact: ContactSide) -> &FlankSurface {
        if contact < 0 { &self.back } else { &self.driving }
    }

    /// Index and width of the interval that contains `interior`, and the relative position of `phase` in it.
    fn interval(&self, phase: f64, interior: f64) -> (usize, f64, f64) {
        let n = self.knots.len();
        let first = self.knots[0];
        let wrapped = first + (interior - first).rem_euclid(1.0);
        let i = self.knots.partition_point(|&k| k <= wrapped).max(1) - 1;
        let width = if i + 1 < n { self.knots[i + 1] - self.knots[i] } else { first + 1.0 - self.knots[i] };
        // `phase` and `interior` can be on either side of the end of the period.
        let at = wrapped + (phase - interior) - self.knots[i];
        (i, at / width, width)
    }

    /// Displacement beyond half the backlash at first contact on a flank (1 driving, −1 back), m.
    pub fn free_m(&self, side: ContactSide, phase: f64) -> f64 {
        let (i, u, _) = self.interval(phase, phase);
        cubic(&self.flank(side).free[i], u)
    }

    /// Lower bound of [`ContactForce::free_m`] over the mesh period, within a hundredth of its range, m.
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

    /// Derivative of [`ContactForce::free_m`] by the phase, m per mesh period.
    pub(super) fn free_rate_m(&self, side: ContactSide, phase: f64) -> f64 {
        let (i, u, width) = self.interval(phase, phase);
        let c = &self.flank(side).free[i];
        (c[1] + u * (2.0 * c[2] + u * 3.0 * c[3])) / width
    }

    /// Place of a phase between the knots.
    pub(super) fn place(&self, phase: f64) -> PhasePlace {
        let (interval, u, _) = self.interval(phase, phase);
        PhasePlace { interval, u }
    }

    /// Force (N) and stiffness (N/m) of a flank at the displacement `e` (m) beyond first contact.
    fn at(&self, side: ContactSide, e: f64, PhasePlace { interval, u }: PhasePlace) -> (f64, f64) {
        if e <= 0.0 {
            return (0.0, 0.0);
        }
        let flank = self.flank(side);
        let level = flank.level(e);
        let above = e - flank.level_m[level];
        let c = flank.cells[level][interval].map(|row| cubic(&row, u));
        (c[0] + above * (c[1] + above * (c[2] + above * c[3])), c[1] + above * (2.0 * c[2] + above * 3.0 * c[3]))
    }

    /// Force (N, with the sign of s) and stiffness (N/m) at the displacement `s` (m) with half the backlash `b` (m).
    pub fn force(&self, s: f64, b: f64, phase: f64, interior: f64) -> (f64, f64) {
        let (interval, u, _) = self.interval(phase, interior);
        let (force, stiffness, _) = self.force_at(s, b, PhasePlace { interval, u });
        (force, stiffness)
    }

    /// Force and stiffness as [`ContactForce::force`] has them, and the flank that is touched: 1 driving, −1 back, 0
    /// none.
    pub(super) fn force_at(&self, s: f64, b: f64, place: PhasePlace) -> (f64, f64, ContactSide) {
        let e = s - b - cubic(&self.driving.free[place.interval], place.u);
        if e > 0.0 {
            let (force, stiffness) = self.at(1, e, place);
            return (force, stiffness, 1);
        }
        let e = -s - b - cubic(&self.back.free[place.interval], place.u);
        let (force, stiffness) = self.at(-1, e, place);
        (-force, stiffness, -ContactSide::from(e > 0.0))
    }

    /// Displacement s at which the mesh force equals `force` (N, of either sign) at a phase, m.
    pub fn displacement_under(&self, force: f64, b: f64, phase: f64) -> f64 {
        let side: ContactSide = if force < 0.0 { -1 } else { 1 };
        let flank = self.flank(side);
        let load = force.abs();
        let top = flank.level_m[flank.level_m.len() - 1];
        let place = self.place(phase);
        let (at_top, slope) = self.at(side, top, place);
        let e = if load >= at_top {
            top + (load - at_top) / slope.max(f64::MIN_POSITIVE)
        } else {
            let (mut low, mut high) = (0.0, top);
            let mut e = 0.5 * top;
            for _ in 0..200 {
                let (f, k) = self.at(side, e, place);
                if f < load {
                    low = e;
                } else {
                    high = e;
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

    /// Contact at a displacement: 0 apart, ±(1 + level) on a flank.
    pub fn contact_of(&self, s: f64, b: f64, phase: f64) -> ContactSide {
        let driving = s - b - self.free_m(1, phase);
        if driving > 0.0 {
            return 1 + self.driving.level(driving) as ContactSide;
        }
        let back = -s - b - self.free_m(-1, phase);
        if back > 0.0 { -1 - self.back.level(back) as ContactSide } else { 0 }
    }

    /// Largest stiffness of a flank (1 driving, −1 back) over knots and levels, N/m.
    pub fn largest_stiffness_n_per_m(&self, side: ContactSide) -> f64 {
        self.flank(side).cells.iter().flatten().fold(0.0f64, |m, c| m.max(c[1][0]))
    }

    /// Cell of the current contact, as polynomials in scaled time about `phase`.
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

    /// Contact in the adjacent cell beyond the lower (`upper` false) or upper boundary.
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

/// Upper boundary of the last level: a displacement that no motion reaches, m.
const UNREACHABLE_M: f64 = 1e300;

/// Cell of one half as polynomials in scaled time τ. The force is side · Σ_a coefficients[a](τ) e^a with e = side · s +
/// lower(τ). The motion leaves the cell where side · s + lower(τ) or −side · s + upper(τ) becomes negative.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForceCell {
    pub side: f64,
    pub lower: [f64; 4],
    pub upper: [f64; 4],
    pub coefficients: [[f64; 4]; 4],
}

/// Cells of one half in all lanes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ForceCells<R> {
    /// Whether the mesh force of the half is that of the cell.
    pub in_use: bool,
    pub side: R,
    pub lower: [R; 4],
    pub upper: [R; 4],
    pub coefficients: [[R; 4]; 4],
}

impl<R: Real> ForceCells<R> {
    pub(crate) fn none() -> Self {
        let zero = R::splat(0.0);
        Self { in_use: false, side: zero, lower: [zero; 4], upper: [zero; 4], coefficients: [[zero; 4]; 4] }
    }

    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, cell: &ForceCell) {
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

/// The cubic about `u`, in a variable of which one unit is `rate` units of u.
#[inline(always)]
fn shifted(c: &[f64; 4], u: f64, rate: f64) -> [f64; 4] {
    [
        cubic(c, u),
        (c[1] + u * (2.0 * c[2] + u * 3.0 * c[3])) * rate,
        (c[2] + 3.0 * u * c[3]) * rate * rate,
        c[3] * rate * rate * rate,
    ]
}

/// Cubic Hermite interpolant on 0 … 1 from values and derivatives at both ends.
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
                        // Cubics over the phase of force and stiffness at this level and the next.
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
