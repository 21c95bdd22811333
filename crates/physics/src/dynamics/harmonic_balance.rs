//! Periodic motion of a train in contact by harmonic balance.
//!
//! Without loss of contact everything but the two mesh forces is linear. The displacements s of the meshes are Fourier
//! series over the mesh period; the force that a mesh adds to its reference stiffness is evaluated at samples of the
//! period, and the train returns each of its harmonics by a frequency response, a sum over the complex modes
//! ([`TrainModes`]). Unknown are the samples of the two s alone, whatever the number of coordinates. They are found by
//! Newton's method, its linear systems by products alone ([`gmres`]) (T. M. Cameron, J. H. Griffin: An alternating
//! frequency/time method, J. Appl. Mech. 56 (1989) 149, doi:10.1115/1.3176036).

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use nalgebra::Complex;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

use super::excitation::ImpactWaveform;
use super::model::{ContactSide, DynamicModel, MotionState};
use super::train_equations::TrainEquations;
use super::train_modes::{Pole, TrainModes};
use super::variation::Perturbation;
use crate::numerics::gmres::gmres;

type C64 = Complex<f64>;

/// Samples of the period, fewest and most; powers of two.
const FEWEST_SAMPLES: usize = 64;
const MOST_SAMPLES: usize = 1024;
/// Longest mesh period in scaled time: beyond it the harmonics do not reach the fastest modes.
const LONGEST_PERIOD: f64 = 2000.0;
/// Steps of Newton's method, and products per step.
const MOST_STEPS: usize = 12;
const MOST_PRODUCTS: usize = 60;
/// Relative change of s at which Newton's method ends.
const CONVERGED: f64 = 1e-13;
/// Loop gain up to which a motion counts as stable: the sampled frequencies miss a little of the largest.
const STABLE_GAIN: f64 = 0.95;

/// Harmonic balance of a model.
pub(crate) struct HarmonicBalance<'m, const D: usize> {
    model: &'m DynamicModel<D>,
    train: &'m TrainEquations<D>,
    modes: &'m TrainModes,
    poles: Vec<Pole>,
    /// Rates of the components per force: normal to each mesh, opening it, and of the torsional impact of each half.
    normal: [Vec<C64>; 2],
    torsional: [Vec<C64>; 2],
    /// Factors of the components in s of each mesh.
    s: [Vec<C64>; 2],
}

/// A periodic motion as Fourier series.
pub(crate) struct HarmonicOrbit<const D: usize> {
    /// State at the start of the mesh period.
    pub start: MotionState<D>,
    /// Complex amplitudes of the forces by mesh order from 0: what the meshes and impacts along them add to k_ref s,
    /// and the torsional impacts, N.
    normal: [Vec<C64>; 2],
    torsional: [Vec<C64>; 2],
    /// Largest deviation of the tangent stiffness of each mesh from its reference stiffness, N/m.
    deviation: [f64; 2],
}

impl<'m, const D: usize> HarmonicBalance<'m, D> {
    /// None for anything but a train, where its complex modes are nearly dependent or do not decay, and for mesh
    /// periods that are too long.
    pub(crate) fn new(model: &'m DynamicModel<D>) -> Option<Self> {
        let train = model.train.as_deref()?;
        if model.period_tau.is_nan() || model.period_tau > LONGEST_PERIOD {
            return None;
        }
        let modes = model.train_modes()?;
        let poles = modes.poles();
        if !poles.iter().all(|pole| pole.value.re < 0.0) {
            return None;
        }
        let opening = |j: usize| modes.excitation(&train.mesh_acceleration[j].map(|a| -a));
        let normal = [opening(0), opening(1)];
        let torsional = if model.impact_along == 0.0 {
            [Vec::new(), Vec::new()]
        } else {
            [0, 1].map(|j| modes.excitation(&train.torsion_acceleration[j]))
        };
        let s = [0, 1].map(|j| modes.observation(&train.mesh[j]));
        Some(Self { model, train, modes, poles, normal, torsional, s })
    }

    /// The periodic motion on the flanks that `near` touches; samples are doubled until the start changes by less than
    /// `tolerance` of its velocity. None where it loses contact or is not found.
    pub(crate) fn solve(&self, near: &MotionState<D>, tolerance: f64) -> Option<HarmonicOrbit<D>> {
        let sides = near.contact.map(ContactSide::signum);
        if sides.contains(&0) {
            return None;
        }
        let mut planner = RealFftPlanner::new();
        let mut samples = FEWEST_SAMPLES;
        let mut s = [0, 1].map(|j| vec![self.model.s(j, &near.x); samples]);
        let mut coarser: Option<HarmonicOrbit<D>> = None;
        let mut gains = Vec::new();
        loop {
            let grid = Grid::new(self, samples, gains, &mut planner);
            let (normal, deviation) = grid.solve(&mut s)?;
            if !grid.keeps_contact(&s, sides) {
                return None;
            }
            let start = self.start(near, &s, [&normal, &grid.torsional]);
            let orbit = HarmonicOrbit { start, normal, torsional: grid.torsional.clone(), deviation };
            let done = coarser.is_some_and(|coarser| change(&coarser.start, &orbit.start) < tolerance);
            if done || samples == MOST_SAMPLES {
                return Some(orbit);
            }
            coarser = Some(orbit);
            s = s.map(|s| grid.refined(&s, &mut planner));
            gains = grid.gains;
            samples *= 2;
        }
    }

    /// State at the phase 0 from the amplitudes of normal and torsional forces.
    fn start(
        &self,
        near: &MotionState<D>,
        s: &[Vec<f64>; 2],
        [normal, torsional]: [&[Vec<C64>; 2]; 2],
    ) -> MotionState<D> {
        let mut components = vec![C64::ZERO; self.poles.len()];
        for order in 0..normal[0].len() {
            let omega = TAU * order as f64 / self.model.period_tau;
            for (m, pole) in self.poles.iter().enumerate() {
                let forced = self.forced(m, [normal, torsional], order);
                components[m] += forced.0 / (C64::new(0.0, omega) - pole.value);
                if order > 0 {
                    components[m] += forced.1 / (C64::new(0.0, -omega) - pole.value);
                }
            }
        }
        let elastic = self.train.elastic;
        let state = self.modes.state(&components);
        let mut start = MotionState { period: 0, phase: 0.0, ..*near };
        start.x[..elastic].copy_from_slice(&self.train.static_load_state()[..elastic]);
        for c in 0..elastic {
            start.x[c] += state[c];
            start.v[c] = state[elastic + c];
        }
        for j in 0..2 {
            start.contact[j] = self.model.contact_of(j, s[j][0], 0.0);
        }
        start
    }

    /// Rate of component `m` by the forces of an order, and of the conjugate order.
    fn forced(&self, m: usize, [normal, torsional]: [&[Vec<C64>; 2]; 2], order: usize) -> (C64, C64) {
        let (mut up, mut down) = (C64::ZERO, C64::ZERO);
        for j in 0..2 {
            up += self.normal[j][m] * normal[j][order];
            down += self.normal[j][m] * normal[j][order].conj();
            if let (Some(rate), Some(force)) = (self.torsional[j].get(m), torsional[j].get(order)) {
                up += rate * force;
                down += rate * force.conj();
            }
        }
        (up, down)
    }

    /// Frequency response at `omega` in scaled time: rows of the observations, columns of the excitations.
    fn response(&self, omega: f64, residues: &[Vec<C64>], out: &mut [C64]) {
        out.fill(C64::ZERO);
        for (m, pole) in self.poles.iter().enumerate() {
            let up = (C64::new(0.0, omega) - pole.value).inv();
            let (up, down) = if pole.paired {
                (0.5 * up, 0.5 * (C64::new(0.0, omega) - pole.value.conj()).inv())
            } else {
                (up, C64::ZERO)
            };
            for (sum, residue) in out.iter_mut().zip(residues) {
                let residue = residue[m];
                *sum += residue * up + residue.conj() * down;
            }
        }
    }

    /// Products of the observations with the excitations, by component: row by row.
    fn residues(observed: &[&[C64]], excited: &[&[C64]]) -> Vec<Vec<C64>> {
        let product = |a: &[C64], b: &[C64]| a.iter().zip(b).map(|(a, b)| a * b).collect();
        observed.iter().flat_map(|row| excited.iter().map(|column| product(row, column))).collect()
    }

    /// Whether perturbations of the orbit decay by the small-gain theorem: what the deviations of the tangent
    /// stiffnesses feed back through the train returns smaller at every frequency (C. A. Desoer, M. Vidyasagar:
    /// Feedback Systems, Academic Press 1975, doi:10.1137/1.9780898719055, chapter III). Sufficient, not necessary.
    pub(crate) fn is_surely_stable(&self, orbit: &HarmonicOrbit<D>) -> bool {
        let residues = Self::residues(&[&self.s[0], &self.s[1]], &[&self.normal[0], &self.normal[1]]);
        let weight = |r: usize, c: usize| (orbit.deviation[r] * orbit.deviation[c]).sqrt();
        let gain = |omega: f64| {
            let mut g = [C64::ZERO; 4];
            self.response(omega, &residues, &mut g);
            let g = [g[0] * weight(0, 0), g[1] * weight(0, 1), g[2] * weight(1, 0), g[3] * weight(1, 1)];
            let squares: f64 = g.iter().map(|g| g.norm_sqr()).sum();
            let determinant = (g[0] * g[3] - g[1] * g[2]).norm_sqr();
            (0.5 * (squares + (squares * squares - 4.0 * determinant).max(0.0).sqrt())).sqrt()
        };
        // The response has its largest values near the poles.
        let about = |pole: &Pole| [-1.0, -0.5, 0.0, 0.5, 1.0].map(|part| pole.value.im + part * pole.value.re);
        std::iter::once(0.0).chain(self.poles.iter().flat_map(about)).all(|omega| gain(omega) < STABLE_GAIN)
    }

    /// RMS of the circumferential acceleration of each mesh and of the axial acceleration of each half of the pinion,
    /// m/s².
    pub(crate) fn rms_accelerations_m_s2(&self, orbit: &HarmonicOrbit<D>) -> [[f64; 2]; 2] {
        let axial = [&self.train.displacements[1], &self.train.displacements[7]];
        let rows = [&self.train.mesh_x[0], &self.train.mesh_x[1], axial[0], axial[1]];
        let observed = rows.map(|row| self.modes.observation(row));
        let observed: Vec<&[C64]> = observed.iter().map(Vec::as_slice).collect();
        let excited: Vec<&[C64]> =
            self.normal.iter().chain(&self.torsional).map(Vec::as_slice).filter(|c| !c.is_empty()).collect();
        let residues = Self::residues(&observed, &excited);
        let mut response = vec![C64::ZERO; residues.len()];
        let mut squares = [0.0; 4];
        for order in 1..orbit.normal[0].len() {
            let omega = TAU * order as f64 / self.model.period_tau;
            self.response(omega, &residues, &mut response);
            let forces = orbit.normal.iter().chain(&orbit.torsional).filter_map(|force| force.get(order));
            let forces: Vec<C64> = forces.copied().collect();
            for (square, row) in squares.iter_mut().zip(response.chunks(excited.len())) {
                let displacement: C64 = row.iter().zip(&forces).map(|(g, f)| g * f).sum();
                *square += 2.0 * displacement.norm_sqr() * omega.powi(4);
            }
        }
        let unit = self.model.omega_ref * self.model.omega_ref;
        let rms = squares.map(|square| square.sqrt() * unit);
        [[rms[0], rms[1]], [rms[2], rms[3]]]
    }

    /// Correction of the start of a motion that ends after a mesh period with `defect`, end − start, by the free motion
    /// with the reference stiffnesses.
    pub(crate) fn correction(&self, defect: &Perturbation<D>) -> Perturbation<D> {
        let elastic = self.train.elastic;
        let mut components = self.modes.components(&defect.0[..elastic], &defect.1[..elastic]);
        for (component, pole) in components.iter_mut().zip(&self.poles) {
            *component /= C64::new(1.0, 0.0) - (pole.value * self.model.period_tau).exp();
        }
        let state = self.modes.state(&components);
        let (mut x, mut v) = ([0.0; D], [0.0; D]);
        x[..elastic].copy_from_slice(&state.as_slice()[..elastic]);
        v[..elastic].copy_from_slice(&state.as_slice()[elastic..2 * elastic]);
        (x, v)
    }
}

/// Largest difference of two states, relative to the largest velocity.
fn change<const D: usize>(a: &MotionState<D>, b: &MotionState<D>) -> f64 {
    let largest = |a: &[f64; D], b: &[f64; D]| a.iter().zip(b).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
    let size = largest(&b.v, &[0.0; D]).max(1e-9 * largest(&b.x, &[0.0; D]));
    largest(&a.x, &b.x).max(largest(&a.v, &b.v)) / size
}

/// Samples of the period and what does not change with the motion.
struct Grid<'b, 'm, const D: usize> {
    balance: &'b HarmonicBalance<'m, D>,
    samples: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
    /// Frequency response by order: s_0 and s_1 to the normal force of mesh 0, then of mesh 1, by rows.
    gains: Vec<[C64; 4]>,
    /// Amplitudes of s by order without the normal forces: load and torsional impacts.
    given: [Vec<C64>; 2],
    /// Amplitudes of the impacts in the normal forces, and of the torsional impacts.
    impact: [Vec<C64>; 2],
    torsional: [Vec<C64>; 2],
    /// Displacement excitation and its rate in scaled time at the samples; empty without.
    gap: [Vec<(f64, f64)>; 2],
}

impl<'b, 'm, const D: usize> Grid<'b, 'm, D> {
    /// `gains`: those of a grid with fewer samples, or none.
    fn new(
        balance: &'b HarmonicBalance<'m, D>,
        samples: usize,
        mut gains: Vec<[C64; 4]>,
        planner: &mut RealFftPlanner<f64>,
    ) -> Self {
        let model = balance.model;
        // The highest order of an even number of samples has no phase.
        let orders = samples / 2;
        let omega = |order: usize| TAU * order as f64 / model.period_tau;
        let amplitudes = |j: usize, factor: f64| -> Vec<C64> {
            let impact = &model.excitations[j].impact;
            if factor == 0.0 || matches!(impact, ImpactWaveform::None) {
                return Vec::new();
            }
            (0..orders).map(|order| impact.amplitude(order) * factor).collect()
        };
        let impact = [0, 1].map(|j| amplitudes(j, model.impact_normal));
        let torsional = [0, 1].map(|j| amplitudes(j, -model.impact_along));
        let observed = [balance.s[0].as_slice(), &balance.s[1]];
        let residues = HarmonicBalance::<D>::residues(&observed, &[&balance.normal[0], &balance.normal[1]]);
        gains.extend((gains.len()..orders).map(|order| {
            let mut gain = [C64::ZERO; 4];
            balance.response(omega(order), &residues, &mut gain);
            gain
        }));
        let loads = balance.train.static_displacements_m();
        let mut given = loads.map(|load| {
            let mut given = vec![C64::ZERO; orders];
            given[0] = C64::new(load, 0.0);
            given
        });
        for (k, along) in torsional.iter().enumerate().filter(|(_, along)| !along.is_empty()) {
            let residues = HarmonicBalance::<D>::residues(&observed, &[&balance.torsional[k]]);
            for (order, along) in along.iter().enumerate() {
                let mut response = [C64::ZERO; 2];
                balance.response(omega(order), &residues, &mut response);
                (0..2).for_each(|j| given[j][order] += response[j] * along);
            }
        }
        let gap = [0, 1].map(|j| {
            let values = (0..samples).map_while(|i| model.gap(j, i as f64 / samples as f64));
            values.collect()
        });
        let (forward, inverse) = (planner.plan_fft_forward(samples), planner.plan_fft_inverse(samples));
        Self { balance, samples, forward, inverse, gains, given, impact, torsional, gap }
    }

    /// Amplitudes of samples by order.
    fn amplitudes(&self, samples: &[f64]) -> Vec<C64> {
        let mut input = samples.to_vec();
        let mut output = self.forward.make_output_vec();
        // The lengths are those of the plan, so this cannot fail; if it did, the motion would not be found.
        if self.forward.process(&mut input, &mut output).is_err() {
            output.fill(C64::new(f64::NAN, 0.0));
        }
        output.truncate(self.samples / 2);
        output.iter().map(|c| c / self.samples as f64).collect()
    }

    /// Samples from amplitudes by order.
    fn values(inverse: &Arc<dyn ComplexToReal<f64>>, amplitudes: &[C64]) -> Vec<f64> {
        let mut input = inverse.make_input_vec();
        input[..amplitudes.len()].copy_from_slice(amplitudes);
        input[0].im = 0.0;
        let mut output = inverse.make_output_vec();
        if inverse.process(&mut input, &mut output).is_err() {
            output.fill(f64::NAN);
        }
        output
    }

    /// Samples of both s that the amplitudes of the normal forces cause.
    fn caused(&self, normal: &[Vec<C64>; 2]) -> [Vec<f64>; 2] {
        [0, 1].map(|j| {
            let along = |(order, g): (usize, &[C64; 4])| g[2 * j] * normal[0][order] + g[2 * j + 1] * normal[1][order];
            let amplitudes: Vec<C64> = self.gains.iter().enumerate().map(along).collect();
            Self::values(&self.inverse, &amplitudes)
        })
    }

    /// What mesh `j` adds to its reference stiffness at the samples, and the derivative by s, without its impact.
    fn excess(&self, j: usize, s: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let model = self.balance.model;
        let reference = self.balance.train.reference_stiffness[j];
        let one = |(i, s): (usize, &f64)| {
            let phase = i as f64 / self.samples as f64;
            let (gap, rate) = self.gap[j].get(i).copied().unwrap_or((0.0, 0.0));
            let (force, stiffness) = model.spring_force_in_contact(j, s - gap, phase);
            (force - reference * s - model.halves[j].cm * rate, stiffness - reference)
        };
        s.iter().enumerate().map(one).unzip()
    }

    /// Newton's method from samples of both s: the amplitudes of the normal forces and the largest deviations of the
    /// tangent stiffnesses from the reference ones; None where it does not converge.
    fn solve(&self, s: &mut [Vec<f64>; 2]) -> Option<([Vec<C64>; 2], [f64; 2])> {
        let n = self.samples;
        let given = [0, 1].map(|j| Self::values(&self.inverse, &self.given[j]));
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let [(left, left_slope), (right, right_slope)] = [0, 1].map(|j| self.excess(j, &s[j]));
            let mut normal = [self.amplitudes(&left), self.amplitudes(&right)];
            for (normal, impact) in normal.iter_mut().zip(&self.impact) {
                normal.iter_mut().zip(impact).for_each(|(n, i)| *n += i);
            }
            let caused = self.caused(&normal);
            let defect: Vec<f64> =
                (0..2 * n).map(|at| (at / n, at % n)).map(|(j, i)| given[j][i] + caused[j][i] - s[j][i]).collect();
            let slopes = [left_slope, right_slope];
            let product = |v: &[f64], out: &mut [f64]| {
                let normal = [0, 1].map(|j| {
                    let force: Vec<f64> = v[j * n..(j + 1) * n].iter().zip(&slopes[j]).map(|(v, k)| v * k).collect();
                    self.amplitudes(&force)
                });
                let caused = self.caused(&normal);
                for (at, out) in out.iter_mut().enumerate() {
                    *out = v[at] - caused[at / n][at % n];
                }
            };
            let size = s.iter().flatten().fold(0.0f64, |m, s| m.max(s.abs()));
            // No more digits than the step can use.
            let digits = (last * last).clamp(1e-10, 1e-3);
            let step = gmres(product, &defect, digits, MOST_PRODUCTS)?;
            let moved = step.iter().fold(0.0f64, |m, s| m.max(s.abs())) / size;
            if !moved.is_finite() {
                return None;
            }
            for (at, step) in step.iter().enumerate() {
                s[at / n][at % n] += step;
            }
            if moved < CONVERGED || (moved < 1e-10 && moved > 0.1 * last) {
                let deviation = slopes.map(|slope| slope.iter().fold(0.0f64, |m, k| m.max(k.abs())));
                return Some((normal, deviation));
            }
            last = moved;
        }
        None
    }

    fn keeps_contact(&self, s: &[Vec<f64>; 2], sides: [ContactSide; 2]) -> bool {
        let on_side = |(j, side): (usize, ContactSide)| {
            let at = |(i, s): (usize, &f64)| self.balance.model.contact_of(j, *s, i as f64 / self.samples as f64);
            s[j].iter().enumerate().map(at).all(|contact| contact.signum() == side)
        };
        sides.into_iter().enumerate().all(on_side)
    }

    /// Twice as many samples of the same series.
    fn refined(&self, s: &[f64], planner: &mut RealFftPlanner<f64>) -> Vec<f64> {
        Self::values(&planner.plan_fft_inverse(2 * self.samples), &self.amplitudes(s))
    }
}

impl ImpactWaveform {
    /// Complex amplitude of a mesh order, N: the force is the sum of amplitude · exp(2πi · order · phase) over positive
    /// and negative orders.
    fn amplitude(&self, order: usize) -> C64 {
        match self {
            ImpactWaveform::None => C64::ZERO,
            ImpactWaveform::HalfSine { force_n, duration, start, .. } => {
                let (a, w) = (PI / duration, TAU * order as f64);
                let delay = C64::from_polar(*force_n, -w * start);
                if (w - a).abs() < 1e-7 * a {
                    return delay * C64::new(0.0, -0.5 * duration);
                }
                delay * (C64::new(1.0, 0.0) + C64::from_polar(1.0, -w * duration)) * (a / (a * a - w * w))
            }
            ImpactWaveform::Harmonics(series) => series.amplitude(order),
        }
    }
}
