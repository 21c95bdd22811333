//! The tooth above its root as a plate of variable thickness with free end faces.
//!
//! Mindlin's plate (shear factor 5/6) in the middle surface of the tooth: deflection w and rotations θ_y (over the
//! height) and θ_t (along the tooth trace), polynomials over the height, Legendre functions along the face. The root is
//! clamped, top and end faces are free (natural boundary conditions), so that a load near an end face meets the softer
//! free edge, and loads at different heights couple as the plate couples them. Even and odd functions of the face
//! separate.
//!
//! The body below the root is loaded by the plate's reactions: normal force, moment about the trace, and the twisting
//! moment, which goes into the normal force because the root turns with the slope of its own displacement along the
//! trace.

use super::ring::WidthBasis;
use crate::numerics::dense::{add_product, cholesky_inlined, forward_solve_columns};
use crate::numerics::gauss::gauss_12;
use crate::simd::vectorised;

/// Functions over the height: 1 (the root) and η L_{j-1}(2η - 1), j = 1..=ORDER.
const ORDER: usize = 5;

/// Shape and material of the plate; Young's modulus is one.
pub(super) struct Plate<'a> {
    /// Height from the root circle to the tip.
    pub height_m: f64,
    /// Poisson's ratio.
    pub nu: f64,
    /// Cosine of the angle between trace and axis.
    pub cos_trace: f64,
    /// Thickness in the normal section at a height above the root.
    pub thickness: &'a dyn Fn(f64) -> f64,
}

/// Displacements and reactions of the plate under loads H_j(η) P_q(z), over the Legendre functions of the face.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct PlateModes {
    height_m: f64,
    size: usize,
    /// Deflection coefficients per load coefficients, ((j, q), (j', q')), j from 1.
    deflection: Vec<f64>,
    /// Force and moment of the root per load coefficients, (q, (j, q')): what the clamped root adds to the load itself.
    root: [Vec<f64>; 2],
    /// Stiffness of the plate against displacements of its root: force and moment per displacement and rotation, ((0 or
    /// 1, q), same).
    pub resistance: Vec<f64>,
}

/// Values of the height functions at η, the root's constant first.
fn heights(eta: f64) -> [f64; ORDER + 1] {
    let x = 2.0 * eta - 1.0;
    let mut out = [1.0, eta, eta * x, 0.0, 0.0, 0.0];
    let (mut before, mut now) = (1.0, x);
    for k in 1..ORDER - 1 {
        let next = ((2 * k + 1) as f64 * x * now - k as f64 * before) / (k + 1) as f64;
        out[k + 2] = eta * next;
        (before, now) = (now, next);
    }
    out
}

/// Slopes dH/dη.
fn slopes(eta: f64) -> [f64; ORDER + 1] {
    let x = 2.0 * eta - 1.0;
    let mut out = [0.0, 1.0, x + 2.0 * eta, 0.0, 0.0, 0.0];
    // P'_{k+1} = P'_{k-1} + (2k+1) P_k.
    let (mut p0, mut p1, mut d0, mut d1) = (1.0, x, 0.0, 1.0);
    for k in 1..ORDER - 1 {
        let p2 = ((2 * k + 1) as f64 * x * p1 - k as f64 * p0) / (k + 1) as f64;
        let d2 = d0 + (2 * k + 1) as f64 * p1;
        out[k + 2] = p2 + 2.0 * eta * d2;
        (p0, p1, d0, d1) = (p1, p2, d1, d2);
    }
    out
}

/// Integrals over the height of products of functions and slopes, weighted with bending and shear stiffness.
#[derive(Clone, Copy, Default)]
struct SectionIntegrals {
    bend_ss: f64,
    bend_nn: f64,
    bend_sn: f64,
    bend_ns: f64,
    slide_ss: f64,
    slide_nn: f64,
    slide_sn: f64,
}

const FUNCTIONS: usize = ORDER + 1;

impl Plate<'_> {
    fn sections(&self) -> [[SectionIntegrals; FUNCTIONS]; FUNCTIONS] {
        let mut out = [[SectionIntegrals::default(); FUNCTIONS]; FUNCTIONS];
        let shear = 5.0 / 6.0 / (2.0 * (1.0 + self.nu));
        for (x, w) in gauss_12() {
            // η = t² takes the square root out of the fillet at the root circle.
            let t = 0.5 * (1.0 + x);
            let eta = t * t;
            let weight = w * t * self.height_m;
            let s = (self.thickness)(eta * self.height_m);
            let bend = weight * s.powi(3) / (12.0 * (1.0 - self.nu * self.nu));
            let slide = weight * s * shear;
            let (n, d) = (heights(eta), slopes(eta).map(|v| v / self.height_m));
            for a in 0..FUNCTIONS {
                for b in 0..FUNCTIONS {
                    let c = &mut out[a][b];
                    c.bend_ss += bend * d[a] * d[b];
                    c.bend_nn += bend * n[a] * n[b];
                    c.bend_sn += bend * d[a] * n[b];
                    c.bend_ns += bend * n[a] * d[b];
                    c.slide_ss += slide * d[a] * d[b];
                    c.slide_nn += slide * n[a] * n[b];
                    c.slide_sn += slide * d[a] * n[b];
                }
            }
        }
        out
    }

    /// Solves the plate over the functions of `basis`.
    pub(super) fn modes(&self, basis: &WidthBasis) -> PlateModes {
        let sections = self.sections();
        let size = basis.order + 1;
        let mut modes = PlateModes {
            height_m: self.height_m,
            size,
            deflection: vec![0.0; (ORDER * size).pow(2)],
            root: std::array::from_fn(|_| vec![0.0; size * ORDER * size]),
            resistance: vec![0.0; 4 * size * size],
        };
        for parity in 0..2 {
            self.half(&sections, basis, parity, &mut modes);
        }
        modes
    }

    /// Stiffness between field `f` of function `a`, degree `p`, and field `g` of function `b`, degree `q`; fields w,
    /// θ_y, θ_t.
    fn stiffness(
        &self,
        s: &[[SectionIntegrals; FUNCTIONS]; FUNCTIONS],
        basis: &WidthBasis,
        (f, a, p): (usize, usize, usize),
        (g, b, q): (usize, usize, usize),
    ) -> f64 {
        if f > g {
            return self.stiffness(s, basis, (g, b, q), (f, a, p));
        }
        let c = &s[a][b];
        let still = if p == q { 1.0 / self.cos_trace } else { 0.0 };
        let slope = basis.stiff(p, q) * self.cos_trace;
        let twist = 0.5 * (1.0 - self.nu);
        match (f, g) {
            (0, 0) => c.slide_ss * still + c.slide_nn * slope,
            (0, 1) => -c.slide_sn * still,
            (0, _) => -c.slide_nn * basis.mixed(q, p),
            (1, 1) => (c.bend_ss + c.slide_nn) * still + twist * c.bend_nn * slope,
            (1, _) => self.nu * c.bend_sn * basis.mixed(p, q) + twist * c.bend_ns * basis.mixed(q, p),
            _ => c.bend_nn * slope + (twist * c.bend_ss + c.slide_nn) * still,
        }
    }

    fn half(
        &self,
        sections: &[[SectionIntegrals; FUNCTIONS]; FUNCTIONS],
        basis: &WidthBasis,
        parity: usize,
        out: &mut PlateModes,
    ) {
        let degrees = |field: usize| ((parity + usize::from(field == 2)) % 2..=basis.order).step_by(2);
        let mut free = Vec::new();
        for j in 1..=ORDER {
            for field in 0..3 {
                free.extend(degrees(field).map(|q| (field, j, q)));
            }
        }
        let roots: Vec<(usize, usize, usize)> =
            (0..3).flat_map(|field| degrees(field).map(move |q| (field, 0, q))).collect();
        let n = free.len();
        let mut k = vec![0.0; n * n];
        for (row, &x) in free.iter().enumerate() {
            for (column, &y) in free[..=row].iter().enumerate() {
                k[row * n + column] = self.stiffness(sections, basis, x, y);
            }
        }
        let loads: Vec<(usize, (usize, usize))> =
            free.iter().enumerate().filter(|(_, x)| x.0 == 0).map(|(i, x)| (i, (x.1, x.2))).collect();
        // Columns: unit loads, then the stiffness towards the root.
        let columns = loads.len() + roots.len();
        let mut sides = vec![0.0; n * columns];
        for (column, &(row, _)) in loads.iter().enumerate() {
            sides[row * columns + column] = 1.0;
        }
        for (row, &x) in free.iter().enumerate() {
            for (column, &r) in roots.iter().enumerate() {
                sides[row * columns + loads.len() + column] = self.stiffness(sections, basis, x, r);
            }
        }
        let mut products = vec![0.0; columns * columns];
        vectorised(
            #[inline(always)]
            || {
                cholesky_inlined(&mut k, n);
                forward_solve_columns(&k, &mut sides, n);
                add_product(&mut products, 1.0, &sides, &sides, n);
            },
        );
        let size = out.size;
        let width = ORDER * size;
        // Root unknowns w and θ_y behind every root function: itself, or the slope of w along the trace.
        let behind = |(field, _, p): (usize, usize, usize)| -> Vec<(usize, f64)> {
            match field {
                0 => vec![(p, 1.0)],
                1 => vec![(size + p, 1.0)],
                _ => degrees(0).map(|q| (q, self.cos_trace * basis.mixed(p, q))).filter(|f| f.1 != 0.0).collect(),
            }
        };
        for (i, &r) in roots.iter().enumerate() {
            for (j, &s) in roots.iter().enumerate() {
                let product = products[(loads.len() + i) * columns + loads.len() + j];
                let value = self.stiffness(sections, basis, r, s) - product;
                for (p, left) in behind(r) {
                    for (q, right) in behind(s) {
                        out.resistance[p * 2 * size + q] += left * value * right;
                    }
                }
            }
        }
        for (x, &(_, (j, q))) in loads.iter().enumerate() {
            let column = (j - 1) * size + q;
            for (y, &(_, (i, p))) in loads.iter().enumerate() {
                out.deflection[((i - 1) * size + p) * width + column] = products[y * columns + x];
            }
            for (r, &root) in roots.iter().enumerate() {
                let reaction = -products[(loads.len() + r) * columns + x];
                for (p, factor) in behind(root) {
                    out.root[p / size][p % size * width + column] += factor * reaction;
                }
            }
        }
    }
}

impl PlateModes {
    fn shapes(&self, height_m: f64) -> [f64; FUNCTIONS] {
        heights((height_m / self.height_m).clamp(0.0, 1.0))
    }

    /// Deflection coefficients at `height_m` per load coefficients at `load_m`, times Young's modulus: `size` × `size`.
    pub(super) fn deflection(&self, height_m: f64, load_m: f64) -> Vec<f64> {
        let (size, width) = (self.size, ORDER * self.size);
        let (at, load) = (self.shapes(height_m), self.shapes(load_m));
        let mut out = vec![0.0; size * size];
        for i in 0..ORDER {
            for j in 0..ORDER {
                let factor = at[i + 1] * load[j + 1];
                for p in 0..size {
                    let source = &self.deflection[(i * size + p) * width + j * size..][..size];
                    for (t, s) in out[p * size..(p + 1) * size].iter_mut().zip(source) {
                        *t += factor * s;
                    }
                }
            }
        }
        out
    }

    /// Force (0) or moment (1) coefficients that reach the root per load coefficients at `load_m`: `size` × `size`.
    pub(super) fn root(&self, which: usize, load_m: f64) -> Vec<f64> {
        let (size, width) = (self.size, ORDER * self.size);
        let load = self.shapes(load_m);
        let mut out = vec![0.0; size * size];
        for p in 0..size {
            for j in 0..ORDER {
                let source = &self.root[which][p * width + j * size..][..size];
                for (t, s) in out[p * size..(p + 1) * size].iter_mut().zip(source) {
                    *t += load[j + 1] * s;
                }
            }
            if which == 0 {
                out[p * size + p] += 1.0;
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use herringbone_oracle::check_worst;

    const TOPIC: &str = "Contact: tooth as a plate, gear body as a ring";

    #[test]
    fn the_whole_load_and_its_moment_reach_the_root() {
        let plate = Plate { height_m: 2.0, nu: 0.3, cos_trace: 0.8, thickness: &|y| 1.5 - 0.4 * y };
        let basis = WidthBasis::new(8, 12.0);
        let modes = plate.modes(&basis);
        let size = basis.order + 1;
        let (force, moment) = (modes.root(0, 1.4), modes.root(1, 1.4));
        // Total force, moment about the trace, and moment about the height of loads of every degree.
        let first = |q: usize| if q == 1 { 1.0 } else { 0.0 };
        let mut errors = Vec::new();
        for q in 0..size {
            let unit = if q == 0 { 1.0 } else { 0.0 };
            errors.push(force[q] - unit);
            errors.push(moment[q] - 1.4 * unit);
            errors.push(force[size + q] - first(q));
        }
        check_worst(TOPIC, "force and moments at the root of a plate, any load", errors, 1e-9);
        // Rigid motions of the root: shift, rotation about the trace, rotation about the height.
        let most = modes.resistance.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let free = (0..2 * size).flat_map(|row| [0, 1, size].map(|c| modes.resistance[row * 2 * size + c] / most));
        check_worst(TOPIC, "resistance of a plate to rigid motions of its root", free, 1e-9);
    }

    #[test]
    fn a_uniform_load_bends_a_thin_strip() {
        let plate = Plate { height_m: 2.0, nu: 0.0, cos_trace: 1.0, thickness: &|_| 0.1 };
        let modes = plate.modes(&WidthBasis::new(4, 3.0));
        let (u, d) = (1.4f64, 1e-3 / 12.0);
        let got = modes.deflection(u, u)[0];
        check_worst(TOPIC, "deflection of a thin strip against u³/(3D)", [got / (u.powi(3) / (3.0 * d)) - 1.0], 0.02);
    }
}
