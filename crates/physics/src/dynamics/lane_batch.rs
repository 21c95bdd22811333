//! Integration of several trajectories side by side, one per vector lane, each with its own time.

use super::equations::Equations;
use super::error::DynamicsError;
use super::excitation::MAX_ORDER;
use super::expansion::LaneExcitations;
use super::integrate::{Integrator, Motion, StepCounts, has_diverged};
use super::lanes::{Lanes, Real};
use super::model::{ContactSide, DynamicModel, MotionState};
use super::recurrence::TaylorWork;
use super::segment::{Observer, Segment};
use super::taylor::{ChatterGuard, SmoothInterval, StepOutcome, evaluate_rows, order_for, step, step_error};
use crate::simd::vectorised;
use crate::watch::{Canceled, Watch};

/// Number of lanes of a batch.
pub(crate) const BATCH_LANES: usize = 8;

/// Operating points per task of the thread pool.
pub(crate) const POINTS_PER_TASK: usize = 4 * BATCH_LANES;

/// One trajectory to be integrated: its model, start and tolerance, and the observer of its steps.
pub(crate) trait TrajectoryObserver<'m, const D: usize> {
    /// Equations of motion of the trajectory.
    fn model(&self) -> &'m DynamicModel<D>;

    /// Initial state, at the start of a mesh period.
    fn start(&self) -> MotionState<D>;

    /// Local error of a step relative to the size of the motion.
    fn tolerance(&self) -> f64;

    /// Completed fraction of the trajectory, 0 … 1, for the progress report.
    fn fraction_done(&self) -> f64;

    /// Whether [`TrajectoryObserver::segment`] is to be called for the steps of the current mesh period.
    fn wants_segments(&self) -> bool;

    /// Receives one step; called only while [`TrajectoryObserver::wants_segments`].
    fn segment(&mut self, segment: &Segment<'_, D>);

    /// Receives the state at the end of a mesh period. Returns whether the integration continues.
    fn finish_period(&mut self, state: &MotionState<D>) -> bool;

    /// Receives the step counts of the whole trajectory and the error that ended it, if any.
    fn finished(&mut self, counts: StepCounts, error: Option<DynamicsError>);
}

/// Steps of a batch between two calls of [`Watch::checkpoint`].
const BATCH_STEPS_PER_CHECKPOINT: u32 = 2048;

/// Integrates all trajectories, [`BATCH_LANES`] at a time; a lane whose trajectory is finished takes the next one of
/// the queue. Each result is bit-identical to that of the trajectory alone at the Taylor order of `order_tolerance`.
/// `max_steps` limits the steps of each trajectory.
///
/// # Errors
/// [`Canceled`] by the watch. An error of a trajectory is passed to its observer.
pub(crate) fn integrate_trajectories<'m, const D: usize, P: TrajectoryObserver<'m, D>>(
    observers: &mut [P],
    order_tolerance: f64,
    max_steps: u64,
    watch: &Watch<'_>,
) -> Result<(), Canceled> {
    // All lanes of a batch have the same kind of mesh force.
    let (by_contact, by_stiffness): (Vec<usize>, Vec<usize>) =
        (0..observers.len()).partition(|&i| observers[i].model().uses_contact_force());
    for queue in [by_stiffness, by_contact] {
        integrate_lanes(observers, &queue, order_tolerance, max_steps, watch)?;
    }
    Ok(())
}

/// Integrates the trajectories with the indices `queue`, whose mesh forces are of one kind.
fn integrate_lanes<'m, const D: usize, P: TrajectoryObserver<'m, D>>(
    observers: &mut [P],
    queue: &[usize],
    order_tolerance: f64,
    max_steps: u64,
    watch: &Watch<'_>,
) -> Result<(), Canceled> {
    let mut queue = queue.iter().copied();
    let mut batch = LaneBatch::<D, BATCH_LANES>::new(order_for(order_tolerance), max_steps);
    let mut finished = 0;
    let mut since_checkpoint = 0;
    loop {
        for lane in 0..BATCH_LANES {
            if batch.slots[lane].is_none()
                && let Some(next) = queue.next()
            {
                batch.load_lane(lane, next, &observers[next]);
            }
        }
        if batch.slots.iter().all(Option::is_none) {
            return Ok(());
        }
        // Lanes are refilled only after a trajectory has finished.
        loop {
            let before = finished;
            let stepped = batch.step();
            finished += batch.finish_step(&stepped, observers);
            since_checkpoint += 1;
            if since_checkpoint == BATCH_STEPS_PER_CHECKPOINT {
                since_checkpoint = 0;
                watch.checkpoint(finished as f64 / observers.len() as f64)?;
            }
            if finished > before {
                break;
            }
        }
    }
}

/// Integrates one trajectory by the given method.
///
/// # Errors
/// [`Canceled`] by the watch. An error of the trajectory is passed to its observer.
pub(crate) fn integrate_trajectory<'m, const D: usize, P: TrajectoryObserver<'m, D>>(
    observer: &mut P,
    integrator: Integrator,
    max_steps: u64,
    watch: &Watch<'_>,
) -> Result<(), Canceled> {
    let mut motion = Motion::new(observer.model(), observer.start(), integrator, observer.tolerance(), max_steps);
    let error = loop {
        let fraction = observer.fraction_done();
        let advanced = motion.advance_period(&mut SegmentForwarder(observer), watch, fraction);
        if let Err(error) = advanced {
            break Some(error);
        }
        watch.checkpoint(fraction)?;
        if !observer.finish_period(&motion.state) {
            break None;
        }
    };
    if error == Some(DynamicsError::Canceled(Canceled)) {
        return Err(Canceled);
    }
    observer.finished(motion.counts, error);
    Ok(())
}

/// Passes the segments of a motion to a trajectory observer that wants them.
struct SegmentForwarder<'a, P>(&'a mut P);

impl<'m, const D: usize, P: TrajectoryObserver<'m, D>> Observer<D> for SegmentForwarder<'_, P> {
    fn segment(&mut self, segment: &Segment<'_, D>) {
        if self.0.wants_segments() {
            self.0.segment(segment);
        }
    }
}

/// Trajectory that occupies a lane.
#[derive(Clone, Copy)]
struct LaneSlot {
    observer: usize,
    period: u64,
    /// Index of the breakpoint at which the current smooth interval ends.
    breakpoint: usize,
    steps: u64,
    evaluations: u64,
    chatter: ChatterGuard,
}

/// State of all lanes of a batch.
struct LaneBatch<'m, const D: usize, const L: usize> {
    order: usize,
    max_steps: u64,
    slots: [Option<LaneSlot>; L],
    equations: Equations<D, Lanes<L>>,
    excitations: LaneExcitations<'m, L>,
    interval: SmoothInterval<Lanes<L>>,
    contact: [Lanes<L>; 2],
    size: Lanes<L>,
    work: Box<TaylorWork<D, Lanes<L>>>,
    /// Displacements and velocities at the end of the step.
    end: ([Lanes<L>; D], [Lanes<L>; D]),
    /// Polynomials of one lane, for its observer.
    rows: Box<[[f64; D]; MAX_ORDER + 1]>,
    force: Box<[[f64; MAX_ORDER + 1]; 2]>,
}

impl<'m, const D: usize, const L: usize> LaneBatch<'m, D, L> {
    fn new(order: usize, max_steps: u64) -> Self {
        let zero = Lanes::splat(0.0);
        Self {
            order,
            max_steps,
            slots: [None; L],
            equations: Equations::at_rest(),
            excitations: LaneExcitations::none(),
            interval: SmoothInterval {
                phase: zero,
                end: zero,
                interior: zero,
                period_tau: Lanes::splat(1.0),
                tolerance: Lanes::splat(1.0),
                fixed: Lanes::splat(f64::INFINITY),
                switching: zero,
            },
            contact: [zero; 2],
            size: zero,
            work: TaylorWork::new(),
            end: ([zero; D], [zero; D]),
            rows: Box::new([[0.0; D]; MAX_ORDER + 1]),
            force: Box::new([[0.0; MAX_ORDER + 1]; 2]),
        }
    }

    fn load_lane(&mut self, lane: usize, index: usize, observer: &impl TrajectoryObserver<'m, D>) {
        let model = observer.model();
        let state = observer.start();
        self.equations.put(lane, model);
        self.excitations.put(lane, &model.excitations);
        self.slots[lane] = Some(LaneSlot {
            observer: index,
            period: state.period,
            breakpoint: 0,
            steps: 0,
            evaluations: 0,
            chatter: ChatterGuard::default(),
        });
        self.size.set(lane, 0.0);
        let s = &mut self.interval;
        s.period_tau.set(lane, model.period_tau);
        s.tolerance.set(lane, observer.tolerance());
        s.switching.set(lane, if model.contact_can_change() { 1.0 } else { 0.0 });
        self.set_state(lane, &state);
        self.set_smooth_interval(lane, model, 0.0, 0);
    }

    /// Sets the state of a lane.
    fn set_state(&mut self, lane: usize, state: &MotionState<D>) {
        for c in 0..D {
            self.end.0[c].set(lane, state.x[c]);
            self.end.1[c].set(lane, state.v[c]);
        }
        for j in 0..2 {
            self.contact[j].set(lane, f64::from(state.contact[j]));
        }
        self.interval.phase.set(lane, state.phase);
    }

    /// Sets the smooth interval of a lane: from the phase `from` to the breakpoint of this index.
    fn set_smooth_interval(&mut self, lane: usize, model: &DynamicModel<D>, from: f64, breakpoint: usize) {
        let end = model.breakpoints[breakpoint];
        self.interval.end.set(lane, end);
        self.interval.interior.set(lane, 0.5 * (from + end));
    }

    fn state(&self, lane: usize, period: u64) -> MotionState<D> {
        MotionState {
            period,
            phase: self.interval.phase.get(lane),
            x: self.end.0.map(|c| c.get(lane)),
            v: self.end.1.map(|c| c.get(lane)),
            contact: self.contact.map(|c| c.get(lane) as ContactSide),
        }
    }

    /// Takes one step in every lane.
    fn step(&mut self) -> StepOutcome<Lanes<L>> {
        let Self { order, equations, excitations, interval, contact, size, work, end, .. } = self;
        vectorised(
            #[inline(always)]
            || {
                (work.rows[0], work.rows[1]) = *end;
                let stepped = step(equations, &*excitations, *order, *interval, *contact, size, work);
                *end = evaluate_rows(&work.rows[..=stepped.degree], stepped.h);
                stepped
            },
        )
    }

    /// Evaluates the step in every lane: events, ends of mesh periods, errors. Returns the number of finished
    /// trajectories.
    fn finish_step<P: TrajectoryObserver<'m, D>>(
        &mut self,
        stepped: &StepOutcome<Lanes<L>>,
        observers: &mut [P],
    ) -> usize {
        let mut finished = 0;
        for lane in 0..L {
            let Some(mut slot) = self.slots[lane] else { continue };
            let observer = &mut observers[slot.observer];
            let model = observer.model();
            let (h, changed) = (stepped.h.get(lane), stepped.changed.get(lane));
            let (from, end) = (self.interval.phase.get(lane), self.interval.end.get(lane));
            let to_end = stepped.to_end.get(lane) != 0.0;
            let phase = if to_end { end } else { (from + h / model.period_tau).min(end) };
            slot.steps += 1;
            slot.evaluations += (stepped.degree - 1) as u64;
            let step_error = step_error(model, slot.period, from, h, phase > from || changed >= 0.0);
            let error = step_error.or_else(|| {
                (slot.steps > self.max_steps).then(|| DynamicsError::TooManySteps {
                    time_s: (slot.period as f64 + from) * model.period_tau / model.omega_ref,
                    limit: self.max_steps,
                })
            });
            if let Some(error) = error {
                self.unload_lane(lane, &slot, observer, Some(error));
                finished += 1;
                continue;
            }
            if observer.wants_segments() {
                self.emit_segment(lane, &slot, model, h, stepped.degree, observer);
            }
            self.interval.phase.set(lane, phase);
            if changed >= 0.0 {
                self.contact[changed as usize].set(lane, stepped.contact.get(lane));
                let mut state = self.state(lane, slot.period);
                if slot.chatter.contact_changed(model, &mut state, end) {
                    self.set_state(lane, &state);
                }
            }
            if self.interval.phase.get(lane) >= end {
                slot.breakpoint += 1;
                if slot.breakpoint < model.breakpoints.len() {
                    self.set_smooth_interval(lane, model, end, slot.breakpoint);
                } else {
                    slot.period += 1;
                    slot.breakpoint = 0;
                    self.interval.phase.set(lane, 0.0);
                    self.set_smooth_interval(lane, model, 0.0, 0);
                    let state = self.state(lane, slot.period);
                    let error = has_diverged(&state).then(|| DynamicsError::Diverged {
                        time_s: slot.period as f64 * model.period_tau / model.omega_ref,
                    });
                    if error.is_some() || !observer.finish_period(&state) {
                        self.unload_lane(lane, &slot, observer, error);
                        finished += 1;
                        continue;
                    }
                }
            }
            self.slots[lane] = Some(slot);
        }
        finished
    }

    /// Passes the step of a lane to its observer.
    fn emit_segment(
        &mut self,
        lane: usize,
        slot: &LaneSlot,
        model: &DynamicModel<D>,
        h: f64,
        degree: usize,
        observer: &mut impl TrajectoryObserver<'m, D>,
    ) {
        for n in 0..=degree {
            for c in 0..D {
                self.rows[n][c] = self.work.rows[n][c].get(lane);
            }
        }
        for j in 0..DynamicModel::<D>::HALVES {
            for n in 0..=degree {
                self.force[j][n] = self.work.force[j][n].get(lane);
            }
        }
        observer.segment(&Segment {
            model,
            period: slot.period,
            phase: self.interval.phase.get(lane),
            h,
            degree,
            rows: &self.rows,
            force: &self.force,
            contact: self.contact.map(|c| c.get(lane) as ContactSide),
        });
    }

    /// Empties a lane. Its equations stay, at rest over an interval of length zero.
    fn unload_lane(
        &mut self,
        lane: usize,
        slot: &LaneSlot,
        observer: &mut impl TrajectoryObserver<'m, D>,
        error: Option<DynamicsError>,
    ) {
        self.slots[lane] = None;
        let rest = MotionState { period: 0, phase: 0.0, x: [0.0; D], v: [0.0; D], contact: [0; 2] };
        self.set_state(lane, &rest);
        self.interval.end.set(lane, 0.0);
        self.interval.interior.set(lane, 0.0);
        self.interval.switching.set(lane, 0.0);
        let counts = StepCounts { steps: slot.steps, rejected_steps: 0, force_evaluations: slot.evaluations };
        observer.finished(counts, error);
    }
}
