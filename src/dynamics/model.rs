//! The equations of motion in the coordinates they are solved in.
//!
//! # Coordinates
//! Per half: y_p, z_p, u, y_g, z_g, w (all lengths) with u = R_p θ_p − R_g θ_g and w = I_p θ_p/R_p + I_g θ_g/R_g scaled to a
//! length by 1/(I_p/R_p² + I_g/R_g²). u is all the mesh feels of the rotations, w is the free rotation: it is driven only by torsional couplings,
//! so rigid rotation neither drifts numerically nor costs accuracy. x = y_p − y_g + u and s = cosβ x + sinβ_j (z_p − z_g).
//!
//! `Model<6>` is one half of a mirror-symmetric pair (the other half has z and w mirrored as the symmetry says), `Model<12>`
//! both halves. Time is scaled by a reference frequency: τ = ω_ref t; velocities are dx/dτ.

use super::error::DynamicsError;
use super::excitation::{ImpactCourse, MAX_ORDER, StiffnessCourse};
use super::parameters::{HalfParameters, Parameters, Spring};

/// Coordinates per half, and their places.
pub(crate) const PER_HALF: usize = 6;
pub(crate) const YP: usize = 0;
pub(crate) const ZP: usize = 1;
pub(crate) const U: usize = 2;
pub(crate) const YG: usize = 3;
pub(crate) const ZG: usize = 4;
pub(crate) const W: usize = 5;

/// Which side of the backlash a half is on: 1 driving flanks, 0 apart, −1 back flanks.
pub type Contact = i8;

/// State in solver coordinates at a mesh phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct State<const D: usize> {
    /// Whole mesh periods since the start.
    pub period: u64,
    /// Phase within the mesh period, 0 … 1.
    pub phase: f64,
    pub x: [f64; D],
    /// dx/dτ.
    pub v: [f64; D],
    pub contact: [Contact; 2],
}

/// Spring and damper in scaled time, already divided by the mass they act on.
#[derive(Debug, Clone, Copy, Default)]
struct Rate {
    k: f64,
    c: f64,
}

impl Rate {
    fn new(spring: Spring, mass: f64, omega: f64) -> Self {
        Self { k: spring.stiffness / (mass * omega * omega), c: spring.damping / (mass * omega) }
    }

    #[inline(always)]
    fn of(self, x: f64, v: f64) -> f64 {
        self.k * x + self.c * v
    }
}

#[derive(Debug, Clone)]
pub(crate) struct HalfModel {
    pub sin: f64,
    /// Force to scaled acceleration: 1/(m ω²).
    inv_mp: f64,
    inv_mg: f64,
    pub inv_me: f64,
    yp: Rate,
    zp: Rate,
    yg: Rate,
    zg: Rate,
    yp_other: Rate,
    zp_other: Rate,
    yg_other: Rate,
    zg_other: Rate,
    /// Torsional couplings act on R_p θ_p and R_g θ_g as forces (per length).
    torsion_p: Rate,
    torsion_g: Rate,
    /// Reduced inertias I_p/R_p², I_g/R_g².
    pub reduced_p: f64,
    pub reduced_g: f64,
    /// 1/(reduced ω²).
    inv_rp: f64,
    inv_rg: f64,
    inv_rw: f64,
    /// Mesh damper times ω.
    pub cm: f64,
    /// T_p/R_p, N.
    pub load: f64,
    pub stiffness: StiffnessCourse,
    pub impact: ImpactCourse,
}

/// The equations of one half (D = 6, mirror symmetric) or both (D = 12).
#[derive(Debug, Clone)]
pub(crate) struct Model<const D: usize> {
    pub halves: Vec<HalfModel>,
    pub cos: f64,
    pub b: f64,
    pub damping_in_gap: bool,
    torsional: bool,
    /// D = 6 only: the other half moves as the mirror image (1) or as its opposite (−1, for variations).
    parity: f64,
    /// Contact is taken to stay as it is: the linear system with periodic coefficients.
    pub hold_contact: bool,
    pub omega_ref: f64,
    /// One mesh period in scaled time.
    pub period_tau: f64,
    /// Phases in (0, 1], ascending, at which an excitation is not smooth; the last is 1.
    pub breakpoints: Vec<f64>,
    /// Radii, for the source's displacements.
    pub radius_p: f64,
    pub radius_g: f64,
}

/// Breakpoints closer than this are one, in mesh periods.
const SAME_PHASE: f64 = 1e-12;

impl<const D: usize> Model<D> {
    pub const HALVES: usize = D / PER_HALF;

    pub fn new(p: &Parameters) -> Result<Self, DynamicsError> {
        p.validate()?;
        let mesh_omega = std::f64::consts::TAU * p.mesh_frequency_hz;
        let omega_ref =
            (0..Self::HALVES).fold(mesh_omega, |w, j| w.max(fastest(p, &p.halves[j], p.equivalent_mass_kg(j))));
        let period_tau = omega_ref / p.mesh_frequency_hz;
        let halves: Vec<HalfModel> = (0..Self::HALVES).map(|j| half_model(p, j, omega_ref, period_tau)).collect();
        let mut breakpoints = vec![1.0];
        for h in &halves {
            h.stiffness.breakpoints(&mut breakpoints);
            h.impact.breakpoints(&mut breakpoints);
        }
        breakpoints.retain(|&phase| phase > SAME_PHASE && phase <= 1.0);
        breakpoints.sort_by(f64::total_cmp);
        // Of two that coincide the later one stays, so that the end of the period is met exactly.
        breakpoints.reverse();
        breakpoints.dedup_by(|earlier, later| *later - *earlier < SAME_PHASE);
        breakpoints.reverse();
        let couplings = &p.couplings;
        let torsional = [couplings.pinion_torsion, couplings.gear_torsion].iter().any(|s| *s != Spring::default());
        let numbers = [omega_ref, period_tau];
        if let Some(&bad) = numbers.iter().find(|n| !n.is_finite()) {
            return Err(DynamicsError::InvalidParameter {
                name: "reference frequency",
                value: bad,
                reason: "stiffness over mass is too large",
            });
        }
        Ok(Self {
            halves,
            cos: p.helix_angle_rad.cos(),
            b: p.half_backlash_m,
            damping_in_gap: p.damping_in_gap,
            torsional,
            parity: 1.0,
            hold_contact: false,
            omega_ref,
            period_tau,
            breakpoints,
            radius_p: p.pinion_radius_m,
            radius_g: p.gear_radius_m,
        })
    }

    /// The same equations with the contact held as it is.
    pub fn holding_contact(&self) -> Self {
        Self { hold_contact: true, ..self.clone() }
    }

    /// The equations that variations against the mirror symmetry obey (D = 6).
    pub fn against_symmetry(&self) -> Self {
        Self { parity: -1.0, ..self.clone() }
    }

    /// Coordinates without which the motion is complete: w, when no torsional spring reads it.
    pub fn active(&self) -> impl Iterator<Item = usize> + use<D> {
        let with_w = self.torsional && (D > PER_HALF || self.parity < 0.0);
        (0..D).filter(move |c| with_w || c % PER_HALF != W)
    }

    /// The diagonal mass matrix of the solver coordinates, kg.
    pub fn masses_kg(&self) -> [f64; D] {
        let mut out = [0.0; D];
        let square = self.omega_ref * self.omega_ref;
        for (j, h) in self.halves.iter().enumerate() {
            let (mp, mg, me) = (1.0 / (h.inv_mp * square), 1.0 / (h.inv_mg * square), 1.0 / (h.inv_me * square));
            out[j * PER_HALF..][..PER_HALF].copy_from_slice(&[mp, mp, me, mg, mg, h.reduced_p + h.reduced_g]);
        }
        out
    }

    /// The other half's place in the coordinates and the factors of its y and w, and of its z.
    #[inline(always)]
    fn other(&self, j: usize) -> (usize, f64, f64) {
        if D > PER_HALF { ((1 - j) * PER_HALF, 1.0, 1.0) } else { (0, self.parity, -self.parity) }
    }

    /// s of a half.
    #[inline(always)]
    pub fn s(&self, j: usize, x: &[f64; D]) -> f64 {
        let i = j * PER_HALF;
        self.cos * (x[i + YP] - x[i + YG] + x[i + U]) + self.halves[j].sin * (x[i + ZP] - x[i + ZG])
    }

    /// The side of the backlash s is on. Without backlash the mesh law is linear: always driving.
    pub fn contact_of(&self, s: f64) -> Contact {
        if self.b == 0.0 || s > self.b {
            1
        } else if s < -self.b {
            -1
        } else {
            0
        }
    }

    /// Scaled accelerations of one half given its normal mesh force and the other force along the mesh, T_p/R_p − F_s. Linear
    /// and homogeneous, so it serves single Taylor coefficients and deviations too.
    #[inline(always)]
    pub(super) fn half_acceleration(
        &self,
        j: usize,
        x: &[f64; D],
        v: &[f64; D],
        force: f64,
        along: f64,
    ) -> [f64; PER_HALF] {
        let h = &self.halves[j];
        let i = j * PER_HALF;
        let (o, along_sign, axial_sign) = self.other(j);
        let fy = self.cos * force;
        let fz = h.sin * force;
        let difference = |c: usize, mirrored: f64| (x[i + c] - mirrored * x[o + c], v[i + c] - mirrored * v[o + c]);
        let (dzp, dzpv) = difference(ZP, axial_sign);
        let (dzg, dzgv) = difference(ZG, axial_sign);
        let mut a_yp = -h.inv_mp * fy - h.yp.of(x[i + YP], v[i + YP]);
        let a_zp = -h.inv_mp * fz - h.zp.of(x[i + ZP], v[i + ZP]) - h.zp_other.of(dzp, dzpv);
        let mut a_yg = h.inv_mg * fy - h.yg.of(x[i + YG], v[i + YG]);
        let a_zg = h.inv_mg * fz - h.zg.of(x[i + ZG], v[i + ZG]) - h.zg_other.of(dzg, dzgv);
        let mut a_u = h.inv_me * (along - fy);
        let mut a_w = 0.0;
        if D > PER_HALF || self.parity < 0.0 {
            let (d, dv) = difference(YP, along_sign);
            a_yp -= h.yp_other.of(d, dv);
            let (d, dv) = difference(YG, along_sign);
            a_yg -= h.yg_other.of(d, dv);
            if self.torsional {
                let k = o / PER_HALF;
                let (ap, ag) = self.arcs(j, x);
                let (bp, bg) = self.arcs(k, x);
                let (avp, avg) = self.arcs(j, v);
                let (bvp, bvg) = self.arcs(k, v);
                let tp = h.torsion_p.of(ap - along_sign * bp, avp - along_sign * bvp);
                let tg = h.torsion_g.of(ag - along_sign * bg, avg - along_sign * bvg);
                a_u += -h.inv_rp * tp + h.inv_rg * tg;
                a_w = -h.inv_rw * (tp + tg);
            }
        }
        [a_yp, a_zp, a_u, a_yg, a_zg, a_w]
    }

    /// R_p θ_p and R_g θ_g of a half from u and w.
    #[inline(always)]
    fn arcs(&self, j: usize, x: &[f64; D]) -> (f64, f64) {
        let h = &self.halves[j];
        let i = j * PER_HALF;
        let sum = h.reduced_p + h.reduced_g;
        (x[i + W] + h.reduced_g / sum * x[i + U], x[i + W] - h.reduced_p / sum * x[i + U])
    }

    /// Normal mesh force, N.
    #[inline(always)]
    pub fn mesh_force(&self, j: usize, stiffness: f64, s: f64, s_v: f64) -> f64 {
        let contact = self.contact_of(s);
        let damper = if contact != 0 || self.damping_in_gap { self.halves[j].cm * s_v } else { 0.0 };
        damper + if contact != 0 { stiffness * (s - f64::from(contact) * self.b) } else { 0.0 }
    }

    /// Scaled accelerations at a phase: the right-hand side for Runge–Kutta methods.
    pub fn acceleration(&self, phase: f64, inside: f64, x: &[f64; D], v: &[f64; D]) -> [f64; D] {
        let mut a = [0.0; D];
        for j in 0..Self::HALVES {
            let h = &self.halves[j];
            let force = self.mesh_force(j, h.stiffness.value(phase, inside), self.s(j, x), self.s(j, v));
            let along = h.load - h.impact.value(phase, inside);
            a[j * PER_HALF..][..PER_HALF].copy_from_slice(&self.half_acceleration(j, x, v, force, along));
        }
        a
    }

    /// Scaled accelerations that a normal mesh force `force` of half `j` causes by itself.
    pub fn push(&self, j: usize, force: f64) -> [f64; D] {
        let mut out = [0.0; D];
        out[j * PER_HALF..][..PER_HALF].copy_from_slice(&self.half_acceleration(j, &[0.0; D], &[0.0; D], force, 0.0));
        out
    }

    /// Scaled accelerations of the springs outside the mesh.
    pub fn springs(&self, x: &[f64; D]) -> [f64; D] {
        let mut out = [0.0; D];
        for j in 0..Self::HALVES {
            out[j * PER_HALF..][..PER_HALF].copy_from_slice(&self.half_acceleration(j, x, &[0.0; D], 0.0, 0.0));
        }
        out
    }

    /// Coefficient `n` of the normal mesh force that moves the gear along y as the polynomials `rows` say.
    pub fn force_behind(&self, j: usize, n: usize, rows: &[[f64; D]; MAX_ORDER + 1]) -> f64 {
        let n1 = (n + 1) as f64;
        let free = self.half_acceleration(j, &rows[n], &rows[n + 1].map(|c| c * n1), 0.0, 0.0);
        let a = rows[n + 2][j * PER_HALF + YG] * n1 * (n1 + 1.0);
        (a - free[YG]) / (self.halves[j].inv_mg * self.cos)
    }

    /// State from the source's 12 displacements and 12 velocities.
    pub fn state_from(&self, source: &[f64; 24]) -> State<D> {
        let mut state = State { period: 0, phase: 0.0, x: [0.0; D], v: [0.0; D], contact: [1; 2] };
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
            convert(&source[6 * j..6 * j + 6], &mut state.x, 1.0);
            convert(&source[12 + 6 * j..18 + 6 * j], &mut state.v, 1.0 / self.omega_ref);
        }
        for j in 0..Self::HALVES {
            state.contact[j] = self.contact_of(self.s(j, &state.x));
        }
        state
    }

    /// The source's 12 displacements and 12 velocities of a state.
    pub fn source_state(&self, state: &State<D>) -> [f64; 24] {
        let mut out = [0.0; 24];
        out[..12].copy_from_slice(&self.source_displacements(&state.x));
        out[12..].copy_from_slice(&self.source_displacements(&state.v).map(|v| v * self.omega_ref));
        out
    }

    /// The source's 12 displacements (or velocities, accelerations when `row` holds those) of solver coordinates.
    pub fn source_displacements(&self, row: &[f64; D]) -> [f64; 12] {
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

/// Upper estimate of the fastest natural frequency of a half, rad/s: every spring on every mass.
fn fastest(p: &Parameters, h: &HalfParameters, equivalent_mass: f64) -> f64 {
    let c = &p.couplings;
    let k_m = match &h.mesh_stiffness {
        super::excitation::Stiffness::Samples { values_n_per_m } => values_n_per_m.iter().copied().fold(0.0, f64::max),
        other => other.mean_n_per_m(),
    };
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

fn half_model(p: &Parameters, j: usize, omega: f64, period_tau: f64) -> HalfModel {
    let h = &p.halves[j];
    let c = &p.couplings;
    let square = omega * omega;
    let reduced_p = h.pinion_inertia_kg_m2 / (p.pinion_radius_m * p.pinion_radius_m);
    let reduced_g = h.gear_inertia_kg_m2 / (p.gear_radius_m * p.gear_radius_m);
    let on_pinion = |s| Rate::new(s, h.pinion_mass_kg, omega);
    let on_gear = |s| Rate::new(s, h.gear_mass_kg, omega);
    let per_arc = |s: Spring, r: f64| Rate { k: s.stiffness / (r * r), c: s.damping * omega / (r * r) };
    let shift = h.phase_shift_mesh_periods.rem_euclid(1.0);
    HalfModel {
        sin: if j == 0 { p.helix_angle_rad.sin() } else { -p.helix_angle_rad.sin() },
        inv_mp: 1.0 / (h.pinion_mass_kg * square),
        inv_mg: 1.0 / (h.gear_mass_kg * square),
        inv_me: 1.0 / (p.equivalent_mass_kg(j) * square),
        yp: on_pinion(h.pinion_lateral),
        zp: on_pinion(h.pinion_axial),
        yg: on_gear(h.gear_lateral),
        zg: on_gear(h.gear_axial),
        yp_other: on_pinion(c.pinion_lateral),
        zp_other: on_pinion(c.pinion_axial),
        yg_other: on_gear(c.gear_lateral),
        zg_other: on_gear(c.gear_axial),
        torsion_p: per_arc(c.pinion_torsion, p.pinion_radius_m),
        torsion_g: per_arc(c.gear_torsion, p.gear_radius_m),
        reduced_p,
        reduced_g,
        inv_rp: 1.0 / (reduced_p * square),
        inv_rg: 1.0 / (reduced_g * square),
        inv_rw: 1.0 / ((reduced_p + reduced_g) * square),
        cm: h.mesh_damping_n_s_per_m * omega,
        load: h.pinion_torque_nm / p.pinion_radius_m,
        stiffness: StiffnessCourse::new(&h.mesh_stiffness, shift, period_tau),
        impact: ImpactCourse::new(h.impact.as_ref(), shift, period_tau),
    }
}
