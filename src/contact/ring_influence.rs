//! Influence between the loads that the teeth of one member hand to its ring: every pair of width slices, on the same
//! tooth and on teeth some pitches apart, following the helix.

use std::f64::consts::PI;

use super::annulus::arc_shapes;
use super::body::{HarmonicFlexibility, Ring, WidthBasis, harmonic};
use super::coupling::{ToothChain, ToothModes};
use super::tooth::ProfilePoint;

/// Waves across the tooth longer than the first (in multiples of the normal module per radian) belong wholly to the
/// ring, shorter than the second wholly to the tooth's own root; between them they share. A tooth pitch is π m_n, so
/// that neighbouring teeth feel each other through the ring alone.
const RING_WAVES_PER_MODULE: (f64, f64) = (0.8, 1.8);

/// Share of the ring model at a wave number (rad/m) across the tooth.
pub fn ring_weight(wave_per_m: f64, normal_module_m: f64) -> f64 {
    let (low, high) = RING_WAVES_PER_MODULE;
    let t = ((wave_per_m * normal_module_m - low) / (high - low)).clamp(0.0, 1.0);
    0.5 * (1.0 + (PI * t).cos())
}

/// Where the teeth stand on the ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToothLayout {
    pub teeth: u32,
    pub root_half_angle_rad: f64,
    /// Turn of the tooth per length of face, tanβ_b / r_b.
    pub twist_per_m: f64,
    pub root_helix_angle_rad: f64,
    pub normal_module_m: f64,
    /// +1 pinion, -1 gear: sign of the axial force and, reversed, of the angles along the direction of the force.
    pub side: f64,
}

/// Number of load components per slice; order as in `tooth::RootLoad`.
pub const LOADS: usize = 5;

/// Displacements of the slices per load (the displacement conjugate to each load component).
#[derive(Debug, Clone, PartialEq)]
pub struct RingInfluence {
    slices: usize,
    table: Vec<[f64; LOADS * LOADS]>,
}

/// Flexibilities of ascending harmonics: the low ones and every so many of the high ones are computed, the others
/// interpolated linearly in n times flexibility, which tends to the half-space's constant.
struct Harmonics<'a> {
    ring: &'a Ring,
    basis: &'a WidthBasis,
    below: (u32, HarmonicFlexibility),
    above: (u32, HarmonicFlexibility),
    between: HarmonicFlexibility,
}

/// Harmonics up to this one are all computed, the steps beyond grow by an eighth of the order.
const EVERY_HARMONIC: u32 = 8;

impl<'a> Harmonics<'a> {
    fn new(ring: &'a Ring, basis: &'a WidthBasis) -> Harmonics<'a> {
        let first = harmonic(ring, basis, 0, false);
        Harmonics { ring, basis, below: (0, first.clone()), above: (0, first.clone()), between: first }
    }

    /// Harmonic `n`; orders must ascend.
    fn at(&mut self, n: u32) -> &HarmonicFlexibility {
        while self.above.0 < n {
            let step = if self.above.0 < EVERY_HARMONIC { 1 } else { (self.above.0 / 8).max(1) };
            let next = self.above.0 + step;
            let fresh = (next, harmonic(self.ring, self.basis, next, false));
            self.below = std::mem::replace(&mut self.above, fresh);
        }
        if self.above.0 == n {
            return &self.above.1;
        }
        let (low, high) = (f64::from(self.below.0), f64::from(self.above.0));
        let t = (f64::from(n) - low) / (high - low);
        let (a, b) = ((1.0 - t) * low / f64::from(n), t * high / f64::from(n));
        for (parity, block) in self.between.blocks.iter_mut().enumerate() {
            let (below, above) = (&self.below.1.blocks[parity], &self.above.1.blocks[parity]);
            for ((value, x), y) in block.iter_mut().zip(below).zip(above) {
                *value = a * x + b * y;
            }
        }
        &self.between
    }
}

/// Sum over harmonics and its slice-space workspace.
struct Accumulator {
    slices: usize,
    size: usize,
    /// Slice means of the width functions, degree by degree.
    shapes: Vec<f64>,
    /// Slice-space flexibility per pair of components.
    components: [Vec<f64>; 9],
    rows: Vec<f64>,
}

impl RingInfluence {
    /// Influence for `slices` equal slices and teeth up to `offsets` pitches apart.
    pub fn new(ring: &Ring, layout: &ToothLayout, slices: usize, offsets: usize) -> RingInfluence {
        let reach = ring.outer_radius_m * layout.root_helix_angle_rad.cos();
        let highest = (RING_WAVES_PER_MODULE.1 / layout.normal_module_m * reach).ceil().max(3.0) as u32;
        let waves = RING_WAVES_PER_MODULE.1 * ring.face_width_m / (PI * layout.normal_module_m);
        let basis = WidthBasis::new((4.0 + 1.1 * waves).ceil().clamp(5.0, 26.0) as usize, ring.face_width_m);
        let mut sum = Accumulator::new(&basis, slices);
        let mut series = Harmonics::new(ring, &basis);
        let mut table = vec![[0.0; LOADS * LOADS]; (offsets + 1) * slices * slices];
        let pitch = 2.0 * PI / layout.teeth as f64;
        let turn = ring.face_width_m / slices as f64 * layout.twist_per_m;
        for n in 0..=highest {
            let weight = ring_weight(n as f64 / reach, layout.normal_module_m);
            if weight <= 0.0 {
                continue;
            }
            sum.transform(series.at(n));
            let factor = weight * if n == 0 { 0.5 } else { 1.0 } / PI;
            let (uniform, linear) = arc_shapes(n as f64, layout.root_half_angle_rad);
            // (component, shape, odd) of tangential, moment, radial and axial load.
            let kinds = [(1, uniform, true), (0, -linear, true), (0, uniform, false), (2, uniform, false)];
            for k in 0..=offsets {
                for shift in 0..2 * slices - 1 {
                    let steps = shift as f64 - (slices - 1) as f64;
                    let psi = -layout.side * (k as f64 * pitch + steps * turn);
                    let (sin, cos) = (n as f64 * psi).sin_cos();
                    let mut coefficients = [0.0; 16];
                    for (a, &(_, fa, odd_a)) in kinds.iter().enumerate() {
                        for (b, &(_, fb, odd_b)) in kinds.iter().enumerate() {
                            let phase = match (odd_a, odd_b) {
                                (true, false) => -sin,
                                (false, true) => sin,
                                _ => cos,
                            };
                            coefficients[a * 4 + b] = factor * fa * fb * phase;
                        }
                    }
                    let first = (shift + 1).saturating_sub(slices);
                    for i in first..slices.min(shift + 1) {
                        let j = i + slices - 1 - shift;
                        let entry = &mut table[(k * slices + i) * slices + j];
                        for (a, &(ca, ..)) in kinds.iter().enumerate() {
                            for (b, &(cb, ..)) in kinds.iter().enumerate() {
                                entry[a * LOADS + b] +=
                                    coefficients[a * 4 + b] * sum.components[ca * 3 + cb][i * slices + j];
                            }
                        }
                    }
                }
            }
        }
        let mut influence = RingInfluence { slices, table };
        influence.add_dipoles(ring.face_width_m / slices as f64, offsets);
        influence
    }

    /// The dipole's displacement is the slope of the radial displacement along the tooth: central differences between
    /// slices, one-sided at the ends.
    fn add_dipoles(&mut self, step: f64, offsets: usize) {
        const RADIAL: usize = 2;
        const DIPOLE: usize = 4;
        let n = self.slices;
        if n < 2 {
            return;
        }
        let neighbours = |i: usize| {
            let (low, high) = (i.saturating_sub(1), (i + 1).min(n - 1));
            (low, high, 1.0 / ((high - low) as f64 * step))
        };
        for k in 0..=offsets {
            let base = k * n * n;
            for i in 0..n {
                let (low, high, scale) = neighbours(i);
                for j in 0..n {
                    for b in 0..4 {
                        let difference = self.table[base + high * n + j][RADIAL * LOADS + b]
                            - self.table[base + low * n + j][RADIAL * LOADS + b];
                        self.table[base + i * n + j][DIPOLE * LOADS + b] = difference * scale;
                    }
                }
            }
            for i in 0..n {
                for j in 0..n {
                    let (low, high, scale) = neighbours(j);
                    for a in 0..LOADS {
                        let difference = self.table[base + i * n + high][a * LOADS + RADIAL]
                            - self.table[base + i * n + low][a * LOADS + RADIAL];
                        self.table[base + i * n + j][a * LOADS + DIPOLE] = difference * scale;
                    }
                }
            }
        }
    }

    /// Contracts the load components at `NODES` places of the profile, spreading each load along the tooth before it
    /// reaches the ring and each displacement on its way back.
    pub fn along_profile(&self, step_m: f64, places: &[ProfilePoint; NODES]) -> ProfileInfluence {
        let n = self.slices;
        let offsets = self.table.len() / (n * n);
        let chains = places.map(|place| {
            place.root_spread_m.map(|decay| {
                let mut chain = ToothChain::default();
                chain.prepare(step_m, std::iter::repeat_n(decay, n));
                chain
            })
        });
        let mut table = vec![[0.0; NODES * NODES]; self.table.len()];
        let mut loaded = vec![0.0; LOADS * n * n];
        let (mut forces, mut moments) = (vec![0.0; n], vec![0.0; n]);
        for k in 0..offsets {
            let raw = &self.table[k * n * n..(k + 1) * n * n];
            for b in 0..NODES {
                let load = &places[b].root_load.components;
                for i in 0..n {
                    for a in 0..LOADS {
                        for (j, entry) in raw[i * n..(i + 1) * n].iter().enumerate() {
                            (forces[j], moments[j]) = split(&entry[a * LOADS..(a + 1) * LOADS], load);
                        }
                        chains[b][0].spread(step_m, &mut forces);
                        chains[b][1].spread(step_m, &mut moments);
                        let target = &mut loaded[(a * n + i) * n..(a * n + i + 1) * n];
                        for ((t, f), m) in target.iter_mut().zip(&forces).zip(&moments) {
                            *t = f + m;
                        }
                    }
                }
                for a in 0..NODES {
                    let answer = &places[a].root_load.components;
                    for j in 0..n {
                        for i in 0..n {
                            let column: [f64; LOADS] = std::array::from_fn(|c| loaded[(c * n + i) * n + j]);
                            (forces[i], moments[i]) = split(&column, answer);
                        }
                        chains[a][0].spread(step_m, &mut forces);
                        chains[a][1].spread(step_m, &mut moments);
                        for i in 0..n {
                            table[(k * n + i) * n + j][a * NODES + b] = forces[i] + moments[i];
                        }
                    }
                }
            }
        }
        ProfileInfluence { slices: n, table }
    }
}

/// Parts of a contraction by forces (tangential, radial, axial) and by moments (moment, dipole).
fn split(row: &[f64], load: &[f64; LOADS]) -> (f64, f64) {
    (row[0] * load[0] + row[2] * load[2] + row[3] * load[3], row[1] * load[1] + row[4] * load[4])
}

/// Places of the profile between which the influence is interpolated (Chebyshev nodes, a polynomial through all).
pub const NODES: usize = 5;

/// Normal displacements per normal force of teeth and ring together, for every pair of slices and places of the profile:
/// all but the contact indentation.
#[derive(Debug, Clone, PartialEq)]
pub struct ProfileInfluence {
    slices: usize,
    table: Vec<[f64; NODES * NODES]>,
}

impl ProfileInfluence {
    /// Adds the tooth's own compliance above the ring (`coupling`) between all places of one tooth.
    pub fn add_tooth(&mut self, step_m: f64, places: &[ProfilePoint; NODES]) {
        let n = self.slices;
        let own = ToothModes::new(step_m, n, &places.map(|p| (p.line_compliance_m2_per_n, p.decay_length_m)));
        for (i, row) in self.table[..n * n].chunks_exact_mut(n).enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                own.add(i, j, entry);
            }
        }
    }

    /// Displacement at slice `i` from a force at slice `j`, both on one tooth (`offset` 0) or with the first `offset` pairs
    /// earlier in the mesh than the second; `wa` and `wb` are the interpolation weights of their places.
    #[cfg(test)]
    pub fn between(&self, offset: usize, i: usize, j: usize, wa: &[f64; NODES], wb: &[f64; NODES]) -> f64 {
        let entry = &self.table[(offset * self.slices + i) * self.slices + j];
        let mut sum = 0.0;
        for a in 0..NODES {
            let row = &entry[a * NODES..(a + 1) * NODES];
            let mut inner = 0.0;
            for b in 0..NODES {
                inner += row[b] * wb[b];
            }
            sum += wa[a] * inner;
        }
        sum
    }
}

impl ProfileInfluence {
    /// The same between two of the places themselves.
    pub fn entry(&self, offset: usize, (i, a): (usize, usize), (j, b): (usize, usize)) -> f64 {
        self.table[(offset * self.slices + i) * self.slices + j][a * NODES + b]
    }
}

impl Accumulator {
    fn new(basis: &WidthBasis, slices: usize) -> Accumulator {
        let size = basis.order + 1;
        let means = basis.slice_means(slices);
        let mut shapes = vec![0.0; size * slices];
        for i in 0..slices {
            for p in 0..size {
                shapes[p * slices + i] = means[i * size + p];
            }
        }
        Accumulator {
            slices,
            size,
            shapes,
            components: std::array::from_fn(|_| vec![0.0; slices * slices]),
            rows: Vec::new(),
        }
    }

    /// From width functions to slices.
    fn transform(&mut self, harmonic: &HarmonicFlexibility) {
        let n = self.slices;
        for c in &mut self.components {
            c.fill(0.0);
        }
        for (rows, block) in harmonic.rows.iter().zip(&harmonic.blocks) {
            let count = rows.len();
            self.rows.clear();
            self.rows.resize(count * 3 * n, 0.0);
            for r in 0..count {
                for (c, &(component, degree)) in rows.iter().enumerate() {
                    debug_assert!(degree < self.size);
                    let value = block[r * count + c];
                    let target = &mut self.rows[(r * 3 + component) * n..(r * 3 + component + 1) * n];
                    let shape = &self.shapes[degree * n..(degree + 1) * n];
                    for (t, s) in target.iter_mut().zip(shape) {
                        *t += value * s;
                    }
                }
            }
            for (r, &(component, degree)) in rows.iter().enumerate() {
                for other in 0..3 {
                    let source = &self.rows[(r * 3 + other) * n..(r * 3 + other + 1) * n];
                    let target = &mut self.components[component * 3 + other];
                    for i in 0..n {
                        let factor = self.shapes[degree * n + i];
                        for (t, s) in target[i * n..(i + 1) * n].iter_mut().zip(source) {
                            *t += factor * s;
                        }
                    }
                }
            }
        }
    }
}
