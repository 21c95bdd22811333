//! One position of the mesh: the points, their compliance, the distribution of the force.

use super::distribution::{Distribution, Problem, Stalled, Workspace, distribute};
use super::flank::Flank;
use super::hertz::LineContact;
use super::lines::{Point, Reach, collect};
use super::ring_influence::NODES;
use crate::gear::{Half, Pair};

/// Interpolation weights of one point on both members.
#[derive(Debug, Clone, Copy)]
struct Shapes([[f64; NODES]; 2]);

/// The loaded points of one position.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    pub points: Vec<Point>,
    /// Normal forces.
    pub forces_n: Vec<f64>,
    /// Loaded transmission error, along the transverse base tangent.
    pub approach_m: f64,
    /// dF_bt/dδ.
    pub stiffness_n_per_m: f64,
    pub iterations: u32,
}

impl Loaded {
    /// Force of pair `k` as a part of all forces.
    pub fn share(&self, k: i32) -> f64 {
        let of_pair: f64 = self.points.iter().zip(&self.forces_n).filter(|(p, _)| p.pair == k).map(|(_, f)| f).sum();
        of_pair / self.forces_n.iter().sum::<f64>()
    }
}

/// Why a position could not be solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Trouble {
    NoContact,
    Stalled(Stalled),
}

/// Solves positions one after the other, each from the one before.
pub struct Solver<'a> {
    pair: &'a Pair,
    half: Half,
    flanks: &'a [Flank; 2],
    slices: usize,
    corner_contact: bool,
    points: Vec<Point>,
    previous: Vec<(i32, usize, [u8; 2], f64)>,
    start: Vec<f64>,
    matrix: Vec<f64>,
    shapes: Vec<Shapes>,
    contacts: Vec<LineContact>,
    work: Workspace,
    /// Largest corner gap that was worth looking at so far.
    corner_gap_m: f64,
}

struct Assembled<'s> {
    matrix: &'s [f64],
    points: &'s [Point],
    contacts: &'s [LineContact],
    cos: f64,
}

impl Problem for Assembled<'_> {
    fn len(&self) -> usize {
        self.points.len()
    }
    fn compliance(&self) -> &[f64] {
        self.matrix
    }
    fn gap(&self, i: usize) -> f64 {
        self.points[i].gap_m * self.cos
    }
    fn local(&self, i: usize, force: f64) -> (f64, f64) {
        let per_force = self.cos / self.points[i].width_m;
        let (value, slope) = self.contacts[i].approach(force * per_force);
        (value, slope * per_force)
    }
}

impl<'a> Solver<'a> {
    pub fn new(pair: &'a Pair, half: Half, flanks: &'a [Flank; 2], slices: usize, corner_contact: bool) -> Solver<'a> {
        Solver {
            pair,
            half,
            flanks,
            slices,
            corner_contact,
            points: Vec::new(),
            previous: Vec::new(),
            start: Vec::new(),
            matrix: Vec::new(),
            shapes: Vec::new(),
            contacts: Vec::new(),
            work: Workspace::default(),
            corner_gap_m: 0.0,
        }
    }

    /// Distributes `force_bt_n` at `phase`. Pairs below `lowest_pair` stay out.
    pub fn solve(&mut self, phase: f64, lowest_pair: i32, force_bt_n: f64) -> Result<Loaded, Trouble> {
        let cos = self.pair.base_helix_angle_rad.cos();
        for _ in 0..8 {
            let reach = Reach { lowest_pair, corner_gap_m: if self.corner_contact { self.corner_gap_m } else { 0.0 } };
            let mut points = std::mem::take(&mut self.points);
            collect(self.pair, self.half, phase, self.slices, &reach, &mut points);
            self.points = points;
            if self.points.is_empty() {
                return Err(Trouble::NoContact);
            }
            self.assemble();
            let solved = self.distribute(force_bt_n / cos).map_err(Trouble::Stalled)?;
            let approach_m = solved.approach / cos;
            self.remember(&solved);
            if self.corner_contact && approach_m > self.corner_gap_m {
                self.corner_gap_m = 1.25 * approach_m;
                continue;
            }
            return Ok(Loaded {
                points: self.points.clone(),
                forces_n: solved.forces,
                approach_m,
                stiffness_n_per_m: solved.stiffness * cos * cos,
                iterations: solved.iterations,
            });
        }
        Err(Trouble::NoContact)
    }

    fn distribute(&mut self, total: f64) -> Result<Distribution, Stalled> {
        self.start.clear();
        for p in &self.points {
            let before = self.previous.iter().find(|q| (q.0, q.1, q.2) == (p.pair, p.slice, [p.zone, p.part]));
            self.start.push(before.map_or(0.0, |q| q.3));
        }
        let problem = Assembled {
            matrix: &self.matrix,
            points: &self.points,
            contacts: &self.contacts,
            cos: self.pair.base_helix_angle_rad.cos(),
        };
        distribute(&problem, total, Some(&self.start), &mut self.work)
    }

    fn remember(&mut self, solved: &Distribution) {
        self.previous.clear();
        self.previous
            .extend(self.points.iter().zip(&solved.forces).map(|(p, &f)| (p.pair, p.slice, [p.zone, p.part], f)));
    }

    /// Compliance matrix and local contacts of the current points.
    fn assemble(&mut self) {
        let pair = self.pair;
        let (e, nu) = (pair.material().youngs_modulus_pa, pair.material().poissons_ratio);
        let cos = pair.base_helix_angle_rad.cos();
        let n = self.points.len();
        self.shapes.clear();
        self.contacts.clear();
        for p in &self.points {
            let x = p.x_m.clamp(pair.path_start_m, pair.path_end_m);
            let other = pair.line_of_action_m - x;
            let on = [self.flanks[0].at(x), self.flanks[1].at(other)];
            self.shapes.push(Shapes([self.flanks[0].weights(x), self.flanks[1].weights(other)]));
            let radius = (x * other / pair.line_of_action_m / cos).max(1e-3 * pair.spec.normal_module_m);
            self.contacts.push(LineContact::new(e, nu, radius, on.map(|o| o.depth_m)));
        }
        self.matrix.clear();
        self.matrix.resize(n * n, 0.0);
        for a in 0..n {
            for b in 0..=a {
                let (p, q) = (&self.points[a], &self.points[b]);
                // Points come in the order of the pairs, so that the first is never the later one.
                let offset = (p.pair - q.pair) as usize;
                let mut sum = 0.0;
                for side in 0..2 {
                    let (fa, fb) = (&self.shapes[a].0[side], &self.shapes[b].0[side]);
                    sum += self.flanks[side].bulk.between(offset, p.slice, q.slice, fa, fb);
                }
                self.matrix[a * n + b] = sum;
            }
        }
        for a in 0..n {
            for b in 0..a {
                self.matrix[b * n + a] = self.matrix[a * n + b];
            }
        }
    }
}
