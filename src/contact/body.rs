//! The gear body as a three-dimensional elastic ring: exact circumference, free end faces.
//!
//! A ring from the holding radius (rim or bore, all displacements zero there) to the root circle. Around the
//! circumference: Fourier harmonics; across the width: Legendre polynomials (free end faces are natural boundary
//! conditions, so disc bending, coning, in-plane modes and torsion are all contained); along the radius: quadratic finite
//! elements, eliminated from the inside out until only the root circle remains. With
//! u_r = U e^{inθ}, u_θ = iV e^{inθ}, u_y = W e^{inθ} each harmonic is real and symmetric, and even and odd powers of the
//! width separate (U, V even with W odd, and the reverse). A Galerkin flexibility is positive definite and never larger
//! than the exact one.

use super::linalg::{cholesky, cholesky_solve, forward_solve};

/// The ring and its material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ring {
    pub outer_radius_m: f64,
    pub inner_radius_m: f64,
    pub face_width_m: f64,
    /// Length of the outermost radial element; the others grow inwards.
    pub element_m: f64,
    pub youngs_pa: f64,
    pub nu: f64,
}

/// Growth of the radial elements towards the inside.
const GROWTH: f64 = 1.5;

/// 2-point Gauss rule on [-1, 1]: the reduced rule of the quadratic element, which keeps thin discs from locking.
const GAUSS: [(f64, f64); 2] = [(-0.577_350_269_189_625_8, 1.0), (0.577_350_269_189_625_8, 1.0)];

/// Legendre functions over the face width, orthonormal on [0, b].
#[derive(Debug, Clone, PartialEq)]
pub struct WidthBasis {
    pub order: usize,
    width_m: f64,
    /// ∫ P_p P_q' dy and ∫ P_p' P_q' dy.
    mixed: Vec<f64>,
    stiff: Vec<f64>,
}

impl WidthBasis {
    /// Polynomials of degree 0..=`order` on a face of `width_m`.
    pub fn new(order: usize, width_m: f64) -> WidthBasis {
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

    /// Mean of every polynomial over `count` equal slices: `count` rows of `order + 1`.
    pub fn slice_means(&self, count: usize) -> Vec<f64> {
        let size = self.order + 1;
        let mut out = vec![0.0; count * size];
        // ∫P_p dξ = (P_{p+1} - P_{p-1}) / (2p+1).
        let integral = |xi: f64| {
            let mut p = vec![0.0; size + 2];
            p[0] = 1.0;
            p[1] = xi;
            for k in 1..=size {
                p[k + 1] = ((2 * k + 1) as f64 * xi * p[k] - k as f64 * p[k - 1]) / (k + 1) as f64;
            }
            let mut q = vec![0.0; size];
            q[0] = xi;
            for k in 1..size {
                q[k] = (p[k + 1] - p[k - 1]) / (2 * k + 1) as f64;
            }
            q
        };
        let mut low = integral(-1.0);
        for i in 0..count {
            let high = integral(2.0 * (i + 1) as f64 / count as f64 - 1.0);
            for p in 0..size {
                let norm = ((2 * p + 1) as f64 / self.width_m).sqrt();
                out[i * size + p] = norm * (high[p] - low[p]) * count as f64 / 2.0;
            }
            low = high;
        }
        out
    }
}

/// Flexibility of the outer circle at one harmonic: displacement coefficients per load coefficients over the width basis,
/// as two blocks (U, V of even degree with W of odd degree; and the reverse).
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicFlexibility {
    /// (component 0 U, 1 V, 2 W; degree) of every row of a block.
    pub rows: [Vec<(usize, usize)>; 2],
    /// Symmetric, row-major.
    pub blocks: [Vec<f64>; 2],
}

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

/// Flexibility of `ring` at harmonic `n`; `planar` keeps U and V of degree zero only (plane strain, for verification).
pub fn harmonic(ring: &Ring, basis: &WidthBasis, n: u32, planar: bool) -> HarmonicFlexibility {
    let rows = [0, 1].map(|parity| {
        let mut rows = Vec::new();
        for component in 0..3 {
            for degree in 0..=basis.order {
                let wanted = (degree + usize::from(component == 2)) % 2 == parity;
                if wanted && (!planar || (component < 2 && degree == 0)) {
                    rows.push((component, degree));
                }
            }
        }
        rows
    });
    let blocks = [0, 1].map(|p| condense(ring, basis, n as f64, &rows[p]));
    HarmonicFlexibility { rows, blocks }
}

fn condense(ring: &Ring, basis: &WidthBasis, n: f64, rows: &[(usize, usize)]) -> Vec<f64> {
    let size = rows.len();
    if size == 0 {
        return Vec::new();
    }
    let mesh = radial_mesh(ring);
    let mut inner_stiffness: Option<Vec<f64>> = None;
    let mut outer = vec![0.0; size * size];
    for span in mesh.windows(2) {
        let element = element_stiffness(ring, basis, n, rows, span[0], span[1]);
        // Order: inner and middle nodes (eliminated), then the outer node.
        let first = if inner_stiffness.is_some() { 0 } else { 1 };
        let gone = (2 - first) * size;
        let at = |a: usize, i: usize, b: usize, j: usize| element[(a * size + i) * 3 * size + b * size + j];
        let mut k = vec![0.0; gone * gone];
        for i in 0..gone {
            for j in 0..=i {
                k[i * gone + j] = at(first + i / size, i % size, first + j / size, j % size);
            }
        }
        if let Some(previous) = &inner_stiffness {
            for i in 0..size {
                for j in 0..=i {
                    k[i * gone + j] += previous[i * size + j];
                }
            }
        }
        cholesky(&mut k, gone);
        let mut columns = vec![0.0; size * gone];
        for j in 0..size {
            let column = &mut columns[j * gone..(j + 1) * gone];
            for (i, value) in column.iter_mut().enumerate() {
                *value = at(first + i / size, i % size, 2, j);
            }
            forward_solve(&k, column, gone);
        }
        for i in 0..size {
            for j in 0..=i {
                let minus = super::linalg::dot(&columns[i * gone..(i + 1) * gone], &columns[j * gone..(j + 1) * gone]);
                outer[i * size + j] = at(2, i, 2, j) - minus;
                outer[j * size + i] = outer[i * size + j];
            }
        }
        inner_stiffness = Some(outer.clone());
    }
    cholesky(&mut outer, size);
    let mut flexibility = vec![0.0; size * size];
    for j in 0..size {
        let column = &mut flexibility[j * size..(j + 1) * size];
        column[j] = 1.0;
        cholesky_solve(&outer, column, size);
    }
    flexibility
}

/// Stiffness of one quadratic radial element (nodes: inner, middle, outer) per radian of the harmonic's circumference.
fn element_stiffness(ring: &Ring, basis: &WidthBasis, n: f64, rows: &[(usize, usize)], r0: f64, r1: f64) -> Vec<f64> {
    let mu = 0.5 * ring.youngs_pa / (1.0 + ring.nu);
    let lame = 2.0 * mu * ring.nu / (1.0 - 2.0 * ring.nu);
    let stiff = lame + 2.0 * mu;
    // Radial integrals for every pair of nodes: products of N', N/r and N.
    #[derive(Clone, Copy, Default)]
    struct Radial {
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
    let mut radial = [[Radial::default(); 3]; 3];
    let half = 0.5 * (r1 - r0);
    for (xi, w) in GAUSS {
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
    let total = basis.order + 1;
    let mut k = vec![0.0; 9 * size * size];
    for (i, &(ci, p)) in rows.iter().enumerate() {
        for (j, &(cj, q)) in rows.iter().enumerate() {
            let m = f64::from(u8::from(p == q));
            let kk = basis.stiff[p * total + q];
            let pq = basis.mixed[p * total + q];
            let qp = basis.mixed[q * total + p];
            for a in 0..3 {
                for b in 0..3 {
                    let t = radial[a][b];
                    let value = match (ci, cj) {
                        (0, 0) => {
                            m * (stiff * (t.dd + t.ss) + lame * (t.ds + t.sd) + mu * n * n * t.ss) + mu * kk * t.nn
                        }
                        (0, 1) => m * n * (-stiff * t.ss - lame * t.ds + mu * (t.sd - t.ss)),
                        (1, 0) => m * n * (-stiff * t.ss - lame * t.sd + mu * (t.ds - t.ss)),
                        (1, 1) => m * (stiff * n * n * t.ss + mu * (t.dd - t.ds - t.sd + t.ss)) + mu * kk * t.nn,
                        (0, 2) => lame * pq * (t.dn + t.sn) + mu * qp * t.nd,
                        (2, 0) => lame * qp * (t.nd + t.ns) + mu * pq * t.dn,
                        (1, 2) => -lame * n * pq * t.sn + mu * n * qp * t.ns,
                        (2, 1) => -lame * n * qp * t.ns + mu * n * pq * t.sn,
                        _ => stiff * kk * t.nn + m * mu * (t.dd + n * n * t.ss),
                    };
                    k[(a * size + i) * 3 * size + b * size + j] = value;
                }
            }
        }
    }
    k
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::annulus::harmonic_flexibility;
    use crate::oracle::Tolerance::Relative;
    use crate::oracle::{check, check_worst};

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
            let got = &harmonic(&ring(0.7, 1.0), &basis, n, true).blocks[0];
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
        let f = harmonic(&Ring { element_m: 0.05, ..ring(q, 0.4) }, &basis, 0, false);
        let i = f.rows[0].iter().position(|&r| r == (1, 0)).unwrap();
        let mu = 0.5 / 1.3;
        let exact = (1.0 / (q * q) - 1.0) / (2.0 * mu);
        let got = f.blocks[0][i * f.rows[0].len() + i];
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
        let f = harmonic(&Ring { element_m: 0.02, ..ring(q, b) }, &basis, 0, false);
        let parity = f.rows.iter().position(|r| r.contains(&(2, 0))).unwrap();
        let i = f.rows[parity].iter().position(|&r| r == (2, 0)).unwrap();
        // Load coefficient of a unit total per radian: P_0 = 1/sqrt(b); traction Q/b over b gives Q sqrt(b)/b.
        let got = f.blocks[parity][i * f.rows[parity].len() + i] / b;
        check(TOPIC, "bending of a thin disc held inside, unit modulus", got, w.abs(), Relative(0.02));
    }
}
