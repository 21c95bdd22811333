//! Frequency responses of an elastic system at the orders of the mesh frequency.

use nalgebra::Complex;

use super::elastic_system::ElasticSystem;
use crate::simd::vectorised;

type C64 = Complex<f64>;

/// Responses by mesh order from 0, as many as were asked for.
#[derive(Default)]
pub(super) struct FrequencyResponses {
    /// 1/(iω − p) and 1/(iω − p*) of each pole p.
    above: Vec<Vec<C64>>,
    below: Vec<Vec<C64>>,
    /// Of each s (rows) to each force (columns), row by row: normal forces, then those of torsional impacts.
    gains: Vec<Vec<C64>>,
}

impl FrequencyResponses {
    /// Adds orders until there are `orders`. `omega`: angular frequency of the first order; `torsional`: whether the
    /// responses to torsional impacts are wanted, in every call alike.
    pub(super) fn extend<const D: usize>(
        &mut self,
        system: &ElasticSystem<D>,
        omega: f64,
        orders: usize,
        torsional: bool,
    ) {
        let known = self.above.first().map_or(0, Vec::len);
        let normal = system.halves() * system.halves();
        let residues = &system.residues[..if torsional { 2 * normal } else { normal }];
        self.above.resize(system.poles.len(), Vec::new());
        self.below.resize(system.poles.len(), Vec::new());
        self.gains.resize(residues.len(), Vec::new());
        self.gains.iter_mut().for_each(|gain| gain.resize(orders.max(known), C64::ZERO));
        vectorised(
            #[inline(always)]
            || {
                for (m, pole) in system.poles.iter().enumerate() {
                    let (above, below) = (&mut self.above[m], &mut self.below[m]);
                    above.extend((known..orders).map(|order| inverse(omega * order as f64, pole.value)));
                    below.extend((known..orders).map(|order| inverse(omega * order as f64, pole.value.conj())));
                    for (gain, residues) in self.gains.iter_mut().zip(residues) {
                        let (up, down) = match pole.paired {
                            true => (0.5 * residues[m], 0.5 * residues[m].conj()),
                            false => (residues[m], C64::ZERO),
                        };
                        let inverses = above[known..].iter().zip(&below[known..]);
                        for (gain, (above, below)) in gain[known..].iter_mut().zip(inverses) {
                            *gain += up * above + down * below;
                        }
                    }
                }
            },
        );
    }

    /// Responses of s of a mesh `j` to the normal force of a mesh `k` of `halves`.
    pub(super) fn to_normal(&self, halves: usize, (j, k): (usize, usize)) -> &[C64] {
        &self.gains[halves * j + k]
    }

    /// Responses of s of a mesh `j` to the tangential force of a torsional impact of the half `k` of `halves`.
    pub(super) fn to_torsional(&self, halves: usize, (j, k): (usize, usize)) -> &[C64] {
        &self.gains[halves * (halves + j) + k]
    }

    /// Components at the phase 0 of the motion in the mode of each pole under a force, by its amplitudes: `rates` per
    /// unit of force.
    pub(super) fn add_components(&self, rates: &[C64], amplitudes: &[C64], first: usize, components: &mut [C64]) {
        vectorised(
            #[inline(always)]
            || {
                for (m, component) in components.iter_mut().enumerate() {
                    let (mut up, mut down) = (C64::ZERO, C64::ZERO);
                    let inverses = self.above[m][first..].iter().zip(&self.below[m][first..]);
                    for (order, (amplitude, (above, below))) in amplitudes.iter().zip(inverses).enumerate() {
                        up += amplitude * above;
                        if first + order > 0 {
                            down += amplitude * below;
                        }
                    }
                    // 1/(−iω − p) is the conjugate of 1/(iω − p*).
                    *component += rates[m] * (up + down.conj());
                }
            },
        );
    }
}

/// 1/(iω − p).
#[inline(always)]
fn inverse(omega: f64, pole: C64) -> C64 {
    let (re, im) = (-pole.re, omega - pole.im);
    let square = re * re + im * im;
    C64::new(re / square, -im / square)
}
