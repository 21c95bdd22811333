//! Taylor series of high order on the piecewise-linear equations, restarted exactly where they change.
//!
//! Between two events (an edge of a pulse, a knot of the stiffness, a change of contact) the equations are linear with analytic
//! coefficients, so the Taylor coefficients of the motion follow from a recurrence and the step may be as long as the wanted
//! accuracy allows. Changes of contact are zeros of the polynomial s(τ) ∓ b and are located to rounding. Step length after Jorba
//! and Zou (Experimental Mathematics 14 (2005) 99), from the last two coefficients.

use super::crossing::first_crossing;
use super::error::DynamicsError;
use super::excitation::MAX_ORDER;
use super::integrate::Numerics;
use super::model::{Contact, Model, PER_HALF, State, W};
use super::recurrence::TaylorWork;
use super::segment::{Observer, Segment};

/// Changes of contact per mesh period beyond which they are no longer located but left to short steps.
const MOST_CHANGES_PER_PERIOD: u32 = 20_000;

/// Working memory of the Taylor method.
pub(super) struct Taylor<const D: usize> {
    order: usize,
    tolerance: f64,
    /// None: step chosen from the coefficients; Some: fixed step in scaled time (for measuring the order).
    fixed: Option<f64>,
    work: Box<TaylorWork<D>>,
    /// Size of the recent motion: scaled velocity and acceleration, as lengths.
    size: f64,
    changes: (u64, u32),
}

impl<const D: usize> Taylor<D> {
    /// `tolerance`: local error of a step relative to the size of the motion.
    pub fn new(tolerance: f64, order: usize, fixed: Option<f64>) -> Self {
        Self { order: order.clamp(4, MAX_ORDER), tolerance, fixed, work: TaylorWork::new(), size: 0.0, changes: (0, 0) }
    }

    /// The order that costs least at a tolerance (measured on the reference cases).
    pub fn order_for(tolerance: f64) -> usize {
        match tolerance {
            t if t >= 1e-6 => 14,
            t if t >= 1e-9 => 18,
            t if t >= 1e-12 => 20,
            _ => 24,
        }
    }

    /// Advances by one step, at most to the phase `end`; `inside` is a phase in the smooth stretch.
    pub fn step(
        &mut self,
        model: &Model<D>,
        state: &mut State<D>,
        end: f64,
        inside: f64,
        numerics: &mut Numerics,
        observer: &mut impl Observer<D>,
    ) -> Result<(), DynamicsError> {
        let order = self.order;
        self.work.excite(model, state.phase, inside, order);
        self.work.rows[0] = state.x;
        self.work.rows[1] = state.v;
        model.taylor(state.contact, order, true, &mut self.work);
        numerics.steps += 1;
        numerics.force_evaluations += (order - 1) as u64;

        let remaining = (end - state.phase) * model.period_tau;
        let wanted = self.step_length(remaining);
        let to_end = remaining <= wanted * (1.0 + 1e-9);
        // Two equal steps rather than a long one and a stub.
        let mut h = if to_end { remaining } else { remaining / (remaining / wanted - 1e-9).ceil() };
        if h.is_nan() || h <= 0.0 || h.is_infinite() || (!to_end && state.phase + h / model.period_tau <= state.phase) {
            let time_s = (state.period as f64 + state.phase) * model.period_tau / model.omega_ref;
            return Err(if h.is_finite() {
                DynamicsError::StepSizeTooSmall { time_s, step_s: h / model.omega_ref }
            } else {
                DynamicsError::Diverged { time_s }
            });
        }
        let mut changed = None;
        if model.b > 0.0 && !model.hold_contact {
            for j in 0..Model::<D>::HALVES {
                if let Some((at, contact)) = self.next_contact(model.b, j, state.contact[j], h) {
                    h = at;
                    changed = Some((j, contact));
                }
            }
        }
        observer.segment(&Segment {
            model,
            period: state.period,
            phase: state.phase,
            h,
            degree: order,
            rows: &self.work.rows,
            force: &self.work.force,
            contact: state.contact,
        });
        (state.x, state.v) = evaluate_rows(&self.work.rows[..=order], h);
        match changed {
            Some((j, contact)) => {
                state.phase = (state.phase + h / model.period_tau).min(end);
                state.contact[j] = contact;
                if self.changes.0 != state.period {
                    self.changes = (state.period, 0);
                }
                self.changes.1 += 1;
                if self.changes.1 > MOST_CHANGES_PER_PERIOD {
                    self.shuffle_on(model, state, end);
                }
            }
            None if to_end => state.phase = end,
            None => state.phase += h / model.period_tau,
        }
        Ok(())
    }

    /// Rattling faster than can be followed: goes on by a short free step and takes the contact it finds.
    fn shuffle_on(&mut self, model: &Model<D>, state: &mut State<D>, end: f64) {
        let step = (end - state.phase).min(1e-4);
        let a = model.acceleration(state.phase, state.phase + 0.5 * step, &state.x, &state.v);
        let h = step * model.period_tau;
        for c in 0..D {
            state.v[c] += h * a[c];
            state.x[c] += h * state.v[c];
        }
        state.phase += step;
        for j in 0..Model::<D>::HALVES {
            state.contact[j] = model.contact_of(model.s(j, &state.x));
        }
    }

    fn step_length(&mut self, remaining: f64) -> f64 {
        let moving = norm(&self.work.rows[1]).max(norm(&self.work.rows[2]));
        self.size = (0.98 * self.size).max(moving);
        // Below the rounding of the positions no tolerance can be met.
        let allowed = (self.tolerance * self.size).max(1e-17 * norm(&self.work.rows[0]));
        let h = reach(&self.work.rows[..], self.order, allowed);
        let h = self.fixed.unwrap_or(h);
        if h.is_nan() { f64::NAN } else { h.min(remaining) }
    }

    /// The first change of contact of a half within `h`: when, and to what.
    fn next_contact(&self, b: f64, j: usize, contact: Contact, h: f64) -> Option<(f64, Contact)> {
        let mut g = [0.0; MAX_ORDER + 1];
        let g = &mut g[..=self.order];
        let mut distance = |sign: f64, offset: f64, h: f64| {
            for (g, s) in g.iter_mut().zip(&self.work.s[j]) {
                *g = sign * s;
            }
            g[0] += offset;
            first_crossing(g, h)
        };
        match contact {
            0 => {
                let up = distance(-1.0, b, h).map(|at| (at, 1));
                let within = up.map_or(h, |(at, _)| at);
                distance(1.0, b, within).map(|at| (at, -1)).or(up)
            }
            side => distance(f64::from(side), -b, h).map(|at| (at, 0)),
        }
    }
}

/// Largest coordinate, free rotation apart.
#[inline(always)]
fn norm<const D: usize>(row: &[f64; D]) -> f64 {
    let mut largest = 0.0f64;
    for (c, value) in row.iter().enumerate() {
        if c % PER_HALF != W {
            // Keeps a NaN, which f64::max would drop.
            largest = if value.abs() <= largest { largest } else { value.abs() };
        }
    }
    largest
}

/// The step at which the last two terms are as large as `allowed`.
#[inline(always)]
fn reach<const D: usize>(rows: &[[f64; D]], order: usize, allowed: f64) -> f64 {
    let of = |k: usize| {
        let last = norm(&rows[k]);
        if last == 0.0 { f64::INFINITY } else { (allowed / last).powf(1.0 / k as f64) }
    };
    let (a, b) = (of(order - 1), of(order));
    if a < b || a.is_nan() { a } else { b }
}

/// The step that keeps the local error at `tolerance` times the size of the polynomials' own motion, at most `most`.
pub(super) fn step_reach<const D: usize>(rows: &[[f64; D]], order: usize, tolerance: f64, most: f64) -> f64 {
    let size = norm(&rows[0]).max(norm(&rows[1])).max(norm(&rows[2]));
    let h = reach(rows, order, tolerance * size);
    if h < most { h } else { most }
}

/// Values and derivatives of all coordinates at τ = t.
#[inline(always)]
pub(super) fn evaluate_rows<const D: usize>(rows: &[[f64; D]], t: f64) -> ([f64; D], [f64; D]) {
    let (mut x, mut v) = ([0.0; D], [0.0; D]);
    for row in rows.iter().rev() {
        for c in 0..D {
            v[c] = v[c] * t + x[c];
            x[c] = x[c] * t + row[c];
        }
    }
    (x, v)
}
