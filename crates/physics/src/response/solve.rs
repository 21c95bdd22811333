//! Response of operating points: steady-state search or integration, record, error estimate.

use super::analysis::{Analysis, AppliedMethod, Multiplier, Regime, Response, SolutionMethod};
use super::channel::ChannelId;
use super::energy::EnergyBalance;
use super::recorder::ChannelRecorder;
use super::recording::{FinishedRun, RecordedRun, poincare};
use super::report::{MotionAssessment, RecordedMotion, ReportInput, assemble_response, solved_halves};
use super::steady::{SteadyMotion, SteadyStateSearch, displaced};
use crate::dynamics::{
    DynamicModel, DynamicsError, IntegrationLimits, Integrator, Motion, MotionState, NaturalModes, PER_HALF,
    POINTS_PER_TASK, Parameters, Perturbation, Shooting, Unobserved, integrate_trajectories, integrate_trajectory,
    is_mirrored, number_of_coordinates, state_difference,
};
use crate::watch::{Canceled, Watch};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Computes the response of a pair.
///
/// # Errors
/// [`DynamicsError`] for invalid parameters or settings, a missing steady state, and integrations that fail.
pub fn solve(p: &Parameters, analysis: &Analysis, watch: &Watch<'_>) -> Result<Response, DynamicsError> {
    let modes = validated_modes(p, analysis)?;
    let point = ResponseProblem { p, analysis, modes: &modes, watch };
    if point.stays_at_rest() {
        return point.rest_response();
    }
    let mirrored = point.is_mirrored();
    let points = std::slice::from_ref(&point);
    match analysis.method {
        SolutionMethod::Integrate { .. } => {
            let alone = LaneUse::Sequential(analysis.integrator);
            let mut responses = match number_of_coordinates(p, mirrored) {
                6 => integrate::<6>(points, alone),
                12 => integrate::<12>(points, alone),
                52 => integrate::<52>(points, alone),
                76 => integrate::<76>(points, alone),
                _ => integrate::<100>(points, alone),
            }?;
            responses.pop().unwrap_or(Err(DynamicsError::Canceled(Canceled)))
        }
        SolutionMethod::Auto | SolutionMethod::Periodic => {
            if mirrored && let Some(response) = point.solve_steady::<6>(false)? {
                return Ok(response);
            }
            // Equal halves come here only when their motion leaves the mirror symmetry: the start is perturbed out of
            // it.
            let found = match number_of_coordinates(p, false) {
                12 => point.solve_steady::<12>(mirrored),
                52 => point.solve_steady::<52>(false),
                76 => point.solve_steady::<76>(false),
                _ => point.solve_steady::<100>(false),
            }?;
            // A search in twelve coordinates or more always returns a motion.
            found.ok_or(DynamicsError::NotPeriodic { mesh_periods: 0, change: f64::NAN })
        }
    }
}

/// Computes the responses of many operating points as [`solve`] does, on all threads of the pool and, for integrations
/// by Taylor series, in vector lanes. The results are bit-identical to those of [`solve`].
///
/// # Errors
/// [`Canceled`] for all; [`DynamicsError`] per point as [`solve`].
pub fn solve_many(
    points: &[Parameters],
    analysis: &Analysis,
    watch: &Watch<'_>,
) -> Result<Vec<Result<Response, DynamicsError>>, Canceled> {
    let done = AtomicUsize::new(0);
    let groups: Result<Vec<_>, Canceled> = points
        .par_chunks(POINTS_PER_TASK)
        .map(|group| {
            let responses = solve_group(group, analysis, watch)?;
            let done = done.fetch_add(group.len(), Ordering::Relaxed) + group.len();
            watch.checkpoint(done as f64 / points.len() as f64)?;
            Ok(responses)
        })
        .collect();
    Ok(groups?.into_iter().flatten().collect())
}

fn solve_group(
    group: &[Parameters],
    analysis: &Analysis,
    watch: &Watch<'_>,
) -> Result<Vec<Result<Response, DynamicsError>>, Canceled> {
    // The progress of single points is not monotonic in that of the whole.
    let canceled = || watch.checkpoint_quietly().is_err();
    let watch = &Watch::new(&|_| {}, &canceled);
    let lanes =
        matches!(analysis.method, SolutionMethod::Integrate { .. }) && analysis.integrator == Integrator::Taylor;
    if !lanes {
        let solved = group.iter().map(|p| match solve(p, analysis, watch) {
            Err(DynamicsError::Canceled(canceled)) => Err(canceled),
            other => Ok(other),
        });
        return solved.collect();
    }
    let modes: Vec<_> = group.iter().map(|p| validated_modes(p, analysis)).collect();
    let mut out = vec![Err(DynamicsError::Canceled(Canceled)); group.len()];
    // Indices and points in six coordinates, and in twelve.
    let mut sides: [(Vec<usize>, Vec<ResponseProblem<'_>>); 2] = Default::default();
    for (i, (p, modes)) in group.iter().zip(&modes).enumerate() {
        match modes {
            Ok(modes) => {
                let point = ResponseProblem { p, analysis, modes, watch };
                if point.stays_at_rest() {
                    out[i] = point.rest_response();
                    continue;
                }
                if p.train.is_some() {
                    // Trains have no lanes.
                    out[i] = solve(p, analysis, watch);
                    if out[i] == Err(DynamicsError::Canceled(Canceled)) {
                        return Err(Canceled);
                    }
                    continue;
                }
                let side = &mut sides[usize::from(!point.is_mirrored())];
                side.0.push(i);
                side.1.push(point);
            }
            Err(error) => out[i] = Err(error.clone()),
        }
    }
    let [(halves, six), (whole, twelve)] = &sides;
    for (i, response) in halves.iter().zip(integrate::<6>(six, LaneUse::Batched)?) {
        out[*i] = response;
    }
    for (i, response) in whole.iter().zip(integrate::<12>(twelve, LaneUse::Batched)?) {
        out[*i] = response;
    }
    Ok(out)
}

/// Validates parameters and settings, and computes the natural modes.
fn validated_modes(p: &Parameters, analysis: &Analysis) -> Result<NaturalModes, DynamicsError> {
    p.validate()?;
    if !(1e-13..=0.1).contains(&analysis.accuracy) {
        return Err(DynamicsError::InvalidParameter {
            name: "accuracy",
            value: analysis.accuracy,
            reason: "must be between 1e-13 and 0.1",
        });
    }
    let modal = analysis.initial_modal_state.as_ref().filter(|_| p.train.is_some());
    if let (Some(modal), Some(train)) = (modal, &p.train)
        && modal.len() != 2 * train.len()
    {
        return Err(DynamicsError::InvalidParameter {
            name: "initial state",
            value: modal.len() as f64,
            reason: "needs a coordinate and a velocity of every mode of the train",
        });
    }
    let numbers = analysis.initial_state.iter().flatten().chain(modal.into_iter().flatten());
    if let Some(bad) = numbers.into_iter().find(|v| !v.is_finite()) {
        return Err(DynamicsError::InvalidParameter { name: "initial state", value: *bad, reason: "must be finite" });
    }
    NaturalModes::new(p)
}

/// One operating point with the settings of the analysis.
pub(super) struct ResponseProblem<'a> {
    pub p: &'a Parameters,
    pub analysis: &'a Analysis,
    pub modes: &'a NaturalModes,
    pub watch: &'a Watch<'a>,
}

/// Relative size of the perturbation out of the mirror symmetry: about the manufacturing difference of the halves.
const OFF_SYMMETRY: f64 = 1e-3;

impl ResponseProblem<'_> {
    /// The initial state that is given, if one is: of a train in its coordinates, or the twelve displacements and
    /// velocities.
    pub(super) fn given_start(&self) -> Option<&[f64]> {
        let modal = self.analysis.initial_modal_state.as_deref().filter(|_| self.p.train.is_some());
        modal.or(self.analysis.initial_state.as_ref().map(|state| state.as_slice()))
    }

    /// Initial state: as given, or at rest under the mean load.
    fn start<const D: usize>(&self, model: &DynamicModel<D>) -> MotionState<D> {
        if let Some(modal) = self.analysis.initial_modal_state.as_ref().filter(|_| DynamicModel::<D>::IS_TRAIN) {
            return model.state_from_modes(modal);
        }
        if let Some(start) = &self.analysis.initial_state {
            return model.state_from(start);
        }
        if DynamicModel::<D>::IS_TRAIN {
            return model.static_state_of_train(self.mean_stiffness_n_per_m());
        }
        let mut at_rest = [0.0; 24];
        at_rest[..12].copy_from_slice(&self.modes.static_deflection(self.p));
        model.state_from(&at_rest)
    }

    /// Whether halves and start are mirror-symmetric.
    fn is_mirrored(&self) -> bool {
        self.p.is_symmetric() && self.analysis.initial_state.as_ref().is_none_or(is_mirrored)
    }

    pub(super) fn report_input(&self) -> ReportInput<'_> {
        ReportInput { p: self.p, analysis: self.analysis, modes: self.modes }
    }

    pub(super) fn limits(&self, tolerance: f64) -> IntegrationLimits<'_> {
        IntegrationLimits { tolerance, max_steps: self.analysis.max_steps, watch: self.watch }
    }

    pub(super) fn mean_stiffness_n_per_m(&self) -> [f64; 2] {
        [0, 1].map(|j| self.p.halves[j].mesh_stiffness.mean_n_per_m())
    }

    /// Steady state; None when the motion in six coordinates leaves the mirror symmetry.
    fn solve_steady<const D: usize>(&self, off_symmetry: bool) -> Result<Option<Response>, DynamicsError> {
        self.search_steady::<D>(off_symmetry, true)
    }

    /// As [`Self::solve_steady`]; `tests_for_chaos`: whether the search may end before the longest transient.
    fn search_steady<const D: usize>(
        &self,
        off_symmetry: bool,
        tests_for_chaos: bool,
    ) -> Result<Option<Response>, DynamicsError> {
        let model = DynamicModel::<D>::new(self.p)?;
        let search = SteadyStateSearch {
            model: &model,
            mean_stiffness_n_per_m: self.mean_stiffness_n_per_m(),
            limits: self.limits((1e-3 * self.analysis.accuracy).clamp(1e-14, 1e-6)),
            must_repeat: self.analysis.method == SolutionMethod::Periodic,
            from_start: self.given_start().is_some(),
            tests_for_chaos,
            wants_exponent: self.analysis.multipliers,
        };
        let mut state = self.start(&model);
        if self.given_start().is_none() {
            model.close_contact(&mut state);
        }
        if off_symmetry {
            let mut perturbation: Perturbation<D> = ([0.0; D], [0.0; D]);
            for c in 0..PER_HALF - 1 {
                perturbation.0[c] = OFF_SYMMETRY * state.x[c];
            }
            state = displaced(&model, state, &perturbation);
        }
        if !search.from_start && !off_symmetry {
            search.check_static_deflection(&state)?;
            match self.solve_by_harmonic_balance(&model, &state, search.limits.tolerance) {
                Ok(Some(response)) => return Ok(Some(response)),
                Err(error @ DynamicsError::Canceled(_)) => return Err(error),
                // The search ends with the same error, or finds the motion that there is instead.
                Ok(None) | Err(_) => {}
            }
        }
        let bounded = |error: DynamicsError| {
            let diverged =
                matches!(error, DynamicsError::Diverged { .. }) && self.analysis.method == SolutionMethod::Auto;
            if diverged { self.unstable_response(&model, state, error).map(Some) } else { Err(error) }
        };
        let found = match search.run(state) {
            Ok(found) => found,
            Err(error) => return bounded(error),
        };
        if found.leaves_symmetry {
            return Ok(None);
        }
        let mut counts = found.counts;
        let (tolerance, until) = match found.orbit {
            Some(_) => (found.tolerance, 0.0),
            None => (STATISTICAL_TOLERANCE, self.analysis.accuracy.max(LEAST_STATISTICAL_ACCURACY)),
        };
        let recorded = self.record_until(
            &model,
            (found.start, tolerance),
            (found.record, until),
            self.recorder(&model, found.record),
            self.energy(&model),
        );
        let finished = match recorded {
            Ok(finished) => finished,
            Err(error) => return bounded(error),
        };
        if found.chaotic_early && finished.record.recent.settled_period(REPEATS).is_some() {
            // It was a long transient.
            return self.search_steady::<D>(off_symmetry, false);
        }
        let classification = match &found.orbit {
            Some(_) => None,
            None => {
                let by = (Integrator::Taylor, tolerance);
                Some(self.classify(&model, &finished, by, found.lyapunov)?)
            }
        };
        if let Some(classification) = &classification {
            counts += classification.counts;
            if classification.regime == Regime::Unstable {
                return bounded(DynamicsError::Diverged {
                    time_s: finished.from.period as f64 * self.p.mesh_period_s(),
                });
            }
        }
        let mut section = finished.record;
        counts += section.counts;
        if found.orbit.is_none() {
            self.add_poincare_points(&model, &mut section, tolerance)?;
        }
        let error_estimate = match &found.orbit {
            Some((n, monodromy)) => self.orbit_error(&model, &found, *n, monodromy, &finished.recorder)?,
            None => section.batch_error,
        };
        let assessment = MotionAssessment {
            regime: match (&found.orbit, classification) {
                (Some((1, _)), _) => Regime::Period1,
                (Some(_), _) => Regime::PeriodN,
                (None, classification) => {
                    classification.map_or(Regime::QuasiPeriodic, |classification| classification.regime)
                }
            },
            period: found.orbit.as_ref().map(|(n, _)| *n),
            floquet: found.floquet,
            multipliers: (!found.multipliers.is_empty()).then(|| {
                found.multipliers.iter().map(|m| Multiplier { modulus: m.norm(), angle_rad: m.arg() }).collect()
            }),
            lyapunov: found.lyapunov,
            method: if found.orbit.is_some() { AppliedMethod::Periodic } else { AppliedMethod::Integrate },
            error_estimate,
            energy_residual: finished.energy.and_then(|e| e.residual()),
            t0_s: if found.orbit.is_some() { 0.0 } else { found.start.period as f64 * self.p.mesh_period_s() },
            counts,
        };
        Ok(Some(assemble_response(&self.report_input(), &model, finished.recorder, section, assessment)))
    }

    /// Continues the motion after its record for the Poincaré points that are wanted beyond those of the record.
    fn add_poincare_points<const D: usize>(
        &self,
        model: &DynamicModel<D>,
        record: &mut RecordedMotion<D>,
        tolerance: f64,
    ) -> Result<(), DynamicsError> {
        let mut motion = Motion::new(model, record.last, Integrator::Taylor, tolerance, self.analysis.max_steps);
        while record.points.len() < self.analysis.poincare_points {
            record.points.push(poincare(model, &motion.state));
            motion.advance_period(&mut Unobserved, self.watch, 0.95)?;
        }
        Ok(())
    }

    /// Assessment of an integrated record, and whether its error is to be found by comparison.
    fn assess<const D: usize>(
        &self,
        model: &DynamicModel<D>,
        finished: &FinishedRun<'_, D>,
        tolerance: f64,
    ) -> Result<(MotionAssessment, bool), DynamicsError> {
        let record = &finished.record;
        let period = record.recent.settled_period(REPEATS);
        let mut assessment = MotionAssessment {
            regime: match period {
                Some(1) => Regime::Period1,
                Some(_) => Regime::PeriodN,
                None => Regime::QuasiPeriodic,
            },
            period: period.map(|n| n as u64),
            floquet: None,
            multipliers: None,
            lyapunov: None,
            method: AppliedMethod::Integrate,
            error_estimate: 0.0,
            energy_residual: finished.energy.as_ref().and_then(EnergyBalance::residual),
            t0_s: finished.from.period as f64 * self.p.mesh_period_s(),
            counts: record.counts,
        };
        if period.is_none() {
            let classification = self.classify(model, finished, (self.analysis.integrator, tolerance), None)?;
            assessment.counts += classification.counts;
            assessment.lyapunov = Some(classification.lyapunov);
            assessment.regime = classification.regime;
            if classification.regime == Regime::Chaotic {
                assessment.error_estimate = record.batch_error;
            }
        }
        let compared = assessment.regime != Regime::Chaotic;
        Ok((assessment, compared))
    }

    /// Energy balance, if requested.
    pub(super) fn energy<'m, const D: usize>(&self, model: &'m DynamicModel<D>) -> Option<EnergyBalance<'m, D>> {
        self.analysis.energy_balance.then(|| EnergyBalance::new(model))
    }

    /// Records `periods` mesh periods of the motion from `start`.
    pub(super) fn record<'m, const D: usize>(
        &self,
        model: &'m DynamicModel<D>,
        (start, tolerance): (MotionState<D>, f64),
        periods: u64,
        recorder: ChannelRecorder<D>,
        energy: Option<EnergyBalance<'m, D>>,
    ) -> Result<FinishedRun<'m, D>, DynamicsError> {
        self.record_until(model, (start, tolerance), (periods, 0.0), recorder, energy)
    }

    /// As [`Self::record`]; the record ends once its statistics have the accuracy `until`, where that is not 0.
    fn record_until<'m, const D: usize>(
        &self,
        model: &'m DynamicModel<D>,
        (start, tolerance): (MotionState<D>, f64),
        (periods, until): (u64, f64),
        recorder: ChannelRecorder<D>,
        energy: Option<EnergyBalance<'m, D>>,
    ) -> Result<FinishedRun<'m, D>, DynamicsError> {
        let span = (start.period, start.period + periods);
        let run = RecordedRun::new(model, start, tolerance, span, recorder)?;
        let mut run = run.with_energy(energy).until_accurate(until);
        integrate_trajectory(&mut run, Integrator::Taylor, self.analysis.max_steps, self.watch)?;
        run.finish()
    }

    /// Relative error of the RMS values of a periodic motion: it is integrated again with a much finer tolerance, its
    /// start is corrected by the remaining defect, and the values are compared.
    fn orbit_error<const D: usize>(
        &self,
        model: &DynamicModel<D>,
        found: &SteadyMotion<D>,
        n: u64,
        monodromy: &nalgebra::DMatrix<f64>,
        recorder: &ChannelRecorder<D>,
    ) -> Result<f64, DynamicsError> {
        let tight = (1e-3 * found.tolerance).max(1e-15);
        let start = MotionState { period: 0, ..found.start };
        let once = self.record(model, (start, tight), n, self.rms_recorder(model), None)?.record;
        let shooting = Shooting::new(model, self.mean_stiffness_n_per_m(), self.limits(tight))?;
        let defect = state_difference(&once.last, &start);
        let Some(correction) = shooting.corrector(monodromy, n).correction(&defect) else { return Ok(f64::INFINITY) };
        let better = self
            .record(model, (displaced(model, start, &correction), tight), n, self.rms_recorder(model), None)?
            .recorder;
        Ok(SAFETY * rms_difference(recorder, &better, acceleration_floor(model)) + ROUNDING)
    }

    /// Recorder of the channels of every response and of the requested ones.
    pub(super) fn recorder<const D: usize>(&self, model: &DynamicModel<D>, periods: u64) -> ChannelRecorder<D> {
        let mut statistics = Vec::new();
        for half in solved_halves::<D>() {
            statistics.push((ChannelId::mesh_acceleration(half), false));
            statistics.push((ChannelId::pinion_axial_acceleration(half), false));
            statistics.push((ChannelId::s(half), true));
            statistics.push((ChannelId::normal_force(half), false));
            statistics.push((ChannelId::tooth_force(half), true));
        }
        let mut orders = Vec::new();
        if let Some(train) = &self.p.train {
            orders.extend(ChannelId::outputs_of(train));
            statistics.extend(orders.iter().map(|id| (*id, false)));
            orders.extend([ChannelId::tooth_force(0), ChannelId::tooth_force(1)]);
        }
        ChannelRecorder::new(
            model,
            &statistics,
            &self.analysis.channels,
            self.analysis.samples_per_mesh_period,
            periods,
        )
        .with_orders(&orders)
    }

    /// Recorder of the accelerations alone.
    pub(super) fn rms_recorder<const D: usize>(&self, model: &DynamicModel<D>) -> ChannelRecorder<D> {
        let mut statistics = Vec::new();
        for half in solved_halves::<D>() {
            statistics.push((ChannelId::mesh_acceleration(half), false));
            statistics.push((ChannelId::pinion_axial_acceleration(half), false));
        }
        ChannelRecorder::new(model, &statistics, &[], 0, 0)
    }
}

/// Execution of integrations: sequential by any method, or batched in vector lanes by Taylor series.
#[derive(Clone, Copy)]
enum LaneUse {
    Sequential(Integrator),
    Batched,
}

impl LaneUse {
    fn integrate<const D: usize>(
        self,
        runs: &mut [RecordedRun<'_, D>],
        tolerance: f64,
        max_steps: u64,
        watch: &Watch<'_>,
    ) -> Result<(), Canceled> {
        let integrator = match self {
            LaneUse::Sequential(integrator) => integrator,
            LaneUse::Batched => {
                // Trains have no lanes.
                if !DynamicModel::<D>::IS_TRAIN {
                    return integrate_trajectories(runs, tolerance, max_steps, watch);
                }
                Integrator::Taylor
            }
        };
        runs.iter_mut().try_for_each(|run| integrate_trajectory(run, integrator, max_steps, watch))
    }

    /// Execution of the comparison for the error estimate: always by Taylor series.
    fn for_comparison(self) -> Self {
        match self {
            LaneUse::Sequential(_) => LaneUse::Sequential(Integrator::Taylor),
            LaneUse::Batched => LaneUse::Batched,
        }
    }
}

/// Integrates operating points with the same settings and estimates their errors by comparison with more accurate
/// integrations of the last part of each.
fn integrate<const D: usize>(
    points: &[ResponseProblem<'_>],
    lane_use: LaneUse,
) -> Result<Vec<Result<Response, DynamicsError>>, Canceled> {
    let Some(ResponseProblem { analysis, watch, .. }) = points.first() else { return Ok(Vec::new()) };
    let SolutionMethod::Integrate { mesh_periods, record_mesh_periods } = analysis.method else {
        return Ok(Vec::new());
    };
    let end = mesh_periods.max(1);
    let record_from = end - record_mesh_periods.clamp(1, end);
    // Measured on the reference cases: RMS error over tolerance is up to 10 for Taylor series, up to 300 for
    // Runge–Kutta.
    let per_accuracy = match analysis.integrator {
        Integrator::Taylor => 0.05,
        Integrator::RungeKutta => 2e-3,
    };
    let tolerance = (per_accuracy * analysis.accuracy).max(1e-15);
    let tight = (1e-2 * tolerance).clamp(1e-15, 1e-9);
    // Start of the comparison: far enough before the record for the initial difference to decay.
    let compared_from = record_from.saturating_sub(COMPARISON_LEAD_MESH_PERIODS);

    let models: Vec<_> = points.iter().map(|point| DynamicModel::<D>::new(point.p)).collect();
    let mut runs = Vec::with_capacity(points.len());
    let mut out: Vec<Result<Response, DynamicsError>> = Vec::with_capacity(points.len());
    let mut positions = Vec::with_capacity(points.len());
    for (i, (point, model)) in points.iter().zip(&models).enumerate() {
        out.push(Err(DynamicsError::Canceled(Canceled)));
        let run = model.as_ref().map_err(Clone::clone).and_then(|model| {
            let recorder = point.recorder(model, end - record_from);
            let mut start = point.start(model);
            if point.given_start().is_none() {
                model.close_contact(&mut start);
            }
            let run = RecordedRun::new(model, start, tolerance, (record_from, end), recorder)?;
            Ok(run.storing_state_at(compared_from).with_energy(point.energy(model)))
        });
        match run {
            Ok(run) => {
                runs.push(run);
                positions.push(i);
            }
            Err(error) => out[i] = Err(error),
        }
    }
    lane_use.integrate(&mut runs, tolerance, analysis.max_steps, watch)?;

    let mut compared = Vec::new();
    let mut pending = Vec::new();
    for (i, run) in positions.into_iter().zip(runs) {
        let Ok(model) = &models[i] else { continue };
        let point = &points[i];
        let next = run.finish().and_then(|finished| {
            let (assessment, compare) = point.assess(model, &finished, tolerance)?;
            let fine_run = compare.then(|| {
                RecordedRun::new(model, finished.stored, tight, (record_from, end), point.rms_recorder(model))
            });
            Ok((finished, assessment, fine_run.transpose()?))
        });
        match next {
            Err(DynamicsError::Canceled(canceled)) => return Err(canceled),
            Err(error @ DynamicsError::Diverged { .. }) => {
                out[i] = point.unstable_response(model, point.start(model), error);
            }
            Err(error) => out[i] = Err(error),
            Ok((finished, assessment, None)) => {
                out[i] =
                    Ok(assemble_response(&point.report_input(), model, finished.recorder, finished.record, assessment));
            }
            Ok((finished, assessment, Some(fine_run))) => {
                compared.push(fine_run);
                pending.push((i, finished, assessment));
            }
        }
    }
    lane_use.for_comparison().integrate(&mut compared, tight, analysis.max_steps, watch)?;
    for ((i, finished, mut assessment), fine_run) in pending.into_iter().zip(compared) {
        let Ok(model) = &models[i] else { continue };
        out[i] = fine_run.finish().map(|fine| {
            let difference = rms_difference(&finished.recorder, &fine.recorder, acceleration_floor(model));
            assessment.error_estimate = SAFETY * difference + ROUNDING;
            assessment.counts += fine.record.counts;
            assemble_response(&points[i].report_input(), model, finished.recorder, finished.record, assessment)
        });
    }
    Ok(out)
}

/// Half of the 95 % interval of the RMS of the circumferential acceleration, relative to it, at which the record of a
/// motion that does not repeat ends, at least: 0.17 dB. The mean of a finite record comes no closer to a finer accuracy
/// in any reasonable time.
const LEAST_STATISTICAL_ACCURACY: f64 = 0.02;
/// Tolerance of such a record.
const STATISTICAL_TOLERANCE: f64 = 1e-6;
/// Relative change over its period below which an integrated motion counts as periodic.
pub(super) const REPEATS: f64 = 1e-3;
/// Factor on an error found by comparison with a result that has an error too.
pub(super) const SAFETY: f64 = 3.0;
/// Mesh periods before the record from which an integration is compared with a more accurate one.
const COMPARISON_LEAD_MESH_PERIODS: u64 = 50;
/// Lower limit of the relative error of RMS values in double precision.
pub(super) const ROUNDING: f64 = 1e-13;

/// Acceleration that counts as rounding: 1e-12 of the acceleration of the free mesh by the load, m/s².
pub(super) fn acceleration_floor<const D: usize>(model: &DynamicModel<D>) -> f64 {
    let square = model.omega_ref * model.omega_ref;
    (0..DynamicModel::<D>::HALVES)
        .fold(0.0f64, |m, j| m.max(model.max_excitation_force_n(j) * model.halves[j].inv_me * square))
        * 1e-12
}

/// Largest relative difference of the RMS accelerations of two records; values below `floor` count as equal.
fn rms_difference<const D: usize>(a: &ChannelRecorder<D>, b: &ChannelRecorder<D>, floor: f64) -> f64 {
    b.all().fold(0.0f64, |worst, (id, gb, _)| {
        let Some(ga) = a.accumulator(id) else { return worst };
        let (ra, rb) = (ga.mean_and_square().1.sqrt(), gb.mean_and_square().1.sqrt());
        if rb > floor { worst.max((ra - rb).abs() / rb) } else { worst }
    })
}
