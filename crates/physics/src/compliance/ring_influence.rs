//! Flexibility of a ring under the loads that its teeth hand to it: forces and moments distributed along the roots
//! (Legendre functions of the face, following the helix), on one tooth and between teeth some pitches apart.

use std::f64::consts::PI;

use super::annulus::arc_shapes;
use super::ring::{Ring, RingSolver, WidthBasis};
use crate::numerics::dense::{add_product, dot};
use crate::numerics::gauss::gauss_legendre_nodes;
use crate::simd::vectorised;
use crate::watch::{Canceled, Meter, Watch};

/// Waves across the tooth longer than the first (in multiples of the normal module per radian) belong wholly to the
/// ring, shorter than the second wholly to the tooth's own root; between them they share. A tooth pitch is π m_n, so
/// that neighbouring teeth feel each other through the ring alone.
const RING_WAVES_PER_MODULE: (f64, f64) = (0.8, 1.8);

/// Share of the ring model at a wave number (rad/m) across the tooth.
pub(super) fn ring_weight(wave_per_m: f64, normal_module_m: f64) -> f64 {
    let (low, high) = RING_WAVES_PER_MODULE;
    let t = ((wave_per_m * normal_module_m - low) / (high - low)).clamp(0.0, 1.0);
    0.5 * (1.0 + (PI * t).cos())
}

/// Arrangement of the teeth on the ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ToothLayout {
    /// Number of teeth.
    pub teeth: u32,
    /// Half angle of a tooth at the root circle.
    pub root_half_angle_rad: f64,
    /// Turn of the tooth per length of face, tanβ_b / r_b.
    pub twist_per_m: f64,
    /// Helix angle at the root circle.
    pub root_helix_angle_rad: f64,
    /// Normal module.
    pub normal_module_m: f64,
    /// +1 pinion, -1 gear: sign of the axial force and, reversed, of the angles along the direction of the force.
    pub side: f64,
}

/// Kinds of root load: tangential force, moment / r_f (radial traction linear across the tooth), radial force, axial
/// force.
pub(super) const KINDS: usize = 4;

/// Displacements of root loads (conjugate to them) per root load: kinds times Legendre functions of the face.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct RingFlexibility {
    /// Functions of the face per kind.
    pub size: usize,
    /// One square row-major matrix over (kind, degree) per pitch between the teeth. Row: the tooth that is ahead in the
    /// mesh.
    pub offsets: Vec<Vec<f64>>,
}

/// Flexibilities of all harmonics: the low ones and every so many of the high ones are computed, the others
/// interpolated (cubic through four) in n times flexibility, which tends to the half-space's constant.
struct Harmonics {
    orders: Vec<f64>,
    computed: Vec<[Vec<f64>; 2]>,
    between: [Vec<f64>; 2],
}

/// Harmonics up to this one are all computed, the steps beyond grow by a third of the order.
const EVERY_HARMONIC: f64 = 4.0;

impl Harmonics {
    fn new(solver: &RingSolver, highest: u32, watch: Watch) -> Result<Harmonics, Canceled> {
        let mut orders = vec![0.0];
        let mut n = 0.0;
        while n < f64::from(highest) {
            n += if n < EVERY_HARMONIC { 1.0 } else { (n / 3.0).ceil() };
            orders.push(n);
        }
        let flexibility = |&n: &f64| {
            watch.checkpoint_quietly()?;
            Ok(solver.flexibility(n))
        };
        let computed: Vec<_> = orders.iter().map(flexibility).collect::<Result<_, Canceled>>()?;
        let between = computed[0].clone();
        Ok(Harmonics { orders, computed, between })
    }

    /// Sets `between` to harmonic `n`.
    #[inline(always)]
    fn set(&mut self, n: u32) {
        let n = f64::from(n);
        let above = self.orders.partition_point(|&o| o < n);
        if self.orders[above] == n {
            self.between.clone_from(&self.computed[above]);
            return;
        }
        let first = above.saturating_sub(2).min(self.orders.len() - 4);
        let near = &self.orders[first..first + 4];
        for block in &mut self.between {
            block.fill(0.0);
        }
        for a in 0..4 {
            let mut weight = near[a] / n;
            for b in (0..4).filter(|&b| b != a) {
                weight *= (n - near[b]) / (near[a] - near[b]);
            }
            for (block, source) in self.between.iter_mut().zip(&self.computed[first + a]) {
                block.iter_mut().zip(source).for_each(|(value, x)| *value += weight * x);
            }
        }
    }
}

/// Load columns of one harmonic: degree of the tooth by degree of the ring, ∫ P_p P_q cos or sin of the twist.
struct Twist {
    points: usize,
    /// Angle of the tooth at the points per harmonic, from the middle of the face.
    angles: Vec<f64>,
    /// Weighted products P_p P_q at the points: (p, q ≤ p).
    products: Vec<f64>,
}

/// Points for functions up to the degree `order` and a highest wave that turns by `half_turn` radians from the middle
/// of the face to its ends.
fn twist_points(order: usize, half_turn: f64) -> usize {
    order + 6 + (0.6 * half_turn).ceil() as usize
}

/// Memory of the flexibility of a ring of `face_modules` normal modules under teeth up to `offsets` pitches apart, over
/// functions up to the degree `order`: what is kept, and what is there in between besides.
pub(super) fn ring_bytes(order: usize, face_modules: f64, helix_angle_rad: f64, offsets: f64) -> (f64, f64) {
    let size = (order + 1) as f64;
    let kept = 8.0 * (offsets + 1.0) * (KINDS as f64 * size).powi(2);
    // Root radius over base radius: below 1.2 with pressure angles up to 35°.
    let half_turn = 0.5 * RING_WAVES_PER_MODULE.1 * face_modules * helix_angle_rad.sin() * 1.2;
    let twist = 8.0 * 0.5 * size * (size + 1.0) * twist_points(order, half_turn) as f64;
    // Elements: three matrices of both parities over three nodes and three components, of twenty radial elements.
    let elements = 8.0 * 20.0 * 6.0 * (3.0 * 1.5 * size).powi(2);
    (kept, twist + elements)
}

/// Multiplications per point of a node of the quadrature (some Newton steps, a division each), and per sine and cosine.
const NODE_OPERATIONS: usize = 20;

impl Twist {
    fn new(
        basis: &WidthBasis,
        width_m: f64,
        twist_per_m: f64,
        highest: u32,
        meter: &mut Meter,
    ) -> Result<Twist, Canceled> {
        // Enough points for the products of the functions and for the highest wave.
        let points = twist_points(basis.order, 0.5 * width_m * twist_per_m * f64::from(highest));
        let size = basis.order + 1;
        let mut angles = Vec::with_capacity(points);
        let mut products = vec![0.0; size * (size + 1) / 2 * points];
        let mut values = vec![0.0; size];
        for (i, (x, w)) in gauss_legendre_nodes(points).map(|(x, w)| (-x, w)).enumerate() {
            meter.count(NODE_OPERATIONS * points)?;
            angles.push(0.5 * width_m * x * twist_per_m);
            basis.values(0.5 * width_m * (1.0 + x), &mut values);
            let mut row = 0;
            for p in 0..size {
                for q in 0..=p {
                    products[row * points + i] = 0.5 * width_m * w * values[p] * values[q];
                    row += 1;
                }
            }
        }
        Ok(Twist { points, angles, products })
    }

    /// Multiplications of [`Self::at`].
    fn operations(&self) -> usize {
        self.products.len() + NODE_OPERATIONS * self.points
    }

    /// Fills `out`: for even and odd degrees p of the ring, rows over the sorted degrees q of the tooth; the integral
    /// with the cosine where p + q is even, with the sine where it is odd.
    #[inline(always)]
    fn at(&self, n: f64, sorted: ParityOrder, waves: &mut [Vec<f64>; 2], out: &mut [Vec<f64>; 2]) {
        for wave in waves.iter_mut() {
            wave.resize(self.points, 0.0);
        }
        for (i, angle) in self.angles.iter().enumerate() {
            let (s, c) = (n * angle).sin_cos();
            waves[0][i] = c;
            waves[1][i] = s;
        }
        let size = sorted.size;
        let mut rows = self.products.chunks_exact(self.points);
        for p in 0..size {
            for q in 0..=p {
                let value = rows.next().map_or(0.0, |row| dot(row, &waves[(p + q) % 2]));
                out[p % 2][p / 2 * size + sorted.place(q)] = value;
                out[q % 2][q / 2 * size + sorted.place(p)] = value;
            }
        }
    }
}

/// Degrees 0..size with the even ones first; matrices over them in four blocks (even and odd rows by even and odd
/// columns).
#[derive(Debug, Clone, Copy)]
struct ParityOrder {
    size: usize,
}

impl ParityOrder {
    fn count(self, parity: usize) -> usize {
        (self.size + 1 - parity) / 2
    }

    fn place(self, degree: usize) -> usize {
        degree / 2 + if degree % 2 == 1 { self.count(0) } else { 0 }
    }

    /// Range of the block of rows and columns of these parities.
    fn block(self, rows: usize, columns: usize) -> std::ops::Range<usize> {
        let start = rows * self.count(0) * self.size + columns * self.count(rows) * self.count(0);
        start..start + self.count(rows) * self.count(columns)
    }
}

impl RingFlexibility {
    /// Flexibility over the functions of `basis`, for teeth up to `offsets` pitches apart.
    ///
    /// # Errors
    /// [`Canceled`].
    pub(super) fn new(
        ring: &Ring,
        basis: &WidthBasis,
        layout: &ToothLayout,
        offsets: usize,
        watch: Watch,
    ) -> Result<RingFlexibility, Canceled> {
        let mut meter = Meter::new(watch);
        let reach = ring.outer_radius_m * layout.root_helix_angle_rad.cos();
        let highest = (RING_WAVES_PER_MODULE.1 / layout.normal_module_m * reach).ceil().max(3.0) as u32;
        let solver = RingSolver::new(ring, basis);
        let mut harmonics = Harmonics::new(&solver, highest, watch)?;
        let twist = Twist::new(basis, ring.face_width_m, layout.twist_per_m, highest, &mut meter)?;
        let mut sum = HarmonicSum::new(basis, twist);
        let sorted = ParityOrder { size: basis.order + 1 };
        let mut offsets = vec![vec![0.0; (KINDS * sorted.size).pow(2)]; offsets + 1];
        vectorised(
            #[inline(always)]
            || {
                for n in 0..=highest {
                    let weight = ring_weight(f64::from(n) / reach, layout.normal_module_m);
                    if weight > 0.0 {
                        harmonics.set(n);
                        meter.count(sum.operations())?;
                        sum.add((n, weight), &harmonics.between, &solver.rows, layout, &mut offsets, &mut meter)?;
                    }
                }
                Ok(())
            },
        )?;
        // One after the other, so that both forms of all of them are never there at once.
        for offset in &mut offsets {
            meter.count(offset.len())?;
            *offset = natural(offset, sorted);
        }
        Ok(RingFlexibility { size: sorted.size, offsets })
    }
}

/// From blocks by kind and parity to one matrix over (kind, degree).
fn natural(blocks: &[f64], sorted: ParityOrder) -> Vec<f64> {
    let size = sorted.size;
    let width = KINDS * size;
    let mut out = vec![0.0; width * width];
    for (ab, matrix) in blocks.chunks_exact(size * size).enumerate() {
        for p in 0..size {
            for q in 0..size {
                let block = &matrix[sorted.block(p % 2, q % 2)];
                out[(ab / KINDS * size + p) * width + ab % KINDS * size + q] =
                    block[p / 2 * sorted.count(q % 2) + q / 2];
            }
        }
    }
    out
}

/// 1 where degree `q` of component `c` takes the sine of the twist in the first block of the ring (in the second block
/// it is the reverse).
fn sine(c: usize, q: usize) -> i32 {
    ((usize::from(c == 2) + q) % 2) as i32
}

/// Real part of i^d e^{-iφ}.
fn real_part(d: i32, sin: f64, cos: f64) -> f64 {
    match d.rem_euclid(4) {
        0 => cos,
        1 => sin,
        2 => -cos,
        _ => -sin,
    }
}

/// Adds up the harmonics in the functions of the teeth.
///
/// A load of unit phase e^{inψ} is i^τ times a real column: tangential displacements and the moment carry one i, the
/// sine of the twist carries -i. The product of two columns takes the cosine or the sine of the angle between the
/// teeth.
struct HarmonicSum {
    sorted: ParityOrder,
    twist: Twist,
    waves: [Vec<f64>; 2],
    twisted: [Vec<f64>; 2],
    half: Vec<f64>,
    /// Per block of the ring: flexibility between the sorted functions of two teeth.
    products: [Vec<f64>; 2],
    /// (component, component), in blocks by parity, without the angle between the teeth.
    components: Vec<f64>,
}

impl HarmonicSum {
    fn new(basis: &WidthBasis, twist: Twist) -> HarmonicSum {
        let sorted = ParityOrder { size: basis.order + 1 };
        let size = sorted.size;
        HarmonicSum {
            sorted,
            twist,
            waves: [Vec::new(), Vec::new()],
            twisted: [0, 1].map(|parity| vec![0.0; sorted.count(parity) * size]),
            half: Vec::new(),
            products: [vec![0.0; size * size], vec![0.0; size * size]],
            components: vec![0.0; 9 * size * size],
        }
    }

    #[inline(always)]
    fn add(
        &mut self,
        (n, weight): (u32, f64),
        flexibility: &[Vec<f64>; 2],
        rows: &[Vec<(usize, usize)>; 2],
        layout: &ToothLayout,
        offsets: &mut [Vec<f64>],
        meter: &mut Meter,
    ) -> Result<(), Canceled> {
        let n = f64::from(n);
        self.twist.at(n, self.sorted, &mut self.waves, &mut self.twisted);
        self.multiply(flexibility, rows, layout.side);
        let area = self.sorted.size.pow(2);
        let factor = weight * if n == 0.0 { 0.5 } else { 1.0 } / PI;
        let (uniform, linear) = arc_shapes(n, layout.root_half_angle_rad);
        // (component, shape, τ) of the kinds.
        let kinds = [(1, uniform, 1i32), (0, -linear, 1), (0, uniform, 0), (2, uniform, 0)];
        let pitch = 2.0 * PI / f64::from(layout.teeth);
        for (k, target) in offsets.iter_mut().enumerate() {
            meter.count(target.len())?;
            let (sin, cos) = (n * layout.side * k as f64 * pitch).sin_cos();
            for (a, &(ca, fa, ta)) in kinds.iter().enumerate() {
                for (b, &(cb, fb, tb)) in kinds.iter().enumerate() {
                    let source = &self.components[(ca * 3 + cb) * area..][..area];
                    let target = &mut target[(a * KINDS + b) * area..][..area];
                    for p in 0..2 {
                        for q in 0..2 {
                            let d = ta - tb + sine(cb, q) - sine(ca, p);
                            let scale = factor * fa * fb * real_part(d, sin, cos);
                            let block = self.sorted.block(p, q);
                            for (t, s) in target[block.clone()].iter_mut().zip(&source[block]) {
                                *t += scale * s;
                            }
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Multiplications of [`Self::add`] before the offsets.
    fn operations(&self) -> usize {
        self.twist.operations() + 6 * self.sorted.size.pow(3)
    }

    /// Twists the flexibility over `rows` from the ring's functions to the teeth's.
    #[inline(always)]
    fn multiply(&mut self, flexibility: &[Vec<f64>; 2], rows: &[Vec<(usize, usize)>; 2], side: f64) {
        let sorted = self.sorted;
        let size = sorted.size;
        for ca in 0..3 {
            for cb in ca..3 {
                for parity in 0..2 {
                    // Rows of a component in this block of the ring: every other degree.
                    let [pa, pb] = [ca, cb].map(|c| (parity + usize::from(c == 2)) % 2);
                    let [first_a, first_b] = [ca, cb].map(|c| rows[parity].partition_point(|r| r.0 < c));
                    let width = rows[parity].len();
                    let (na, nb) = (sorted.count(pa), sorted.count(pb));
                    self.half.clear();
                    self.half.resize(na * size, 0.0);
                    for (r, half) in self.half.chunks_exact_mut(size).enumerate() {
                        let source = &flexibility[parity][(first_a + r) * width + first_b..][..nb];
                        for (f, t) in source.iter().zip(self.twisted[pb].chunks_exact(size)) {
                            half.iter_mut().zip(t).for_each(|(h, t)| *h += f * t);
                        }
                    }
                    self.products[parity].fill(0.0);
                    if na > 0 {
                        add_product(&mut self.products[parity], 1.0, &self.twisted[pa], &self.half, na);
                    }
                }
                let ahead = (ca * 3 + cb) * size * size;
                let mirrored = (cb * 3 + ca) * size * size;
                for p in 0..2 {
                    for q in 0..2 {
                        // The sine changes sign with the side, and between the blocks where only one column has it.
                        let sign = if sine(ca, p) == sine(cb, q) { [1.0, 1.0] } else { [side, -side] };
                        let (block, turned) = (sorted.block(p, q).start, sorted.block(q, p).start);
                        let (np, nq) = (sorted.count(p), sorted.count(q));
                        for i in 0..np {
                            let from = (p * sorted.count(0) + i) * size + q * sorted.count(0);
                            for j in 0..nq {
                                let value = sign[0] * self.products[0][from + j] + sign[1] * self.products[1][from + j];
                                self.components[ahead + block + i * nq + j] = value;
                                self.components[mirrored + turned + j * np + i] = value;
                            }
                        }
                    }
                }
            }
        }
    }
}
