//! Samples of the mesh period for harmonic balance, and the equation for the displacements of the meshes.

use nalgebra::Complex;

use super::contact_force::PhasePlace;
use super::excitation::ImpactWaveform;
use super::frequency_response::FrequencyResponses;
use super::harmonic_balance::HarmonicBalance;
use super::harmonic_preconditioner::Preconditioner;
use super::model::ContactSide;
use crate::numerics::fourier::Fourier;
use crate::numerics::gmres::{gmres, norm};
use crate::simd::vectorised;

type C64 = Complex<f64>;

/// Steps of Newton's method, and products per step.
const MOST_STEPS: usize = 12;
const MOST_PRODUCTS: usize = 60;
/// Residual of the linear systems, relative to their right side: the largest and the smallest.
const FIRST_RESIDUAL: f64 = 1e-3;
const LEAST_RESIDUAL: f64 = 1e-10;

/// Samples of the period and what does not change with the motion. Amplitudes of s are lists of real and imaginary
/// parts by order from 0, one mesh after the other.
pub(super) struct HarmonicGrid<'b, 'm, const D: usize> {
    balance: &'b HarmonicBalance<'m, D>,
    pub samples: usize,
    fourier: Fourier,
    pub responses: FrequencyResponses,
    /// Amplitudes of every s without the normal forces: load and torsional impacts.
    given: Vec<f64>,
    /// Amplitudes of the impacts in the normal forces.
    pub impact: Vec<Vec<C64>>,
    /// Amplitudes of the tangential forces of the torsional impacts.
    pub torsional: Vec<Vec<C64>>,
    /// Displacement excitation and its rate in scaled time at the samples; empty without.
    gap: Vec<Vec<(f64, f64)>>,
    law: ForceLaw,
}

/// Law of the mesh forces at the samples, one mesh after the other.
enum ForceLaw {
    /// Mesh stiffness, N/m.
    Stiffness(Vec<f64>),
    /// Tabulated contact force.
    Contact(Vec<PhasePlace>),
}

/// Amplitudes of the forces that each mesh adds to k_ref s, without impacts, and the largest deviation of its tangent
/// stiffness from k_ref, N/m.
pub(super) struct MeshForces {
    pub excess: Vec<Vec<C64>>,
    pub deviation: Vec<f64>,
    /// s of every mesh at the phase 0, m.
    pub s_at_start_m: Vec<f64>,
}

impl<'b, 'm, const D: usize> HarmonicGrid<'b, 'm, D> {
    /// `responses`: those of a grid with fewer samples, or none.
    pub(super) fn new(balance: &'b HarmonicBalance<'m, D>, samples: usize, mut responses: FrequencyResponses) -> Self {
        let model = balance.model;
        let halves = balance.halves();
        let orders = samples / 2;
        let system = &balance.system;
        let impact = (0..halves).map(|j| balance.impact_amplitudes(j, model.impact_normal, orders)).collect();
        let torsional: Vec<Vec<C64>> =
            (0..halves).map(|j| balance.impact_amplitudes(j, -model.impact_along, orders)).collect();
        let strikes = torsional.iter().any(|along| !along.is_empty());
        responses.extend(system, balance.omega(1), orders, strikes);
        let mut given = vec![0.0; 2 * halves * orders];
        for (j, given) in given.chunks_mut(2 * orders).enumerate() {
            given[0] = system.static_s_m[j];
            for (k, along) in torsional.iter().enumerate().filter(|(_, along)| !along.is_empty()) {
                add_caused(responses.to_torsional(halves, (j, k)), along, given);
            }
        }
        let mut fourier = Fourier::new(samples);
        let law = if model.uses_contact_force() {
            let place = |j: usize, i: usize| {
                let contact = model.excitations[j].contact.as_ref();
                contact.map(|contact| contact.force.place(i as f64 / samples as f64 - contact.shift))
            };
            let places = (0..halves).flat_map(|j| (0..samples).filter_map(move |i| place(j, i)));
            ForceLaw::Contact(places.collect())
        } else {
            let mut stiffness = vec![0.0; halves * samples];
            for (out, excitation) in stiffness.chunks_mut(samples).zip(&model.excitations) {
                excitation.stiffness.sample(&mut fourier, out);
            }
            ForceLaw::Stiffness(stiffness)
        };
        let gap = (0..halves).map(|j| {
            let values = (0..samples).map_while(|i| model.gap(j, i as f64 / samples as f64));
            values.collect()
        });
        Self { balance, samples, fourier, responses, given, impact, torsional, gap: gap.collect(), law }
    }

    /// Force that mesh `j` adds to that of its reference stiffness at every sample of s, N, and its derivative by s,
    /// N/m. False where the mesh does not touch the flanks of `side`.
    fn excess(&self, j: usize, s: &[f64], (force, slope): (&mut [f64], &mut [f64]), side: ContactSide) -> bool {
        let model = self.balance.model;
        let reference = self.balance.system.reference_stiffness[j];
        let of_mesh = j * self.samples..(j + 1) * self.samples;
        let mut touches = true;
        match &self.law {
            ForceLaw::Stiffness(stiffness) => {
                let (half_play, has_gap) = (model.loaded_side(j) * model.b, !self.gap[j].is_empty());
                for ((s, k), (force, slope)) in s.iter().zip(&stiffness[of_mesh]).zip(force.iter_mut().zip(slope)) {
                    touches &= has_gap || model.flank_at(*s) == side;
                    *force = k * (s - half_play) - reference * s;
                    *slope = k - reference;
                }
                for (i, (gap, rate)) in self.gap[j].iter().enumerate() {
                    touches &= model.flank_at(s[i] - gap) == side;
                    force[i] -= stiffness[j * self.samples + i] * gap + model.halves[j].cm * rate;
                }
            }
            ForceLaw::Contact(places) => {
                let Some(contact) = &model.excitations[j].contact else { return false };
                let gaps = self.gap[j].iter().copied().chain(std::iter::repeat((0.0, 0.0)));
                for (((s, place), (gap, rate)), (force, slope)) in
                    s.iter().zip(&places[of_mesh]).zip(gaps).zip(force.iter_mut().zip(slope))
                {
                    let (normal, stiffness, flank) = contact.force.force_at(s - gap, model.b, *place);
                    touches &= flank == side;
                    *force = normal - reference * s - model.halves[j].cm * rate;
                    *slope = stiffness - reference;
                }
            }
        }
        touches
    }

    /// Newton's method from the amplitudes of every s to a relative error of s of about `precision`; None where it does
    /// not converge, or where a mesh leaves the flanks of its side.
    pub(super) fn solve(&mut self, s: &mut [f64], sides: &[ContactSide], precision: f64) -> Option<MeshForces> {
        let (n, halves) = (self.samples, self.balance.halves());
        let orders = n / 2;
        let is_linear = matches!(self.law, ForceLaw::Stiffness(_));
        let precision = precision.clamp(1e-13, 1e-6);
        let mut samples = vec![0.0; halves * n];
        let (mut force, mut slope) = (vec![0.0; halves * n], vec![0.0; halves * n]);
        let mut amplitudes = vec![vec![C64::ZERO; orders]; halves];
        let mut defect = vec![0.0; s.len()];
        let mut preconditioner = None;
        let mut last = f64::INFINITY;
        let mut converged = false;
        for _ in 0..=MOST_STEPS {
            let mut touches = true;
            for (j, out) in amplitudes.iter_mut().enumerate() {
                let of_mesh = j * n..(j + 1) * n;
                let samples = &mut samples[of_mesh.clone()];
                self.fourier.samples(complex(&s[2 * orders * j..][..2 * orders]), samples);
                let (force, slope) = (&mut force[of_mesh.clone()], &mut slope[of_mesh]);
                touches &= self.excess(j, samples, (force, slope), sides[j]);
                self.fourier.amplitudes(force.iter().copied(), out);
            }
            let largest = |values: &[f64]| values.iter().fold(0.0f64, |m, value| m.max(value.abs()));
            if converged {
                let deviation = slope.chunks(n).map(largest).collect();
                let s_at_start_m = samples.iter().step_by(n).copied().collect();
                return touches.then_some(MeshForces { excess: amplitudes, deviation, s_at_start_m });
            }
            for (amplitudes, impact) in amplitudes.iter_mut().zip(&self.impact) {
                amplitudes.iter_mut().zip(impact).for_each(|(force, impact)| *force += impact);
            }
            defect.iter_mut().zip(&self.given).zip(&*s).for_each(|((defect, given), s)| *defect = given - s);
            let (fourier, responses) = (&mut self.fourier, &self.responses);
            let gains = |at: (usize, usize)| responses.to_normal(halves, at);
            for (j, defect) in defect.chunks_mut(2 * orders).enumerate() {
                (0..halves).for_each(|k| add_caused(gains((j, k)), &amplitudes[k], defect));
            }
            let preconditioner = preconditioner.get_or_insert_with(|| {
                for (slope, out) in slope.chunks(n).zip(&mut amplitudes) {
                    fourier.amplitudes(slope.iter().copied(), out);
                }
                let stiffness = amplitudes.iter().zip(slope.chunks(n)).map(|(k, slope)| (k.as_slice(), largest(slope)));
                Preconditioner::new(&gains, &stiffness.collect::<Vec<_>>())
            });
            let size = largest(&samples);
            // No more digits than the step can use: in the norm of the amplitudes, which that of s is about.
            let enough = 0.05 * precision * norm(s) / norm(&defect).max(f64::MIN_POSITIVE);
            let residual = if is_linear { enough } else { enough.max(last * last) };
            let residual = residual.clamp(LEAST_RESIDUAL, FIRST_RESIDUAL);
            let mut given = vec![0.0; s.len()];
            let product = |v: &[f64], out: &mut [f64]| {
                given.copy_from_slice(v);
                preconditioner.solve(&mut given);
                for (j, amplitudes) in amplitudes.iter_mut().enumerate() {
                    let samples = &mut samples[j * n..][..n];
                    fourier.samples(complex(&given[2 * orders * j..][..2 * orders]), samples);
                    let forces = samples.iter().zip(&slope[j * n..][..n]).map(|(v, k)| -v * k);
                    fourier.amplitudes(forces, amplitudes);
                }
                out.copy_from_slice(&given);
                for (j, out) in out.chunks_mut(2 * orders).enumerate() {
                    (0..halves).for_each(|k| add_caused(gains((j, k)), &amplitudes[k], out));
                }
            };
            let mut step = gmres(product, &defect, residual, MOST_PRODUCTS)?;
            preconditioner.solve(&mut step);
            for (step, samples) in step.chunks(2 * orders).zip(samples.chunks_mut(n)) {
                fourier.samples(complex(step), samples);
            }
            let moved = largest(&samples) / size;
            if !moved.is_finite() {
                return None;
            }
            s.iter_mut().zip(&step).for_each(|(s, step)| *s += step);
            // What is left after the step: of the linear system, and of the force law by its curvature.
            let left = if is_linear { residual } else { residual.max(10.0 * moved) };
            converged = moved * left < precision || (moved < 1e-10 && moved > 0.1 * last);
            last = moved;
        }
        None
    }
}

/// Amplitudes from their real and imaginary parts.
fn complex(parts: &[f64]) -> impl Iterator<Item = C64> {
    parts.chunks_exact(2).map(|parts| C64::new(parts[0], parts[1]))
}

/// Adds the amplitudes that a force causes: products of the response by order with the amplitudes of the force.
fn add_caused(response: &[C64], force: &[C64], out: &mut [f64]) {
    vectorised(
        #[inline(always)]
        || {
            for (out, (response, force)) in out.chunks_exact_mut(2).zip(response.iter().zip(force)) {
                let caused = response * force;
                out[0] += caused.re;
                out[1] += caused.im;
            }
        },
    );
}

impl<const D: usize> HarmonicBalance<'_, D> {
    /// Amplitudes of `factor` times the impact of a half by order; empty where it is zero.
    pub(super) fn impact_amplitudes(&self, j: usize, factor: f64, orders: usize) -> Vec<C64> {
        let impact = &self.model.excitations[j].impact;
        if factor == 0.0 || matches!(impact, ImpactWaveform::None) {
            return Vec::new();
        }
        impact.amplitudes(factor, orders)
    }
}
