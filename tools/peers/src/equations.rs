//! Right-hand side for the other programs: the twelve equations as 24 of first order, scaled so that one tolerance fits
//! all.
//!
//! Time in mesh periods. Displacements in units of [`LENGTH_M`], rotations as arcs R θ; velocities in [`LENGTH_M`]
//! times the frequency of the mesh √(k/m_e), so that both are of order one. 12 displacements, then 12 velocities, in
//! the order of the reference.

use std::f64::consts::{PI, TAU};

use crate::case::{PhysicalState, ReferenceCase};

/// Size of the vibration in the reference cases.
const LENGTH_M: f64 = 5e-6;

pub type Y = [f64; 24];

/// Spring and damper over the mass they act on, in scaled units.
#[derive(Clone, Copy)]
struct SpringRate {
    k: f64,
    c: f64,
}

impl SpringRate {
    #[inline(always)]
    fn of(self, x: f64, v: f64) -> f64 {
        self.k * x + self.c * v
    }
}

#[derive(Clone)]
pub struct ScaledEquations {
    /// Factor from velocity to change per mesh period; also from acceleration.
    rate: f64,
    /// Harmonics a cos φ and a sin φ of k/k_mean.
    harmonics: [[f64; 2]; 4],
    cos: f64,
    sin: f64,
    backlash: f64,
    /// c_m over k_mean.
    damper: f64,
    pulse: f64,
    duration: f64,
    /// T/R over k_mean.
    load: f64,
    /// Factors from force over k_mean to acceleration: lateral and axial of pinion and gear, arcs of pinion and gear.
    mobility: [f64; 4],
    pinion_lateral: SpringRate,
    gear_lateral: SpringRate,
    pinion_axial_other: SpringRate,
    gear_axial: SpringRate,
    gear_axial_other: SpringRate,
    /// SI units over scaled units of each state.
    units: Y,
}

impl ScaledEquations {
    pub fn new(case: &ReferenceCase) -> Self {
        let (m, n) = (&case.common, &case.numbers);
        let k = m.mean_stiffness_n_per_m;
        let omega = (k / m.equivalent_mass_kg).sqrt();
        let rate = |stiffness: f64, mass: f64| SpringRate {
            k: stiffness / (mass * omega * omega),
            c: 2.0 * m.support_damping_ratio * (stiffness * mass).sqrt() / (mass * omega),
        };
        let mobility = |mass: f64| k / (mass * omega * omega);
        let (rp, rg) = (m.pinion_radius_m, m.gear_radius_m);
        let angle = m.helix_angle_deg.to_radians();
        let mut harmonics = [[0.0; 2]; 4];
        assert!(n.amplitudes.len() <= harmonics.len());
        for (h, (a, phase)) in harmonics.iter_mut().zip(n.amplitudes.iter().zip(&m.phases_rad)) {
            *h = [a * phase.cos(), a * phase.sin()];
        }
        let lengths = [1.0, 1.0, 1.0 / rp, 1.0, 1.0, 1.0 / rg].map(|u| u * LENGTH_M);
        Self {
            rate: omega / case.mesh_frequency_hz(),
            harmonics,
            cos: angle.cos(),
            sin: angle.sin(),
            backlash: n.half_backlash_m / LENGTH_M,
            damper: case.mesh_damping_n_s_per_m() * omega / k,
            pulse: m.impact_force_n / (k * LENGTH_M),
            duration: m.impact_duration_mesh_periods,
            load: n.pinion_torque_per_half_nm / rp / (k * LENGTH_M),
            mobility: [
                mobility(m.pinion_mass_kg),
                mobility(m.gear_mass_kg),
                mobility(m.pinion_inertia_kg_m2 / (rp * rp)),
                mobility(m.gear_inertia_kg_m2 / (rg * rg)),
            ],
            pinion_lateral: rate(m.lateral_n_per_m, m.pinion_mass_kg),
            gear_lateral: rate(m.lateral_n_per_m, m.gear_mass_kg),
            pinion_axial_other: rate(m.pinion_axial_coupling_n_per_m, m.pinion_mass_kg),
            gear_axial: rate(m.gear_axial_n_per_m, m.gear_mass_kg),
            gear_axial_other: rate(m.gear_axial_coupling_n_per_m, m.gear_mass_kg),
            units: std::array::from_fn(|i| lengths[i % 6] * if i < 12 { 1.0 } else { omega }),
        }
    }

    pub fn scaled(&self, state: &PhysicalState) -> Y {
        std::array::from_fn(|i| state[i] / self.units[i])
    }

    pub fn physical(&self, y: &[f64]) -> PhysicalState {
        std::array::from_fn(|i| y[i] * self.units[i])
    }

    /// Times at which the impact begins and ends, through `periods`.
    pub fn edges(&self, periods: u64) -> impl Iterator<Item = f64> + use<> {
        let duration = self.duration;
        (0..periods).flat_map(move |n| [n as f64 + duration, (n + 1) as f64])
    }

    /// k/k_mean and the impact at a time: one sine and cosine, the harmonics by their recurrence.
    #[inline(always)]
    fn excitation(&self, t: f64) -> (f64, f64) {
        let phase = t - t.floor();
        let (sin1, cos1) = (TAU * phase).sin_cos();
        let (mut sin, mut cos) = (sin1, cos1);
        let mut k = 1.0;
        for [a, b] in self.harmonics {
            k += a * cos - b * sin;
            (sin, cos) = (sin * cos1 + cos * sin1, cos * cos1 - sin * sin1);
        }
        let pulse = if phase < self.duration { self.pulse * (PI * phase / self.duration).sin() } else { 0.0 };
        (k, pulse)
    }

    /// Accelerations of half j from the tooth force and the tangential force, over k_mean.
    #[inline(always)]
    fn half(&self, j: usize, x: &[f64], v: &[f64], force: f64, along: f64, out: &mut [f64]) {
        let (i, o) = (6 * j, 6 - 6 * j);
        let [pinion, gear, pinion_arc, gear_arc] = self.mobility;
        let sin = if j == 0 { self.sin } else { -self.sin };
        let (fy, fz) = (self.cos * force, sin * force);
        let a = [
            -pinion * fy - self.pinion_lateral.of(x[i], v[i]),
            -pinion * fz - self.pinion_axial_other.of(x[i + 1] - x[o + 1], v[i + 1] - v[o + 1]),
            pinion_arc * (along - fy),
            gear * fy - self.gear_lateral.of(x[i + 3], v[i + 3]),
            gear * fz
                - self.gear_axial.of(x[i + 4], v[i + 4])
                - self.gear_axial_other.of(x[i + 4] - x[o + 4], v[i + 4] - v[o + 4]),
            gear_arc * (fy - along),
        ];
        for c in 0..6 {
            out[12 + i + c] = self.rate * a[c];
        }
    }

    #[inline(always)]
    fn normal(&self, j: usize, q: &[f64]) -> f64 {
        let i = 6 * j;
        let sin = if j == 0 { self.sin } else { -self.sin };
        self.cos * (q[i] - q[i + 3] + q[i + 2] - q[i + 5]) + sin * (q[i + 1] - q[i + 4])
    }

    /// dy/dt.
    #[inline]
    pub fn derivative(&self, t: f64, y: &Y, dy: &mut Y) {
        let (k, pulse) = self.excitation(t);
        let (x, v) = y.split_at(12);
        for c in 0..12 {
            dy[c] = self.rate * v[c];
        }
        for j in 0..2 {
            let s = self.normal(j, x);
            let pressed = (s - self.backlash).max(0.0) + (s + self.backlash).min(0.0);
            let force = self.damper * self.normal(j, v) + k * pressed;
            self.half(j, x, v, force, self.load - pulse, dy);
        }
    }

    /// The Jacobian of [`Self::derivative`] at (t, y) times `d`.
    pub fn jacobian_product(&self, t: f64, y: &Y, d: &Y, out: &mut Y) {
        let (k, _) = self.excitation(t);
        let (x, v) = d.split_at(12);
        for c in 0..12 {
            out[c] = self.rate * v[c];
        }
        for j in 0..2 {
            let stiffness = if self.normal(j, &y[..12]).abs() > self.backlash { k } else { 0.0 };
            let force = self.damper * self.normal(j, v) + stiffness * self.normal(j, x);
            self.half(j, x, v, force, 0.0, out);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Between changes of contact the equations are linear: differences are exact except for rounding.
    #[test]
    fn the_jacobian_is_the_derivative() {
        for case in crate::case::all() {
            let equations = ScaledEquations::new(&case);
            let y = equations.scaled(&case.start);
            for column in 0..24 {
                let mut d = [0.0; 24];
                d[column] = 1e-3;
                let moved: Y = std::array::from_fn(|i| y[i] + d[i]);
                let (mut before, mut after, mut product) = ([0.0; 24], [0.0; 24], [0.0; 24]);
                equations.derivative(0.03, &y, &mut before);
                equations.derivative(0.03, &moved, &mut after);
                equations.jacobian_product(0.03, &y, &d, &mut product);
                for i in 0..24 {
                    let difference = after[i] - before[i] - product[i];
                    assert!(difference.abs() < 1e-9, "case {}, {i} by {column}: {difference:e}", case.name);
                }
            }
        }
    }
}
