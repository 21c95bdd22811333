//! The gear body as a three-dimensional elastic ring: exact circumference, free end faces.
//!
//! A ring from the holding radius (rim or bore, all displacements zero there) to the root circle. Around the
//! circumference: Fourier harmonics; across the width: Legendre polynomials (free end faces are natural boundary
//! conditions, so disc bending, coning, in-plane modes and torsion are all contained); along the radius: quadratic
//! finite elements, eliminated from the inside out until only the root circle remains. With u_r = U e^{inθ}, u_θ = iV
//! e^{inθ}, u_y = W e^{inθ} each harmonic is real and symmetric, and even and odd powers of the width separate (U, V
//! even with W odd, and the reverse). A Galerkin flexibility is positive definite and never larger than the exact one.

use crate::numerics::dense::{add_product, cholesky_inlined, forward_solve_columns};
use crate::numerics::gauss::{GAUSS_2, GAUSS_3};
use crate::simd::vectorised;

/// The ring and its material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ring {
    /// Radius of the loaded circle, the root circle.
    pub outer_radius_m: f64,
    /// Radius of the held circle.
    pub inner_radius_m: f64,
    /// Width of the ring.
    pub face_width_m: f64,
    /// Length of the outermost radial element; the others grow inwards.
    pub element_m: f64,
    /// Young's modulus, Pa.
    pub youngs_pa: f64,
    /// Poisson's ratio.
    pub nu: f64,
}

/// Growth of the radial elements towards the inside.
const GROWTH: f64 = 1.5;

/// Legendre functions over the face width, orthonormal on [0, b].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct WidthBasis {
    /// Highest degree.
    pub order: usize,
    width_m: f64,
    /// ∫ P_p P_q' dy and ∫ P_p' P_q' dy.
    mixed: Vec<f64>,
    stiff: Vec<f64>,
}

impl WidthBasis {
    /// Polynomials of degree 0..=`order` on a face of `width_m`.
    pub(super) fn new(order: usize, width_m: f64) -> WidthBasis {
        let size = order + 1;
        let mut mixed = vec![0.0; size * size];
        let mut stiff = vec![0.0; size * size];
        let norm = |p: usize| ((2 * p + 1) as f64 / width_m).sqrt();
        // P_q' = Σ (2p+1) P_p over p = q-1, q-3, …, in ξ = 2y/b - 1.
        let derivative = |p: usize, q: usize| {
            if p < q && (q - p) % 2 == 1 { (2.0 / width_m) * (2 * p + 1) as f64 * norm(q) / norm(p) } else { 0.0 }
        };
        for p in 0..size {
            for q in 0..size {
                mixed[p * size + q] = derivative(p, q);
                stiff[p * size + q] = (0..size).map(|k| derivative(k, p) * derivative(k, q)).sum();
            }
        }
        WidthBasis { order, width_m, mixed, stiff }
    }

    /// ∫ P_p P_q' dy.
    pub(super) fn mixed(&self, p: usize, q: usize) -> f64 {
        self.mixed[p * (self.order + 1) + q]
    }

    /// ∫ P_p' P_q' dy.
    pub(super) fn stiff(&self, p: usize, q: usize) -> f64 {
        self.stiff[p * (self.order + 1) + q]
    }

    /// Values of all polynomials at `y_m`; beyond the ends of the face those of the end.
    pub(super) fn values(&self, y_m: f64, out: &mut [f64]) {
        let inside = (2.0 * y_m / self.width_m - 1.0).clamp(-1.0, 1.0);
        let (mut before, mut now) = (1.0, inside);
        for (p, value) in out.iter_mut().enumerate() {
            *value = if p == 0 { 1.0 } else { now };
            if p > 0 {
                let next = ((2 * p + 1) as f64 * inside * now - p as f64 * before) / (p + 1) as f64;
                (before, now) = (now, next);
            }
            *value *= ((2 * p + 1) as f64 / self.width_m).sqrt();
        }
    }

    /// Mean of every polynomial over `count` equal slices of a part of the face (its start and its width) moved by
    /// `shift_m`: `count` rows of `order + 1`.
    pub(super) fn slice_means(&self, count: usize, (from_m, width_m): (f64, f64), shift_m: f64) -> Vec<f64> {
        let size = self.order + 1;
        let step = width_m / count as f64;
        let shift_m = from_m + shift_m;
        let mut out = vec![0.0; count * size];
        let mut values = vec![0.0; size];
        for (i, row) in out.chunks_exact_mut(size).enumerate() {
            for (x, w) in GAUSS_3 {
                self.values((i as f64 + 0.5 + 0.5 * x) * step + shift_m, &mut values);
                for (mean, value) in row.iter_mut().zip(&values) {
                    *mean += 0.5 * w * value;
                }
            }
        }
        out
    }
}

/// The ring's elements over a width basis, ready to be put together at any harmonic.
///
/// Flexibilities of the outer circle (displacement coefficients per load coefficients) come as two symmetric row-major
/// blocks: U, V of even degree with W of odd degree, and the reverse.
#[derive(Debug, Clone)]
pub(super) struct RingSolver {
    /// (component 0 U, 1 V, 2 W; degree) of every row of a block.
    pub rows: [Vec<(usize, usize)>; 2],
    mesh: Vec<f64>,
    /// Per block and element: stiffness without n, with n and with n².
    elements: [Vec<[Vec<f64>; 3]>; 2],
}

/// Displacements of harmonic n have fallen to this part of their value at the outer circle where the ring is cut off.
const NEGLIGIBLE: f64 = 1e-3;

/// Radial boundaries of the elements, from the holding radius outwards.
fn radial_mesh(ring: &Ring) -> Vec<f64> {
    let mut radii = vec![ring.outer_radius_m];
    let mut step = ring.element_m;
    let mut r = ring.outer_radius_m;
    while r - step > ring.inner_radius_m + 0.6 * step {
        r -= step;
        radii.push(r);
        step = (step * GROWTH).min(0.45 * r);
    }
    radii.push(ring.inner_radius_m);
    radii.reverse();
    radii
}

impl RingSolver {
    /// Prepares `ring` over the functions of `basis`.
    pub(super) fn new(ring: &Ring, basis: &WidthBasis) -> RingSolver {
        let rows = [0, 1].map(|parity| {
            let degrees = |component: usize| {
                ((parity + usize::from(component == 2)) % 2..=basis.order).step_by(2).map(move |q| (component, q))
            };
            (0..3).flat_map(degrees).collect::<Vec<_>>()
        });
        let mesh = radial_mesh(ring);
        let elements = [0, 1]
            .map(|p| mesh.windows(2).map(|span| element_stiffness(ring, basis, &rows[p], span[0], span[1])).collect());
        RingSolver { rows, mesh, elements }
    }

    /// Flexibility of the outer circle at harmonic `n`.
    pub(super) fn flexibility(&self, n: f64) -> [Vec<f64>; 2] {
        let outer = self.mesh[self.mesh.len() - 1];
        // Elements that the harmonic does not reach stay out: the first one in use is held at its inner boundary.
        let first = (0..self.mesh.len() - 1).rev().find(|&e| (self.mesh[e] / outer).powf(n) < NEGLIGIBLE).unwrap_or(0);
        [0, 1].map(|p| condense(&self.elements[p][first..], n, self.rows[p].len()))
    }
}

fn condense(elements: &[[Vec<f64>; 3]], n: f64, size: usize) -> Vec<f64> {
    let mut flexibility = vec![0.0; size * size];
    if size > 0 {
        vectorised(
            #[inline(always)]
            || condense_inlined(elements, n, size, &mut flexibility),
        );
    }
    flexibility
}

#[inline(always)]
fn condense_inlined(elements: &[[Vec<f64>; 3]], n: f64, size: usize, flexibility: &mut [f64]) {
    let width = 3 * size;
    let mut element = vec![0.0; width * width];
    let mut outer = vec![0.0; size * size];
    let mut k = vec![0.0; 4 * size * size];
    let mut columns = vec![0.0; 2 * size * size];
    for (e, [still, once, twice]) in elements.iter().enumerate() {
        for (((value, a), b), c) in element.iter_mut().zip(still).zip(once).zip(twice) {
            *value = a + n * (b + n * c);
        }
        // Order: inner and middle nodes (eliminated), then the outer node.
        let skip = if e == 0 { size } else { 0 };
        let gone = 2 * size - skip;
        for i in 0..gone {
            let row = &element[(skip + i) * width..(skip + i + 1) * width];
            k[i * gone..=i * gone + i].copy_from_slice(&row[skip..=skip + i]);
            columns[i * size..(i + 1) * size].copy_from_slice(&row[2 * size..]);
        }
        if e > 0 {
            for i in 0..size {
                for (value, previous) in k[i * gone..=i * gone + i].iter_mut().zip(&outer[i * size..]) {
                    *value += previous;
                }
            }
        }
        cholesky_inlined(&mut k[..gone * gone], gone);
        let columns = &mut columns[..gone * size];
        forward_solve_columns(&k, columns, gone);
        for (row, i) in outer.chunks_exact_mut(size).zip(2 * size..) {
            row.copy_from_slice(&element[i * width + 2 * size..(i + 1) * width]);
        }
        add_product(&mut outer, -1.0, columns, columns, gone);
    }
    cholesky_inlined(&mut outer, size);
    // The inverse: L⁻¹ and its products.
    let lower = &mut columns[..size * size];
    lower.fill(0.0);
    for j in 0..size {
        lower[j * size + j] = 1.0;
    }
    forward_solve_columns(&outer, lower, size);
    add_product(flexibility, 1.0, lower, lower, size);
}

/// Stiffness of one quadratic radial element (nodes: inner, middle, outer) per radian of the harmonic's circumference,
/// by powers of n.
fn element_stiffness(ring: &Ring, basis: &WidthBasis, rows: &[(usize, usize)], r0: f64, r1: f64) -> [Vec<f64>; 3] {
    let mu = 0.5 * ring.youngs_pa / (1.0 + ring.nu);
    let lame = 2.0 * mu * ring.nu / (1.0 - 2.0 * ring.nu);
    let stiff = lame + 2.0 * mu;
    // Radial integrals for every pair of nodes: products of N', N/r and N.
    #[derive(Clone, Copy, Default)]
    struct RadialIntegrals {
        dd: f64,
        ds: f64,
        sd: f64,
        ss: f64,
        nn: f64,
        dn: f64,
        sn: f64,
        nd: f64,
        ns: f64,
    }
    let mut radial = [[RadialIntegrals::default(); 3]; 3];
    let half = 0.5 * (r1 - r0);
    // The reduced rule of the quadratic element keeps thin discs from locking.
    for (xi, w) in GAUSS_2 {
        let r = 0.5 * (r0 + r1) + half * xi;
        let weight = w * half * r;
        let shape = [0.5 * xi * (xi - 1.0), 1.0 - xi * xi, 0.5 * xi * (xi + 1.0)];
        let slope = [(xi - 0.5) / half, -2.0 * xi / half, (xi + 0.5) / half];
        for a in 0..3 {
            for b in 0..3 {
                let (na, nb, da, db) = (shape[a], shape[b], slope[a], slope[b]);
                let (sa, sb) = (na / r, nb / r);
                let t = &mut radial[a][b];
                t.dd += weight * da * db;
                t.ds += weight * da * sb;
                t.sd += weight * sa * db;
                t.ss += weight * sa * sb;
                t.nn += weight * na * nb;
                t.dn += weight * da * nb;
                t.sn += weight * sa * nb;
                t.nd += weight * na * db;
                t.ns += weight * na * sb;
            }
        }
    }
    let size = rows.len();
    let mut k = [0, 1, 2].map(|_| vec![0.0; 9 * size * size]);
    for (i, &(ci, p)) in rows.iter().enumerate() {
        for (j, &(cj, q)) in rows.iter().enumerate() {
            let m = f64::from(u8::from(p == q));
            let kk = basis.stiff(p, q);
            let (pq, qp) = (basis.mixed(p, q), basis.mixed(q, p));
            for a in 0..3 {
                for b in 0..3 {
                    let t = radial[a][b];
                    let parts = match (ci, cj) {
                        (0, 0) => {
                            [m * (stiff * (t.dd + t.ss) + lame * (t.ds + t.sd)) + mu * kk * t.nn, 0.0, m * mu * t.ss]
                        }
                        (0, 1) => [0.0, m * (-stiff * t.ss - lame * t.ds + mu * (t.sd - t.ss)), 0.0],
                        (1, 0) => [0.0, m * (-stiff * t.ss - lame * t.sd + mu * (t.ds - t.ss)), 0.0],
                        (1, 1) => [m * mu * (t.dd - t.ds - t.sd + t.ss) + mu * kk * t.nn, 0.0, m * stiff * t.ss],
                        (0, 2) => [lame * pq * (t.dn + t.sn) + mu * qp * t.nd, 0.0, 0.0],
                        (2, 0) => [lame * qp * (t.nd + t.ns) + mu * pq * t.dn, 0.0, 0.0],
                        (1, 2) => [0.0, -lame * pq * t.sn + mu * qp * t.ns, 0.0],
                        (2, 1) => [0.0, -lame * qp * t.ns + mu * pq * t.sn, 0.0],
                        _ => [stiff * kk * t.nn + m * mu * t.dd, 0.0, m * mu * t.ss],
                    };
                    for (k, part) in k.iter_mut().zip(parts) {
                        k[(a * size + i) * 3 * size + b * size + j] = part;
                    }
                }
            }
        }
    }
    k
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compliance::annulus::harmonic_flexibility;
    use herringbone_oracle::Tolerance::Relative;
    use herringbone_oracle::{check, check_worst};

    const TOPIC: &str = "Contact: tooth as a plate, gear body as a ring";

    fn ring(inner: f64, width: f64) -> Ring {
        Ring {
            outer_radius_m: 1.0,
            inner_radius_m: inner,
            face_width_m: width,
            element_m: 0.03,
            youngs_pa: 1.0,
            nu: 0.3,
        }
    }

    #[test]
    fn planar_harmonics_equal_the_exact_series() {
        let basis = WidthBasis::new(0, 1.0);
        let mut errors = Vec::new();
        for n in [0, 1, 2, 5, 17, 30] {
            let got = &RingSolver::new(&ring(0.7, 1.0), &basis).flexibility(f64::from(n))[0];
            let exact = harmonic_flexibility(n, 0.7, 0.3);
            for i in 0..2 {
                for j in 0..2 {
                    let scale = exact[0][0].max(exact[1][1]);
                    errors.push((got[i * 2 + j] - exact[i][j]) / scale);
                }
            }
        }
        check_worst(TOPIC, "plane harmonics 0 to 30 against the exact series", errors, 3e-3);
    }

    #[test]
    fn torsion_and_thin_disc_bending_match_closed_forms() {
        // Torsion of the whole width: u_θ = T (1/q² - 1) / (4π μ b r), exact for free faces.
        let basis = WidthBasis::new(6, 0.4);
        let q = 0.5;
        let solver = RingSolver::new(&Ring { element_m: 0.05, ..ring(q, 0.4) }, &basis);
        let f = solver.flexibility(0.0);
        let i = solver.rows[0].iter().position(|&r| r == (1, 0)).unwrap();
        let mu = 0.5 / 1.3;
        let exact = (1.0 / (q * q) - 1.0) / (2.0 * mu);
        let got = f[0][i * solver.rows[0].len() + i];
        check(TOPIC, "torsion of a ring, unit modulus", got, exact, Relative(2e-3));
        // Thin annular plate, clamped inside, ring load Q per unit length on its free outer edge, axisymmetric (Roark's
        // case: outer edge free, inner edge fixed, line load at the rim): integrated here from the plate equation
        // w' of D d/dr(1/r d(r w')/dr) = Q a / r, with M_r = 0 outside and w = w' = 0 inside.
        let (b, nu, a) = (0.05, 0.3, 1.0f64);
        let d = b * b * b / (12.0 * (1.0 - nu * nu));
        // w' = Q a r/(2D) (ln r - 1/2) + c1 r/2 + c2/r
        let g = |r: f64| 0.5 * a * r * (r.ln() - 0.5) / d;
        let dg = |r: f64| 0.5 * a * (r.ln() + 0.5) / d;
        // w'(q) = 0; w''(1) + nu w'(1) = 0
        let (m11, m12, r1) = (0.5 * q, 1.0 / q, -g(q));
        let (m21, m22, r2) = (0.5 + nu * 0.5, -1.0 + nu, -(dg(1.0) + nu * g(1.0)));
        let det = m11 * m22 - m12 * m21;
        let (c1, c2) = ((r1 * m22 - m12 * r2) / det, (m11 * r2 - r1 * m21) / det);
        let w: f64 = (0..2000)
            .map(|k| {
                let r = q + (1.0 - q) * (k as f64 + 0.5) / 2000.0;
                (g(r) + c1 * r / 2.0 + c2 / r) * (1.0 - q) / 2000.0
            })
            .sum();
        let basis = WidthBasis::new(5, b);
        let solver = RingSolver::new(&Ring { element_m: 0.02, ..ring(q, b) }, &basis);
        let f = solver.flexibility(0.0);
        let parity = solver.rows.iter().position(|r| r.contains(&(2, 0))).unwrap();
        let i = solver.rows[parity].iter().position(|&r| r == (2, 0)).unwrap();
        // Load coefficient of a unit total per radian: P_0 = 1/sqrt(b); traction Q/b over b gives Q sqrt(b)/b.
        let got = f[parity][i * solver.rows[parity].len() + i] / b;
        check(TOPIC, "bending of a thin disc held inside, unit modulus", got, w.abs(), Relative(0.02));
    }
}
