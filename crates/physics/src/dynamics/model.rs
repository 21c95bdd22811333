//! The equations of one pair with their excitations, and the transformation between solver coordinates and physical
//! displacements.

use std::ops::Deref;
use std::sync::Arc;

use super::contact_force::ContactForce;
use super::equations::{Equations, PER_HALF, U, YG, YP, ZG, ZP, solved_halves};
use super::error::DynamicsError;
use super::excitation::{FourierSeries, ImpactWaveform, MAX_ORDER, Stiffness, StiffnessWaveform};
use super::modal_train::ModalTrain;
use super::parameters::{HalfParameters, Parameters};
use super::segment::Segment;
use super::taylor::evaluate_rows;
use super::train_equations::TrainEquations;
use super::train_modes::TrainModes;

/// Contact of a half: positive on the driving flanks, 0 apart, negative on the back flanks. The magnitude is 1 for a
/// mesh stiffness, and 1 + the level of the displacement for a tabulated contact force.
pub type ContactSide = i8;

/// State in solver coordinates at a mesh phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MotionState<const D: usize> {
    /// Whole mesh periods since the start of the integration.
    pub period: u64,
    /// Phase within the mesh period, 0 … 1.
    pub phase: f64,
    /// Displacements, m.
    pub x: [f64; D],
    /// dx/dτ, m.
    pub v: [f64; D],
    /// Contact of each half.
    pub contact: [ContactSide; 2],
}

/// Excitations of one half.
#[derive(Debug, Clone)]
pub(crate) struct Excitation {
    pub stiffness: StiffnessWaveform,
    pub contact: Option<ContactForceWaveform>,
    pub impact: ImpactWaveform,
    /// Displacement excitation.
    pub gap: Option<FourierSeries<f64>>,
}

/// Tabulated contact force with a phase shift.
#[derive(Debug, Clone)]
pub(crate) struct ContactForceWaveform {
    pub force: Arc<ContactForce>,
    /// Delay of the force, in mesh periods.
    pub shift: f64,
    /// Half the backlash in m, and one mesh period in scaled time.
    pub b: f64,
    pub period_tau: f64,
}

/// Equations of one half (D = 6, mirror-symmetric pair), of both (D = 12) or of a train (larger D), with their
/// excitations.
#[derive(Debug, Clone)]
pub(crate) struct DynamicModel<const D: usize> {
    equations: Equations<D, f64>,
    /// One per solved half.
    pub excitations: Vec<Excitation>,
    /// Contact is fixed: the equations are linear with periodic coefficients.
    pub fixed_contact: bool,
    /// Reference frequency of the scaled time τ = ω_ref t, rad/s.
    pub omega_ref: f64,
    /// One mesh period in scaled time.
    pub period_tau: f64,
    /// Phases in (0, 1], ascending, at which an excitation is not smooth; the last is 1.
    pub breakpoints: Vec<f64>,
    /// Radii of pinion and gear in the reference plane, m.
    pub radius_p: f64,
    pub radius_g: f64,
}

impl<const D: usize> Deref for DynamicModel<D> {
    type Target = Equations<D, f64>;

    fn deref(&self) -> &Equations<D, f64> {
        &self.equations
    }
}

/// Distance below which two breakpoints count as one, in mesh periods.
const SAME_PHASE: f64 = 1e-12;

impl<const D: usize> DynamicModel<D> {
    /// Number of solved halves.
    pub(crate) const HALVES: usize = solved_halves(D);
    /// Whether the coordinates are those of a train.
    pub(crate) const IS_TRAIN: bool = Equations::<D, f64>::IS_TRAIN;

    /// Scales the equations by the highest of the mesh frequency and the estimated natural frequencies.
    ///
    /// # Errors
    /// [`DynamicsError::InvalidParameter`].
    pub(crate) fn new(p: &Parameters) -> Result<Self, DynamicsError> {
        p.validate()?;
        let mesh_omega = std::f64::consts::TAU * p.mesh_frequency_hz;
        let train = if Self::IS_TRAIN { p.train.as_deref() } else { None };
        if Self::IS_TRAIN != train.is_some() {
            return Err(DynamicsError::InvalidParameter {
                name: "number of coordinates",
                value: D as f64,
                reason: "is not that of the parameters",
            });
        }
        let omega_ref = match train {
            Some(train) => mesh_omega.max(fastest_of_train(p, train)),
            None => (0..Self::HALVES).fold(mesh_omega, |w, j| w.max(fastest(p, &p.halves[j], p.equivalent_mass_kg(j)))),
        };
        let period_tau = omega_ref / p.mesh_frequency_hz;
        let excitations: Vec<Excitation> =
            p.halves[..Self::HALVES].iter().map(|h| excitation(h, p.half_backlash_m, period_tau)).collect();
        let mut breakpoints = vec![1.0];
        for e in &excitations {
            e.stiffness.breakpoints(&mut breakpoints);
            e.impact.breakpoints(&mut breakpoints);
            if let Some(contact) = &e.contact {
                breakpoints.extend(contact.force.knots().iter().map(|knot| (knot + contact.shift).rem_euclid(1.0)));
            }
        }
        breakpoints.retain(|&phase| phase > SAME_PHASE && phase <= 1.0);
        breakpoints.sort_by(f64::total_cmp);
        // Of two breakpoints that coincide the later one is kept, so that the end of the period is reached exactly.
        breakpoints.reverse();
        breakpoints.dedup_by(|earlier, later| *later - *earlier < SAME_PHASE);
        breakpoints.reverse();
        let numbers = [omega_ref, period_tau];
        if let Some(&bad) = numbers.iter().find(|n| !n.is_finite()) {
            return Err(DynamicsError::InvalidParameter {
                name: "reference frequency",
                value: bad,
                reason: "stiffness over mass is too large",
            });
        }
        let equations = match train {
            Some(train) => {
                let radii_m = [p.pinion_radius_m, p.gear_radius_m];
                Equations::of_train(p, TrainEquations::new(train, radii_m, omega_ref), omega_ref)
            }
            None => Equations::new(p, omega_ref),
        };
        Ok(Self {
            equations,
            excitations,
            fixed_contact: false,
            omega_ref,
            period_tau,
            breakpoints,
            radius_p: p.pinion_radius_m,
            radius_g: p.gear_radius_m,
        })
    }

    /// The same model with fixed contact.
    pub(crate) fn with_fixed_contact(&self) -> Self {
        Self { fixed_contact: true, ..self.clone() }
    }

    /// The same model with the equations of antisymmetric perturbations (D = 6), see [`Equations::antisymmetric`].
    pub(crate) fn antisymmetric(&self) -> Self {
        Self { equations: self.equations.antisymmetric(), ..self.clone() }
    }

    /// Complex modes of a train with its mesh dampers.
    pub(super) fn train_modes(&self) -> Option<&TrainModes> {
        self.train.as_ref()?.modes([self.halves[0].cm, self.halves[1].cm])
    }

    /// Frobenius norm of the damping matrix of a train in scaled time, its meshes in contact or apart.
    pub(crate) fn damping_norm_of_train(&self, in_contact: bool) -> f64 {
        let Some(train) = &self.train else { return 0.0 };
        let mut sum = 0.0;
        for c in 0..D {
            let mut unit = [0.0; D];
            unit[c] = 1.0;
            let mut column = train.damping_product(&unit);
            for j in 0..Self::HALVES {
                let damper = if in_contact { self.halves[j].cm } else { self.halves[j].cm_in_gap };
                let force = damper * train.mesh[j][c];
                (0..D).for_each(|r| column[r] += train.mesh_acceleration[j][r] * force);
            }
            sum += column.iter().map(|v| v * v).sum::<f64>();
        }
        sum.sqrt()
    }

    /// Diagonal of the mass matrix in solver coordinates, kg.
    pub(crate) fn masses_kg(&self) -> [f64; D] {
        self.equations.masses_kg(self.omega_ref)
    }

    /// Whether contact can change.
    pub(crate) fn contact_can_change(&self) -> bool {
        self.uses_contact_force() || (self.b > 0.0 && !self.fixed_contact)
    }

    /// Whether the mesh force is a tabulated contact force, on all halves.
    pub(crate) fn uses_contact_force(&self) -> bool {
        self.excitations.iter().any(|e| e.contact.is_some())
    }

    /// Displacement excitation of a half and its rate in scaled time, m.
    #[inline(always)]
    pub(super) fn gap(&self, j: usize, phase: f64) -> Option<(f64, f64)> {
        let series = self.excitations[j].gap.as_ref()?;
        let (value, rate) = series.value_and_rate(phase);
        Some((value, rate / self.period_tau))
    }

    /// Rate of s less the displacement excitation in scaled time, from the rate of s.
    pub(crate) fn rate_of_approach(&self, j: usize, s_v: f64, phase: f64) -> f64 {
        self.gap(j, phase).map_or(s_v, |(_, rate)| s_v - rate)
    }

    /// Contact of half `j` at the displacement `s`. Without backlash the law of a mesh stiffness is linear: always
    /// driving.
    pub(crate) fn contact_of(&self, j: usize, s: f64, phase: f64) -> ContactSide {
        let s = self.gap(j, phase).map_or(s, |(gap, _)| s - gap);
        if let Some(contact) = &self.excitations[j].contact {
            return contact.force.contact_of(s, self.b, phase - contact.shift);
        }
        self.flank_at(s)
    }

    /// Contact with a mesh stiffness at the displacement `s` less the displacement excitation.
    #[inline(always)]
    pub(super) fn flank_at(&self, s: f64) -> ContactSide {
        if self.b == 0.0 || s > self.b {
            1
        } else if s < -self.b {
            -1
        } else {
            0
        }
    }

    /// Largest s of a half without force on its driving flanks at any phase, m.
    pub(crate) fn first_contact_displacement_m(&self, j: usize) -> f64 {
        let contact = self.excitations[j].contact.as_ref();
        self.b + contact.map_or(0.0, |c| c.force.min_free_m(1))
    }

    /// Rate in scaled time of the displacement at which contact of a side (1 driving, −1 back) begins, measured from
    /// mid-gap; 0 for a mesh stiffness.
    pub(crate) fn contact_onset_rate(&self, j: usize, side: ContactSide, phase: f64) -> f64 {
        let contact = self.excitations[j].contact.as_ref();
        contact.map_or(0.0, |c| c.force.free_rate_m(side, phase - c.shift) / self.period_tau)
    }

    /// Normal mesh force, N.
    #[inline(always)]
    pub(crate) fn mesh_force(&self, j: usize, (phase, interior): (f64, f64), s: f64, s_v: f64) -> f64 {
        let e = &self.excitations[j];
        let contact_side = self.contact_of(j, s, phase);
        let (s, s_v) = self.gap(j, phase).map_or((s, s_v), |(gap, rate)| (s - gap, s_v - rate));
        let damper = |closed: bool| if closed { self.halves[j].cm } else { self.halves[j].cm_in_gap } * s_v;
        if let Some(contact) = &e.contact {
            let (force, _) = contact.force.force(s, self.b, phase - contact.shift, interior - contact.shift);
            return damper(contact_side != 0) + force;
        }
        let spring = e.stiffness.value(phase, interior) * (s - f64::from(contact_side) * self.b);
        damper(contact_side != 0) + if contact_side != 0 { spring } else { 0.0 }
    }

    /// 1 where the load presses the driving flanks of a half, −1 where it presses the back flanks.
    pub(super) fn loaded_side(&self, j: usize) -> f64 {
        if self.halves[j].load < 0.0 { -1.0 } else { 1.0 }
    }

    /// Accelerations in scaled time at a phase: right-hand side for Runge–Kutta methods.
    pub(crate) fn acceleration(&self, phase: f64, interior: f64, x: &[f64; D], v: &[f64; D]) -> [f64; D] {
        let mut a = [0.0; D];
        if Self::IS_TRAIN {
            let s = [0, 1].map(|j| self.s(j, x));
            let impact = [0, 1].map(|j| self.excitations[j].impact.value(phase, interior));
            let normal = [0, 1].map(|j| {
                let force = self.mesh_force(j, (phase, interior), s[j], self.s(j, v));
                force + self.impact_normal * impact[j]
            });
            let along = impact.map(|impact| -self.impact_along * impact);
            return self.train_acceleration((x, v), (s, normal, Some(along)), 1.0);
        }
        for j in 0..Self::HALVES {
            let force = self.mesh_force(j, (phase, interior), self.s(j, x), self.s(j, v));
            let impact = self.excitations[j].impact.value(phase, interior);
            let along = self.halves[j].load - self.impact_along * impact;
            let normal = force + self.impact_normal * impact;
            a[j * PER_HALF..][..PER_HALF].copy_from_slice(&self.half_acceleration(j, x, v, normal, along));
        }
        a
    }

    /// Upper bound of load and impact on the mesh of a half, N.
    pub(crate) fn max_excitation_force_n(&self, j: usize) -> f64 {
        self.halves[j].load.abs() + self.excitations[j].impact.largest_n()
    }

    /// Accelerations in scaled time due to a normal mesh force (N) of half `j` alone.
    pub(crate) fn acceleration_of_mesh_force(&self, j: usize, force: f64) -> [f64; D] {
        let mut out = [0.0; D];
        if Self::IS_TRAIN {
            let mesh = self.train.as_ref().map(|train| &train.mesh_acceleration[j]);
            return mesh.map_or(out, |mesh| mesh.map(|a| -a * force));
        }
        out[j * PER_HALF..][..PER_HALF].copy_from_slice(&self.half_acceleration(j, &[0.0; D], &[0.0; D], force, 0.0));
        out
    }

    /// Accelerations in scaled time due to the springs other than the mesh; not of a train.
    pub(crate) fn acceleration_of_springs(&self, x: &[f64; D]) -> [f64; D] {
        let mut out = [0.0; D];
        for j in 0..Self::HALVES {
            out[j * PER_HALF..][..PER_HALF].copy_from_slice(&self.half_acceleration(j, x, &[0.0; D], 0.0, 0.0));
        }
        out
    }

    /// Taylor coefficient `n` of the total normal tooth force of a half, mesh force plus F_s/cosβ, N, from the
    /// rotational equation of motion and the polynomials `rows`; it does not depend on the law of the mesh force. Not
    /// of a train. Over a periodic motion its mean is T_p/(R_p cosβ) if no torsional spring couples the halves, and
    /// always in the sum of both halves.
    pub(crate) fn tooth_force_coefficient(&self, j: usize, n: usize, rows: &[[f64; D]; MAX_ORDER + 1]) -> f64 {
        let n1 = (n + 1) as f64;
        let free = self.half_acceleration(j, &rows[n], &rows[n + 1].map(|c| c * n1), 0.0, 0.0);
        let a = rows[n + 2][j * PER_HALF + U] * n1 * (n1 + 1.0);
        let load = if n == 0 { self.halves[j].load } else { 0.0 };
        (load - (a - free[U]) / self.halves[j].inv_me) / self.cos
    }

    /// Total normal tooth force of a half of a train as a polynomial in scaled time since the start of the segment, N:
    /// mesh force and F_s/cosβ.
    pub(crate) fn tooth_force_of_train(&self, j: usize, segment: &Segment<'_, D>, out: &mut [f64; MAX_ORDER + 1]) {
        let degree = segment.degree - 2;
        let step = segment.h / self.period_tau;
        let interior = segment.phase + 0.5 * step;
        let impact = &self.excitations[j].impact;
        let mut struck = [0.0; MAX_ORDER + 1];
        if degree > 3 {
            impact.taylor(segment.phase, interior, degree, &mut struck);
        } else {
            // Steps without a Taylor series: the force is a cubic too.
            let cubic = interpolating_cubic(|part| impact.value(segment.phase + part * step, interior));
            for (n, c) in cubic.into_iter().enumerate() {
                struck[n] = c / segment.h.powi(n as i32);
            }
        }
        for n in 0..=degree {
            out[n] = segment.force[j][n] + struck[n] / self.cos;
        }
    }

    /// The impact's contribution to the normal force in the lateral and axial equations, N: interpolating cubic through
    /// four phases of a step, in powers of the fraction of the step.
    pub(crate) fn impact_in_normal(&self, j: usize, phase: f64, step: f64, interior: f64) -> [f64; 4] {
        if self.impact_normal == 0.0 {
            return [0.0; 4];
        }
        interpolating_cubic(|part| self.impact_normal * self.excitations[j].impact.value(phase + part * step, interior))
    }

    /// Normal mesh force of a half over a step from the polynomials `rows`: interpolating cubic through four phases, in
    /// powers of the fraction of the step.
    pub(crate) fn mesh_force_over_step(
        &self,
        j: usize,
        (phase, interior, h): (f64, f64, f64),
        rows: &[[f64; D]],
    ) -> [f64; 4] {
        interpolating_cubic(|part| {
            let (x, v) = evaluate_rows(rows, part * h);
            self.mesh_force(j, (phase + part * h / self.period_tau, interior), self.s(j, &x), self.s(j, &v))
        })
    }

    /// Taylor coefficient `n` of the normal force (mesh force, and an impact that acts on all motions), N, from the
    /// lateral equation of motion of the gear and the polynomials `rows`; not of a train.
    pub(crate) fn mesh_force_coefficient(&self, j: usize, n: usize, rows: &[[f64; D]; MAX_ORDER + 1]) -> f64 {
        let n1 = (n + 1) as f64;
        let free = self.half_acceleration(j, &rows[n], &rows[n + 1].map(|c| c * n1), 0.0, 0.0);
        let a = rows[n + 2][j * PER_HALF + YG] * n1 * (n1 + 1.0);
        (a - free[YG]) / (self.halves[j].inv_mg * self.cos)
    }

    /// State from 12 displacements and 12 velocities: of a train the one of least energy.
    pub(crate) fn state_from(&self, physical: &[f64; 24]) -> MotionState<D> {
        let mut state = MotionState { period: 0, phase: 0.0, x: [0.0; D], v: [0.0; D], contact: [1; 2] };
        if let Some(train) = &self.train {
            state.x = train.coordinates(&physical[..12]);
            state.v = train.velocities(&physical[12..]).map(|v| v / self.omega_ref);
            self.set_contact(&mut state);
            return state;
        }
        for j in 0..Self::HALVES {
            let h = &self.halves[j];
            let sum = h.reduced_p + h.reduced_g;
            let convert = |q: &[f64], out: &mut [f64; D], scale: f64| {
                let (arc_p, arc_g) = (self.radius_p * q[2], self.radius_g * q[5]);
                let w = (h.reduced_p * arc_p + h.reduced_g * arc_g) / sum;
                let row = [q[0], q[1], arc_p - arc_g, q[3], q[4], w];
                for c in 0..PER_HALF {
                    out[j * PER_HALF + c] = row[c] * scale;
                }
            };
            convert(&physical[6 * j..6 * j + 6], &mut state.x, 1.0);
            convert(&physical[12 + 6 * j..18 + 6 * j], &mut state.v, 1.0 / self.omega_ref);
        }
        self.set_contact(&mut state);
        state
    }

    /// Sets the contact of each half from the displacements of the state.
    pub(crate) fn set_contact(&self, state: &mut MotionState<D>) {
        for j in 0..Self::HALVES {
            state.contact[j] = self.contact_of(j, self.s(j, &state.x), state.phase);
        }
    }

    /// State from the coordinates of a train, then their velocities (1/s), in the order of the [`ModalTrain`].
    pub(crate) fn state_from_modes(&self, modal: &[f64]) -> MotionState<D> {
        let mut state = MotionState { period: 0, phase: 0.0, x: [0.0; D], v: [0.0; D], contact: [1; 2] };
        if let Some(train) = &self.train {
            let (x, v) = modal.split_at(modal.len() / 2);
            for ((place, x), v) in train.places.iter().zip(x).zip(v) {
                (state.x[*place], state.v[*place]) = (*x, *v / self.omega_ref);
            }
            self.set_contact(&mut state);
        }
        state
    }

    /// Coordinates of a train, then their velocities (1/s), in the order of the [`ModalTrain`]; empty for a pair.
    pub(crate) fn modal_state(&self, state: &MotionState<D>) -> Vec<f64> {
        let Some(train) = &self.train else { return Vec::new() };
        let coordinates = train.places.iter().map(|place| state.x[*place]);
        coordinates.chain(train.places.iter().map(|place| state.v[*place] * self.omega_ref)).collect()
    }

    /// Train at rest under its load at the phase 0: with the tabulated contact force, or with the mean mesh stiffnesses
    /// `mean_n_per_m` on the flanks that the load presses. Without load the flanks touch.
    pub(crate) fn static_state_of_train(&self, mean_n_per_m: [f64; 2]) -> MotionState<D> {
        let mut state = MotionState { period: 0, phase: 0.0, x: [0.0; D], v: [0.0; D], contact: [1; 2] };
        let Some(train) = &self.train else { return state };
        let forces_n = train.static_forces_n();
        let side = forces_n.map(|force| if force < 0.0 { -1.0 } else { 1.0 });
        let gap = [0, 1].map(|j| self.gap(j, 0.0).map_or(0.0, |(gap, _)| gap));
        let contact = [0, 1].map(|j| self.excitations[j].contact.as_ref());
        let law = |j: usize, s: f64| match contact[j] {
            Some(c) => c.force.force(s - gap[j], self.b, -c.shift, -c.shift),
            None => (mean_n_per_m[j] * (s - side[j] * self.b), mean_n_per_m[j]),
        };
        let start = [0, 1].map(|j| match contact[j] {
            Some(c) if forces_n[j] == 0.0 => gap[j] + self.b + c.force.free_m(1, -c.shift),
            Some(c) => gap[j] + c.force.displacement_under(forces_n[j], self.b, -c.shift),
            None => side[j] * self.b + forces_n[j] / mean_n_per_m[j],
        });
        state.x = train.static_state(start, law);
        self.set_contact(&mut state);
        state
    }

    /// For a tabulated contact force, not of a train: rotates the gears until each half carries its load at the phase
    /// of the state. Halves coupled in torsion rotate by the mean of their angles.
    pub(crate) fn close_contact(&self, state: &mut MotionState<D>) {
        if Self::IS_TRAIN {
            return;
        }
        let mut turns = [0.0; 2];
        for (j, e) in self.excitations.iter().enumerate() {
            let Some(contact) = &e.contact else { return };
            let load = self.halves[j].load / self.cos;
            let s = contact.force.displacement_under(load, self.b, state.phase - contact.shift);
            let s = self.gap(j, state.phase).map_or(s, |(gap, _)| s + gap);
            turns[j] = (s - self.s(j, &state.x)) / self.cos;
        }
        if Self::HALVES == 2 && self.couples_rotations() {
            turns = [0.5 * (turns[0] + turns[1]); 2];
        }
        for j in 0..Self::HALVES {
            state.x[j * PER_HALF + U] += turns[j];
            state.contact[j] = self.contact_of(j, self.s(j, &state.x), state.phase);
        }
    }

    /// 12 displacements (m, rad) and 12 velocities (m/s, rad/s) of a state.
    pub(crate) fn physical_state(&self, state: &MotionState<D>) -> [f64; 24] {
        let mut out = [0.0; 24];
        out[..12].copy_from_slice(&self.physical_displacements(&state.x));
        out[12..].copy_from_slice(&self.physical_displacements(&state.v).map(|v| v * self.omega_ref));
        out
    }

    /// 12 displacements of solver coordinates; of velocities or accelerations when `row` holds those.
    pub(crate) fn physical_displacements(&self, row: &[f64; D]) -> [f64; 12] {
        if let Some(train) = &self.train {
            return train.physical_displacements(row);
        }
        let mut out = [0.0; 12];
        for j in 0..2 {
            let (from, mirrored) = if D > PER_HALF { (j, 1.0) } else { (0, if j == 0 { 1.0 } else { -1.0 }) };
            let i = from * PER_HALF;
            let (arc_p, arc_g) = self.arcs(from, row);
            let half = [
                row[i + YP],
                mirrored * row[i + ZP],
                arc_p / self.radius_p,
                row[i + YG],
                mirrored * row[i + ZG],
                arc_g / self.radius_g,
            ];
            out[6 * j..6 * j + 6].copy_from_slice(&half);
        }
        out
    }
}

/// Interpolating cubic through the values at 0, 1/3, 2/3 and 1, in powers of the argument.
fn interpolating_cubic(at: impl Fn(f64) -> f64) -> [f64; 4] {
    let [y0, y1, y2, y3] = [at(0.0), at(1.0 / 3.0), at(2.0 / 3.0), at(1.0)];
    [
        y0,
        -5.5 * y0 + 9.0 * y1 - 4.5 * y2 + y3,
        9.0 * y0 - 22.5 * y1 + 18.0 * y2 - 4.5 * y3,
        4.5 * (-y0 + 3.0 * y1 - 3.0 * y2 + y3),
    ]
}

/// Upper bound of the natural frequencies of a train with the largest mesh stiffness, rad/s.
fn fastest_of_train(p: &Parameters, train: &ModalTrain) -> f64 {
    let largest = train.eigenvalues_rad2_s2.iter().fold(0.0f64, |m, l| m.max(*l));
    let beyond = |j: usize| {
        let k_ref = train.reference_stiffness_n_per_m[j];
        let stiffer = (largest_stiffness_n_per_m(&p.halves[j]) - k_ref).max(0.0);
        stiffer * train.mesh[j].iter().map(|m| m * m).sum::<f64>()
    };
    (largest + beyond(0) + beyond(1)).sqrt()
}

/// Largest mesh stiffness of a half on the flank that its torque presses, N/m; of a Fourier series its mean.
fn largest_stiffness_n_per_m(h: &HalfParameters) -> f64 {
    let k_m = match &h.mesh_stiffness {
        Stiffness::Samples { values_n_per_m } => values_n_per_m.iter().copied().fold(0.0, f64::max),
        other => other.mean_n_per_m(),
    };
    let side = if h.pinion_torque_nm < 0.0 { -1 } else { 1 };
    h.contact_force.as_ref().map_or(k_m, |force| force.largest_stiffness_n_per_m(side).max(k_m))
}

/// Upper estimate of the highest natural frequency of a half, rad/s: all springs acting on each mass.
fn fastest(p: &Parameters, h: &HalfParameters, equivalent_mass: f64) -> f64 {
    let c = &p.couplings;
    let k_m = largest_stiffness_n_per_m(h);
    let mesh = k_m * (1.0 / equivalent_mass + 1.0 / h.pinion_mass_kg + 1.0 / h.gear_mass_kg);
    let springs = [
        (h.pinion_lateral.stiffness + 2.0 * c.pinion_lateral.stiffness) / h.pinion_mass_kg,
        (h.pinion_axial.stiffness + 2.0 * c.pinion_axial.stiffness) / h.pinion_mass_kg,
        (h.gear_lateral.stiffness + 2.0 * c.gear_lateral.stiffness) / h.gear_mass_kg,
        (h.gear_axial.stiffness + 2.0 * c.gear_axial.stiffness) / h.gear_mass_kg,
        2.0 * c.pinion_torsion.stiffness / h.pinion_inertia_kg_m2,
        2.0 * c.gear_torsion.stiffness / h.gear_inertia_kg_m2,
    ];
    springs.into_iter().fold(mesh, f64::max).sqrt()
}

fn excitation(h: &HalfParameters, b: f64, period_tau: f64) -> Excitation {
    let shift = h.phase_shift_mesh_periods.rem_euclid(1.0);
    let contact =
        h.contact_force.as_ref().map(|force| ContactForceWaveform { force: force.clone(), shift, b, period_tau });
    // With a tabulated contact force the stiffness is not used and adds no breakpoints.
    let stiffness = match &contact {
        None => StiffnessWaveform::new(&h.mesh_stiffness, shift, period_tau),
        Some(_) => {
            let mean_n_per_m = h.mesh_stiffness.mean_n_per_m();
            StiffnessWaveform::new(&Stiffness::Constant { mean_n_per_m }, shift, period_tau)
        }
    };
    Excitation {
        stiffness,
        contact,
        impact: ImpactWaveform::new(h.impact.as_ref(), shift, period_tau),
        gap: FourierSeries::of_displacement(&h.displacement_excitation, shift, period_tau),
    }
}
