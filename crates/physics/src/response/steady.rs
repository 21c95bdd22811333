//! Search for the steady motion: periodic without loss of contact, periodic with it, or a motion that does not repeat.

use nalgebra::{Complex, DMatrix};

use super::budget::{Budget, budget_exhausted, steps_per_period};
use super::lyapunov::{
    CHAOS_PER_MESH_PERIOD, LYAPUNOV_MESH_PERIODS, lyapunov_exponent, lyapunov_exponent_with, perturbation_decay,
};
use super::poincare::{PoincareSection, largest_component};
use crate::dynamics::{
    BroydenSteps, DIVERGENCE_LIMIT_M, DynamicModel, DynamicsError, IntegrationLimits, Integrator, Motion, MotionState,
    PER_HALF, Perturbation, RigidBodyModes, Shooting, StepCounts, U, Unobserved, state_difference,
};

/// Mesh periods after which a motion that does not nearly repeat counts as aperiodic.
const MAX_TRANSIENT_MESH_PERIODS: u64 = 1500;
/// Smallest number of mesh periods from which a motion can be called aperiodic.
const MIN_TRANSIENT_MESH_PERIODS: u64 = 40;
/// Relative change over its period below which Newton's method is started.
const NEWTON_START_CHANGE: f64 = 1e-3;
/// Relative change over a fraction of its period below which an orbit has that fraction as its period.
const SAME_PERIOD_CHANGE: f64 = 1e-6;
/// Tolerance with which a transient is followed: its end is a start of Newton's method, or of a record.
const TRANSIENT_TOLERANCE: f64 = 1e-6;
/// Mesh periods between two attempts.
const MESH_PERIODS_BETWEEN_ATTEMPTS: u64 = 40;
/// Mesh periods after which a motion that has not nearly repeated is first tested for chaos; after as many again, and
/// so on twice as late each time. Length of a test, and the exponent per mesh period above which it is decided: the
/// exponents of regular motions over so few mesh periods stay well below.
const CHAOS_TEST_MESH_PERIODS: u64 = 300;
const CHAOS_TEST_LENGTH_MESH_PERIODS: u64 = 100;
const SURELY_CHAOTIC_PER_MESH_PERIOD: f64 = 0.05;
/// Length of the record of an aperiodic motion, and the limit of its steps.
const LONG_RECORD_MESH_PERIODS: u64 = 2000;
const LONG_RECORD_STEPS: u64 = 2_000_000;
/// Steps per mesh period above which the motion is first integrated over a few mesh periods, in case the transient
/// decays within them: the monodromy matrix needs one perturbation per displacement and velocity.
const MANY_STEPS_PER_PERIOD: f64 = 2000.0;
/// Number of these mesh periods, and the required reduction of the change from one to the next.
const SETTLING_MESH_PERIODS: u64 = 6;
const SETTLING_REDUCTION: f64 = 0.03;
/// Change below which a lack of reduction is rounding; its effect on the result is measured by the error estimate.
const SETTLING_ROUNDING: f64 = 1e-5;
/// Remaining part of a perturbation after a mesh period below which the transient counts as decayed.
const DECAYED: f64 = 0.01;
/// Modulus of a multiplier above which the start of an orbit is refined with a finer tolerance: an error of the map is
/// amplified by 1/(1 − modulus) in the start.
const SLOW_DECAY: f64 = 0.95;

/// A steady motion, ready to be recorded.
pub(super) struct SteadyMotion<const D: usize> {
    pub start: MotionState<D>,
    /// Mesh periods to record.
    pub record: u64,
    /// Period in mesh periods and monodromy matrix over it; None for an aperiodic motion.
    pub orbit: Option<(u64, DMatrix<f64>)>,
    /// Largest modulus of the Floquet multipliers, per mesh period.
    pub floquet: Option<f64>,
    /// All multipliers over the orbit, antisymmetric ones included, largest first.
    pub multipliers: Vec<Complex<f64>>,
    /// Largest Lyapunov exponent per mesh period.
    pub lyapunov: Option<f64>,
    /// Whether the motion counts as chaotic by its exponent, before the longest transient has passed.
    pub chaotic_early: bool,
    /// Whether antisymmetric perturbations grow, so that the motion leaves the mirror symmetry.
    pub leaves_symmetry: bool,
    pub tolerance: f64,
    pub counts: StepCounts,
}

/// Parameters of a search.
pub(super) struct SteadyStateSearch<'a, const D: usize> {
    pub model: &'a DynamicModel<D>,
    pub mean_stiffness_n_per_m: [f64; 2],
    pub limits: IntegrationLimits<'a>,
    /// Whether an aperiodic motion is an error.
    pub must_repeat: bool,
    /// Whether the motion reached from the start is required, even if another one keeps contact.
    pub from_start: bool,
    /// Whether a motion is tested for chaos before the longest transient has passed.
    pub tests_for_chaos: bool,
    /// Whether the exponent of a motion that is surely chaotic is to be averaged over more mesh periods than show that.
    pub wants_exponent: bool,
}

impl<const D: usize> SteadyStateSearch<'_, D> {
    /// The steady motion reached from `start`, or the periodic one without loss of contact if it exists and is stable.
    ///
    /// # Errors
    /// [`DynamicsError`].
    pub(crate) fn run(&self, start: MotionState<D>) -> Result<SteadyMotion<D>, DynamicsError> {
        let mut budget = Budget::new::<D>(&self.limits);
        self.check_static_deflection(&start)?;
        let start = self.perturb_from_rest(start);
        let mut counts = StepCounts::default();
        if steps_per_period(self.model) > MANY_STEPS_PER_PERIOD
            && let Some(found) = self.settle_by_integration(start, &mut budget, &mut counts)?
        {
            return Ok(found);
        }
        // Also checks that a steady state exists.
        let keeps_contact = if self.model.uses_contact_force() {
            self.orbit_near_static_deflection(start, &mut budget, &mut counts)?
        } else {
            self.orbit_in_contact(start, &mut budget, &mut counts)?
        };
        if let Some(found) = keeps_contact.filter(|_| !self.from_start) {
            return Ok(found);
        }
        self.motion_by_integration(start, &mut budget, counts)
    }

    /// Fails where the static deflection exceeds the limit of any motion.
    pub(super) fn check_static_deflection(&self, start: &MotionState<D>) -> Result<(), DynamicsError> {
        let furthest = largest_component(&(start.x, [0.0; D]));
        if furthest > DIVERGENCE_LIMIT_M {
            return Err(DynamicsError::InvalidParameter {
                name: "static deflection in m",
                value: furthest,
                reason: "the springs are far too weak for the load",
            });
        }
        Ok(())
    }

    /// Perturbs a start at zero (a pair without load), at which the motion has no size for the step control, by 1e-6 of
    /// the deflection that the largest impact force could cause.
    fn perturb_from_rest(&self, start: MotionState<D>) -> MotionState<D> {
        const RELATIVE_SIZE: f64 = 1e-6;
        if start.x.iter().chain(&start.v).any(|c| *c != 0.0) {
            return start;
        }
        let masses = self.model.masses_kg();
        let square = self.model.omega_ref * self.model.omega_ref;
        let mut perturbation: Perturbation<D> = ([0.0; D], [0.0; D]);
        if DynamicModel::<D>::IS_TRAIN {
            for j in 0..DynamicModel::<D>::HALVES {
                let force = -RELATIVE_SIZE * self.model.max_excitation_force_n(j);
                let along = self.model.acceleration_of_mesh_force(j, force);
                (0..D).for_each(|c| perturbation.0[c] += along[c]);
            }
            return displaced(self.model, start, &perturbation);
        }
        for j in 0..DynamicModel::<D>::HALVES {
            let u = j * PER_HALF + U;
            perturbation.0[u] = RELATIVE_SIZE * self.model.max_excitation_force_n(j) / (masses[u] * square);
        }
        displaced(self.model, start, &perturbation)
    }

    fn motion(&self, start: MotionState<D>, budget: &Budget) -> Motion<'_, D> {
        let IntegrationLimits { tolerance, .. } = self.limits;
        Motion::new(self.model, start, Integrator::Taylor, tolerance, budget.steps(0))
    }

    /// Shooting method within the remaining work.
    fn shooting<'s>(&'s self, model: &'s DynamicModel<D>, budget: &Budget) -> Result<Shooting<'s, D>, DynamicsError> {
        Shooting::new(model, self.mean_stiffness_n_per_m, budget.limits(&self.limits, 2 * model.active().count()))
    }

    /// Fails when the mean load has a component along a rigid-body mode.
    fn check_load_balance(&self, shooting: &Shooting<'_, D>, defect: &Perturbation<D>) -> Result<(), DynamicsError> {
        check_load_balance(self.model, shooting, defect)
    }

    /// Periodic motion of a pair whose transient decays within a mesh period, found by integration where the monodromy
    /// matrix would need very many steps. None when the transient decays more slowly.
    fn settle_by_integration(
        &self,
        start: MotionState<D>,
        budget: &mut Budget,
        counts: &mut StepCounts,
    ) -> Result<Option<SteadyMotion<D>>, DynamicsError> {
        let rigid_body = RigidBodyModes::new(self.model)?;
        let mut motion = self.motion(start, budget);
        let mut section = PoincareSection::without_rigid_body(self.model)?;
        section.push(motion.state);
        let (mut last, mut before) = (motion.state, f64::INFINITY);
        let mut settled = false;
        for _ in 0..SETTLING_MESH_PERIODS {
            last = motion.state;
            motion.advance_period(&mut Unobserved, self.limits.watch, 0.0)?;
            section.push(motion.state);
            let change = section.change(1).unwrap_or(f64::INFINITY);
            // Or limited by rounding: the velocity of a slow motion has few digits beside its displacement.
            let floor = change <= SETTLING_ROUNDING && change > SETTLING_REDUCTION * before;
            settled = floor || change <= 10.0 * self.limits.tolerance;
            if settled || change > SETTLING_REDUCTION * before {
                break;
            }
            before = change;
        }
        budget.spend(&motion.counts, 0);
        *counts += motion.counts;
        let steps = motion.counts.steps / (motion.state.period - start.period).max(1);
        if !settled || !budget.affords(steps, 1) {
            return Ok(None);
        }
        let near = MotionState { period: 0, ..last };
        // A mode that this start does not excite may decay more slowly.
        let mut decays = |model: &DynamicModel<D>, rigid_body: &RigidBodyModes<D>| {
            let mut motion = self.motion(near, budget);
            let left = perturbation_decay(&mut motion, model, rigid_body, self.limits.watch)?;
            budget.spend(&motion.counts, 1);
            *counts += motion.counts;
            Ok::<_, DynamicsError>(left < DECAYED)
        };
        if !decays(self.model, &rigid_body)? {
            return Ok(None);
        }
        if D == PER_HALF {
            let antisymmetric = self.model.antisymmetric();
            if !decays(&antisymmetric, &RigidBodyModes::new(&antisymmetric)?)? {
                return Ok(None);
            }
        }
        let shooting = self.shooting(self.model, budget)?;
        let defect = state_difference(&motion.state, &last);
        self.check_load_balance(&shooting, &defect)?;
        let n = 2 * self.model.active().count();
        let zero_monodromy = DMatrix::zeros(n, n);
        let Some(correction) = shooting.corrector(&zero_monodromy, 1).correction(&defect) else { return Ok(None) };
        Ok(Some(SteadyMotion {
            start: displaced(self.model, near, &correction),
            record: 1,
            orbit: Some((1, zero_monodromy)),
            floquet: None,
            multipliers: Vec::new(),
            lyapunov: None,
            chaotic_early: false,
            leaves_symmetry: false,
            tolerance: self.limits.tolerance,
            counts: *counts,
        }))
    }

    /// Periodic orbit with fixed contact: the equations are linear, so one period from any start gives it. None if it
    /// loses contact or is unstable.
    fn orbit_in_contact(
        &self,
        start: MotionState<D>,
        budget: &mut Budget,
        counts: &mut StepCounts,
    ) -> Result<Option<SteadyMotion<D>>, DynamicsError> {
        let perturbations = 2 * self.model.active().count();
        let fixed = self.model.with_fixed_contact();
        let mut first = start;
        for j in 0..DynamicModel::<D>::HALVES {
            first.contact[j] = if self.model.halves[j].load < 0.0 { -1 } else { 1 };
        }
        let shooting = self.shooting(self.model, budget)?;
        let period_map = shooting.period_map(&fixed, first, 1)?;
        budget.spend(&period_map.counts, perturbations);
        *counts += period_map.counts;
        let defect = state_difference(&period_map.end, &first);
        self.check_load_balance(&shooting, &defect)?;
        let within = shooting.multipliers(&period_map.monodromy);
        let modulus = within.first().map(|m| m.norm());
        let Some(modulus) = modulus.filter(|m| *m < 1.0) else { return Ok(None) };
        let Some(correction) = shooting.corrector(&period_map.monodromy, 1).correction(&defect) else {
            return Ok(None);
        };
        let orbit_start = displaced(self.model, first, &correction);
        if orbit_start.contact != first.contact {
            return Ok(None);
        }
        let mut motion = self.motion(orbit_start, budget);
        motion.advance_period(&mut Unobserved, self.limits.watch, 0.0)?;
        budget.spend(&motion.counts, 0);
        *counts += motion.counts;
        if motion.contact_changed {
            return Ok(None);
        }
        let start = self.refine_orbit(&shooting, (orbit_start, 1), &period_map.monodromy, modulus, budget, counts)?;
        let (antisymmetric_modulus, multipliers) = self.with_antisymmetric_multipliers(within, start, 1, budget)?;
        Ok(Some(SteadyMotion {
            start,
            multipliers,
            record: 1,
            orbit: Some((1, period_map.monodromy)),
            floquet: Some(modulus.max(antisymmetric_modulus)),
            lyapunov: None,
            chaotic_early: false,
            leaves_symmetry: antisymmetric_modulus > 1.0,
            tolerance: self.limits.tolerance,
            counts: *counts,
        }))
    }

    /// Period-1 orbit about the static deflection for a tabulated contact force, by Newton's method on the period map.
    /// The monodromy matrix is kept as long as the steps converge (chord method) and computed anew at the orbit. None
    /// if the orbit loses contact, is unstable or is not found.
    fn orbit_near_static_deflection(
        &self,
        start: MotionState<D>,
        budget: &mut Budget,
        counts: &mut StepCounts,
    ) -> Result<Option<SteadyMotion<D>>, DynamicsError> {
        const MAX_ITERATIONS: usize = 12;
        /// Reduction of the defect per step with which a monodromy matrix is kept.
        const CHORD_REDUCTION: f64 = 0.2;
        let perturbations = 2 * self.model.active().count();
        let shooting = self.shooting(self.model, budget)?;
        let mut at = MotionState { period: 0, ..start };
        // The first steps to the orbit of a train need no exact monodromy matrix.
        let approximate = shooting.approximate_period_map(at)?;
        let mut monodromy_is_current = approximate.is_none();
        let mut period_map = match approximate {
            Some(approximate) => approximate,
            None => shooting.period_map(self.model, at, 1)?,
        };
        budget.spend(&period_map.counts, if monodromy_is_current { perturbations } else { 0 });
        *counts += period_map.counts;
        let mut defect = state_difference(&period_map.end, &at);
        self.check_load_balance(&shooting, &defect)?;
        let mut corrector = shooting.corrector(&period_map.monodromy, 1);
        let mut steps = BroydenSteps::new();
        let mut last = f64::INFINITY;
        for _ in 0..MAX_ITERATIONS {
            let size = period_map.size.max(1e-9 * largest_component(&(at.x, [0.0; D])));
            let change = largest_component(&defect) / size;
            let converged = change < 10.0 * self.limits.tolerance || (change < 1e-9 && change >= 0.3 * last);
            if converged && monodromy_is_current {
                break;
            }
            if converged || (!monodromy_is_current && change > CHORD_REDUCTION * last) {
                period_map = shooting.period_map(self.model, at, 1)?;
                budget.spend(&period_map.counts, perturbations);
                *counts += period_map.counts;
                defect = state_difference(&period_map.end, &at);
                monodromy_is_current = true;
                if converged {
                    break;
                }
                corrector = shooting.corrector(&period_map.monodromy, 1);
                steps.clear();
            }
            last = change;
            let Some(newton) = corrector.correction(&defect) else { return Ok(None) };
            // A train's approximate derivative is corrected by the steps themselves.
            let step = if DynamicModel::<D>::IS_TRAIN { steps.step(newton) } else { newton };
            at = displaced(self.model, at, &step);
            let mut motion = self.motion(at, budget);
            motion.advance_period(&mut Unobserved, self.limits.watch, 0.0)?;
            budget.spend(&motion.counts, 0);
            *counts += motion.counts;
            defect = state_difference(&motion.state, &at);
            monodromy_is_current = false;
        }
        let size = period_map.size.max(1e-9 * largest_component(&(at.x, [0.0; D])));
        if !monodromy_is_current
            || period_map.separated
            || largest_component(&defect) / size > 1e-9f64.max(10.0 * self.limits.tolerance)
        {
            return Ok(None);
        }
        self.stable_orbit(&shooting, at, 1, period_map.monodromy, budget, counts)
    }

    /// The orbit that closes from `at` after `n` mesh periods, with its multipliers; None if it is unstable.
    fn stable_orbit(
        &self,
        shooting: &Shooting<'_, D>,
        at: MotionState<D>,
        n: u64,
        monodromy: DMatrix<f64>,
        budget: &mut Budget,
        counts: &mut StepCounts,
    ) -> Result<Option<SteadyMotion<D>>, DynamicsError> {
        let within = shooting.multipliers(&monodromy);
        let modulus = within.first().map(|m| m.norm());
        let Some(modulus) = modulus.filter(|m| *m < 1.0) else { return Ok(None) };
        let start = self.refine_orbit(shooting, (at, n), &monodromy, modulus, budget, counts)?;
        let (antisymmetric_modulus, multipliers) = self.with_antisymmetric_multipliers(within, start, n, budget)?;
        Ok(Some(SteadyMotion {
            multipliers,
            start,
            record: n,
            orbit: Some((n, monodromy)),
            floquet: Some(modulus.max(antisymmetric_modulus).powf(1.0 / n as f64)),
            lyapunov: None,
            chaotic_early: false,
            leaves_symmetry: antisymmetric_modulus > 1.0,
            tolerance: self.limits.tolerance,
            counts: *counts,
        }))
    }

    fn motion_by_integration(
        &self,
        start: MotionState<D>,
        budget: &mut Budget,
        mut counts: StepCounts,
    ) -> Result<SteadyMotion<D>, DynamicsError> {
        let all = budget.steps(0);
        let reserve = all - all / 8 * 3;
        let tolerance = self.limits.tolerance.max(TRANSIENT_TOLERANCE);
        let mut motion = Motion::new(self.model, start, Integrator::Taylor, tolerance, budget.steps(0));
        let mut section = PoincareSection::without_rigid_body(self.model)?;
        section.push(motion.state);
        let mut next_attempt = 8;
        let mut periods_integrated = 0;
        let mut next_test = if self.tests_for_chaos && !self.must_repeat { CHAOS_TEST_MESH_PERIODS } else { u64::MAX };
        let mut surely_chaotic = None;
        // Half of the work is for the integration, three eighths for attempts at an orbit, the rest for what follows.
        while periods_integrated < MAX_TRANSIENT_MESH_PERIODS && motion.counts.steps <= all / 2 {
            periods_integrated += 1;
            let fraction = 0.9 * periods_integrated as f64 / MAX_TRANSIENT_MESH_PERIODS as f64;
            motion.advance_period(&mut Unobserved, self.limits.watch, fraction)?;
            self.limits.watch.checkpoint(fraction)?;
            section.push(motion.state);
            if periods_integrated >= next_test && section.repeats(NEWTON_START_CHANGE).is_none() {
                let length = CHAOS_TEST_LENGTH_MESH_PERIODS;
                let before = motion.counts.steps;
                let follow = |_: f64, state: &MotionState<D>| section.push(*state);
                let exponent = lyapunov_exponent_with(&mut motion, self.model, length, self.limits.watch, follow)?;
                // The steps of the perturbation; those of the motion are counted with all others.
                budget.spend(&StepCounts { steps: motion.counts.steps - before, ..StepCounts::default() }, 0);
                periods_integrated += length;
                next_test = 2 * periods_integrated;
                if exponent > SURELY_CHAOTIC_PER_MESH_PERIOD {
                    surely_chaotic = Some(exponent);
                    break;
                }
            }
            if periods_integrated < next_attempt {
                continue;
            }
            if let Some((n, _)) = section.repeats(NEWTON_START_CHANGE) {
                next_attempt = periods_integrated + MESH_PERIODS_BETWEEN_ATTEMPTS;
                match self.find_orbit(motion.state, n as u64, section.size(), budget) {
                    Ok(Some(mut found)) => {
                        counts += motion.counts;
                        found.counts += counts;
                        return Ok(found);
                    }
                    Ok(None) => {}
                    // Newton's method exceeds the work limit at this period: the motion is treated as aperiodic.
                    Err(DynamicsError::TooManySteps { .. }) => next_attempt = u64::MAX,
                    Err(other) => return Err(other),
                }
                if budget.steps(0) < reserve {
                    next_attempt = u64::MAX;
                }
            }
        }
        budget.spend(&motion.counts, 0);
        counts += motion.counts;
        let steps = motion.counts.steps / periods_integrated.max(1);
        if periods_integrated < MAX_TRANSIENT_MESH_PERIODS.min(MIN_TRANSIENT_MESH_PERIODS) {
            return Err(budget_exhausted(all, motion.time_s()));
        }
        if self.must_repeat {
            let change = section.change(1).unwrap_or(f64::INFINITY);
            return Err(DynamicsError::NotPeriodic { mesh_periods: periods_integrated, change });
        }
        let affordable = budget.steps(1) / 2 / steps.max(1);
        if affordable == 0 {
            return Err(budget_exhausted(all, motion.time_s()));
        }
        let mut exponent_of = |model: &DynamicModel<D>, periods: u64| {
            let mut continued = self.motion(motion.state, budget);
            let exponent = lyapunov_exponent(&mut continued, model, periods.min(affordable), self.limits.watch)?;
            budget.spend(&continued.counts, 1);
            counts += continued.counts;
            Ok::<_, DynamicsError>(exponent)
        };
        let of_antisymmetric =
            if surely_chaotic.is_some() { CHAOS_TEST_LENGTH_MESH_PERIODS } else { LYAPUNOV_MESH_PERIODS };
        let leaves_symmetry =
            D == PER_HALF && exponent_of(&self.model.antisymmetric(), of_antisymmetric)? > CHAOS_PER_MESH_PERIOD;
        let exponent = match surely_chaotic {
            // The motion is searched for anew without symmetry, or the exponent is good enough.
            Some(exponent) if leaves_symmetry || !self.wants_exponent => exponent,
            _ => exponent_of(self.model, LYAPUNOV_MESH_PERIODS)?,
        };
        Ok(SteadyMotion {
            start: motion.state,
            record: LONG_RECORD_MESH_PERIODS.min(LONG_RECORD_STEPS / steps.max(1)).max(MIN_TRANSIENT_MESH_PERIODS),
            orbit: None,
            floquet: None,
            multipliers: Vec::new(),
            lyapunov: Some(exponent),
            chaotic_early: surely_chaotic.is_some(),
            leaves_symmetry,
            tolerance: self.limits.tolerance,
            counts,
        })
    }

    /// Periodic orbit near a state that nearly repeats after `n` mesh periods, with its fundamental period; None if
    /// Newton's method does not converge to a stable one.
    fn find_orbit(
        &self,
        near: MotionState<D>,
        n: u64,
        size: f64,
        budget: &mut Budget,
    ) -> Result<Option<SteadyMotion<D>>, DynamicsError> {
        let Some(found) = self.newton_orbit(near, n, size, budget)? else { return Ok(None) };
        let Some(shorter) = self.fundamental_period(&found, n, size, budget)? else { return Ok(Some(found)) };
        Ok(Some(self.newton_orbit(found.start, shorter, size, budget)?.unwrap_or(found)))
    }

    /// Divisor of the `n` mesh periods of an orbit after which it repeats already. A decaying oscillation can return
    /// closest to itself after a multiple of the fundamental period.
    fn fundamental_period(
        &self,
        found: &SteadyMotion<D>,
        n: u64,
        size: f64,
        budget: &mut Budget,
    ) -> Result<Option<u64>, DynamicsError> {
        let rigid_body = RigidBodyModes::new(self.model)?;
        let mut motion = self.motion(found.start, budget);
        for period in 1..=n / 2 {
            motion.advance_period(&mut Unobserved, self.limits.watch, 0.9)?;
            let change =
                largest_component(&rigid_body.project_out(&state_difference(&motion.state, &found.start))) / size;
            if n.is_multiple_of(period) && change < SAME_PERIOD_CHANGE {
                budget.spend(&motion.counts, 0);
                return Ok(Some(period));
            }
        }
        budget.spend(&motion.counts, 0);
        Ok(None)
    }

    /// Newton's method on the period map over `n` mesh periods; None if it does not converge to a stable orbit nearby.
    fn newton_orbit(
        &self,
        near: MotionState<D>,
        n: u64,
        size: f64,
        budget: &mut Budget,
    ) -> Result<Option<SteadyMotion<D>>, DynamicsError> {
        let perturbations = 2 * self.model.active().count();
        let rigid_body = RigidBodyModes::new(self.model)?;
        let mut start = MotionState { period: 0, ..near };
        let mut counts = StepCounts::default();
        let mut last = f64::INFINITY;
        for _ in 0..10 {
            let shooting = self.shooting(self.model, budget)?;
            let period_map = shooting.period_map(self.model, start, n)?;
            budget.spend(&period_map.counts, perturbations);
            counts += period_map.counts;
            let defect = state_difference(&period_map.end, &start);
            let change = largest_component(&defect) / size;
            if change < 10.0 * self.limits.tolerance || (change < 1e-9 && change >= 0.3 * last) {
                return self.stable_orbit(&shooting, start, n, period_map.monodromy, budget, &mut counts);
            }
            last = change;
            let Some(correction) = shooting.corrector(&period_map.monodromy, n).correction(&defect) else {
                return Ok(None);
            };
            // The velocity along rigid-body modes is not limited.
            if largest_component(&rigid_body.project_out(&correction)) > 0.1 * size {
                return Ok(None);
            }
            start = displaced(self.model, start, &correction);
        }
        Ok(None)
    }

    /// Start of a slowly decaying orbit, corrected by the defect of an integration with finer tolerance.
    fn refine_orbit(
        &self,
        shooting: &Shooting<'_, D>,
        (start, n): (MotionState<D>, u64),
        monodromy: &DMatrix<f64>,
        modulus: f64,
        budget: &mut Budget,
        counts: &mut StepCounts,
    ) -> Result<MotionState<D>, DynamicsError> {
        let fine = (1e-3 * self.limits.tolerance).max(1e-15);
        if modulus < SLOW_DECAY || fine >= self.limits.tolerance {
            return Ok(start);
        }
        let mut motion = Motion::new(self.model, start, Integrator::Taylor, fine, budget.steps(0));
        for _ in 0..n {
            motion.advance_period(&mut Unobserved, self.limits.watch, 0.0)?;
        }
        budget.spend(&motion.counts, 0);
        *counts += motion.counts;
        let correction = shooting.corrector(monodromy, n).correction(&state_difference(&motion.state, &start));
        let better = correction.map(|by| displaced(self.model, start, &by));
        Ok(better.filter(|b| b.contact == start.contact).map_or(start, |b| MotionState { period: start.period, ..b }))
    }

    /// Largest modulus of the multipliers of antisymmetric perturbations over `n` periods (0 with twelve coordinates,
    /// whose monodromy matrix includes them), and all multipliers merged with those `within` the symmetry.
    fn with_antisymmetric_multipliers(
        &self,
        mut within: Vec<Complex<f64>>,
        start: MotionState<D>,
        n: u64,
        budget: &mut Budget,
    ) -> Result<(f64, Vec<Complex<f64>>), DynamicsError> {
        if D != PER_HALF {
            return Ok((0.0, within));
        }
        let antisymmetric = self.model.antisymmetric();
        let shooting = self.shooting(&antisymmetric, budget)?;
        let period_map = shooting.period_map(self.model, start, n)?;
        budget.spend(&period_map.counts, 2 * antisymmetric.active().count());
        let against = shooting.multipliers(&period_map.monodromy);
        let largest = against.first().map_or(f64::INFINITY, |m| m.norm());
        within.extend(against);
        within.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        Ok((largest, within))
    }
}

/// Fails when the mean load has a component along a rigid-body mode; `defect`: end less start of a mesh period.
pub(super) fn check_load_balance<const D: usize>(
    model: &DynamicModel<D>,
    shooting: &Shooting<'_, D>,
    defect: &Perturbation<D>,
) -> Result<(), DynamicsError> {
    let unbalanced_n = shooting.unbalanced_force_n(defect, 1);
    let load = (0..DynamicModel::<D>::HALVES).fold(0.0f64, |m, j| m.max(model.max_excitation_force_n(j)));
    // Rounding and truncation errors are far below this threshold, an imbalance far above.
    if load > 0.0 && unbalanced_n > 1e-6 * load {
        return Err(DynamicsError::Unbalanced { force_n: unbalanced_n });
    }
    Ok(())
}

/// A state displaced by a perturbation, with its contact determined anew.
pub(super) fn displaced<const D: usize>(
    model: &DynamicModel<D>,
    mut state: MotionState<D>,
    by: &Perturbation<D>,
) -> MotionState<D> {
    for c in 0..D {
        state.x[c] += by.0[c];
        state.v[c] += by.1[c];
    }
    for j in 0..DynamicModel::<D>::HALVES {
        state.contact[j] = model.contact_of(j, model.s(j, &state.x), state.phase);
    }
    state
}
