//! Taylor coefficients of the excitations about a phase, for one motion or for the motions in all lanes.

use super::contact_force::ForceCells;
use super::excitation::{Coefficients, FourierSeries, ImpactWaveform, MAX_ORDER, StiffnessWaveform};
use super::lanes::{Lanes, Real};
use super::model::{ContactForceWaveform, ContactSide, DynamicModel, Excitation};
use super::recurrence::ContactSeries;
use super::segment::Segment;

/// Taylor coefficients of the excitations of both halves over one step.
pub(crate) struct ExcitationTerms<R> {
    pub stiffness: [[R; MAX_ORDER + 1]; 2],
    /// The stiffness in descending order, for convolutions.
    pub reversed: [[R; MAX_ORDER + 1]; 2],
    /// Highest order of the stiffness that is not zero.
    pub degree: [usize; 2],
    pub impact: [[R; MAX_ORDER + 1]; 2],
    /// Whether the impact is not zero.
    pub impact_active: [bool; 2],
    /// Displacement excitation, which s − gap is without.
    pub gap: [[R; MAX_ORDER + 1]; 2],
    /// Whether there is one.
    pub gap_active: [bool; 2],
    /// Cells of a tabulated contact force, one per half.
    pub cells: [ForceCells<R>; 2],
}

impl<R: Real> ExcitationTerms<R> {
    pub(crate) fn new() -> Self {
        let zero = [[R::splat(0.0); MAX_ORDER + 1]; 2];
        Self {
            stiffness: zero,
            reversed: zero,
            degree: [0; 2],
            impact: zero,
            impact_active: [false; 2],
            gap: zero,
            gap_active: [false; 2],
            cells: [ForceCells::none(); 2],
        }
    }

    /// Copies the terms of one motion, as they act on perturbations, into all lanes.
    #[inline(always)]
    pub(crate) fn broadcast(&mut self, one: &ExcitationTerms<f64>, order: usize) {
        for j in 0..2 {
            for n in 0..=order {
                self.stiffness[j][n] = R::splat(one.stiffness[j][n]);
                self.reversed[j][MAX_ORDER - n] = R::splat(one.reversed[j][MAX_ORDER - n]);
                self.impact[j][n] = R::splat(one.impact[j][n]);
            }
        }
        (self.degree, self.impact_active) = (one.degree, one.impact_active);
    }

    /// Sets the stiffness of a half from its Taylor coefficients.
    #[inline(always)]
    pub(crate) fn set_stiffness(&mut self, j: usize, coefficients: &[R], order: usize) {
        self.stiffness[j][..coefficients.len()].copy_from_slice(coefficients);
        self.degree[j] = order;
        self.reverse_stiffness(j, order);
    }

    #[inline(always)]
    fn reverse_stiffness(&mut self, j: usize, order: usize) {
        for n in 0..=order {
            self.reversed[j][MAX_ORDER - n] = self.stiffness[j][n];
        }
    }
}

/// Taylor coefficients of the excitations in scaled time, orders 0 to `order`, about `phase`, on the smooth interval
/// that contains `interior`, with the given contact of both halves.
pub(crate) trait ExcitationExpansion<R> {
    fn expand(&self, phase: R, interior: R, contact: [R; 2], order: usize, terms: &mut ExcitationTerms<R>);
}

impl ContactForceWaveform {
    /// Sets the cell of a half in one lane.
    #[inline(always)]
    fn put<R: Real>(&self, phase: f64, interior: f64, contact: ContactSide, lane: usize, cells: &mut ForceCells<R>) {
        let Self { force, shift, b, period_tau } = self;
        cells.set(lane, &force.cell(contact, *b, phase - shift, interior - shift, *period_tau));
    }
}

impl<const D: usize> ExcitationExpansion<f64> for DynamicModel<D> {
    #[inline(always)]
    fn expand(&self, phase: f64, interior: f64, contact: [f64; 2], order: usize, terms: &mut ExcitationTerms<f64>) {
        for (j, e) in self.excitations.iter().enumerate() {
            terms.cells[j].in_use = e.contact.is_some();
            if let Some(waveform) = &e.contact {
                waveform.put(phase, interior, contact[j] as ContactSide, 0, &mut terms.cells[j]);
            } else {
                let stiffness = &mut terms.stiffness[j];
                if let Some(series) = e.stiffness.series() {
                    series.fill(phase, order, stiffness);
                    terms.degree[j] = if series.is_constant() { 0 } else { order };
                }
                if let Some(cubic) = e.stiffness.cubic(phase, interior) {
                    stiffness[..4].copy_from_slice(&cubic);
                    stiffness[4..=order].fill(0.0);
                    terms.degree[j] = 3;
                }
                terms.reverse_stiffness(j, order);
            }
            terms.gap_active[j] = e.gap.is_some();
            if let Some(series) = &e.gap {
                series.fill(phase, order, &mut terms.gap[j]);
            }
            terms.impact_active[j] = false;
            if let Some((sin, cos)) = e.impact.pulse(phase, interior)
                && let Some(powers) = e.impact.powers()
                && (sin != 0.0 || cos != 0.0)
            {
                pulse(sin, cos, powers, order, &mut terms.impact[j]);
                terms.impact_active[j] = true;
            }
            if let Some(series) = e.impact.series() {
                series.fill(phase, order, &mut terms.impact[j]);
                terms.impact_active[j] = true;
            }
        }
    }
}

impl<const D: usize> DynamicModel<D> {
    /// Excitations of the variational equations about the scaled time `at` of a segment: for a tabulated contact force
    /// its stiffness along the motion.
    #[inline(always)]
    pub(crate) fn expand_for_perturbations(
        &self,
        segment: &Segment<'_, D>,
        at: f64,
        interior: f64,
        order: usize,
        terms: &mut ExcitationTerms<f64>,
    ) {
        let phase = segment.phase + at / self.period_tau;
        self.expand(phase, interior, segment.contact.map(f64::from), order, terms);
        for j in 0..self.excitations.len() {
            let moved = std::mem::take(&mut terms.gap_active[j]);
            if !terms.cells[j].in_use {
                continue;
            }
            let cells = terms.cells[j];
            terms.cells[j].in_use = false;
            let mut stiffness = [0.0; MAX_ORDER + 1];
            if segment.contact[j] != 0 {
                let mut s = [0.0; MAX_ORDER + 1];
                for (s, row) in s.iter_mut().zip(&segment.rows[..=segment.degree]) {
                    *s = self.s(j, row);
                }
                recentre(&mut s[..=segment.degree], at);
                if moved {
                    for (s, gap) in s[..=order].iter_mut().zip(&terms.gap[j]) {
                        *s -= gap;
                    }
                }
                let mut series = ContactSeries::new();
                for n in 0..=order {
                    stiffness[n] = series.stiffness(&cells, n, s[n]);
                }
            }
            terms.set_stiffness(j, &stiffness, order);
        }
    }
}

/// Re-expands the polynomial about `at`.
fn recentre(c: &mut [f64], at: f64) {
    if at == 0.0 {
        return;
    }
    let last = c.len() - 1;
    for first in 0..last {
        for n in (first..last).rev() {
            c[n] += at * c[n + 1];
        }
    }
}

/// Taylor coefficients of half sines, whose derivatives are sine, cosine, −sine, −cosine in turn.
#[inline(always)]
fn pulse<R: Real>(sin: R, cos: R, powers: &[R; MAX_ORDER + 1], order: usize, out: &mut [R; MAX_ORDER + 1]) {
    let signed = [sin, cos, -sin, -cos];
    for n in 0..=order {
        out[n] = powers[n] * signed[n & 3];
    }
}

/// Excitations of one half in all lanes.
struct LaneExcitation<'m, const L: usize> {
    /// Stiffnesses that are Fourier series; zero in the other lanes.
    stiffness: FourierSeries<Lanes<L>>,
    /// Stiffnesses that are piecewise cubic.
    cubics: [Option<&'m StiffnessWaveform>; L],
    /// Tabulated contact forces: in all lanes in use, or in none.
    contacts: [Option<&'m ContactForceWaveform>; L],
    pulses: [Option<&'m ImpactWaveform>; L],
    powers: [Lanes<L>; MAX_ORDER + 1],
    impact: FourierSeries<Lanes<L>>,
    gap: FourierSeries<Lanes<L>>,
}

/// Excitations of the motions in all lanes.
pub(crate) struct LaneExcitations<'m, const L: usize> {
    halves: [LaneExcitation<'m, L>; 2],
}

impl<'m, const L: usize> LaneExcitations<'m, L> {
    pub(crate) fn none() -> Self {
        let half = || LaneExcitation {
            stiffness: FourierSeries::zero(),
            cubics: [None; L],
            contacts: [None; L],
            pulses: [None; L],
            powers: [Lanes::splat(0.0); MAX_ORDER + 1],
            impact: FourierSeries::zero(),
            gap: FourierSeries::zero(),
        };
        Self { halves: [half(), half()] }
    }

    /// Sets the excitations of one lane.
    pub(crate) fn put(&mut self, lane: usize, one: &'m [Excitation]) {
        const NONE: Coefficients = [0.0; MAX_ORDER + 1];
        for (to, from) in self.halves.iter_mut().zip(one) {
            let series = from.stiffness.series();
            to.cubics[lane] = series.is_none().then_some(&from.stiffness);
            to.contacts[lane] = from.contact.as_ref();
            to.stiffness.put(lane, series.unwrap_or(&FourierSeries::zero()));
            to.pulses[lane] = from.impact.powers().map(|_| &from.impact);
            for (to, from) in to.powers.iter_mut().zip(from.impact.powers().unwrap_or(&NONE)) {
                to.set(lane, *from);
            }
            to.impact.put(lane, from.impact.series().unwrap_or(&FourierSeries::zero()));
            to.gap.put(lane, from.gap.as_ref().unwrap_or(&FourierSeries::zero()));
        }
    }
}

impl<const L: usize> ExcitationExpansion<Lanes<L>> for LaneExcitations<'_, L> {
    #[inline(always)]
    fn expand(
        &self,
        phase: Lanes<L>,
        interior: Lanes<L>,
        contact: [Lanes<L>; 2],
        order: usize,
        terms: &mut ExcitationTerms<Lanes<L>>,
    ) {
        let zero = Lanes::splat(0.0);
        for (j, e) in self.halves.iter().enumerate() {
            terms.cells[j].in_use = e.contacts.iter().any(Option::is_some);
            if terms.cells[j].in_use {
                for lane in 0..L {
                    if let Some(waveform) = e.contacts[lane] {
                        let (phase, interior) = (phase.get(lane), interior.get(lane));
                        waveform.put(phase, interior, contact[j].get(lane) as ContactSide, lane, &mut terms.cells[j]);
                    }
                }
            } else {
                let stiffness = &mut terms.stiffness[j];
                e.stiffness.fill(phase, order, stiffness);
                terms.degree[j] = if e.stiffness.is_constant() { 3 } else { order };
                for lane in 0..L {
                    if let Some(cubic) = e.cubics[lane].and_then(|c| c.cubic(phase.get(lane), interior.get(lane))) {
                        for (n, c) in cubic.into_iter().enumerate() {
                            stiffness[n].set(lane, c);
                        }
                    }
                }
                terms.reverse_stiffness(j, order);
            }
            terms.gap_active[j] = !e.gap.is_constant();
            if terms.gap_active[j] {
                e.gap.fill(phase, order, &mut terms.gap[j]);
            }
            let (mut sin, mut cos) = (zero, zero);
            for lane in 0..L {
                let pulse = e.pulses[lane].and_then(|p| p.pulse(phase.get(lane), interior.get(lane)));
                let (s, c) = pulse.unwrap_or((0.0, 0.0));
                sin.set(lane, s);
                cos.set(lane, c);
            }
            terms.impact_active[j] = sin.any(|s| s != 0.0) || cos.any(|c| c != 0.0);
            if terms.impact_active[j] {
                pulse(sin, cos, &e.powers, order, &mut terms.impact[j]);
            }
            if !e.impact.is_constant() {
                let mut harmonics = [zero; MAX_ORDER + 1];
                e.impact.fill(phase, order, &mut harmonics);
                for n in 0..=order {
                    let pulse = if terms.impact_active[j] { terms.impact[j][n] } else { zero };
                    terms.impact[j][n] = pulse + harmonics[n];
                }
                terms.impact_active[j] = true;
            }
        }
    }
}
