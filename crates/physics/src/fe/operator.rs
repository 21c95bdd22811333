//! Stiffness of a helical sector: section elements times functions along the face.
//!
//! The body is the section screwed along the axis, so in the frame that turns with the section nothing depends on the
//! axial place. With `u = Σ N_k(x, y) f_i(z) q` the stiffness between (node k, function i) and (node l, function j) is
//! `A00 ∫f g + A01 ∫f g' + A10 ∫f' g + A11 ∫f' g'` with 3 x 3 section integrals `A`: the derivative along the axis at a
//! fixed place is `∂_ζ + τ (e_z × · − (x ∂_y − y ∂_x))` there. Displacements are radial, tangential, axial at every
//! node, so that the cut faces of all sectors are alike.

use std::collections::BTreeMap;

use super::section::{Border, SectionMesh, shapes};
use super::spline::{SplineProducts, SplineSpace};
use crate::numerics::gauss::gauss_legendre;

/// Section integrals between two nodes, `[A00, A01, A10, A11]`, row-major.
type Coupling = [[f64; 9]; 4];

/// Material, twist and mesh of one sector.
pub(super) struct ElasticBody<'a> {
    /// Mesh of the transverse section.
    pub section: &'a SectionMesh,
    /// Young's modulus, Pa.
    pub youngs_pa: f64,
    /// Poisson's ratio.
    pub nu: f64,
    /// Turn per length, positive towards growing angle.
    pub twist_per_m: f64,
}

/// Unknowns and stiffness of one sector. A *point* is one function on one node's line: three unknowns.
pub(super) struct Operator {
    /// First point of every node's line, the held lines have none; one more than there are nodes.
    first: Vec<usize>,
    /// Node of every point.
    node: Vec<u32>,
    levels: Vec<u8>,
    spaces: Vec<SplineSpace>,
    products: Vec<SplineProducts>,
    couplings: Vec<Vec<(u32, Coupling)>>,
}

impl Operator {
    /// `levels` says which of `spaces` every node's line carries.
    pub(super) fn new(body: &ElasticBody, spaces: Vec<SplineSpace>, levels: Vec<u8>) -> Operator {
        let section = body.section;
        let mut first = vec![0];
        let mut node = Vec::new();
        for (k, border) in section.borders.iter().enumerate() {
            let count = if *border == Border::Held { 0 } else { spaces[usize::from(levels[k])].len() };
            node.extend(std::iter::repeat_n(k as u32, count));
            first.push(node.len());
        }
        let mut products = Vec::new();
        for a in &spaces {
            for b in &spaces {
                products.push(SplineProducts::new(a, b));
            }
        }
        let couplings = couplings(body);
        Operator { first, node, levels, spaces, products, couplings }
    }

    /// Number of points.
    pub(super) fn points(&self) -> usize {
        self.node.len()
    }

    /// Node and function of a point.
    pub(super) fn place(&self, point: usize) -> (usize, usize) {
        let node = self.node[point] as usize;
        (node, point - self.first[node])
    }

    /// Points of a node's line.
    pub(super) fn line(&self, node: usize) -> std::ops::Range<usize> {
        self.first[node]..self.first[node + 1]
    }

    /// Functions along the face at a node.
    pub(super) fn space(&self, node: usize) -> &SplineSpace {
        &self.spaces[usize::from(self.levels[node])]
    }

    /// Index of those functions among [`Operator::spaces`].
    pub(super) fn level(&self, node: usize) -> usize {
        usize::from(self.levels[node])
    }

    /// Function spaces along the face, finest first.
    pub(super) fn spaces(&self) -> &[SplineSpace] {
        &self.spaces
    }

    /// Calls `visit` with every point that `point` is coupled to (itself included) and gives access to the stiffness.
    pub(super) fn for_each_neighbour(&self, point: usize, mut visit: impl FnMut(usize, NodeBlock<'_>)) {
        let (node, function) = self.place(point);
        let level = self.level(node);
        for (other, coupling) in &self.couplings[node] {
            let other = *other as usize;
            let table = &self.products[level * self.spaces.len() + self.level(other)];
            let (from, row) = table.row(function);
            let base = self.first[other] + from;
            for (offset, along) in row.iter().enumerate() {
                visit(base + offset, NodeBlock { coupling, along });
            }
        }
    }
}

/// Stiffness between two points.
pub(super) struct NodeBlock<'a> {
    coupling: &'a Coupling,
    along: &'a [f64; 4],
}

impl NodeBlock<'_> {
    /// 3 x 3, row-major, rows of the point that was given.
    pub(super) fn values(&self) -> [f64; 9] {
        std::array::from_fn(|e| (0..4).map(|p| self.coupling[p][e] * self.along[p]).sum())
    }
}

/// Isotropic stiffness, Voigt order xx, yy, zz, xy, yz, zx (engineering shear).
fn stress(strain: &[f64; 6], lambda: f64, shear: f64) -> [f64; 6] {
    let volume = lambda * (strain[0] + strain[1] + strain[2]);
    [
        volume + 2.0 * shear * strain[0],
        volume + 2.0 * shear * strain[1],
        volume + 2.0 * shear * strain[2],
        shear * strain[3],
        shear * strain[4],
        shear * strain[5],
    ]
}

/// Points per direction of the section rule.
const RULE: usize = 3;

fn couplings(body: &ElasticBody) -> Vec<Vec<(u32, Coupling)>> {
    let section = body.section;
    let (e, nu) = (body.youngs_pa, body.nu);
    let lambda = e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let shear = e / (2.0 * (1.0 + nu));
    // Angles grow from y to x, against the sense of e_z.
    let tau = -body.twist_per_m;
    let rule = gauss_legendre(RULE);
    let mut rows: Vec<BTreeMap<u32, Coupling>> = vec![BTreeMap::new(); section.nodes.len()];
    for element in &section.elements {
        let frames = element.map(|node| {
            let node = &section.nodes[node];
            let r = node.x_m.hypot(node.y_m);
            (node.x_m / r, node.y_m / r)
        });
        let mut local = vec![[[0.0; 9]; 4]; 81];
        for &(v, wv) in &rule {
            for &(u, wu) in &rule {
                let (n, du, dv) = shapes(u, v);
                let (mut x, mut y, mut j) = (0.0, 0.0, [0.0; 4]);
                for (k, &node) in element.iter().enumerate() {
                    let node = &section.nodes[node];
                    x += n[k] * node.x_m;
                    y += n[k] * node.y_m;
                    j[0] += du[k] * node.x_m;
                    j[1] += du[k] * node.y_m;
                    j[2] += dv[k] * node.x_m;
                    j[3] += dv[k] * node.y_m;
                }
                let det = j[0] * j[3] - j[1] * j[2];
                let weight = wu * wv * det;
                // Strains of the three displacements of every node: without and with the axial derivative.
                let strains: [[[[f64; 6]; 3]; 2]; 9] = std::array::from_fn(|k| {
                    let nx = (j[3] * du[k] - j[1] * dv[k]) / det;
                    let ny = (j[0] * dv[k] - j[2] * du[k]) / det;
                    let n = n[k];
                    let turn = tau * (x * ny - y * nx);
                    // Columns: Cartesian x, y, z.
                    let still = [
                        [nx, 0.0, 0.0, ny, tau * n, -turn],
                        [0.0, ny, 0.0, nx, -turn, -tau * n],
                        [0.0, 0.0, -turn, 0.0, ny, nx],
                    ];
                    let moved =
                        [[0.0, 0.0, 0.0, 0.0, 0.0, n], [0.0, 0.0, 0.0, 0.0, n, 0.0], [0.0, 0.0, n, 0.0, 0.0, 0.0]];
                    let (s, c) = frames[k];
                    [still, moved].map(|part| {
                        let radial = std::array::from_fn(|i| s * part[0][i] + c * part[1][i]);
                        let tangential = std::array::from_fn(|i| c * part[0][i] - s * part[1][i]);
                        [radial, tangential, part[2]]
                    })
                });
                for (l, of_l) in strains.iter().enumerate() {
                    for (q, part) in of_l.iter().enumerate() {
                        for (d, strain) in part.iter().enumerate() {
                            let stress = stress(strain, lambda, shear).map(|s| s * weight);
                            for (k, of_k) in strains.iter().enumerate() {
                                for (p, rows) in of_k.iter().enumerate() {
                                    for (c, row) in rows.iter().enumerate() {
                                        let work: f64 = row.iter().zip(&stress).map(|(a, b)| a * b).sum();
                                        local[k * 9 + l][2 * p + q][3 * c + d] += work;
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
        for (k, &a) in element.iter().enumerate() {
            if section.borders[a] == Border::Held {
                continue;
            }
            for (l, &b) in element.iter().enumerate() {
                if section.borders[b] == Border::Held {
                    continue;
                }
                let entry = rows[a].entry(b as u32).or_insert([[0.0; 9]; 4]);
                for (e, v) in entry.iter_mut().flatten().zip(local[k * 9 + l].iter().flatten()) {
                    *e += v;
                }
            }
        }
    }
    rows.into_iter().map(|row| row.into_iter().collect()).collect()
}
