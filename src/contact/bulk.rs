//! All compliance of one member but the contact indentation, between slices of the face and places of the profile.
//!
//! A unit normal force at a place of the profile bends the tooth as a plate, and the reactions of the plate's root load the
//! ring and the short-wave remainder of the root. Everything is put together over Legendre functions of the face and only
//! then brought to the slices, where each place has its own way along the face between contact and middle surface.

use super::body::WidthBasis;
use super::edge::AcuteEnd;
use super::linalg::{add_product, cholesky, cholesky_solve, vectorised};
use super::plate::PlateModes;
use super::ring_influence::{KINDS, RingFlexibility};
use super::tooth::{Place, RootRemainder};

/// Places of the profile between which the compliance is interpolated (Chebyshev nodes, a polynomial through all).
pub const NODES: usize = 4;

/// Normal displacements per normal force of teeth and ring together, for every pair of slices and places of the profile.
#[derive(Debug, Clone, PartialEq)]
pub struct BulkCompliance {
    slices: usize,
    /// By offset, places of response and load, slices of response and load.
    table: Vec<f64>,
}

/// What the compliance is made of.
pub struct Parts<'a> {
    pub basis: &'a WidthBasis,
    pub plate: &'a PlateModes,
    pub root: &'a RootRemainder,
    pub ring: &'a RingFlexibility,
    pub end: AcuteEnd,
    pub places: &'a [Place; NODES],
    /// Compression of the tooth below each place, times Young's modulus.
    pub compression_m: [f64; NODES],
    pub youngs_pa: f64,
    pub root_radius_m: f64,
    pub root_helix_angle_rad: f64,
    pub slices: usize,
}

impl BulkCompliance {
    pub fn new(parts: &Parts<'_>) -> BulkCompliance {
        let count = parts.ring.offsets.len() * (NODES * parts.slices).pow(2);
        let mut bulk = BulkCompliance { slices: parts.slices, table: vec![0.0; count] };
        vectorised(
            #[inline(always)]
            || bulk.fill(parts),
        );
        bulk.mirror();
        bulk
    }

    #[inline(always)]
    fn fill(&mut self, parts: &Parts<'_>) {
        let size = parts.basis.order + 1;
        let n = parts.slices;
        let shapes = parts.places.map(|place| transposed(&parts.basis.slice_means(n, place.shift_m), size));
        let [forces, moments] = [0, 1].map(|which| parts.places.map(|place| parts.plate.root(which, place.lever_m)));
        let loads: [Vec<f64>; NODES] = std::array::from_fn(|a| parts.ring_load(a, &forces[a], &moments[a]));
        let spread = parts.root_spread();
        let mut joint = vec![0.0; size * size];
        let mut half = vec![0.0; KINDS * size * size];
        let mut slices = vec![0.0; n * size];
        for (k, flexibility) in parts.ring.offsets.iter().enumerate() {
            let turned = transposed(flexibility, KINDS * size);
            for b in 0..NODES {
                half.fill(0.0);
                add_product(&mut half, 1.0, &turned, &loads[b], KINDS * size);
                // Of one tooth the table is symmetric.
                let upper = if k == 0 { b + 1 } else { NODES };
                for a in 0..upper {
                    // The transpose: degree of b by degree of a.
                    joint.fill(0.0);
                    add_product(&mut joint, 1.0, &half, &loads[a], KINDS * size);
                    if k == 0 {
                        parts.add_tooth(&mut joint, (b, a), &forces, &moments, &spread);
                    }
                    // Degree of a by slice of b.
                    slices.fill(0.0);
                    add_product(&mut slices, 1.0, &joint, &shapes[b], size);
                    let target = &mut self.table[((k * NODES + a) * NODES + b) * n * n..][..n * n];
                    add_product(target, 1.0, &shapes[a], &slices, size);
                    if k == 0 {
                        let depth_m = parts.places[a].depth_m.min(parts.places[b].depth_m);
                        parts.end.add(target, depth_m);
                    }
                }
            }
        }
    }

    /// The other half of one tooth's own table.
    fn mirror(&mut self) {
        let n2 = self.slices * self.slices;
        for a in 0..NODES {
            for b in 0..a {
                let (low, high) = self.table.split_at_mut((a * NODES + b) * n2);
                let source = &low[(b * NODES + a) * n2..][..n2];
                for (i, row) in source.chunks_exact(self.slices).enumerate() {
                    for (j, value) in row.iter().enumerate() {
                        high[j * self.slices + i] = *value;
                    }
                }
            }
        }
    }

    /// Displacement at slice `i` and place `a` from a force at slice `j` and place `b`, both on one tooth (`offset` 0) or with the
    /// first `offset` pairs earlier in the mesh than the second.
    pub fn entry(&self, offset: usize, (i, a): (usize, usize), (j, b): (usize, usize)) -> f64 {
        self.table[(((offset * NODES + a) * NODES + b) * self.slices + i) * self.slices + j]
    }

    /// Displacement at slice `i` from a force at slice `j`, both on one tooth (`offset` 0) or with the first `offset` pairs
    /// earlier in the mesh than the second; `wa` and `wb` are the interpolation weights of their places.
    #[cfg(test)]
    pub fn between(&self, offset: usize, i: usize, j: usize, wa: &[f64; NODES], wb: &[f64; NODES]) -> f64 {
        let mut sum = 0.0;
        for a in 0..NODES {
            for b in 0..NODES {
                sum += wa[a] * wb[b] * self.entry(offset, (i, a), (j, b));
            }
        }
        sum
    }
}

/// The transpose of a row-major matrix with `columns` columns.
fn transposed(matrix: &[f64], columns: usize) -> Vec<f64> {
    let rows = matrix.len() / columns;
    let mut out = vec![0.0; matrix.len()];
    for (i, row) in matrix.chunks_exact(columns).enumerate() {
        for (j, value) in row.iter().enumerate() {
            out[j * rows + i] = *value;
        }
    }
    out
}

impl Parts<'_> {
    /// Ring loads (kind, degree) per load degree at place `a`.
    fn ring_load(&self, a: usize, force: &[f64], moment: &[f64]) -> Vec<f64> {
        let size = self.basis.order + 1;
        let place = &self.places[a];
        let (sin_f, cos_f) = self.root_helix_angle_rad.sin_cos();
        let mut out = vec![0.0; KINDS * size * size];
        for i in 0..size * size {
            let (f, m) = (force[i], moment[i]);
            out[i] = place.tangential * (f + m / self.root_radius_m);
            out[size * size + i] = place.lateral * m / (cos_f * self.root_radius_m);
            out[2 * size * size + i] = place.radial * f;
            out[3 * size * size + i] = place.axial * f;
        }
        // The part of the moment that is turned along the trace: radial dipoles, conjugate to the slope of the radial
        // displacement along the tooth.
        let dipole = -place.axial.signum() * place.lateral * sin_f;
        for p in 0..size {
            for d in (0..p).filter(|d| (p - d) % 2 == 1) {
                let factor = dipole * self.basis.mixed(d, p);
                for q in 0..size {
                    out[(2 * size + p) * size + q] += factor * moment[d * size + q];
                }
            }
        }
        out
    }

    /// (1 + λ² k²)⁻¹ of the root's remainder.
    fn root_spread(&self) -> Vec<f64> {
        let size = self.basis.order + 1;
        let mut k = vec![0.0; size * size];
        for p in 0..size {
            for q in 0..=p {
                k[p * size + q] = self.basis.stiff(p, q) * self.root.decay_m.powi(2) + f64::from(u8::from(p == q));
            }
        }
        cholesky(&mut k, size);
        let mut out = vec![0.0; size * size];
        for (p, column) in out.chunks_exact_mut(size).enumerate() {
            column[p] = 1.0;
            cholesky_solve(&k, column, size);
        }
        out
    }

    /// The tooth's plate, its compression and the remainder of its root.
    #[inline(always)]
    fn add_tooth(
        &self,
        joint: &mut [f64],
        (a, b): (usize, usize),
        forces: &[Vec<f64>; NODES],
        moments: &[Vec<f64>; NODES],
        spread: &[f64],
    ) {
        let size = self.basis.order + 1;
        let (pa, pb) = (&self.places[a], &self.places[b]);
        let e = self.youngs_pa;
        let bent = self.plate.deflection(pa.lever_m, pb.lever_m);
        let factor = pa.lateral * pb.lateral / e;
        for (t, d) in joint.iter_mut().zip(&bent) {
            *t += factor * d;
        }
        let lower = if pa.lever_m < pb.lever_m { a } else { b };
        let pressed = pa.normal_sin * pb.normal_sin * self.compression_m[lower] / e;
        for p in 0..size {
            joint[p * size + p] += pressed;
        }
        // Force and moment at the root of either place: f = (lateral V, lateral M / r, -sin V).
        let s = &self.root.matrix;
        let r = self.root.virtual_radius_m;
        let combined = |place: &Place, force: &[f64], moment: &[f64], c: usize| -> Vec<f64> {
            let parts = [place.lateral, place.lateral / r, -place.normal_sin];
            let source = if c == 1 { moment } else { force };
            source.iter().map(|v| parts[c] * v).collect()
        };
        let left: [Vec<f64>; 3] = std::array::from_fn(|c| combined(pa, &forces[a], &moments[a], c));
        let right: [Vec<f64>; 3] = std::array::from_fn(|c| combined(pb, &forces[b], &moments[b], c));
        let mut row = vec![0.0; size * size];
        let mut answer = vec![0.0; size * size];
        for (c, left) in left.iter().enumerate() {
            row.fill(0.0);
            for (d, right) in right.iter().enumerate() {
                for (t, v) in row.iter_mut().zip(right) {
                    *t += s[c][d] * v / e;
                }
            }
            answer.fill(0.0);
            add_product(&mut answer, 1.0, spread, &row, size);
            add_product(joint, 1.0, left, &answer, size);
        }
    }
}
