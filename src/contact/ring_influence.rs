//! Flexibility of a ring under the loads that its teeth hand to it: forces and moments distributed along the roots (Legendre
//! functions of the face, following the helix), on one tooth and between teeth some pitches apart.

use std::f64::consts::PI;

use super::annulus::arc_shapes;
use super::body::{Ring, RingSolver, WidthBasis};
use super::linalg::dot;

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

/// Kinds of root load: tangential force, moment / r_f (radial traction linear across the tooth), radial force, axial force.
pub const KINDS: usize = 4;

/// Displacements of root loads (conjugate to them) per root load: kinds times Legendre functions of the face.
#[derive(Debug, Clone, PartialEq)]
pub struct RingFlexibility {
    /// Functions of the face per kind.
    pub size: usize,
    /// One square row-major matrix over (kind, degree) per pitch between the teeth. Row: the tooth that is ahead in the mesh.
    pub offsets: Vec<Vec<f64>>,
}

/// Flexibilities of all harmonics: the low ones and every so many of the high ones are computed, the others interpolated
/// (cubic through four) in n times flexibility, which tends to the half-space's constant.
struct Harmonics {
    orders: Vec<f64>,
    computed: Vec<[Vec<f64>; 2]>,
    between: [Vec<f64>; 2],
}

/// Harmonics up to this one are all computed, the steps beyond grow by a quarter of the order.
const EVERY_HARMONIC: f64 = 5.0;

impl Harmonics {
    fn new(solver: &RingSolver, highest: u32) -> Harmonics {
        let mut orders = vec![0.0];
        let mut n = 0.0;
        while n < f64::from(highest) {
            n += if n < EVERY_HARMONIC { 1.0 } else { (n / 4.0).ceil() };
            orders.push(n);
        }
        let computed: Vec<_> = orders.iter().map(|&n| solver.flexibility(n)).collect();
        let between = computed[0].clone();
        Harmonics { orders, computed, between }
    }

    fn at(&mut self, n: u32) -> &[Vec<f64>; 2] {
        let n = f64::from(n);
        let above = self.orders.partition_point(|&o| o < n);
        if self.orders[above] == n {
            return &self.computed[above];
        }
        let first = above.saturating_sub(2).min(self.orders.len() - 4);
        let near = &self.orders[first..first + 4];
        let weights: [f64; 4] = std::array::from_fn(|a| {
            let others = (0..4).filter(|&b| b != a).map(|b| (n - near[b]) / (near[a] - near[b]));
            others.product::<f64>() * near[a] / n
        });
        for (parity, block) in self.between.iter_mut().enumerate() {
            block.fill(0.0);
            for (a, w) in weights.iter().enumerate() {
                for (value, x) in block.iter_mut().zip(&self.computed[first + a][parity]) {
                    *value += w * x;
                }
            }
        }
        &self.between
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

impl Twist {
    fn new(basis: &WidthBasis, width_m: f64, twist_per_m: f64, highest: u32) -> Twist {
        // The trapezoidal rule in the angle of a circle (Clenshaw-Curtis without its end corrections) would do as well; Gauss
        // points by Newton are exact for the products and resolve the highest wave.
        let half_turn = 0.5 * width_m * twist_per_m * f64::from(highest);
        let points = basis.order + 6 + (0.6 * half_turn).ceil() as usize;
        let size = basis.order + 1;
        let mut angles = Vec::with_capacity(points);
        let mut products = vec![0.0; size * (size + 1) / 2 * points];
        let mut values = vec![0.0; size];
        for (i, (x, w)) in gauss_legendre(points).into_iter().enumerate() {
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
        Twist { points, angles, products }
    }

    /// Fills `out[p * size + q]`: the integral with the cosine where p + q is even, with the sine where it is odd.
    fn at(&self, n: f64, size: usize, waves: &mut [Vec<f64>; 2], out: &mut [f64]) {
        for wave in waves.iter_mut() {
            wave.resize(self.points, 0.0);
        }
        for (i, angle) in self.angles.iter().enumerate() {
            let (s, c) = (n * angle).sin_cos();
            waves[0][i] = c;
            waves[1][i] = s;
        }
        let mut rows = self.products.chunks_exact(self.points);
        for p in 0..size {
            for q in 0..=p {
                let value = rows.next().map_or(0.0, |row| dot(row, &waves[(p + q) % 2]));
                out[p * size + q] = value;
                out[q * size + p] = value;
            }
        }
    }
}

/// Points and weights of the Gauss-Legendre rule on [-1, 1], by Newton's method.
fn gauss_legendre(points: usize) -> Vec<(f64, f64)> {
    let n = points as f64;
    (0..points)
        .map(|i| {
            let mut x = -(PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..20 {
                let (mut before, mut now) = (1.0, x);
                for k in 1..points {
                    let next = ((2 * k + 1) as f64 * x * now - k as f64 * before) / (k + 1) as f64;
                    (before, now) = (now, next);
                }
                slope = n * (x * now - before) / (x * x - 1.0);
                let step = now / slope;
                x -= step;
                if step.abs() < 1e-15 {
                    break;
                }
            }
            (x, 2.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

impl RingFlexibility {
    /// Flexibility over the functions of `basis`, for teeth up to `offsets` pitches apart.
    pub fn new(ring: &Ring, basis: &WidthBasis, layout: &ToothLayout, offsets: usize) -> RingFlexibility {
        let reach = ring.outer_radius_m * layout.root_helix_angle_rad.cos();
        let highest = (RING_WAVES_PER_MODULE.1 / layout.normal_module_m * reach).ceil().max(3.0) as u32;
        let solver = RingSolver::new(ring, basis);
        let mut harmonics = Harmonics::new(&solver, highest);
        let twist = Twist::new(basis, ring.face_width_m, layout.twist_per_m, highest);
        let size = basis.order + 1;
        let width = KINDS * size;
        // A load of unit phase e^{inψ} is i^τ times a real column: tangential displacements and the moment carry one i, the
        // sine of the twist carries -i. Their product takes the cosine or the sine of the angle between the teeth.
        let mut even = vec![vec![0.0; width * width]; offsets + 1];
        let mut work = Columns::new(size);
        let mut waves = [Vec::new(), Vec::new()];
        let mut twisted = vec![0.0; size * size];
        let pitch = 2.0 * PI / f64::from(layout.teeth);
        for n in 0..=highest {
            let weight = ring_weight(f64::from(n) / reach, layout.normal_module_m);
            if weight <= 0.0 {
                continue;
            }
            twist.at(f64::from(n), size, &mut waves, &mut twisted);
            work.multiply(&solver.rows, harmonics.at(n), &twisted, layout.side);
            let factor = weight * if n == 0 { 0.5 } else { 1.0 } / PI;
            let (uniform, linear) = arc_shapes(f64::from(n), layout.root_half_angle_rad);
            // (component, shape, τ) of the kinds.
            let kinds = [(1, uniform, 1i32), (0, -linear, 1), (0, uniform, 0), (2, uniform, 0)];
            for (k, target) in even.iter_mut().enumerate() {
                let (sin, cos) = (f64::from(n) * layout.side * k as f64 * pitch).sin_cos();
                for (a, &(ca, fa, ta)) in kinds.iter().enumerate() {
                    for (b, &(cb, fb, tb)) in kinds.iter().enumerate() {
                        let scale = factor * fa * fb;
                        for p in 0..size {
                            let source = &work.product[((ca * size + p) * 3 + cb) * size..][..size];
                            let row = &mut target[(a * size + p) * width + b * size..][..size];
                            let xa = sine(ca, p);
                            // i^d of even and of odd degrees.
                            let by = [0, 1].map(|q| scale * real_part(ta - tb + sine(cb, q) - xa, sin, cos));
                            for (pair, from) in row.chunks_mut(2).zip(source.chunks(2)) {
                                for ((r, s), f) in pair.iter_mut().zip(from).zip(by) {
                                    *r += f * s;
                                }
                            }
                        }
                    }
                }
            }
        }
        RingFlexibility { size, offsets: even }
    }
}

/// Whether degree `q` of component `c` takes the sine of the twist in the first block of the ring (in the second block it is
/// the reverse).
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

/// Ring flexibility of one harmonic between the functions of two teeth, without the angle between them.
struct Columns {
    size: usize,
    /// (component, degree; component, degree).
    product: Vec<f64>,
    half: Vec<f64>,
}

impl Columns {
    fn new(size: usize) -> Columns {
        Columns { size, product: vec![0.0; 9 * size * size], half: vec![0.0; size * size] }
    }

    /// Twists the flexibility `blocks` over `rows` from the ring's functions to the tooth's.
    fn multiply(&mut self, rows: &[Vec<(usize, usize)>; 2], blocks: &[Vec<f64>; 2], twisted: &[f64], side: f64) {
        let size = self.size;
        self.product.fill(0.0);
        for (parity, (rows, block)) in rows.iter().zip(blocks).enumerate() {
            let of = |c: usize| {
                let first = rows.partition_point(|r| r.0 < c);
                first..rows.partition_point(|r| r.0 <= c)
            };
            for ca in 0..3 {
                for cb in ca..3 {
                    for r in of(ca) {
                        // F times the twisted functions of the second tooth.
                        self.half[..size].fill(0.0);
                        for s in of(cb) {
                            let f = block[r * rows.len() + s];
                            let t = &twisted[rows[s].1 * size..][..size];
                            for (h, t) in self.half[..size].iter_mut().zip(t) {
                                *h += f * t;
                            }
                        }
                        let degree = rows[r].1;
                        for p in 0..size {
                            let xa = sine(ca, p);
                            let left = twisted[degree * size + p];
                            // The sine changes sign with the side, and between the blocks where only one column has it.
                            let by = [0, 1].map(|q| {
                                let xb = sine(cb, q);
                                if xa == xb {
                                    left
                                } else if parity == 0 {
                                    left * side
                                } else {
                                    -left * side
                                }
                            });
                            let target = &mut self.product[((ca * size + p) * 3 + cb) * size..][..size];
                            for (pair, from) in target.chunks_mut(2).zip(self.half.chunks(2)) {
                                for ((t, h), f) in pair.iter_mut().zip(from).zip(by) {
                                    *t += f * h;
                                }
                            }
                        }
                    }
                }
            }
        }
        for ca in 1..3 {
            for cb in 0..ca {
                for p in 0..size {
                    for q in 0..size {
                        self.product[((ca * size + p) * 3 + cb) * size + q] =
                            self.product[((cb * size + q) * 3 + ca) * size + p];
                    }
                }
            }
        }
    }
}
