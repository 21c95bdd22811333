//! Perturbations of a train, all at once: the linear equations in their complex modes, closed by the two meshes.
//!
//! Between events a perturbation obeys z′ = A z + Σ_j B_j g_j, where A is the damped, gyroscopic train closed with the
//! reference mesh stiffnesses and the mesh dampers, and g_j = (k_j(τ) − k_ref,j) s_j is what the mesh of a half adds
//! (in the gap −k_ref,j s_j, and less the damper that does not act). In the eigenvectors of A the free motion is known
//! at any time. The two g_j are polynomials through Gauss points (collocation): as many points per step as
//! the fastest mode requires for the tolerance.

use nalgebra::DMatrix;

use super::excitation::MAX_ORDER;
use super::expansion::ExcitationTerms;
use super::model::{ContactSide, DynamicModel};
use super::segment::Segment;
use super::train_modes::{TERMS, TrainModes};
use super::variation::Perturbation;
use crate::numerics::gauss::gauss_legendre_unit;

/// Longest step in scaled time of the fastest mode: the series then ends below rounding.
const LONGEST_STEP: f64 = 4.0;
/// Gauss points per step, fewest and most.
const FEWEST_POINTS: usize = 3;
const MOST_POINTS: usize = 10;
/// Collocation at Gauss points of the unit interval.
struct Collocation {
    nodes: Vec<f64>,
    weights: Vec<f64>,
    /// By power n: ∫_0^{c_i} (c_i − x)^n ℓ_l(x) dx with the Lagrange polynomials ℓ_l through the nodes, i by rows.
    integrals: Vec<Vec<f64>>,
    /// By power n: c_i^n.
    powers: Vec<Vec<f64>>,
}

impl Collocation {
    fn new<const P: usize>() -> Self {
        let rule: [(f64, f64); P] = gauss_legendre_unit();
        let (nodes, weights): (Vec<f64>, Vec<f64>) = rule.into_iter().unzip();
        let lagrange = |l: usize, x: f64| {
            (0..P).filter(|&m| m != l).map(|m| (x - nodes[m]) / (nodes[l] - nodes[m])).product::<f64>()
        };
        // Exact for the highest power.
        let fine: [(f64, f64); (TERMS + MOST_POINTS) / 2 + 1] = gauss_legendre_unit();
        let integral = |power: usize, i: usize, l: usize| {
            let c = nodes[i];
            let value = |x: f64| (1.0 - x).powi(power as i32) * lagrange(l, c * x);
            c.powi(power as i32 + 1) * fine.iter().map(|(x, weight)| weight * value(*x)).sum::<f64>()
        };
        let integrals = (0..=TERMS).map(|n| (0..P * P).map(|at| integral(n, at / P, at % P)).collect()).collect();
        let powers = (0..=TERMS).map(|n| nodes.iter().map(|c| c.powi(n as i32)).collect()).collect();
        Self { nodes, weights, integrals, powers }
    }

    fn points(&self) -> usize {
        self.nodes.len()
    }
}

static COLLOCATIONS: std::sync::LazyLock<[Collocation; MOST_POINTS - FEWEST_POINTS + 1]> =
    std::sync::LazyLock::new(|| {
        [
            Collocation::new::<3>(),
            Collocation::new::<4>(),
            Collocation::new::<5>(),
            Collocation::new::<6>(),
            Collocation::new::<7>(),
            Collocation::new::<8>(),
            Collocation::new::<9>(),
            Collocation::new::<10>(),
        ]
    });

/// Collocation with the fewest points whose quadrature error over a step of `span` of the fastest mode is within the
/// tolerance: (p!)⁴/((2p + 1) ((2p)!)³) span^(2p + 1).
fn collocation(span: f64, tolerance: f64) -> &'static Collocation {
    let error = |p: usize| {
        let mut error = span / (2 * p + 1) as f64;
        for m in 1..=p {
            error *= (m * m) as f64;
        }
        for m in 1..=p {
            error *= (m * m) as f64;
        }
        for m in 1..=2 * p {
            error *= span / (m as f64).powi(3);
        }
        error
    };
    let p = (FEWEST_POINTS..MOST_POINTS).find(|&p| error(p) <= tolerance).unwrap_or(MOST_POINTS);
    &COLLOCATIONS[p - FEWEST_POINTS]
}

/// Perturbations of a train, in its eigenvectors.
pub(super) struct TrainPropagator {
    z: DMatrix<f64>,
    tolerance: f64,
    terms: ExcitationTerms<f64>,
}

impl TrainPropagator {
    /// `columns`: perturbations without rigid-body modes.
    pub(super) fn new<const D: usize>(modes: &TrainModes, columns: &[Perturbation<D>], tolerance: f64) -> Self {
        let n = modes.coordinates();
        let states =
            DMatrix::from_fn(2 * n, columns.len(), |r, c| if r < n { columns[c].0[r] } else { columns[c].1[r - n] });
        // Rounding is far below this.
        Self { z: &modes.inverse * states, tolerance: tolerance.max(1e-14), terms: ExcitationTerms::new() }
    }

    /// The perturbations, over (displacements, velocities) of the elastic modes.
    pub(super) fn states(&self, modes: &TrainModes) -> DMatrix<f64> {
        &modes.vectors * &self.z
    }

    /// Adds the saltation of a change of contact: `force` N of the mesh of half `j` act for s_j/`speed`.
    pub(super) fn saltate(&mut self, modes: &TrainModes, j: usize, force: f64, speed: f64) {
        let s = modes.outputs.row(j) * &self.z;
        self.z.ger(force / speed, &modes.inputs.column(j), &s.transpose(), 1.0);
    }

    /// Propagates the perturbations over a segment of the motion.
    pub(super) fn segment<const D: usize>(
        &mut self,
        modes: &TrainModes,
        model: &DynamicModel<D>,
        segment: &Segment<'_, D>,
    ) {
        // A NaN length takes one step: the motion itself has diverged and reports it.
        let steps = (segment.h * modes.fastest / LONGEST_STEP).ceil().clamp(1.0, 1e4);
        let h = segment.h / steps;
        let order = segment.degree.clamp(12, MAX_ORDER);
        let interior = segment.phase + 0.5 * segment.h / model.period_tau;
        let points = collocation(h * modes.fastest, self.tolerance);
        for i in 0..steps as usize {
            model.expand_for_perturbations(segment, i as f64 * h, interior, order, &mut self.terms);
            self.step(modes, model, segment.contact, (order, h), points);
        }
    }

    fn step<const D: usize>(
        &mut self,
        modes: &TrainModes,
        model: &DynamicModel<D>,
        contact: [ContactSide; 2],
        (order, h): (usize, f64),
        points: &Collocation,
    ) {
        let p = points.points();
        let mut powers = [1.0; TERMS + 1];
        for term in 1..=TERMS {
            powers[term] = powers[term - 1] * h;
        }
        // g_j at node i = stiffness[p j + i] s_j + damping[j] s_j′.
        let mut stiffness = vec![0.0; 2 * p];
        let mut damping = [0.0; 2];
        for j in 0..2 {
            let closed = contact[j] != 0;
            let half = &model.halves[j];
            damping[j] = if closed { 0.0 } else { half.cm_in_gap - half.cm };
            for i in 0..p {
                let at = points.nodes[i] * h;
                let k = self.terms.stiffness[j][..=order].iter().rev().fold(0.0, |sum, c| sum * at + c);
                stiffness[p * j + i] = if closed { k } else { 0.0 } - modes.reference_stiffness[j];
            }
        }
        // Free motion of s_j, or of g_j with the rate, at the nodes: combinations of the rows of A^n/n!.
        let with_rate = damping != [0.0; 2];
        let combination = |j: usize, i: usize, term: usize| {
            let mut factor = stiffness[p * j + i] * points.powers[term][i] * powers[term];
            if with_rate && term > 0 {
                factor += damping[j] * term as f64 * points.powers[term - 1][i] * powers[term - 1];
            }
            factor
        };
        let rows = DMatrix::from_fn(2 * p, 2 * (TERMS + 1), |r, c| {
            if r / p == c % 2 { combination(r / p, r % p, c / 2) } else { 0.0 }
        });
        // (I − K) g = g_free.
        let mut system = DMatrix::<f64>::identity(2 * p, 2 * p);
        for j in 0..2 {
            for k in 0..2 {
                let response = &modes.responses[j][k];
                for i in 0..p {
                    for l in 0..p {
                        let mut s = 0.0;
                        let mut rate = 0.0;
                        for term in 0..=TERMS {
                            let integral = points.integrals[term][p * i + l];
                            s += response[term] * powers[term] * h * integral;
                            if with_rate && term > 0 {
                                // The response to an impulse begins at 0, so the rate is that of its derivative.
                                let before = points.integrals[term - 1][p * i + l];
                                rate += response[term] * term as f64 * powers[term - 1] * h * before;
                            }
                        }
                        system[(p * j + i, p * k + l)] -= stiffness[p * j + i] * s + damping[j] * rate;
                    }
                }
            }
        }
        let Some(solution) = system.try_inverse() else { return };
        let forces = (solution * (rows * &modes.outputs)) * &self.z;
        // End of the step: free motion, and the forces by Gauss quadrature.
        let inputs = DMatrix::from_fn(2 * (TERMS + 1), 2 * p, |r, c| {
            if r % 2 == c / p {
                // The nodes are symmetric: 1 − c_l is the node from the other end.
                let l = c % p;
                h * points.weights[l] * points.powers[r / 2][p - 1 - l] * powers[r / 2]
            } else {
                0.0
            }
        });
        let ends = &modes.inputs * inputs;
        modes.advance(h, &mut self.z);
        self.z.gemm(1.0, &ends, &forces, 1.0);
    }
}
