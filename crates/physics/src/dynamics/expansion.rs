//! Taylor coefficients of the excitations about a phase: of one motion, or of the motions in all lanes.

use super::contact_force::Cells;
use super::excitation::{Coefficients, ImpactCourse, MAX_ORDER, Series, StiffnessCourse};
use super::lanes::{Lanes, Real};
use super::model::{Contact, ContactCourse, Excitation, Model};
use super::recurrence::ContactSeries;
use super::segment::Segment;

/// Taylor coefficients of the excitations of both halves over one step.
pub(crate) struct ExcitationTerms<R> {
    pub stiffness: [[R; MAX_ORDER + 1]; 2],
    /// The stiffness again, highest order first, so that a convolution is a product of two rows.
    pub backwards: [[R; MAX_ORDER + 1]; 2],
    /// Highest order of the stiffness that is not zero.
    pub degree: [usize; 2],
    pub impact: [[R; MAX_ORDER + 1]; 2],
    /// The impact is not zero.
    pub pushed: [bool; 2],
    /// Where the mesh force is that of the loaded contact: the cell of each half.
    pub cells: [Cells<R>; 2],
}

impl<R: Real> ExcitationTerms<R> {
    pub fn new() -> Self {
        let zero = [[R::splat(0.0); MAX_ORDER + 1]; 2];
        Self {
            stiffness: zero,
            backwards: zero,
            degree: [0; 2],
            impact: zero,
            pushed: [false; 2],
            cells: [Cells::none(); 2],
        }
    }

    /// Copies the terms of one motion into all lanes.
    #[inline(always)]
    pub fn spread(&mut self, one: &ExcitationTerms<f64>, order: usize) {
        for j in 0..2 {
            for n in 0..=order {
                self.stiffness[j][n] = R::splat(one.stiffness[j][n]);
                self.backwards[j][MAX_ORDER - n] = R::splat(one.backwards[j][MAX_ORDER - n]);
                self.impact[j][n] = R::splat(one.impact[j][n]);
            }
        }
        (self.degree, self.pushed) = (one.degree, one.pushed);
    }

    /// Sets the stiffness of a half from its Taylor coefficients.
    #[inline(always)]
    pub fn set_stiffness(&mut self, j: usize, coefficients: &[R], order: usize) {
        self.stiffness[j][..coefficients.len()].copy_from_slice(coefficients);
        self.degree[j] = order;
        self.mirror(j, order);
    }

    #[inline(always)]
    fn mirror(&mut self, j: usize, order: usize) {
        for n in 0..=order {
            self.backwards[j][MAX_ORDER - n] = self.stiffness[j][n];
        }
    }
}

/// Gives the excitations' Taylor coefficients in scaled time, orders 0 to `order`, about `phase`; `inside` is a phase in the
/// interior of the smooth stretch that is meant, `contact` the sides and levels the halves are on.
pub(crate) trait Excite<R> {
    fn excite(&self, phase: R, inside: R, contact: [R; 2], order: usize, terms: &mut ExcitationTerms<R>);
}

impl ContactCourse {
    /// Puts the cell that a half is in into a lane.
    #[inline(always)]
    fn put<R: Real>(&self, phase: f64, inside: f64, contact: Contact, lane: usize, cells: &mut Cells<R>) {
        let Self { force, shift, b, period_tau } = self;
        cells.set(lane, &force.cell(contact, *b, phase - shift, inside - shift, *period_tau));
    }
}

impl<const D: usize> Excite<f64> for Model<D> {
    #[inline(always)]
    fn excite(&self, phase: f64, inside: f64, contact: [f64; 2], order: usize, terms: &mut ExcitationTerms<f64>) {
        for (j, e) in self.excitations.iter().enumerate() {
            terms.cells[j].in_use = e.contact.is_some();
            if let Some(course) = &e.contact {
                course.put(phase, inside, contact[j] as Contact, 0, &mut terms.cells[j]);
            } else {
                let stiffness = &mut terms.stiffness[j];
                if let Some(series) = e.stiffness.series() {
                    series.fill(phase, order, stiffness);
                    terms.degree[j] = if series.is_constant() { 0 } else { order };
                }
                if let Some(cubic) = e.stiffness.cubic(phase, inside) {
                    stiffness[..4].copy_from_slice(&cubic);
                    stiffness[4..=order].fill(0.0);
                    terms.degree[j] = 3;
                }
                terms.mirror(j, order);
            }
            terms.pushed[j] = false;
            if let Some((sin, cos)) = e.impact.pulse(phase, inside)
                && let Some(powers) = e.impact.powers()
                && (sin != 0.0 || cos != 0.0)
            {
                pulse(sin, cos, powers, order, &mut terms.impact[j]);
                terms.pushed[j] = true;
            }
            if let Some(series) = e.impact.series() {
                series.fill(phase, order, &mut terms.impact[j]);
                terms.pushed[j] = true;
            }
        }
    }
}

impl<const D: usize> Model<D> {
    /// The excitations that perturbations from a motion feel, about the scaled time `at` of one of its segments: where the mesh force is that of the
    /// loaded contact, its stiffness along the motion.
    #[inline(always)]
    pub fn excite_variation(
        &self,
        segment: &Segment<'_, D>,
        at: f64,
        inside: f64,
        order: usize,
        terms: &mut ExcitationTerms<f64>,
    ) {
        let phase = segment.phase + at / self.period_tau;
        self.excite(phase, inside, segment.contact.map(f64::from), order, terms);
        for j in 0..self.excitations.len() {
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
                let mut series = ContactSeries::new();
                for n in 0..=order {
                    stiffness[n] = series.stiffness(&cells, n, s[n]);
                }
            }
            terms.set_stiffness(j, &stiffness, order);
        }
    }
}

/// The polynomial about `at` instead of 0.
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

/// Taylor coefficients of half sines: their derivatives are sine, cosine, −sine, −cosine in turn.
#[inline(always)]
fn pulse<R: Real>(sin: R, cos: R, powers: &[R; MAX_ORDER + 1], order: usize, out: &mut [R; MAX_ORDER + 1]) {
    let signed = [sin, cos, -sin, -cos];
    for n in 0..=order {
        out[n] = powers[n] * signed[n & 3];
    }
}

/// The excitations of one half in all lanes.
struct LaneExcitation<'m, const L: usize> {
    /// Stiffnesses that are Fourier series; zero in the other lanes.
    stiffness: Series<Lanes<L>>,
    /// Stiffnesses that are cubics.
    cubics: [Option<&'m StiffnessCourse>; L],
    /// Contact forces: in all lanes in use, or in none.
    contacts: [Option<&'m ContactCourse>; L],
    pulses: [Option<&'m ImpactCourse>; L],
    powers: [Lanes<L>; MAX_ORDER + 1],
    impact: Series<Lanes<L>>,
}

/// The excitations of the motions in all lanes.
pub(crate) struct LaneExcitations<'m, const L: usize> {
    halves: [LaneExcitation<'m, L>; 2],
}

impl<'m, const L: usize> LaneExcitations<'m, L> {
    pub fn none() -> Self {
        let half = || LaneExcitation {
            stiffness: Series::zero(),
            cubics: [None; L],
            contacts: [None; L],
            pulses: [None; L],
            powers: [Lanes::splat(0.0); MAX_ORDER + 1],
            impact: Series::zero(),
        };
        Self { halves: [half(), half()] }
    }

    /// Puts the excitations of one motion into a lane.
    pub fn put(&mut self, lane: usize, one: &'m [Excitation]) {
        const NONE: Coefficients = [0.0; MAX_ORDER + 1];
        for (to, from) in self.halves.iter_mut().zip(one) {
            let series = from.stiffness.series();
            to.cubics[lane] = series.is_none().then_some(&from.stiffness);
            to.contacts[lane] = from.contact.as_ref();
            to.stiffness.put(lane, series.unwrap_or(&Series::zero()));
            to.pulses[lane] = from.impact.powers().map(|_| &from.impact);
            for (to, from) in to.powers.iter_mut().zip(from.impact.powers().unwrap_or(&NONE)) {
                to.set(lane, *from);
            }
            to.impact.put(lane, from.impact.series().unwrap_or(&Series::zero()));
        }
    }
}

impl<const L: usize> Excite<Lanes<L>> for LaneExcitations<'_, L> {
    #[inline(always)]
    fn excite(
        &self,
        phase: Lanes<L>,
        inside: Lanes<L>,
        contact: [Lanes<L>; 2],
        order: usize,
        terms: &mut ExcitationTerms<Lanes<L>>,
    ) {
        let zero = Lanes::splat(0.0);
        for (j, e) in self.halves.iter().enumerate() {
            terms.cells[j].in_use = e.contacts.iter().any(Option::is_some);
            if terms.cells[j].in_use {
                for lane in 0..L {
                    if let Some(course) = e.contacts[lane] {
                        let (phase, inside) = (phase.get(lane), inside.get(lane));
                        course.put(phase, inside, contact[j].get(lane) as Contact, lane, &mut terms.cells[j]);
                    }
                }
            } else {
                let stiffness = &mut terms.stiffness[j];
                e.stiffness.fill(phase, order, stiffness);
                terms.degree[j] = if e.stiffness.is_constant() { 3 } else { order };
                for lane in 0..L {
                    if let Some(cubic) = e.cubics[lane].and_then(|c| c.cubic(phase.get(lane), inside.get(lane))) {
                        for (n, c) in cubic.into_iter().enumerate() {
                            stiffness[n].set(lane, c);
                        }
                    }
                }
                terms.mirror(j, order);
            }
            let (mut sin, mut cos) = (zero, zero);
            for lane in 0..L {
                let pulse = e.pulses[lane].and_then(|p| p.pulse(phase.get(lane), inside.get(lane)));
                let (s, c) = pulse.unwrap_or((0.0, 0.0));
                sin.set(lane, s);
                cos.set(lane, c);
            }
            terms.pushed[j] = sin.any(|s| s != 0.0) || cos.any(|c| c != 0.0);
            if terms.pushed[j] {
                pulse(sin, cos, &e.powers, order, &mut terms.impact[j]);
            }
            if !e.impact.is_constant() {
                let mut harmonics = [zero; MAX_ORDER + 1];
                e.impact.fill(phase, order, &mut harmonics);
                for n in 0..=order {
                    let pulse = if terms.pushed[j] { terms.impact[j][n] } else { zero };
                    terms.impact[j][n] = pulse + harmonics[n];
                }
                terms.pushed[j] = true;
            }
        }
    }
}
