//! Small deviations from a motion: the linear map over mesh periods, and how fast they grow.

use super::excitation::MAX_ORDER;
use super::model::{Contact, Model, State};
use super::recurrence::TaylorWork;
use super::segment::{Observer, Segment};
use super::taylor::{evaluate_rows, step_reach};

/// A deviation: displacements and scaled velocities.
pub(crate) type Deviation<const D: usize> = ([f64; D], [f64; D]);

/// Carries deviations along a motion, as the observer of that motion. `model` holds the equations the deviations obey:
/// the motion's own, or those against its mirror symmetry.
///
/// With damping in the gap the mesh force is continuous in the state, so deviations pass a change of contact unchanged; without,
/// the force jumps by c_m ds/dt and the deviation of the velocity by (a₊ − a₋) δs/(ds/dt).
pub(crate) struct Variation<'m, const D: usize> {
    model: &'m Model<D>,
    pub columns: Vec<Deviation<D>>,
    tolerance: f64,
    last_contact: Option<[Contact; 2]>,
    work: Box<TaylorWork<D>>,
}

impl<'m, const D: usize> Variation<'m, D> {
    pub fn new(model: &'m Model<D>, columns: Vec<Deviation<D>>, tolerance: f64) -> Self {
        Self { model, columns, tolerance, last_contact: None, work: TaylorWork::new() }
    }

    /// One unit deviation per active displacement, then one per active velocity.
    pub fn units(model: &Model<D>) -> Vec<Deviation<D>> {
        let unit = |c: usize| {
            let mut row = [0.0; D];
            row[c] = 1.0;
            row
        };
        let places = model.active().map(|c| (unit(c), [0.0; D]));
        let speeds = model.active().map(|c| ([0.0; D], unit(c)));
        places.chain(speeds).collect()
    }

    fn jump(&mut self, segment: &Segment<'_, D>, before: [Contact; 2]) {
        for j in 0..Model::<D>::HALVES {
            let (was, is) = (before[j], segment.contact[j]);
            let speed = self.model.s(j, &segment.rows[1]);
            if was == is || speed == 0.0 {
                continue;
            }
            let damper = self.model.halves[j].cm * speed;
            let change = f64::from(i8::from(is != 0) - i8::from(was != 0)) * damper;
            let push = self.model.push(j, change);
            for (x, v) in &mut self.columns {
                let later = self.model.s(j, x) / speed;
                for c in 0..D {
                    v[c] += push[c] * later;
                }
            }
        }
    }
}

impl<const D: usize> Observer<D> for Variation<'_, D> {
    fn segment(&mut self, segment: &Segment<'_, D>) {
        if let Some(before) = self.last_contact
            && before != segment.contact
            && !self.model.damping_in_gap
        {
            self.jump(segment, before);
        }
        self.last_contact = Some(segment.contact);
        let order = segment.degree.clamp(12, MAX_ORDER);
        let inside = segment.phase + 0.5 * segment.h / self.model.period_tau;
        self.work.excite(self.model, segment.phase, inside, order);
        let mut filled_at = 0.0;
        for i in 0..self.columns.len() {
            let mut at = 0.0;
            loop {
                if at != filled_at {
                    self.work.excite(self.model, segment.phase + at / self.model.period_tau, inside, order);
                    filled_at = at;
                }
                (self.work.rows[0], self.work.rows[1]) = self.columns[i];
                self.model.taylor(segment.contact, order, false, &mut self.work);
                let left = segment.h - at;
                let reach = step_reach(&self.work.rows[..], order, self.tolerance, f64::INFINITY);
                // A NaN reach takes the whole step: the motion itself has diverged and says so.
                let h = if reach < left { left / (left / reach).ceil().min(1e4) } else { left };
                self.columns[i] = evaluate_rows(&self.work.rows[..=order], h);
                if h >= left {
                    break;
                }
                at += h;
            }
        }
    }
}

/// Looks through two observers at once.
pub(crate) struct Both<'a, A, B>(pub &'a mut A, pub &'a mut B);

impl<const D: usize, A: Observer<D>, B: Observer<D>> Observer<D> for Both<'_, A, B> {
    fn segment(&mut self, segment: &Segment<'_, D>) {
        self.0.segment(segment);
        self.1.segment(segment);
    }
}

/// Deviation of one state from another.
pub(crate) fn difference<const D: usize>(a: &State<D>, b: &State<D>) -> Deviation<D> {
    (std::array::from_fn(|c| a.x[c] - b.x[c]), std::array::from_fn(|c| a.v[c] - b.v[c]))
}
