//! Embedded Runge–Kutta 4(5) method of Fehlberg with variable step, advancing the fourth-order result as the source
//! paper's method does.
//!
//! Changes of contact are not located. Edges of pulses, knots of the stiffness and ends of mesh periods are ends of
//! steps. Tableau: E. Fehlberg, Low-order classical Runge-Kutta formulas with stepsize control, NASA TR R-315 (1969),
//! table III.

use super::equations::is_rigid_rotation;
use super::error::DynamicsError;
use super::excitation::{Coefficients, MAX_ORDER};
use super::integrate::StepCounts;
use super::model::{DynamicModel, MotionState};
use super::segment::{Observer, Segment};

const C: [f64; 6] = [0.0, 1.0 / 4.0, 3.0 / 8.0, 12.0 / 13.0, 1.0, 1.0 / 2.0];
const A: [[f64; 5]; 6] = [
    [0.0; 5],
    [1.0 / 4.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 32.0, 9.0 / 32.0, 0.0, 0.0, 0.0],
    [1932.0 / 2197.0, -7200.0 / 2197.0, 7296.0 / 2197.0, 0.0, 0.0],
    [439.0 / 216.0, -8.0, 3680.0 / 513.0, -845.0 / 4104.0, 0.0],
    [-8.0 / 27.0, 2.0, -3544.0 / 2565.0, 1859.0 / 4104.0, -11.0 / 40.0],
];
const B4: [f64; 6] = [25.0 / 216.0, 0.0, 1408.0 / 2565.0, 2197.0 / 4104.0, -1.0 / 5.0, 0.0];
const B5: [f64; 6] = [16.0 / 135.0, 0.0, 6656.0 / 12825.0, 28561.0 / 56430.0, -9.0 / 50.0, 2.0 / 55.0];

/// Runge–Kutta method for one motion, with its working memory.
pub(super) struct RungeKutta<const D: usize> {
    tolerance: f64,
    /// None: the step follows from the error estimate. Some: fixed step in scaled time, to measure the order.
    fixed: Option<f64>,
    next: f64,
    size: f64,
    rows: Box<[[f64; D]; MAX_ORDER + 1]>,
    force: Box<[Coefficients; 2]>,
}

impl<const D: usize> RungeKutta<D> {
    pub(crate) fn new(tolerance: f64, fixed: Option<f64>) -> Self {
        Self {
            tolerance,
            fixed,
            next: 0.05,
            size: 0.0,
            rows: Box::new([[0.0; D]; MAX_ORDER + 1]),
            force: Box::new([[0.0; MAX_ORDER + 1]; 2]),
        }
    }

    pub(crate) fn step(
        &mut self,
        model: &DynamicModel<D>,
        state: &mut MotionState<D>,
        end: f64,
        interior: f64,
        counts: &mut StepCounts,
        observer: &mut impl Observer<D>,
    ) -> Result<(), DynamicsError> {
        let time_s = (state.period as f64 + state.phase) * model.period_tau / model.omega_ref;
        let remaining = (end - state.phase) * model.period_tau;
        let mut k = [([0.0; D], [0.0; D]); 6];
        k[0] = (state.v, model.acceleration(state.phase, interior, &state.x, &state.v));
        loop {
            let desired = self.fixed.unwrap_or(self.next);
            let count = (remaining / desired - 1e-9).ceil().max(1.0);
            let to_end = count <= 1.0;
            let h = if to_end { remaining } else { remaining / count };
            let phase_step = h / model.period_tau;
            if h.is_nan() || h <= 0.0 || (!to_end && state.phase + phase_step <= state.phase) {
                return Err(DynamicsError::StepSizeTooSmall { time_s, step_s: h / model.omega_ref });
            }
            for i in 1..6 {
                let (mut x, mut v) = (state.x, state.v);
                for (a, (kx, kv)) in A[i].iter().zip(&k[..i]) {
                    for c in 0..D {
                        x[c] += h * a * kx[c];
                        v[c] += h * a * kv[c];
                    }
                }
                k[i] = (v, model.acceleration(state.phase + C[i] * phase_step, interior, &x, &v));
            }
            counts.force_evaluations += 5;
            let (mut x, mut v) = (state.x, state.v);
            let mut error = 0.0f64;
            let mut moving = 0.0f64;
            for c in 0..D {
                let (mut ex, mut ev) = (0.0, 0.0);
                for i in 0..6 {
                    x[c] += h * B4[i] * k[i].0[c];
                    v[c] += h * B4[i] * k[i].1[c];
                    ex += h * (B5[i] - B4[i]) * k[i].0[c];
                    ev += h * (B5[i] - B4[i]) * k[i].1[c];
                }
                if !is_rigid_rotation(D, c) {
                    // `max` would drop a NaN.
                    let both = ex.abs() + ev.abs();
                    error = if both > error || both.is_nan() { both } else { error };
                    moving = moving.max(state.v[c].abs()).max(k[0].1[c].abs());
                }
            }
            if error.is_nan() {
                return Err(DynamicsError::Diverged { time_s });
            }
            let size = self.size.max(moving);
            let allowed = (self.tolerance * size).max(1e-16 * x.iter().fold(0.0f64, |m, v| m.max(v.abs())));
            // Error per step of the fourth-order result: order 5 in h.
            let factor = if error == 0.0 { 4.0 } else { (0.9 * (allowed / error).powf(0.2)).clamp(0.2, 4.0) };
            if self.fixed.is_none() {
                // The step after a last, shortened one is not limited by it.
                self.next = if to_end && factor >= 1.0 { (h * factor).max(self.next.min(4.0 * h)) } else { h * factor };
                if error > allowed {
                    counts.rejected_steps += 1;
                    if h < 1e-13 * model.period_tau {
                        return Err(DynamicsError::StepSizeTooSmall { time_s, step_s: h / model.omega_ref });
                    }
                    continue;
                }
            }
            self.size = 0.999 * size;
            counts.steps += 1;
            let phase = if to_end { end } else { state.phase + phase_step };
            let a = model.acceleration(phase, interior, &x, &v);
            counts.force_evaluations += 1;
            self.quintic(model, (&state.x, &state.v, &k[0].1), (&x, &v, &a), h);
            for j in 0..DynamicModel::<D>::HALVES {
                if DynamicModel::<D>::IS_TRAIN {
                    let step = (state.phase, interior, h);
                    let cubic = model.mesh_force_over_step(j, step, &self.rows[..=5]);
                    for (n, part) in cubic.into_iter().enumerate() {
                        self.force[j][n] = part / h.powi(n as i32);
                    }
                    continue;
                }
                let impact = model.impact_in_normal(j, state.phase, phase_step, interior);
                for (n, part) in impact.into_iter().enumerate() {
                    self.force[j][n] -= part / h.powi(n as i32);
                }
            }
            observer.segment(&Segment {
                model,
                period: state.period,
                phase: state.phase,
                h,
                degree: 5,
                rows: &self.rows,
                force: &self.force,
                contact: state.contact,
            });
            (state.phase, state.x, state.v) = (phase, x, v);
            for j in 0..DynamicModel::<D>::HALVES {
                state.contact[j] = model.contact_of(j, model.s(j, &state.x), state.phase);
            }
            return Ok(());
        }
    }

    /// Dense output: quintic Hermite interpolant of positions, velocities and accelerations at both ends. The mesh
    /// force is that of the gear's lateral equation of motion along the quintic; that of a train is not set here.
    fn quintic(&mut self, model: &DynamicModel<D>, start: Ends<'_, D>, end: Ends<'_, D>, h: f64) {
        let r = &mut self.rows;
        for c in 0..D {
            let (x0, v0, a0) = (start.0[c], start.1[c] * h, start.2[c] * h * h);
            let (x1, v1, a1) = (end.0[c], end.1[c] * h, end.2[c] * h * h);
            let dx = x1 - x0 - v0 - 0.5 * a0;
            let dv = v1 - v0 - a0;
            let da = a1 - a0;
            r[0][c] = x0;
            r[1][c] = start.1[c];
            r[2][c] = 0.5 * start.2[c];
            r[3][c] = (10.0 * dx - 4.0 * dv + 0.5 * da) / h.powi(3);
            r[4][c] = (-15.0 * dx + 7.0 * dv - da) / h.powi(4);
            r[5][c] = (6.0 * dx - 3.0 * dv + 0.5 * da) / h.powi(5);
        }
        if DynamicModel::<D>::IS_TRAIN {
            return;
        }
        for j in 0..DynamicModel::<D>::HALVES {
            for n in 0..=3 {
                self.force[j][n] = model.mesh_force_coefficient(j, n, r);
            }
        }
    }
}

/// Position, velocity and acceleration at one end of a step.
type Ends<'a, const D: usize> = (&'a [f64; D], &'a [f64; D], &'a [f64; D]);
