//! Samples of the mesh period for harmonic balance, and the equation for the displacements of the meshes at them.

use nalgebra::Complex;

use super::excitation::ImpactWaveform;
use super::harmonic_balance::HarmonicBalance;
use super::model::ContactSide;
use crate::numerics::fourier::Fourier;
use crate::numerics::gmres::gmres;

type C64 = Complex<f64>;

/// Steps of Newton's method, and products per step.
const MOST_STEPS: usize = 12;
const MOST_PRODUCTS: usize = 60;
/// Residual of the linear systems, relative to their right side: in the first step of a force law that is not linear,
/// and the smallest.
const FIRST_RESIDUAL: f64 = 1e-3;
const LEAST_RESIDUAL: f64 = 1e-10;

/// Samples of the period and what does not change with the motion.
pub(super) struct HarmonicGrid<'b, 'm, const D: usize> {
    balance: &'b HarmonicBalance<'m, D>,
    pub samples: usize,
    fourier: Fourier,
    /// Frequency response of each s (rows) to each normal force (columns) by order.
    gains: Vec<[C64; 4]>,
    /// Samples of both s, one mesh after the other, without the normal forces: load and torsional impacts.
    given: Vec<f64>,
    /// Amplitudes of the impacts in the normal forces.
    pub impact: Vec<Vec<C64>>,
    /// Amplitudes of the tangential forces of the torsional impacts.
    pub torsional: Vec<Vec<C64>>,
    /// Displacement excitation and its rate in scaled time at the samples; empty without.
    gap: Vec<Vec<(f64, f64)>>,
    /// Mesh stiffness at the samples, N/m, one mesh after the other; empty for a tabulated contact force.
    stiffness: Vec<f64>,
}

/// Amplitudes of the forces that each mesh adds to k_ref s, without impacts, and the largest deviation of its tangent
/// stiffness from k_ref, N/m.
pub(super) struct MeshForces {
    pub excess: Vec<Vec<C64>>,
    pub deviation: Vec<f64>,
}

impl<'b, 'm, const D: usize> HarmonicGrid<'b, 'm, D> {
    /// `gains`: those of a grid with fewer samples, or none.
    pub(super) fn new(balance: &'b HarmonicBalance<'m, D>, samples: usize, mut gains: Vec<[C64; 4]>) -> Self {
        let model = balance.model;
        let halves = balance.halves();
        let orders = samples / 2;
        let mut fourier = Fourier::new(samples);
        let system = &balance.system;
        let impact = (0..halves).map(|j| balance.impact_amplitudes(j, model.impact_normal, orders)).collect();
        let torsional: Vec<Vec<C64>> =
            (0..halves).map(|j| balance.impact_amplitudes(j, -model.impact_along, orders)).collect();
        let mut caused = vec![vec![C64::ZERO; orders]; halves];
        let known = gains.len();
        let strikes = torsional.iter().any(|along| !along.is_empty());
        for order in if strikes { 0 } else { known }..orders {
            // By normal forces and by torsional impacts, rows of s.
            let mut gain = [C64::ZERO; 8];
            let (columns, all) = (halves * halves, 2 * halves * halves);
            let wanted = if strikes { all } else { columns };
            system.response(balance.omega(order), &system.residues[..wanted], &mut gain[..wanted]);
            if order >= known {
                gains.push([gain[0], gain[1], gain[2], gain[3]]);
            }
            for (j, caused) in caused.iter_mut().enumerate() {
                for (k, along) in torsional.iter().enumerate().filter(|(_, along)| !along.is_empty()) {
                    caused[order] += gain[columns + halves * j + k] * along[order];
                }
            }
        }
        let mut given = vec![0.0; halves * samples];
        for (j, given) in given.chunks_mut(samples).enumerate() {
            caused[j][0] += system.static_s_m[j];
            fourier.samples(caused[j].iter().copied(), given);
        }
        let mut stiffness = Vec::new();
        if !model.uses_contact_force() {
            stiffness.resize(halves * samples, 0.0);
            for (out, excitation) in stiffness.chunks_mut(samples).zip(&model.excitations) {
                excitation.stiffness.sample(&mut fourier, out);
            }
        }
        let gap = (0..halves).map(|j| {
            let values = (0..samples).map_while(|i| model.gap(j, i as f64 / samples as f64));
            values.collect()
        });
        let gap = gap.collect();
        Self { balance, samples, fourier, gains, given, impact, torsional, gap, stiffness }
    }

    /// Adds to `out` the samples of every s that the amplitudes of the normal forces cause.
    fn add_caused(
        fourier: &mut Fourier,
        gains: &[[C64; 4]],
        (normal, samples): (&[Vec<C64>], &mut [f64]),
        out: &mut [f64],
    ) {
        let halves = normal.len();
        for (j, out) in out.chunks_mut(samples.len()).enumerate() {
            let along = |(order, gain): (usize, &[C64; 4])| {
                (0..halves).map(|k| gain[halves * j + k] * normal[k][order]).sum::<C64>()
            };
            fourier.samples(gains.iter().enumerate().map(along), samples);
            out.iter_mut().zip(&*samples).for_each(|(out, value)| *out += value);
        }
    }

    /// What mesh `j` adds to the force of its reference stiffness at a sample, N, and its derivative by s, N/m.
    fn excess(&self, j: usize, i: usize, s: f64) -> (f64, f64) {
        let model = self.balance.model;
        let reference = self.balance.system.reference_stiffness[j];
        let phase = i as f64 / self.samples as f64;
        let (gap, rate) = self.gap[j].get(i).copied().unwrap_or((0.0, 0.0));
        let (force, stiffness) = match self.stiffness.get(j * self.samples + i) {
            Some(stiffness) => (stiffness * (s - gap - model.loaded_side(j) * model.b), *stiffness),
            None => model.spring_force_in_contact(j, s - gap, phase),
        };
        (force - reference * s - model.halves[j].cm * rate, stiffness - reference)
    }

    /// Newton's method from samples of every s, one mesh after the other, to a relative error of s of about
    /// `precision`; None where it does not converge.
    pub(super) fn solve(&mut self, s: &mut [f64], precision: f64) -> Option<MeshForces> {
        let (n, halves) = (self.samples, self.balance.halves());
        let is_linear = !self.balance.model.uses_contact_force();
        let precision = precision.clamp(1e-13, 1e-6);
        let (mut force, mut slope) = (vec![0.0; s.len()], vec![0.0; s.len()]);
        let mut amplitudes = vec![vec![C64::ZERO; n / 2]; halves];
        let mut defect = vec![0.0; s.len()];
        let mut caused = vec![0.0; n];
        let mut last = f64::INFINITY;
        let mut converged = false;
        for _ in 0..=MOST_STEPS {
            for j in 0..halves {
                for i in 0..n {
                    let at = j * n + i;
                    (force[at], slope[at]) = self.excess(j, i, s[at]);
                }
            }
            for (force, out) in force.chunks(n).zip(&mut amplitudes) {
                self.fourier.amplitudes(force.iter().copied(), out);
            }
            if converged {
                let largest = |slopes: &[f64]| slopes.iter().fold(0.0f64, |m, k| m.max(k.abs()));
                return Some(MeshForces { excess: amplitudes, deviation: slope.chunks(n).map(largest).collect() });
            }
            for (amplitudes, impact) in amplitudes.iter_mut().zip(&self.impact) {
                amplitudes.iter_mut().zip(impact).for_each(|(force, impact)| *force += impact);
            }
            defect.iter_mut().zip(&self.given).zip(&*s).for_each(|((defect, given), s)| *defect = given - s);
            Self::add_caused(&mut self.fourier, &self.gains, (&amplitudes, &mut caused), &mut defect);
            let (fourier, gains) = (&mut self.fourier, &self.gains);
            let product = |v: &[f64], out: &mut [f64]| {
                for (j, amplitudes) in amplitudes.iter_mut().enumerate() {
                    let forces = v[j * n..][..n].iter().zip(&slope[j * n..][..n]).map(|(v, k)| -v * k);
                    fourier.amplitudes(forces, amplitudes);
                }
                out.copy_from_slice(v);
                Self::add_caused(fourier, gains, (&amplitudes, &mut caused), out);
            };
            let size = s.iter().fold(0.0f64, |m, s| m.max(s.abs()));
            // No more digits than the step can use.
            let residual = if is_linear { precision } else { last * last };
            let residual = residual.clamp(LEAST_RESIDUAL, FIRST_RESIDUAL);
            let step = gmres(product, &defect, residual, MOST_PRODUCTS)?;
            let moved = step.iter().fold(0.0f64, |m, s| m.max(s.abs())) / size;
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

    /// Whether every mesh touches the flanks of its side at all samples.
    pub(super) fn keeps_contact(&self, s: &[f64], sides: &[ContactSide]) -> bool {
        let touches = |(at, s): (usize, &f64)| {
            let (j, i) = (at / self.samples, at % self.samples);
            let contact = self.balance.model.contact_of(j, *s, i as f64 / self.samples as f64);
            contact.signum() == sides[j]
        };
        s.iter().enumerate().all(touches)
    }

    /// Twice as many samples of the same series, and the gains for the next grid.
    pub(super) fn refined(mut self, s: &[f64]) -> (Vec<f64>, Vec<[C64; 4]>) {
        let mut finer = Fourier::new(2 * self.samples);
        let mut amplitudes = vec![C64::ZERO; self.samples / 2];
        let mut out = vec![0.0; 2 * s.len()];
        for (s, out) in s.chunks(self.samples).zip(out.chunks_mut(2 * self.samples)) {
            self.fourier.amplitudes(s.iter().copied(), &mut amplitudes);
            finer.samples(amplitudes.iter().copied(), out);
        }
        (out, self.gains)
    }
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
