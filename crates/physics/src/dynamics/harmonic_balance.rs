//! Periodic motion in contact by harmonic balance.
//!
//! Without loss of contact everything but the mesh forces is linear. The displacements s of the meshes are Fourier
//! series over the mesh period; the force that a mesh adds to its reference stiffness is evaluated at samples of the
//! period, and the rest of the system returns each of its harmonics by a frequency response, a sum over the complex
//! modes ([`ElasticSystem`]). Unknown are the samples of the s alone, whatever the number of coordinates
//! ([`HarmonicGrid`]). They are found by Newton's method, its linear systems by products alone (T. M. Cameron, J. H.
//! Griffin: An alternating frequency/time method, J. Appl. Mech. 56 (1989) 149, doi:10.1115/1.3176036).

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use nalgebra::Complex;

use super::elastic_system::{ElasticSystem, residues};
use super::excitation::ImpactWaveform;
use super::frequency_response::FrequencyResponses;
use super::harmonic_grid::{HarmonicGrid, MeshForces};
use super::model::{ContactSide, DynamicModel, MotionState};
use super::variation::Perturbation;

type C64 = Complex<f64>;

/// Samples of the period, fewest and most; powers of two.
const FEWEST_SAMPLES: usize = 64;
const MOST_SAMPLES: usize = 1024;
/// Longest mesh period in scaled time: beyond it the harmonics do not reach the fastest modes.
const LONGEST_PERIOD: f64 = 2000.0;
/// Error of s over the error of the start that is permitted.
const OF_S: f64 = 0.02;
/// Part of the start by the upper half of the orders over that by the orders beyond: the amplitudes fall by the third
/// power of the order and faster.
const OVER_NEXT: f64 = 8.0;
/// Loop gain up to which a motion counts as stable: the sampled frequencies miss a little of the largest.
const STABLE_GAIN: f64 = 0.95;

/// Harmonic balance of a model.
pub(crate) struct HarmonicBalance<'m, const D: usize> {
    pub(super) model: &'m DynamicModel<D>,
    pub(super) system: Arc<ElasticSystem<D>>,
}

/// A periodic motion as Fourier series.
pub(crate) struct HarmonicOrbit<const D: usize> {
    /// State at the start of the mesh period.
    pub start: MotionState<D>,
    /// Complex amplitudes of the forces by mesh order from 0: what the meshes and impacts along them add to k_ref s,
    /// and the torsional impacts, N.
    normal: Vec<Vec<C64>>,
    torsional: Vec<Vec<C64>>,
    /// Largest deviation of the tangent stiffness of each mesh from its reference stiffness, N/m.
    deviation: Vec<f64>,
}

impl<'m, const D: usize> HarmonicBalance<'m, D> {
    /// None where the complex modes are nearly dependent or do not decay, and for mesh periods that are too long.
    /// `mean_stiffness_n_per_m`: of each mesh.
    pub(crate) fn new(model: &'m DynamicModel<D>, mean_stiffness_n_per_m: [f64; 2]) -> Option<Self> {
        if model.period_tau.is_nan() || model.period_tau > LONGEST_PERIOD {
            return None;
        }
        let system = ElasticSystem::find(model, mean_stiffness_n_per_m)?;
        let decays = system.poles.iter().all(|pole| pole.value.re < 0.0);
        decays.then_some(Self { model, system })
    }

    pub(super) fn halves(&self) -> usize {
        self.system.halves()
    }

    /// Whether the model has motions that no spring resists.
    pub(crate) fn has_rigid_body_modes(&self) -> bool {
        self.system.has_rigid_body_modes
    }

    /// Rates by torsional impacts, where they act so.
    fn torsional(&self) -> &[Vec<C64>] {
        if self.model.impact_along == 0.0 { &[] } else { &self.system.torsional }
    }

    /// Angular frequency of a mesh order in scaled time.
    pub(super) fn omega(&self, order: usize) -> f64 {
        TAU * order as f64 / self.model.period_tau
    }

    /// The periodic motion on the flanks that `near` touches; samples are doubled until the start is as exact as
    /// `tolerance`, relative to the velocity, by the part that the upper half of the orders makes. None where it loses
    /// contact or is not found.
    pub(crate) fn solve(&self, near: &MotionState<D>, tolerance: f64) -> Option<HarmonicOrbit<D>> {
        let sides: Vec<ContactSide> = near.contact[..self.halves()].iter().map(|side| side.signum()).collect();
        if sides.contains(&0) {
            return None;
        }
        let mut samples = FEWEST_SAMPLES;
        // Real and imaginary parts of the amplitudes of each s, by order from 0.
        let mut s = vec![0.0; self.halves() * samples];
        (0..self.halves()).for_each(|j| s[j * samples] = self.model.s(j, &near.x));
        let mut responses = FrequencyResponses::default();
        loop {
            let mut grid = HarmonicGrid::new(self, samples, responses);
            let forces = grid.solve(&mut s, &sides, OF_S * tolerance)?;
            let (start, upper) = self.start(near, &forces, &grid.responses);
            let excess = size_of(&upper) / (OVER_NEXT * tolerance * size_of(&(start.x, start.v)));
            if excess < 1.0 || samples == MOST_SAMPLES {
                return Some(self.orbit(start, forces, &grid));
            }
            let factor = if excess > OVER_NEXT * OVER_NEXT { 4 } else { 2 };
            let factor = factor.min(MOST_SAMPLES / samples);
            let mut finer = vec![0.0; factor * s.len()];
            let meshes = finer.chunks_mut(factor * samples).zip(s.chunks(samples));
            meshes.for_each(|(finer, s)| finer[..samples].copy_from_slice(s));
            (s, samples, responses) = (finer, factor * samples, grid.responses);
        }
    }

    fn orbit(&self, mut start: MotionState<D>, forces: MeshForces, grid: &HarmonicGrid<'_, '_, D>) -> HarmonicOrbit<D> {
        let MeshForces { excess: mut normal, deviation, s_at_start_m } = forces;
        for (j, s) in s_at_start_m.into_iter().enumerate() {
            start.contact[j] = self.model.contact_of(j, s, 0.0);
        }
        for (normal, impact) in normal.iter_mut().zip(&grid.impact) {
            normal.iter_mut().zip(impact).for_each(|(normal, impact)| *normal += impact);
        }
        HarmonicOrbit { start, normal, torsional: grid.torsional.clone(), deviation }
    }

    /// State at the phase 0 from the amplitudes of the mesh forces, and the part of it that the upper half of their
    /// orders makes. The motion due to the impacts is that of the whole pulse.
    fn start(
        &self,
        near: &MotionState<D>,
        forces: &MeshForces,
        responses: &FrequencyResponses,
    ) -> (MotionState<D>, Perturbation<D>) {
        let mut components = vec![C64::ZERO; self.system.poles.len()];
        let mut upper = components.clone();
        for (rates, excess) in self.system.normal.iter().zip(&forces.excess) {
            let (low, high) = excess.split_at(excess.len() / 2);
            responses.add_components(rates, low, 0, &mut components);
            responses.add_components(rates, high, low.len(), &mut upper);
        }
        components.iter_mut().zip(&upper).for_each(|(all, upper)| *all += upper);
        for j in 0..self.halves() {
            let impact = &self.model.excitations[j].impact;
            let factors = [
                (&self.system.normal[j], self.model.impact_normal),
                (&self.system.torsional[j], -self.model.impact_along),
            ];
            for (rate, factor) in factors.into_iter().filter(|(_, factor)| *factor != 0.0) {
                for (m, pole) in self.system.poles.iter().enumerate() {
                    components[m] += rate[m] * (factor * impact.response_at_start(pole.value, self.model.period_tau));
                }
            }
        }
        let n = self.system.modes.coordinates();
        let state = self.system.modes.state(&components);
        let mut displacements = self.system.under_load.clone();
        displacements.iter_mut().zip(state.iter()).for_each(|(q, more)| *q += more);
        let (x, v) = self.system.to_solver(&displacements, &state.as_slice()[n..]);
        let upper = self.system.modes.state(&upper);
        let upper = self.system.to_solver(&upper.as_slice()[..n], &upper.as_slice()[n..]);
        let mut start = MotionState { period: 0, phase: 0.0, ..*near };
        self.system.replace_elastic(&mut start, (x, v));
        (start, upper)
    }

    /// Whether perturbations of the orbit decay by the small-gain theorem: what the deviations of the tangent
    /// stiffnesses feed back through the rest returns smaller at every frequency (C. A. Desoer, M. Vidyasagar: Feedback
    /// Systems, Academic Press 1975, doi:10.1137/1.9780898719055, chapter III). Sufficient, not necessary.
    pub(crate) fn is_surely_stable(&self, orbit: &HarmonicOrbit<D>) -> bool {
        let deviation = orbit.deviation.iter().copied().fold(0.0, f64::max);
        self.system.largest_gain_m_per_n() * deviation < STABLE_GAIN
    }

    /// RMS of the circumferential acceleration of each mesh and of the axial acceleration of each half of the pinion,
    /// m/s².
    pub(crate) fn rms_accelerations_m_s2(&self, orbit: &HarmonicOrbit<D>) -> [Vec<f64>; 2] {
        let rows = self.system.mesh_x.iter().chain(&self.system.axial);
        let observed: Vec<Vec<C64>> = rows.map(|row| self.system.modes.observation(row)).collect();
        let excited: Vec<Vec<C64>> = self.system.normal.iter().chain(self.torsional()).cloned().collect();
        let residues = residues(&observed, &excited);
        let mut response = vec![C64::ZERO; residues.len()];
        let mut squares = vec![0.0; observed.len()];
        for order in 1..orbit.normal[0].len() {
            let omega = self.omega(order);
            self.system.response(omega, &residues, &mut response);
            let forces = orbit.normal.iter().chain(&orbit.torsional[..self.torsional().len()]);
            let forces: Vec<C64> = forces.map(|force| force.get(order).copied().unwrap_or_default()).collect();
            for (square, row) in squares.iter_mut().zip(response.chunks(excited.len())) {
                let displacement: C64 = row.iter().zip(&forces).map(|(g, f)| g * f).sum();
                *square += 2.0 * displacement.norm_sqr() * omega.powi(4);
            }
        }
        let unit = self.model.omega_ref * self.model.omega_ref;
        let rms: Vec<f64> = squares.iter().map(|square| square.sqrt() * unit).collect();
        let (mesh, axial) = rms.split_at(self.halves());
        [mesh.to_vec(), axial.to_vec()]
    }

    /// Correction of the start of a motion that ends after a mesh period with `defect`, end − start, by the free motion
    /// with the reference stiffnesses.
    pub(crate) fn correction(&self, defect: &Perturbation<D>) -> Perturbation<D> {
        let mut components = self.system.components(defect);
        for (component, pole) in components.iter_mut().zip(&self.system.poles) {
            *component /= C64::new(1.0, 0.0) - (pole.value * self.model.period_tau).exp();
        }
        let state = self.system.modes.state(&components);
        let n = self.system.modes.coordinates();
        self.system.to_solver(&state.as_slice()[..n], &state.as_slice()[n..])
    }
}

/// Largest velocity of a state, or a small part of its largest displacement.
fn size_of<const D: usize>((x, v): &Perturbation<D>) -> f64 {
    let largest = |values: &[f64; D]| values.iter().fold(0.0f64, |m, value| m.max(value.abs()));
    largest(v).max(1e-9 * largest(x))
}

impl ImpactWaveform {
    /// Complex amplitudes of `factor` times the force by mesh order from 0, N: the force is the sum of amplitude ·
    /// exp(2πi · order · phase) over positive and negative orders.
    pub(super) fn amplitudes(&self, factor: f64, orders: usize) -> Vec<C64> {
        match self {
            ImpactWaveform::None => vec![C64::ZERO; orders],
            ImpactWaveform::HalfSine { force_n, duration, start, .. } => {
                let a = PI / duration;
                // exp(−i w start) and exp(−i w duration), order by order.
                let (mut delay, mut end) = (C64::new(factor * force_n, 0.0), C64::new(1.0, 0.0));
                let [delay_step, end_step] = [start, duration].map(|time| C64::from_polar(1.0, -TAU * time));
                let amplitude = |order: usize| {
                    let w = TAU * order as f64;
                    let amplitude = if (w - a).abs() < 1e-7 * a {
                        delay * C64::new(0.0, -0.5 * duration)
                    } else {
                        delay * (end + 1.0) * (a / (a * a - w * w))
                    };
                    (delay, end) = (delay * delay_step, end * end_step);
                    amplitude
                };
                (0..orders).map(amplitude).collect()
            }
            ImpactWaveform::Harmonics(series) => (0..orders).map(|order| series.amplitude(order) * factor).collect(),
        }
    }

    /// Value at the phase 0 of the periodic solution of dc/dτ = `pole` c + force, a mesh period being `period`.
    fn response_at_start(&self, pole: C64, period: f64) -> C64 {
        match self {
            ImpactWaveform::None => C64::ZERO,
            ImpactWaveform::HalfSine { force_n, duration, start, .. } => {
                let (d, a) = (duration * period, PI / (duration * period));
                let inverse = (pole * pole + a * a).inv();
                // After the time `age` since the start of a pulse, within it.
                let within = |age: f64| {
                    let (sin, cos) = (a * age).sin_cos();
                    ((pole * age).exp() * a - C64::new(a * cos, 0.0) - pole * sin) * inverse
                };
                let mut age = (-start).rem_euclid(1.0) * period;
                let mut sum = C64::ZERO;
                while age < d {
                    sum += within(age);
                    age += period;
                }
                let after = ((pole * d).exp() + 1.0) * a * inverse;
                let past = after * (pole * (age - d)).exp() / (C64::new(1.0, 0.0) - (pole * period).exp());
                (sum + past) * *force_n
            }
            ImpactWaveform::Harmonics(series) => (0..=series.orders())
                .map(|order| {
                    let omega = TAU * order as f64 / period;
                    let amplitude = series.amplitude(order);
                    let up = amplitude / (C64::new(0.0, omega) - pole);
                    if order == 0 { up } else { up + amplitude.conj() / (C64::new(0.0, -omega) - pole) }
                })
                .sum(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::{Harmonic, ImpactExcitation};

    /// The response to a pulse is the sum of those to its harmonics.
    #[test]
    fn a_pulse_is_the_sum_of_its_harmonics() {
        let period = 7.0;
        let pulse = |duration_mesh_periods: f64, start_mesh_periods: f64| {
            let impact = ImpactExcitation::HalfSine { force_n: 3.0, duration_mesh_periods, start_mesh_periods };
            ImpactWaveform::new(Some(&impact), 0.0, period)
        };
        let harmonics = [(2.0, 0.3), (0.5, -1.0)];
        let harmonics = harmonics.map(|(amplitude, phase_rad)| Harmonic { amplitude, phase_rad }).to_vec();
        let series = ImpactWaveform::new(Some(&ImpactExcitation::Harmonics { harmonics }), 0.0, period);
        for waveform in [pulse(0.08, 0.0), pulse(0.3, 0.85), pulse(0.5, 0.5), pulse(2.4, 0.7), series] {
            for pole in [C64::new(-0.05, 0.9), C64::new(-0.3, 0.0), C64::new(-0.01, 5.0)] {
                let amplitudes = waveform.amplitudes(1.0, 40_000);
                let sum: C64 = amplitudes
                    .into_iter()
                    .enumerate()
                    .map(|(order, amplitude)| {
                        let omega = TAU * order as f64 / period;
                        let up = amplitude / (C64::new(0.0, omega) - pole);
                        if order == 0 { up } else { up + amplitude.conj() / (C64::new(0.0, -omega) - pole) }
                    })
                    .sum();
                let found = waveform.response_at_start(pole, period);
                assert!((found - sum).norm() < 1e-8 * sum.norm(), "{waveform:?} {pole}: {found} for {sum}");
            }
        }
    }
}
