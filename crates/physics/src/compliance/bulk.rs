//! All compliance of one member but the contact indentation, between slices of the face and places of the profile.
//!
//! A unit normal force at a place of the profile bends the tooth as a plate, and the reactions of the plate's root load
//! the ring and the short-wave remainder of the root. Where these yield unevenly along the face, the tooth resists as a
//! rib: with the flexibility G of ring and remainder and the resistance K of the plate to displacements of its root,
//! the reactions p become p - K (1 + G K)⁻¹ G p. Everything is put together over Legendre functions of the face and
//! only then brought to the slices, where each place has its own way along the face between contact and middle surface.

use super::edge::EndFaces;
use super::plate::PlateModes;
use super::ring::WidthBasis;
use super::ring_influence::{KINDS, RingFlexibility};
use super::tooth::{ProfilePoint, RootRemainder};
use crate::numerics::dense::{add_product, cholesky_inlined, cholesky_solve, lu_solve};
use crate::simd::vectorised;
use crate::watch::{Canceled, Meter, Watch};

/// Places of the profile between which the compliance is interpolated (Chebyshev nodes, a polynomial through all).
pub(super) const NODES: usize = 4;

/// Normal displacements per normal force of teeth and ring together, for every pair of slices and places of the
/// profile.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BulkCompliance {
    slices: usize,
    /// By offset, places of response and load, slices of response and load.
    table: Vec<f64>,
}

/// Parts of the compliance of a member.
pub(super) struct BulkInput<'a> {
    /// Functions over the face.
    pub basis: &'a WidthBasis,
    /// Tooth as a plate over those functions, Young's modulus one.
    pub plate: &'a PlateModes,
    /// Short waves at the root that the ring leaves out.
    pub root: &'a RootRemainder,
    /// Ring below the tooth.
    pub ring: &'a RingFlexibility,
    /// Corners of the end faces.
    pub ends: EndFaces,
    /// Load points at the nodes of the path.
    pub places: &'a [ProfilePoint; NODES],
    /// Compression of the tooth below each place, times Young's modulus.
    pub compression_m: [f64; NODES],
    /// Young's modulus, Pa.
    pub youngs_pa: f64,
    /// Radius of the root circle.
    pub root_radius_m: f64,
    /// Helix angle at the root circle.
    pub root_helix_angle_rad: f64,
    /// Slices of the bearing face width.
    pub slices: usize,
    /// Start and width of the bearing part of the face, which is cut into slices.
    pub bearing_m: (f64, f64),
}

impl BulkCompliance {
    /// Puts the parts together.
    ///
    /// # Errors
    /// [`Canceled`].
    pub(super) fn new(parts: &BulkInput<'_>, watch: Watch) -> Result<BulkCompliance, Canceled> {
        let count = parts.ring.offsets.len() * (NODES * parts.slices).pow(2);
        let mut bulk = BulkCompliance { slices: parts.slices, table: vec![0.0; count] };
        vectorised(
            #[inline(always)]
            || bulk.fill(parts, &mut Meter::new(watch)),
        )?;
        bulk.mirror();
        Ok(bulk)
    }

    #[inline(always)]
    fn fill(&mut self, parts: &BulkInput<'_>, meter: &mut Meter) -> Result<(), Canceled> {
        let size = parts.basis.order + 1;
        let n = parts.slices;
        let shapes =
            parts.places.map(|place| transposed(&parts.basis.slice_means(n, parts.bearing_m, place.shift_m), size));
        let [forces, moments] = [0, 1].map(|which| parts.places.map(|place| parts.plate.root(which, place.lever_m)));
        let loads: [RootLoad; NODES] = std::array::from_fn(|a| parts.root_load(a, &forces[a], &moments[a]));
        let remainder = parts.remainder();
        let ribbed = parts.with_rib(&loads, &remainder, meter)?;
        let mut joint = vec![0.0; size * size];
        let mut half = vec![0.0; KINDS * size * size];
        let mut slices = vec![0.0; n * size];
        for (k, flexibility) in parts.ring.offsets.iter().enumerate() {
            let turned = transposed(flexibility, KINDS * size);
            for b in 0..NODES {
                meter.count((KINDS * size).pow(2) * size + NODES * size * (KINDS * size * size + n * (size + n)))?;
                half.fill(0.0);
                add_product(&mut half, 1.0, &turned, &ribbed[b].ring, KINDS * size);
                let answer = if k == 0 { product(&remainder, &ribbed[b].local, 3 * size) } else { Vec::new() };
                // Of one tooth the table is symmetric.
                let upper = if k == 0 { b + 1 } else { NODES };
                for a in 0..upper {
                    // The transpose: degree of b by degree of a.
                    joint.fill(0.0);
                    if k == 0 {
                        add_product(&mut joint, 1.0, &half, &loads[a].ring, KINDS * size);
                        add_product(&mut joint, 1.0, &answer, &loads[a].local, 3 * size);
                        parts.add_tooth(&mut joint, (b, a));
                    } else {
                        add_product(&mut joint, 1.0, &half, &ribbed[a].ring, KINDS * size);
                    }
                    // Degree of a by slice of b.
                    slices.fill(0.0);
                    add_product(&mut slices, 1.0, &joint, &shapes[b], size);
                    let target = &mut self.table[((k * NODES + a) * NODES + b) * n * n..][..n * n];
                    add_product(target, 1.0, &shapes[a], &slices, size);
                    if k == 0 {
                        let depth_m = parts.places[a].depth_m.min(parts.places[b].depth_m);
                        parts.ends.add(target, depth_m);
                    }
                }
            }
        }
        Ok(())
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

    /// Displacement at slice `i` and place `a` from a force at slice `j` and place `b`, both on one tooth (`offset` 0)
    /// or with the first `offset` pairs earlier in the mesh than the second.
    pub(super) fn entry(&self, offset: usize, (i, a): (usize, usize), (j, b): (usize, usize)) -> f64 {
        self.table[(((offset * NODES + a) * NODES + b) * self.slices + i) * self.slices + j]
    }

    /// Displacement at slice `i` from a force at slice `j`, both on one tooth (`offset` 0) or with the first `offset`
    /// pairs earlier in the mesh than the second; `wa` and `wb` are the interpolation weights of their places.
    #[cfg(test)]
    pub(super) fn between(&self, offset: usize, i: usize, j: usize, wa: &[f64; NODES], wb: &[f64; NODES]) -> f64 {
        let mut sum = 0.0;
        for (a, wa) in wa.iter().enumerate() {
            for (b, wb) in wb.iter().enumerate() {
                sum += wa * wb * self.entry(offset, (i, a), (j, b));
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

impl BulkInput<'_> {
    /// Displacements under force and moment coefficients at the root: `normal` are the tangential, radial and axial
    /// components, the lateral one and the one along the height of the force.
    fn carried(&self, [tangential, radial, axial, lateral, sin]: [f64; 5], force: &[f64], moment: &[f64]) -> RootLoad {
        let size = self.basis.order + 1;
        let columns = force.len() / size;
        let area = force.len();
        let (sin_f, cos_f) = self.root_helix_angle_rad.sin_cos();
        let mut ring = vec![0.0; KINDS * area];
        let mut local = vec![0.0; 3 * area];
        for i in 0..area {
            let (f, m) = (force[i], moment[i]);
            ring[i] = tangential * (f + m / self.root_radius_m);
            ring[area + i] = lateral * m / (cos_f * self.root_radius_m);
            ring[2 * area + i] = radial * f;
            ring[3 * area + i] = axial * f;
            local[i] = lateral * f;
            local[area + i] = lateral * m / self.root.virtual_radius_m;
            local[2 * area + i] = -sin * f;
        }
        // The part of the moment that is turned along the trace: radial dipoles, conjugate to the slope of the radial
        // displacement along the tooth.
        let dipole = -axial.signum() * lateral * sin_f;
        for p in 0..size {
            for d in (0..p).filter(|d| (p - d) % 2 == 1) {
                let factor = dipole * self.basis.mixed(d, p);
                for q in 0..columns {
                    ring[(2 * size + p) * columns + q] += factor * moment[d * columns + q];
                }
            }
        }
        RootLoad { ring, local }
    }

    fn root_load(&self, a: usize, force: &[f64], moment: &[f64]) -> RootLoad {
        let p = &self.places[a];
        self.carried([p.tangential, p.radial, p.axial, p.lateral, p.normal_sin], force, moment)
    }

    /// Flexibility of the root's remainder over (kind, degree): its matrix times (1 + λ² k²)⁻¹.
    fn remainder(&self) -> Vec<f64> {
        let size = self.basis.order + 1;
        let mut k = vec![0.0; size * size];
        for p in 0..size {
            for q in 0..=p {
                k[p * size + q] = self.basis.stiff(p, q) * self.root.decay_m.powi(2) + f64::from(u8::from(p == q));
            }
        }
        cholesky_inlined(&mut k, size);
        let mut out = vec![0.0; 9 * size * size];
        let mut column = vec![0.0; size];
        for p in 0..size {
            column.fill(0.0);
            column[p] = 1.0;
            cholesky_solve(&k, &mut column, size);
            for c in 0..3 {
                for d in 0..3 {
                    for (q, value) in column.iter().enumerate() {
                        out[(c * size + q) * 3 * size + d * size + p] = self.root.matrix[c][d] / self.youngs_pa * value;
                    }
                }
            }
        }
        out
    }

    /// The loads of all places with what the tooth itself takes back as a rib.
    #[inline(always)]
    fn with_rib(
        &self,
        loads: &[RootLoad; NODES],
        remainder: &[f64],
        meter: &mut Meter,
    ) -> Result<[RootLoad; NODES], Canceled> {
        let size = self.basis.order + 1;
        let (sin_f, cos_f) = self.root_helix_angle_rad.sin_cos();
        let side = self.places[0].axial.signum();
        // Unit forces and unit moments of every degree at the root.
        let unit = |which: usize| -> Vec<f64> {
            (0..2 * size * size).map(|i| f64::from(u8::from(i % (2 * size) == which * size + i / (2 * size)))).collect()
        };
        let rib = self.carried([cos_f, 0.0, side * sin_f, 1.0, 0.0], &unit(0), &unit(1));
        let flexible = RootLoad {
            ring: product(&self.ring.offsets[0], &rib.ring, KINDS * size),
            local: product(remainder, &rib.local, 3 * size),
        };
        let joint = |a: &RootLoad| {
            let mut out = vec![0.0; a.ring.len() / KINDS * 2];
            add_product(&mut out, 1.0, &flexible.ring, &a.ring, KINDS * size);
            add_product(&mut out, 1.0, &flexible.local, &a.local, 3 * size);
            out
        };
        let give = joint(&rib);
        let resistance: Vec<f64> = self.plate.resistance.iter().map(|k| k * self.youngs_pa).collect();
        let mut system = vec![0.0; give.len()];
        add_product(&mut system, 1.0, &resistance, &give, 2 * size);
        for i in 0..2 * size {
            system[i * 2 * size + i] += 1.0;
        }
        let mut reaction = resistance;
        if !lu_solve(&mut system, &mut reaction, 2 * size, meter)? {
            reaction.fill(0.0);
        }
        Ok(std::array::from_fn(|a| {
            let taken = product(&reaction, &joint(&loads[a]), 2 * size);
            let less = |load: &[f64], unit: &[f64]| {
                let mut out = load.to_vec();
                let rows = unit.len() / (2 * size);
                add_product(&mut out, -1.0, &transposed(unit, 2 * size), &taken, 2 * size);
                debug_assert_eq!(out.len(), rows * size);
                out
            };
            RootLoad { ring: less(&loads[a].ring, &rib.ring), local: less(&loads[a].local, &rib.local) }
        }))
    }

    /// The tooth's plate and its compression.
    #[inline(always)]
    fn add_tooth(&self, joint: &mut [f64], (a, b): (usize, usize)) {
        let size = self.basis.order + 1;
        let (pa, pb) = (&self.places[a], &self.places[b]);
        let bent = self.plate.deflection(pa.lever_m, pb.lever_m);
        let factor = pa.lateral * pb.lateral / self.youngs_pa;
        joint.iter_mut().zip(&bent).for_each(|(t, d)| *t += factor * d);
        let lower = if pa.lever_m < pb.lever_m { a } else { b };
        let pressed = pa.normal_sin * pb.normal_sin * self.compression_m[lower] / self.youngs_pa;
        for p in 0..size {
            joint[p * size + p] += pressed;
        }
    }
}

/// Loads on ring (kind, degree) and root remainder (tangential, moment, radial; degree), row-major, one column per
/// cause.
struct RootLoad {
    ring: Vec<f64>,
    local: Vec<f64>,
}

/// The product of a symmetric matrix of `rows` rows with another matrix.
#[inline(always)]
fn product(symmetric: &[f64], other: &[f64], rows: usize) -> Vec<f64> {
    let mut out = vec![0.0; other.len()];
    add_product(&mut out, 1.0, symmetric, other, rows);
    out
}
