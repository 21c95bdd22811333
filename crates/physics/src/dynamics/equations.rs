//! Linear part of the equations of motion, in solver coordinates.
//!
//! # Coordinates
//! Per half: y_p, z_p, u, y_g, z_g, w (all lengths) with u = R_p θ_p − R_g θ_g and w = (I_p θ_p/R_p + I_g
//! θ_g/R_g)/(I_p/R_p² + I_g/R_g²). The mesh acts on u alone. w is the rigid rotation, excited only by torsional
//! couplings, so that a rigid rotation neither drifts numerically nor costs accuracy. x = y_p − y_g + u and s = cosβ x
//! + sinβ_j (z_p − z_g).
//!
//! `Equations<6>` are those of one half of a mirror-symmetric pair (z of the other half is the opposite),
//! `Equations<12>` those of both halves, larger ones those of a reduced train ([`TrainEquations`]). Time is scaled by a
//! reference frequency: τ = ω_ref t; velocities are dx/dτ.

use std::sync::Arc;

use super::lanes::Real;
use super::modal_train::MAX_RIGID_BODY_MODES;
use super::parameters::{ImpactActsOn, Parameters, Spring};
use super::train_equations::{TrainEquations, dot};

/// Coordinates per half, and their indices.
pub(crate) const PER_HALF: usize = 6;
pub(crate) const YP: usize = 0;
pub(crate) const ZP: usize = 1;
pub(crate) const U: usize = 2;
pub(crate) const YG: usize = 3;
pub(crate) const ZG: usize = 4;
pub(crate) const W: usize = 5;

/// Whether the `d` coordinates are those of a reduced train.
pub(crate) const fn is_train(d: usize) -> bool {
    d > 2 * PER_HALF
}

/// Number of solved halves.
pub(crate) const fn solved_halves(d: usize) -> usize {
    if d == PER_HALF { 1 } else { 2 }
}

/// Whether a coordinate is a rigid rotation w or, of a train, a rigid-body mode. They may grow without limit and do not
/// count in the size of a motion.
#[inline(always)]
pub(crate) const fn is_rigid_rotation(d: usize, coordinate: usize) -> bool {
    if is_train(d) { coordinate + MAX_RIGID_BODY_MODES >= d } else { coordinate % PER_HALF == W }
}

/// Spring and damper in scaled time, divided by the mass they act on.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct ScaledSpring<R> {
    k: R,
    c: R,
}

impl ScaledSpring<f64> {
    fn new(spring: Spring, mass: f64, omega: f64) -> Self {
        Self { k: spring.stiffness / (mass * omega * omega), c: spring.damping / (mass * omega) }
    }
}

impl<R: Real> ScaledSpring<R> {
    #[inline(always)]
    fn of(self, x: R, v: R) -> R {
        self.k * x + self.c * v
    }
}

/// Coefficients of one half.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct HalfEquations<R> {
    pub sin: R,
    /// Force to acceleration in scaled time: 1/(m ω²).
    inv_mp: R,
    pub(super) inv_mg: R,
    pub inv_me: R,
    yp: ScaledSpring<R>,
    zp: ScaledSpring<R>,
    yg: ScaledSpring<R>,
    zg: ScaledSpring<R>,
    yp_other: ScaledSpring<R>,
    zp_other: ScaledSpring<R>,
    yg_other: ScaledSpring<R>,
    zg_other: ScaledSpring<R>,
    /// Torsional couplings, acting on R_p θ_p and R_g θ_g as forces.
    torsion_p: ScaledSpring<R>,
    torsion_g: ScaledSpring<R>,
    /// Reduced inertias I_p/R_p² and I_g/R_g² in kg, and their fractions of the sum.
    pub reduced_p: R,
    pub reduced_g: R,
    part_p: R,
    part_g: R,
    /// 1/(reduced inertia · ω²).
    inv_rp: R,
    inv_rg: R,
    inv_rw: R,
    /// Mesh damping coefficient times ω, in contact and in the gap.
    pub cm: R,
    pub cm_in_gap: R,
    /// T_p/R_p, N.
    pub load: R,
}

/// Linear part of the equations of one half (D = 6, mirror-symmetric pair), of both (D = 12), or of a train. Of a train
/// the halves have only s, damper and load.
#[derive(Debug, Clone)]
pub(crate) struct Equations<const D: usize, R> {
    pub halves: [HalfEquations<R>; 2],
    pub cos: R,
    /// Half the backlash, m.
    pub b: R,
    /// Contribution of an impact force of 1 N to the tangential force of the torsional equations, and to the normal
    /// force of all equations: 1 and 0, or 0 and 1/cosβ.
    pub(super) impact_along: R,
    pub(super) impact_normal: R,
    torsional: bool,
    /// D = 6 only: the other half moves as the mirror image (1) or as its opposite (−1, antisymmetric perturbations).
    parity: f64,
    /// Some for a train, and for nothing else.
    pub train: Option<Arc<TrainEquations<D>>>,
}

impl<const D: usize> Equations<D, f64> {
    pub(crate) fn new(p: &Parameters, omega_ref: f64) -> Self {
        let couplings = &p.couplings;
        let torsional = [couplings.pinion_torsion, couplings.gear_torsion].iter().any(|s| *s != Spring::default());
        Self {
            halves: [half(p, 0, omega_ref), half(p, 1, omega_ref)],
            cos: p.helix_angle_rad.cos(),
            b: p.half_backlash_m,
            impact_along: if p.impact_acts_on == ImpactActsOn::Torsion { 1.0 } else { 0.0 },
            impact_normal: if p.impact_acts_on == ImpactActsOn::Torsion { 0.0 } else { 1.0 / p.helix_angle_rad.cos() },
            torsional,
            parity: 1.0,
            train: None,
        }
    }

    /// The equations of a train.
    pub(crate) fn of_train(p: &Parameters, train: TrainEquations<D>, omega_ref: f64) -> Self {
        let cos = p.helix_angle_rad.cos();
        let forces_n = train.static_forces_n();
        let half = |j: usize| {
            let h = &p.halves[j];
            let cm = h.mesh_damping_n_s_per_m * omega_ref;
            // 1 N along the mesh accelerates s by the square of its row.
            let inv_ms: f64 = train.mesh[j].iter().zip(&train.mesh_acceleration[j]).map(|(m, a)| m * a).sum();
            HalfEquations {
                sin: if j == 0 { p.helix_angle_rad.sin() } else { -p.helix_angle_rad.sin() },
                inv_me: inv_ms / (cos * cos),
                cm,
                cm_in_gap: if p.damping_in_gap { cm } else { 0.0 },
                load: forces_n[j] * cos,
                ..HalfEquations::default()
            }
        };
        Self {
            halves: [half(0), half(1)],
            cos,
            b: p.half_backlash_m,
            impact_along: if p.impact_acts_on == ImpactActsOn::Torsion { 1.0 } else { 0.0 },
            impact_normal: if p.impact_acts_on == ImpactActsOn::Torsion { 0.0 } else { 1.0 / cos },
            torsional: false,
            parity: 1.0,
            train: Some(Arc::new(train)),
        }
    }

    /// Number of degrees of freedom: of a train that of its modes.
    pub(crate) fn degrees_of_freedom(&self) -> usize {
        self.train.as_ref().map_or(D, |train| train.elastic + train.rigid)
    }

    /// The equations of antisymmetric perturbations (D = 6): the other half moves as the opposite of the mirror image.
    pub(crate) fn antisymmetric(&self) -> Self {
        Self { parity: -1.0, ..self.clone() }
    }

    /// 1, and −1 of antisymmetric perturbations.
    pub(super) fn parity(&self) -> f64 {
        self.parity
    }

    /// Whether a torsional spring couples the halves of a gear.
    pub(crate) fn couples_rotations(&self) -> bool {
        self.torsional
    }

    /// Indices of the coordinates that are integrated: all, or all but w where no torsional spring acts. Of a train the
    /// elastic modes: its rigid-body modes act on nothing.
    pub(crate) fn active(&self) -> impl Iterator<Item = usize> + use<D> {
        let with_w = self.torsional && (D > PER_HALF || self.parity < 0.0);
        let elastic = self.train.as_ref().map_or(0, |train| train.elastic);
        (0..D).filter(move |&c| if is_train(D) { c < elastic } else { with_w || c % PER_HALF != W })
    }

    /// Diagonal of the mass matrix in solver coordinates, kg.
    pub(crate) fn masses_kg(&self, omega_ref: f64) -> [f64; D] {
        if is_train(D) {
            return [1.0; D];
        }
        let mut out = [0.0; D];
        let square = omega_ref * omega_ref;
        for (j, h) in self.halves[..Self::HALVES].iter().enumerate() {
            let (mp, mg, me) = (1.0 / (h.inv_mp * square), 1.0 / (h.inv_mg * square), 1.0 / (h.inv_me * square));
            out[j * PER_HALF..][..PER_HALF].copy_from_slice(&[mp, mp, me, mg, mg, h.reduced_p + h.reduced_g]);
        }
        out
    }

    /// The same equations in every lane.
    pub(crate) fn broadcast<R: Real>(&self) -> Equations<D, R> {
        let mut out = Equations::at_rest();
        for lane in 0..R::LANES {
            out.put(lane, self);
        }
        out
    }
}

impl<const D: usize, R: Real> Equations<D, R> {
    pub(crate) const HALVES: usize = solved_halves(D);
    /// Whether the linear part is that of a train.
    pub(crate) const IS_TRAIN: bool = is_train(D);

    /// Equations without forces, for unused lanes.
    pub(crate) fn at_rest() -> Self {
        Self {
            halves: [HalfEquations::default(); 2],
            cos: R::default(),
            b: R::default(),
            impact_along: R::default(),
            impact_normal: R::default(),
            torsional: false,
            parity: 1.0,
            train: None,
        }
    }

    /// Sets the equations of one lane. All lanes have the same parity; trains have no lanes.
    pub(crate) fn put(&mut self, lane: usize, one: &Equations<D, f64>) {
        fn rate<R: Real>(to: &mut ScaledSpring<R>, lane: usize, from: &ScaledSpring<f64>) {
            to.k.set(lane, from.k);
            to.c.set(lane, from.c);
        }
        self.cos.set(lane, one.cos);
        self.b.set(lane, one.b);
        self.impact_along.set(lane, one.impact_along);
        self.impact_normal.set(lane, one.impact_normal);
        self.torsional |= one.torsional;
        self.parity = one.parity;
        for (to, from) in self.halves.iter_mut().zip(&one.halves) {
            to.sin.set(lane, from.sin);
            to.inv_mp.set(lane, from.inv_mp);
            to.inv_mg.set(lane, from.inv_mg);
            to.inv_me.set(lane, from.inv_me);
            rate(&mut to.yp, lane, &from.yp);
            rate(&mut to.zp, lane, &from.zp);
            rate(&mut to.yg, lane, &from.yg);
            rate(&mut to.zg, lane, &from.zg);
            rate(&mut to.yp_other, lane, &from.yp_other);
            rate(&mut to.zp_other, lane, &from.zp_other);
            rate(&mut to.yg_other, lane, &from.yg_other);
            rate(&mut to.zg_other, lane, &from.zg_other);
            rate(&mut to.torsion_p, lane, &from.torsion_p);
            rate(&mut to.torsion_g, lane, &from.torsion_g);
            to.reduced_p.set(lane, from.reduced_p);
            to.reduced_g.set(lane, from.reduced_g);
            to.part_p.set(lane, from.part_p);
            to.part_g.set(lane, from.part_g);
            to.inv_rp.set(lane, from.inv_rp);
            to.inv_rg.set(lane, from.inv_rg);
            to.inv_rw.set(lane, from.inv_rw);
            to.cm.set(lane, from.cm);
            to.cm_in_gap.set(lane, from.cm_in_gap);
            to.load.set(lane, from.load);
        }
    }

    /// Index of the other half's first coordinate, and the sign of its y and w and of its z.
    #[inline(always)]
    fn other(&self, j: usize) -> (usize, R, R) {
        if D > PER_HALF {
            ((1 - j) * PER_HALF, R::splat(1.0), R::splat(1.0))
        } else {
            (0, R::splat(self.parity), R::splat(-self.parity))
        }
    }

    /// Displacement s of a half along the tooth normal, m.
    #[inline(always)]
    pub(crate) fn s(&self, j: usize, x: &[R; D]) -> R {
        if Self::IS_TRAIN {
            // No closure: it would not be compiled for the vector instructions of its caller.
            let Some(train) = &self.train else { return R::splat(0.0) };
            return dot(&train.mesh[j], x);
        }
        let i = j * PER_HALF;
        self.cos * (x[i + YP] - x[i + YG] + x[i + U]) + self.halves[j].sin * (x[i + ZP] - x[i + ZG])
    }

    /// Tangential displacement x of a half, m.
    #[inline(always)]
    pub(crate) fn mesh_x(&self, j: usize, x: &[R; D]) -> R {
        if Self::IS_TRAIN {
            let Some(train) = &self.train else { return R::splat(0.0) };
            return dot(&train.mesh_x[j], x);
        }
        let i = j * PER_HALF;
        x[i + YP] - x[i + YG] + x[i + U]
    }

    /// Accelerations of a train in scaled time from its normal tooth forces and tangential forces, N; `s`: the
    /// displacements along the normal. Linear and homogeneous in all of them and `loads`.
    #[inline(always)]
    pub(super) fn train_acceleration(
        &self,
        motion: (&[R; D], &[R; D]),
        (s, normal, along): ([R; 2], [R; 2], Option<[R; 2]>),
        loads: R,
    ) -> [R; D] {
        let Some(train) = &self.train else { return [R::splat(0.0); D] };
        let mut beyond = normal;
        for j in 0..2 {
            beyond[j] -= R::splat(train.reference_stiffness[j]) * s[j];
        }
        train.acceleration(motion, beyond, along, loads)
    }

    /// Accelerations in scaled time of one half from its normal tooth force and the tangential force, T_p/R_p − F_s
    /// (T_p/R_p for an impact that acts on all motions, whose F_s is part of the normal force), N. Linear and
    /// homogeneous, so it holds for single Taylor coefficients and for perturbations too.
    #[inline(always)]
    pub(super) fn half_acceleration(&self, j: usize, x: &[R; D], v: &[R; D], force: R, along: R) -> [R; PER_HALF] {
        let h = &self.halves[j];
        let i = j * PER_HALF;
        let (o, along_sign, axial_sign) = self.other(j);
        let fy = self.cos * force;
        let fz = h.sin * force;
        let (dzp, dzpv) = difference(x, v, (i + ZP, o + ZP), axial_sign);
        let (dzg, dzgv) = difference(x, v, (i + ZG, o + ZG), axial_sign);
        let mut a_yp = -h.inv_mp * fy - h.yp.of(x[i + YP], v[i + YP]);
        let a_zp = -h.inv_mp * fz - h.zp.of(x[i + ZP], v[i + ZP]) - h.zp_other.of(dzp, dzpv);
        let mut a_yg = h.inv_mg * fy - h.yg.of(x[i + YG], v[i + YG]);
        let a_zg = h.inv_mg * fz - h.zg.of(x[i + ZG], v[i + ZG]) - h.zg_other.of(dzg, dzgv);
        let mut a_u = h.inv_me * (along - fy);
        let mut a_w = R::splat(0.0);
        if D > PER_HALF || self.parity < 0.0 {
            let (d, dv) = difference(x, v, (i + YP, o + YP), along_sign);
            a_yp -= h.yp_other.of(d, dv);
            let (d, dv) = difference(x, v, (i + YG, o + YG), along_sign);
            a_yg -= h.yg_other.of(d, dv);
            if self.torsional {
                let k = o / PER_HALF;
                let (ap, ag) = self.arcs(j, x);
                let (bp, bg) = self.arcs(k, x);
                let (avp, avg) = self.arcs(j, v);
                let (bvp, bvg) = self.arcs(k, v);
                let tp = h.torsion_p.of(ap - along_sign * bp, avp - along_sign * bvp);
                let tg = h.torsion_g.of(ag - along_sign * bg, avg - along_sign * bvg);
                a_u += h.inv_rg * tg - h.inv_rp * tp;
                a_w = -h.inv_rw * (tp + tg);
            }
        }
        [a_yp, a_zp, a_u, a_yg, a_zg, a_w]
    }

    /// R_p θ_p and R_g θ_g of a half from u and w.
    #[inline(always)]
    pub(super) fn arcs(&self, j: usize, x: &[R; D]) -> (R, R) {
        let h = &self.halves[j];
        let i = j * PER_HALF;
        (x[i + W] + h.part_g * x[i + U], x[i + W] - h.part_p * x[i + U])
    }
}

/// Difference of a coordinate and its mirrored counterpart on the other half, and of their velocities.
#[inline(always)]
fn difference<const D: usize, R: Real>(x: &[R; D], v: &[R; D], at: (usize, usize), mirrored: R) -> (R, R) {
    (x[at.0] - mirrored * x[at.1], v[at.0] - mirrored * v[at.1])
}

fn half(p: &Parameters, j: usize, omega: f64) -> HalfEquations<f64> {
    let h = &p.halves[j];
    let c = &p.couplings;
    let square = omega * omega;
    let reduced_p = h.pinion_inertia_kg_m2 / (p.pinion_radius_m * p.pinion_radius_m);
    let reduced_g = h.gear_inertia_kg_m2 / (p.gear_radius_m * p.gear_radius_m);
    let on_pinion = |s| ScaledSpring::new(s, h.pinion_mass_kg, omega);
    let on_gear = |s| ScaledSpring::new(s, h.gear_mass_kg, omega);
    let per_arc = |s: Spring, r: f64| ScaledSpring { k: s.stiffness / (r * r), c: s.damping * omega / (r * r) };
    let cm = h.mesh_damping_n_s_per_m * omega;
    HalfEquations {
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
        part_p: reduced_p / (reduced_p + reduced_g),
        part_g: reduced_g / (reduced_p + reduced_g),
        inv_rp: 1.0 / (reduced_p * square),
        inv_rg: 1.0 / (reduced_g * square),
        inv_rw: 1.0 / ((reduced_p + reduced_g) * square),
        cm,
        cm_in_gap: if p.damping_in_gap { cm } else { 0.0 },
        load: h.pinion_torque_nm / p.pinion_radius_m,
    }
}
