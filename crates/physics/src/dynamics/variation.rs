//! Variational equations: small perturbations of a motion over mesh periods.

use nalgebra::DMatrix;

use super::equations::Equations;
use super::excitation::MAX_ORDER;
use super::expansion::ExcitationTerms;
use super::lanes::{Lanes, Real};
use super::model::{ContactSide, DynamicModel, MotionState};
use super::recurrence::{TaylorWork, taylor_coefficients};
use super::segment::{Observer, Segment};
use super::taylor::{evaluate_rows, step_for_tolerance};
use super::train_variation::TrainPropagator;
use crate::simd::vectorised;

/// Perturbations integrated side by side.
const PERTURBATION_LANES: usize = 12;

/// Magnitude below which a component of a perturbation is set to zero. In the subnormal range it would have too few
/// digits to choose a step by, and steps would become ever shorter.
const NEGLIGIBLE: f64 = 1e-200;

/// A perturbation: displacements, and velocities in scaled time.
pub(crate) type Perturbation<const D: usize> = ([f64; D], [f64; D]);

/// Integrates the variational equations along a motion, as the observer of that motion. `model` holds the equations of
/// the perturbations: the motion's own, or those of antisymmetric perturbations ([`DynamicModel::antisymmetric`]).
///
/// With damping in the gap the mesh force is continuous in the state, so a perturbation passes a change of contact
/// unchanged. Without it the force jumps by c_m ds/dt and the velocity of the perturbation by the saltation term (a₊ −
/// a₋) δs/(ds/dt) (R. I. Leine, H. Nijmeijer: Dynamics and Bifurcations of Non-Smooth Mechanical Systems, Springer
/// 2004, doi:10.1007/978-3-540-44398-8).
pub(crate) struct Variation<'m, const D: usize> {
    model: &'m DynamicModel<D>,
    /// The perturbations; with a `propagator` only their number.
    pub columns: Vec<Perturbation<D>>,
    /// All perturbations of a train, if they are many.
    propagator: Option<Box<TrainPropagator>>,
    tolerance: f64,
    last_contact: Option<[ContactSide; 2]>,
    /// `None` only during [`Observer::segment`].
    workspace: Option<Box<PerturbationWorkspace<D>>>,
}

/// Working memory for one perturbation and for several.
struct PerturbationWorkspace<const D: usize> {
    one: Box<TaylorWork<D, f64>>,
    /// None for trains.
    several: Option<SeveralPerturbations<D>>,
    terms: ExcitationTerms<f64>,
}

/// Working memory and equations of perturbations in lanes.
struct SeveralPerturbations<const D: usize> {
    work: Box<TaylorWork<D, Lanes<PERTURBATION_LANES>>>,
    equations: Equations<D, Lanes<PERTURBATION_LANES>>,
}

/// Number of perturbations of a train from which they are propagated together.
const MANY_PERTURBATIONS: usize = 4;

impl<'m, const D: usize> Variation<'m, D> {
    pub(crate) fn new(model: &'m DynamicModel<D>, columns: Vec<Perturbation<D>>, tolerance: f64) -> Self {
        let workspace = PerturbationWorkspace {
            one: TaylorWork::new(),
            several: if DynamicModel::<D>::IS_TRAIN {
                None
            } else {
                Some(SeveralPerturbations { work: TaylorWork::new(), equations: model.broadcast() })
            },
            terms: ExcitationTerms::new(),
        };
        let modes = if columns.len() < MANY_PERTURBATIONS { None } else { model.train_modes() };
        let propagator = modes.map(|modes| Box::new(TrainPropagator::new(modes, &columns, tolerance)));
        Self { model, columns, propagator, tolerance, last_contact: None, workspace: Some(Box::new(workspace)) }
    }

    /// Derivative of the end by the start after [`Variation::unit_perturbations`], over (active displacements, active
    /// velocities).
    pub(crate) fn monodromy(&self) -> DMatrix<f64> {
        if let (Some(propagator), Some(modes)) = (&self.propagator, self.model.train_modes()) {
            return propagator.states(modes);
        }
        let active: Vec<usize> = self.model.active().collect();
        let n = active.len();
        DMatrix::from_fn(2 * n, 2 * n, |r, c| {
            let (x, v) = &self.columns[c];
            if r < n { x[active[r]] } else { v[active[r - n]] }
        })
    }

    /// The unit perturbations: one per active displacement, then one per active velocity.
    pub(crate) fn unit_perturbations(model: &DynamicModel<D>) -> Vec<Perturbation<D>> {
        let unit = |c: usize| {
            let mut row = [0.0; D];
            row[c] = 1.0;
            row
        };
        let places = model.active().map(|c| (unit(c), [0.0; D]));
        let speeds = model.active().map(|c| ([0.0; D], unit(c)));
        places.chain(speeds).collect()
    }

    fn apply_saltation(&mut self, segment: &Segment<'_, D>, before: [ContactSide; 2]) {
        for j in 0..DynamicModel::<D>::HALVES {
            let (was, is) = (before[j], segment.contact[j]);
            let speed = self.model.rate_of_approach(j, self.model.s(j, &segment.rows[1]), segment.phase);
            let h = &self.model.halves[j];
            // A change from one level of a contact force to the next leaves the force continuous.
            if (was == 0) == (is == 0) || speed == 0.0 || h.cm == h.cm_in_gap {
                continue;
            }
            let damper = (h.cm - h.cm_in_gap) * speed;
            let change = f64::from(i8::from(is != 0) - i8::from(was != 0)) * damper;
            let acceleration = self.model.acceleration_of_mesh_force(j, change);
            // Velocity of s relative to the displacement at which contact begins, which may depend on time.
            let side = if is != 0 { is.signum() } else { was.signum() };
            let crossing_speed = speed - f64::from(side) * self.model.contact_onset_rate(j, side, segment.phase);
            if crossing_speed == 0.0 {
                continue;
            }
            if let (Some(propagator), Some(modes)) = (&mut self.propagator, self.model.train_modes()) {
                propagator.saltate(modes, j, change, crossing_speed);
                continue;
            }
            for (x, v) in &mut self.columns {
                let delay = self.model.s(j, x) / crossing_speed;
                for c in 0..D {
                    v[c] += acceleration[c] * delay;
                }
            }
        }
    }

    /// Integrates the columns from `first` on, one per lane, over a segment.
    #[inline(always)]
    fn propagate<R: Real>(
        &mut self,
        segment: &Segment<'_, D>,
        first: usize,
        equations: &Equations<D, R>,
        terms: &mut ExcitationTerms<f64>,
        work: &mut TaylorWork<D, R>,
    ) {
        let count = (self.columns.len() - first).min(R::LANES);
        // Lanes without a column of their own repeat the last one.
        let column = |lane: usize| first + lane.min(count - 1);
        let flushed = |c: f64| if c.abs() < NEGLIGIBLE { 0.0 } else { c };
        let mut x: [R; D] = std::array::from_fn(|c| R::from_fn(|l| flushed(self.columns[column(l)].0[c])));
        let mut v: [R; D] = std::array::from_fn(|c| R::from_fn(|l| flushed(self.columns[column(l)].1[c])));
        let order = segment.degree.clamp(12, MAX_ORDER);
        let period_tau = self.model.period_tau;
        let interior = segment.phase + 0.5 * segment.h / period_tau;
        let contact = segment.contact.map(|c| R::splat(f64::from(c.signum())));
        let mut at = 0.0;
        loop {
            self.model.expand_for_perturbations(segment, at, interior, order, terms);
            work.excitation.broadcast(terms, order);
            (work.rows[0], work.rows[1]) = (x, v);
            taylor_coefficients(equations, contact, order, R::splat(0.0), None, work);
            let left = segment.h - at;
            let reaches: R = step_for_tolerance(&work.rows, order, self.tolerance);
            let reach = (0..R::LANES).fold(f64::INFINITY, |least, lane| least.min(reaches.get(lane)));
            // A NaN step takes the whole segment: the motion itself has diverged and reports it.
            let h = if reach < left { left / (left / reach).ceil().min(1e4) } else { left };
            (x, v) = evaluate_rows(&work.rows[..=order], R::splat(h));
            if h >= left {
                break;
            }
            at += h;
        }
        for lane in 0..count {
            self.columns[first + lane] = (x.map(|c| c.get(lane)), v.map(|c| c.get(lane)));
        }
    }
}

impl<const D: usize> Observer<D> for Variation<'_, D> {
    fn segment(&mut self, segment: &Segment<'_, D>) {
        if let Some(before) = self.last_contact
            && before != segment.contact
        {
            self.apply_saltation(segment, before);
        }
        self.last_contact = Some(segment.contact);
        if let (Some(propagator), Some(modes)) = (&mut self.propagator, self.model.train_modes()) {
            propagator.segment(modes, self.model, segment);
            return;
        }
        let Some(mut workspace) = self.workspace.take() else { return };
        let PerturbationWorkspace { one, several, terms } = &mut *workspace;
        vectorised(
            #[inline(always)]
            || {
                let mut first = 0;
                while first < self.columns.len() {
                    let lanes = several.as_mut().filter(|_| self.columns.len() - first > 1);
                    if DynamicModel::<D>::IS_TRAIN {
                        self.propagate::<f64>(segment, first, self.model, terms, one);
                        first += 1;
                    } else if let Some(SeveralPerturbations { work, equations }) = lanes {
                        self.propagate::<Lanes<PERTURBATION_LANES>>(segment, first, equations, terms, work);
                        first += PERTURBATION_LANES;
                    } else {
                        self.propagate::<f64>(segment, first, self.model, terms, one);
                        first += 1;
                    }
                }
            },
        );
        self.workspace = Some(workspace);
    }
}

/// Passes segments to two observers.
pub(crate) struct ObserverPair<'a, A, B>(pub &'a mut A, pub &'a mut B);

impl<const D: usize, A: Observer<D>, B: Observer<D>> Observer<D> for ObserverPair<'_, A, B> {
    fn segment(&mut self, segment: &Segment<'_, D>) {
        self.0.segment(segment);
        self.1.segment(segment);
    }
}

/// Difference of two states, `a` − `b`.
pub(crate) fn state_difference<const D: usize>(a: &MotionState<D>, b: &MotionState<D>) -> Perturbation<D> {
    (std::array::from_fn(|c| a.x[c] - b.x[c]), std::array::from_fn(|c| a.v[c] - b.v[c]))
}
