//! Recurrence for the Taylor coefficients of the motion between two events.

use super::contact_force::ForceCells;
use super::equations::{Equations, PER_HALF, is_rigid_rotation};
use super::excitation::MAX_ORDER;
use super::expansion::ExcitationTerms;
use super::lanes::Real;
use super::modal_train::MAX_RIGID_BODY_MODES;

/// Working memory of a Taylor step: coefficients of all coordinates, of s less the displacement excitation and of F_n.
#[repr(align(64))]
pub(crate) struct TaylorWork<const D: usize, R> {
    pub rows: [[R; D]; MAX_ORDER + 1],
    pub s: [[R; MAX_ORDER + 1]; 2],
    pub force: [[R; MAX_ORDER + 1]; 2],
    pub excitation: ExcitationTerms<R>,
    contact: [ContactSeries<R>; 2],
}

/// Taylor coefficients of the powers of e within a cell of the contact force.
#[derive(Clone, Copy)]
pub(super) struct ContactSeries<R> {
    /// e, and e in descending order.
    e: [R; MAX_ORDER + 1],
    reversed: [R; MAX_ORDER + 1],
    square: [R; MAX_ORDER + 1],
    cube: [R; MAX_ORDER + 1],
}

impl<R: Real> ContactSeries<R> {
    pub(crate) fn new() -> Self {
        let zero = [R::splat(0.0); MAX_ORDER + 1];
        Self { e: zero, reversed: zero, square: zero, cube: zero }
    }

    /// Adds coefficient `n` of s, and returns coefficient `n` of Σ_a coefficients[a] e^a.
    #[inline(always)]
    fn force(&mut self, cells: &ForceCells<R>, n: usize, s: R) -> R {
        self.add_displacement(cells, n, s);
        let mut sum = R::splat(0.0);
        for m in 0..=n.min(3) {
            let k = n - m;
            sum += cells.coefficients[1][m] * self.e[k]
                + cells.coefficients[2][m] * self.square[k]
                + cells.coefficients[3][m] * self.cube[k];
        }
        if n < 4 { sum + cells.coefficients[0][n] } else { sum }
    }

    /// Adds coefficient `n` of s, and returns coefficient `n` of the stiffness Σ_a a coefficients[a] e^(a−1).
    #[inline(always)]
    pub(crate) fn stiffness(&mut self, cells: &ForceCells<R>, n: usize, s: R) -> R {
        self.add_displacement(cells, n, s);
        let (two, three) = (R::splat(2.0), R::splat(3.0));
        let mut sum = R::splat(0.0);
        for m in 0..=n.min(3) {
            let k = n - m;
            sum += two * cells.coefficients[2][m] * self.e[k] + three * cells.coefficients[3][m] * self.square[k];
        }
        if n < 4 { sum + cells.coefficients[1][n] } else { sum }
    }

    #[inline(always)]
    fn add_displacement(&mut self, cells: &ForceCells<R>, n: usize, s: R) {
        self.e[n] = cells.side * s;
        if n < 4 {
            self.e[n] += cells.lower[n];
        }
        self.reversed[MAX_ORDER - n] = self.e[n];
        let back = &self.reversed[MAX_ORDER - n..];
        self.square[n] = convolution(back, &self.e[..=n], 0);
        self.cube[n] = convolution(back, &self.square[..=n], 0);
    }
}

impl<const D: usize, R: Real> TaylorWork<D, R> {
    pub(crate) fn new() -> Box<Self> {
        let zero = R::splat(0.0);
        Box::new(Self {
            rows: [[zero; D]; MAX_ORDER + 1],
            s: [[zero; MAX_ORDER + 1]; 2],
            force: [[zero; MAX_ORDER + 1]; 2],
            excitation: ExcitationTerms::new(),
            contact: [ContactSeries::new(); 2],
        })
    }
}

/// Condition for ending a series below its full order: over `remaining` scaled time its last two terms are below
/// `tolerance` times the size of the motion.
#[derive(Clone, Copy)]
pub(crate) struct EarlyTermination<R> {
    pub remaining: R,
    pub tolerance: R,
    /// Size of the recent motion.
    pub size: R,
}

/// Lowest order at which the condition is tested, and the longest `remaining` (scaled time, about the phase angle of
/// the fastest natural mode) for which it can hold below the orders in use.
const MIN_ORDER: usize = 6;
const MAX_EARLY_TERMINATION_SPAN: f64 = 2.0;

/// Taylor coefficients of the motion up to `order` in scaled time, from `rows[0]`, `rows[1]` (x and dx/dτ) and the
/// excitation in `work`. `loads` is 1 for a motion and 0 for the variational equations with the same contact. With
/// `early_end`, lanes that satisfy the condition end early (their higher coefficients are 0). Returns these lanes (1)
/// and the highest order computed.
#[inline(always)]
pub(crate) fn taylor_coefficients<const D: usize, R: Real>(
    equations: &Equations<D, R>,
    contact: [R; 2],
    order: usize,
    loads: R,
    early_end: Option<EarlyTermination<R>>,
    work: &mut TaylorWork<D, R>,
) -> (R, usize) {
    let TaylorWork { rows, s, force, excitation, contact: series } = work;
    let halves = Equations::<D, R>::HALVES;
    let (zero, one) = (R::splat(0.0), R::splat(1.0));
    let mut damper = [zero; 2];
    let mut closed = [zero; 2];
    let mut backlash_offset = [zero; 2];
    let mut any_closed = [false; 2];
    for j in 0..halves {
        let h = &equations.halves[j];
        closed[j] = contact[j].map(|c| if c != 0.0 { 1.0 } else { 0.0 });
        any_closed[j] = closed[j].any(|c| c != 0.0);
        damper[j] = R::from_fn(|l| if closed[j].get(l) != 0.0 { h.cm.get(l) } else { h.cm_in_gap.get(l) });
        backlash_offset[j] = loads * contact[j] * equations.b;
        s[j][0] = equations.s(j, &rows[0]);
        s[j][1] = equations.s(j, &rows[1]);
        if excitation.gap_active[j] {
            s[j][0] -= excitation.gap[j][0];
            s[j][1] -= excitation.gap[j][1];
        }
    }
    let short = |r: f64| r <= MAX_EARLY_TERMINATION_SPAN;
    let early_end = early_end.filter(|e| e.remaining.any(short));
    let mut active = one;
    let mut power = early_end.map_or(zero, |e| e.remaining);
    for n in 0..order - 1 {
        let n1 = (n + 1) as f64;
        let (known, next) = rows.split_at_mut(n + 2);
        let (x, next) = (&known[n], &mut next[0]);
        let mut v = known[n + 1];
        for c in &mut v {
            *c = *c * R::splat(n1);
        }
        let scale = R::splat(1.0 / (n1 * (n1 + 1.0))) * active;
        // Of a train: s, normal and tangential forces of both halves.
        let (mut closing, mut normals, mut alongs) = ([zero; 2], [zero; 2], [zero; 2]);
        for j in 0..halves {
            let h = &equations.halves[j];
            let mut f = damper[j] * R::splat(n1) * s[j][n + 1];
            if excitation.cells[j].in_use {
                if any_closed[j] {
                    let cells = &excitation.cells[j];
                    f += closed[j] * cells.side * series[j].force(cells, n, s[j][n]);
                }
            } else {
                let degree = excitation.degree[j].min(n);
                if any_closed[j] {
                    let k = &excitation.reversed[j][MAX_ORDER - n..];
                    f += closed[j] * convolution(k, &s[j][..=n], n - degree);
                    if n <= excitation.degree[j] {
                        f -= excitation.stiffness[j][n] * backlash_offset[j];
                    }
                }
            }
            force[j][n] = f;
            let mut along = zero;
            let mut normal = f;
            if excitation.impact_active[j] {
                let impact_force = loads * excitation.impact[j][n];
                along -= equations.impact_along * impact_force;
                normal += equations.impact_normal * impact_force;
            }
            if Equations::<D, R>::IS_TRAIN {
                closing[j] = s[j][n];
                if excitation.gap_active[j] {
                    closing[j] += excitation.gap[j][n];
                }
                (normals[j], alongs[j]) = (normal, along);
                continue;
            }
            if n == 0 {
                along += loads * h.load;
            }
            let a = equations.half_acceleration(j, x, &v, normal, along);
            let i = j * PER_HALF;
            for c in 0..PER_HALF {
                next[i + c] = a[c] * scale;
            }
        }
        if Equations::<D, R>::IS_TRAIN {
            let struck = excitation.impact_active[0] || excitation.impact_active[1];
            let tooth = (closing, normals, struck.then_some(alongs));
            let a = equations.train_acceleration((x, &v), tooth, if n == 0 { loads } else { zero });
            for c in 0..D {
                next[c] = a[c] * scale;
            }
        }
        for j in 0..halves {
            s[j][n + 2] = equations.s(j, next);
            if excitation.gap_active[j] {
                s[j][n + 2] -= excitation.gap[j][n + 2];
            }
        }
        if let Some(e) = &early_end {
            let before = power;
            power = power * e.remaining;
            if n + 2 >= MIN_ORDER && n % 2 == 0 {
                let size = e.size.zip(larger(norm(&rows[1]), norm(&rows[2])), f64::max);
                let allowed = e.tolerance * size;
                let terms = larger(norm(&rows[n + 1]) * before, norm(&rows[n + 2]) * power);
                active = R::from_fn(|l| {
                    let done = short(e.remaining.get(l)) && terms.get(l) <= allowed.get(l);
                    if done { 0.0 } else { active.get(l) }
                });
                if !active.any(|a| a != 0.0) {
                    return (one, n + 2);
                }
            }
        }
    }
    (one - active, order)
}

/// Σ a_i b_i from `from` on, in four partial sums for parallel execution. The partial sum of a product depends only on
/// its distance from the end, so that leading zeros do not change the result.
#[inline(always)]
fn convolution<R: Real>(a: &[R], b: &[R], from: usize) -> R {
    let mut sums = [R::splat(0.0); 4];
    let end = b.len();
    let a = &a[..end];
    let mut i = end;
    while i >= from + 4 {
        i -= 4;
        for k in 0..4 {
            sums[k] += a[i + 3 - k] * b[i + 3 - k];
        }
    }
    for k in 0..i - from {
        sums[k] += a[i - 1 - k] * b[i - 1 - k];
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

/// Maximum; NaN if either is NaN.
#[inline(always)]
pub(super) fn larger<R: Real>(a: R, b: R) -> R {
    a.zip(b, |a, b| if a <= b || b.is_nan() { b } else { a })
}

/// Largest coordinate, rigid rotation excluded.
#[inline(always)]
pub(super) fn norm<const D: usize, R: Real>(row: &[R; D]) -> R {
    if Equations::<D, R>::IS_TRAIN {
        // Four maxima at a time: the sizes are multiples of four, and so is the number of rigid-body modes.
        let mut largest = [R::splat(0.0); 4];
        for values in row[..D - MAX_RIGID_BODY_MODES].chunks_exact(4) {
            for k in 0..4 {
                largest[k] = largest[k].zip(values[k], |m, v| if v.abs() <= m { m } else { v.abs() });
            }
        }
        return larger(larger(largest[0], largest[1]), larger(largest[2], largest[3]));
    }
    let mut largest = R::splat(0.0);
    for (c, value) in row.iter().enumerate() {
        if !is_rigid_rotation(D, c) {
            // `f64::max` would drop a NaN.
            largest = largest.zip(*value, |m, v| if v.abs() <= m { m } else { v.abs() });
        }
    }
    largest
}
