//! Taylor series of high order for the piecewise analytic equations, restarted at every event.
//!
//! Between two events (an edge of a pulse, a knot of the stiffness, a change of contact) the equations are linear with
//! analytic coefficients, so the Taylor coefficients of the motion follow from a recurrence. Changes of contact are
//! zeros of the polynomial s(τ) ∓ b and are located to rounding. Step length after À. Jorba and M. Zou, Experimental
//! Mathematics 14 (2005) 99–117, doi:10.1080/10586458.2005.10128904, from the last two coefficients.

use super::contact_force::{ContactForce, ForceCells};
use super::crossing::first_crossing;
use super::equations::Equations;
use super::error::DynamicsError;
use super::excitation::MAX_ORDER;
use super::expansion::ExcitationExpansion;
use super::integrate::StepCounts;
use super::lanes::{Real, approximate_root};
use super::model::{ContactSide, DynamicModel, MotionState};
use super::recurrence::{EarlyTermination, TaylorWork, larger, norm, taylor_coefficients};
use super::segment::{Observer, Segment};
use crate::simd::vectorised;

/// Changes of contact per mesh period beyond which they are no longer located.
const MAX_CONTACT_CHANGES_PER_PERIOD: u32 = 20_000;

/// Order with the lowest cost at a tolerance, measured on the reference cases.
pub(super) fn order_for(tolerance: f64) -> usize {
    match tolerance {
        t if t >= 1e-6 => 14,
        t if t >= 1e-9 => 18,
        t if t >= 1e-12 => 20,
        _ => 24,
    }
}

/// An interval of the phase in which the excitations are smooth, and the step control within it.
#[derive(Clone, Copy)]
pub(super) struct SmoothInterval<R> {
    pub phase: R,
    /// Phase at which the interval ends, and a phase in its interior.
    pub end: R,
    pub interior: R,
    /// One mesh period in scaled time.
    pub period_tau: R,
    /// Local error of a step relative to the size of the motion.
    pub tolerance: R,
    /// Fixed step in scaled time; not finite: the step follows from the coefficients.
    pub fixed: R,
    /// 1 where contact can change, 0 where it is fixed.
    pub switching: R,
}

/// Result of a step.
#[derive(Clone, Copy)]
pub(super) struct StepOutcome<R> {
    /// Length in scaled time. NaN where the motion has diverged; not positive where no step is possible.
    pub h: R,
    /// 1 where the step reaches the end of the smooth interval.
    pub to_end: R,
    /// Half whose contact changes at the end of the step (0 or 1; −1: none), and its new contact.
    pub changed: R,
    pub contact: R,
    /// Highest power of the polynomials.
    pub degree: usize,
}

/// Computes the polynomials of a step from `work.rows[0]` and `[1]` and the length over which they are used. `size` is
/// the size of the recent motion, kept from step to step.
#[inline(always)]
pub(super) fn step<const D: usize, R: Real>(
    equations: &Equations<D, R>,
    excitations: &impl ExcitationExpansion<R>,
    order: usize,
    interval: SmoothInterval<R>,
    contact: [R; 2],
    size: &mut R,
    work: &mut TaylorWork<D, R>,
) -> StepOutcome<R> {
    let SmoothInterval { phase, end, interior, period_tau, tolerance, fixed, switching } = interval;
    excitations.expand(phase, interior, contact, order, &mut work.excitation);
    let remaining = (end - phase) * period_tau;
    *size = *size * R::splat(0.98);
    let early_end = EarlyTermination { remaining, tolerance, size: *size };
    let free = !fixed.any(f64::is_finite);
    let (short, degree) =
        taylor_coefficients(equations, contact, order, R::splat(1.0), free.then_some(early_end), work);
    let moving = larger(norm(&work.rows[1]), norm(&work.rows[2]));
    *size = larger(moving, *size);
    // Below the rounding of the positions no tolerance can be met.
    let allowed = (tolerance * *size).zip(norm(&work.rows[0]), |a, x| a.max(1e-17 * x));
    let accurate_step = step_of_last_terms(&work.rows, degree, allowed);
    let desired = R::from_fn(|l| {
        let accurate_step = if short.get(l) != 0.0 { f64::INFINITY } else { accurate_step.get(l) };
        if fixed.get(l).is_finite() { fixed.get(l) } else { accurate_step }
    });
    let mut to_end = R::from_fn(|l| if remaining.get(l) <= desired.get(l) * (1.0 + 1e-9) { 1.0 } else { 0.0 });
    let mut h = R::from_fn(|l| {
        let (remaining, desired) = (remaining.get(l), desired.get(l));
        // Two equal steps rather than a long and a very short one.
        if to_end.get(l) != 0.0 { remaining } else { remaining / (remaining / desired - 1e-9).ceil() }
    });
    let mut changed = R::splat(-1.0);
    let mut to = R::splat(0.0);
    if switching.any(|s| s != 0.0) {
        for j in 0..Equations::<D, R>::HALVES {
            let s = &work.s[j][..=degree];
            let (at, side) = if work.excitation.cells[j].in_use {
                next_cell(s, &work.excitation.cells[j], contact[j], h, switching)
            } else {
                next_contact(s, equations.b, contact[j], h, switching)
            };
            for l in 0..R::LANES {
                if at.get(l) < f64::INFINITY {
                    h.set(l, at.get(l));
                    changed.set(l, j as f64);
                    to.set(l, side.get(l));
                    to_end.set(l, 0.0);
                }
            }
        }
    }
    StepOutcome { h, to_end, changed, contact: to, degree }
}

/// First change of contact of a half within `h`: its time (infinite: none) and the new contact.
#[inline(always)]
fn next_contact<R: Real>(s: &[R], b: R, contact: R, h: R, switching: R) -> (R, R) {
    let mut g = [R::splat(0.0); MAX_ORDER + 1];
    let g = &mut g[..s.len()];
    // On a flank the zero of side·s − b, in the gap the zero of b − s or s + b.
    let first = contact.map(|c| if c == 0.0 { -1.0 } else { c });
    for (g, s) in g.iter_mut().zip(s) {
        *g = first * *s;
    }
    g[0] += R::from_fn(|l| if contact.get(l) == 0.0 { b.get(l) } else { -b.get(l) });
    let mut at = first_crossing(g, h, switching);
    let mut to = contact.map(|c| if c == 0.0 { 1.0 } else { 0.0 });
    let in_gap = R::from_fn(|l| if contact.get(l) == 0.0 { switching.get(l) } else { 0.0 });
    if in_gap.any(|g| g != 0.0) {
        g.copy_from_slice(s);
        g[0] += b;
        let back = first_crossing(g, at.zip(h, f64::min), in_gap);
        to = R::from_fn(|l| if back.get(l) < f64::INFINITY { -1.0 } else { to.get(l) });
        at = at.zip(back, f64::min);
    }
    (at, to)
}

/// First change of the cell of a half's contact force within `h`: its time (infinite: none) and the new contact.
#[inline(always)]
fn next_cell<R: Real>(s: &[R], cells: &ForceCells<R>, contact: R, h: R, switching: R) -> (R, R) {
    let mut g = [R::splat(0.0); MAX_ORDER + 1];
    let g = &mut g[..s.len()];
    let mut leaves = |side: R, ends: &[R; 4], h: R| {
        for (n, (g, s)) in g.iter_mut().zip(s).enumerate() {
            *g = side * *s;
            if n < 4 {
                *g += ends[n];
            }
        }
        first_crossing(g, h, switching)
    };
    let lower = leaves(cells.side, &cells.lower, h);
    let upper = leaves(-cells.side, &cells.upper, lower.zip(h, f64::min));
    let to =
        R::from_fn(|l| f64::from(ContactForce::adjacent(contact.get(l) as ContactSide, upper.get(l) < f64::INFINITY)));
    (lower.zip(upper, f64::min), to)
}

/// Step at which the larger of the last two terms equals `allowed`.
#[inline(always)]
fn step_of_last_terms<const D: usize, R: Real>(rows: &[[R; D]; MAX_ORDER + 1], order: usize, allowed: R) -> R {
    let before = step_of_term(norm(&rows[order - 1]), order - 1, allowed);
    before.zip(step_of_term(norm(&rows[order]), order, allowed), |a, b| if a < b || a.is_nan() { a } else { b })
}

/// Step at which a term of size `last` and power `k` equals `allowed`.
#[inline(always)]
fn step_of_term<R: Real>(last: R, k: usize, allowed: R) -> R {
    allowed.zip(last, |allowed, last| {
        let root = approximate_root(allowed / last, k as f64);
        let root = if last == 0.0 { f64::INFINITY } else { root };
        if last.is_nan() { f64::NAN } else { root }
    })
}

/// Step with a local error of `tolerance` times the size of the polynomials' own motion.
#[inline(always)]
pub(super) fn step_for_tolerance<const D: usize, R: Real>(
    rows: &[[R; D]; MAX_ORDER + 1],
    order: usize,
    tolerance: f64,
) -> R {
    let size = larger(norm(&rows[0]), larger(norm(&rows[1]), norm(&rows[2])));
    step_of_last_terms(rows, order, size * R::splat(tolerance))
}

/// Values and derivatives of all coordinates at τ = t.
#[inline(always)]
pub(super) fn evaluate_rows<const D: usize, R: Real>(rows: &[[R; D]], t: R) -> ([R; D], [R; D]) {
    let (mut x, mut v) = ([R::splat(0.0); D], [R::splat(0.0); D]);
    for row in rows.iter().rev() {
        for c in 0..D {
            v[c] = v[c] * t + x[c];
            x[c] = x[c] * t + row[c];
        }
    }
    (x, v)
}

/// Limits the number of located changes of contact per mesh period (chatter, Zeno behaviour).
#[derive(Clone, Copy, Default)]
pub(super) struct ChatterGuard {
    period: u64,
    changes: u32,
}

impl ChatterGuard {
    /// Counts a change of contact. Beyond the limit it takes a short step without event location, sets the contact from
    /// the new displacement and returns true.
    pub(crate) fn contact_changed<const D: usize>(
        &mut self,
        model: &DynamicModel<D>,
        state: &mut MotionState<D>,
        end: f64,
    ) -> bool {
        if self.period != state.period {
            *self = Self { period: state.period, changes: 0 };
        }
        self.changes += 1;
        if self.changes <= MAX_CONTACT_CHANGES_PER_PERIOD {
            return false;
        }
        let step = (end - state.phase).min(1e-4);
        let a = model.acceleration(state.phase, state.phase + 0.5 * step, &state.x, &state.v);
        let h = step * model.period_tau;
        for c in 0..D {
            state.v[c] += h * a[c];
            state.x[c] += h * state.v[c];
        }
        state.phase += step;
        for j in 0..DynamicModel::<D>::HALVES {
            state.contact[j] = model.contact_of(j, model.s(j, &state.x), state.phase);
        }
        true
    }
}

/// Error of a step of length `h`, if it cannot be taken. `advances`: the step changes the phase or the contact.
#[inline(always)]
pub(super) fn step_error<const D: usize>(
    model: &DynamicModel<D>,
    period: u64,
    phase: f64,
    h: f64,
    advances: bool,
) -> Option<DynamicsError> {
    if advances && (0.0..f64::INFINITY).contains(&h) {
        return None;
    }
    let time_s = (period as f64 + phase) * model.period_tau / model.omega_ref;
    Some(if h.is_finite() {
        DynamicsError::StepSizeTooSmall { time_s, step_s: h / model.omega_ref }
    } else {
        DynamicsError::Diverged { time_s }
    })
}

/// Taylor method for one motion.
pub(super) struct Taylor<const D: usize> {
    order: usize,
    tolerance: f64,
    /// Not finite: the step follows from the coefficients; else a fixed step in scaled time, to measure the order.
    fixed: f64,
    work: Box<TaylorWork<D, f64>>,
    /// Size of the recent motion: scaled velocity and acceleration, as lengths.
    size: f64,
    chatter: ChatterGuard,
}

impl<const D: usize> Taylor<D> {
    /// `tolerance`: local error of a step relative to the size of the motion.
    pub(crate) fn new(tolerance: f64, order: usize, fixed: Option<f64>) -> Self {
        Self {
            order: order.clamp(4, MAX_ORDER),
            tolerance,
            fixed: fixed.unwrap_or(f64::INFINITY),
            work: TaylorWork::new(),
            size: 0.0,
            chatter: ChatterGuard::default(),
        }
    }

    /// Advances by one step, at most to the phase `end`; `interior` is a phase inside the smooth interval.
    pub(crate) fn step(
        &mut self,
        model: &DynamicModel<D>,
        state: &mut MotionState<D>,
        end: f64,
        interior: f64,
        counts: &mut StepCounts,
        observer: &mut impl Observer<D>,
    ) -> Result<(), DynamicsError> {
        self.work.rows[0] = state.x;
        self.work.rows[1] = state.v;
        let interval = SmoothInterval {
            phase: state.phase,
            end,
            interior,
            period_tau: model.period_tau,
            tolerance: self.tolerance,
            fixed: self.fixed,
            switching: if model.contact_can_change() { 1.0 } else { 0.0 },
        };
        let contact = state.contact.map(f64::from);
        let Self { order, work, size, .. } = self;
        let stepped = vectorised(
            #[inline(always)]
            || step(model, model, *order, interval, contact, size, work),
        );
        counts.steps += 1;
        counts.force_evaluations += (stepped.degree - 1) as u64;
        let h = stepped.h;
        let phase = if stepped.to_end != 0.0 { end } else { (state.phase + h / model.period_tau).min(end) };
        let advances = phase > state.phase || stepped.changed >= 0.0;
        if let Some(error) = step_error(model, state.period, state.phase, h, advances) {
            return Err(error);
        }
        observer.segment(&Segment {
            model,
            period: state.period,
            phase: state.phase,
            h,
            degree: stepped.degree,
            rows: &self.work.rows,
            force: &self.work.force,
            contact: state.contact,
        });
        let rows = &self.work.rows[..=stepped.degree];
        (state.x, state.v) = if DynamicModel::<D>::IS_TRAIN {
            vectorised(
                #[inline(always)]
                || evaluate_rows(rows, h),
            )
        } else {
            evaluate_rows(rows, h)
        };
        state.phase = phase;
        if stepped.changed >= 0.0 {
            state.contact[stepped.changed as usize] = stepped.contact as ContactSide;
            self.chatter.contact_changed(model, state, end);
        }
        Ok(())
    }
}
