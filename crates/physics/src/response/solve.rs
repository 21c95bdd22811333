//! One operating point: from parameters to a response.

use super::analysis::{Analysis, Method, Multiplier, Regime, Response};
use super::channel::ChannelId;
use super::energy::EnergyBalance;
use super::recorder::Recorder;
use super::recording::{Finished, Run};
use super::report::{Asked, Verdict, report, solved_halves};
use super::steady::{SteadyMotion, SteadyStateSearch, displaced};
use crate::dynamics::{
    Perturbation, DynamicsError, Integrator, IntegrationLimits, Model, NaturalModes, PER_HALF, Parameters, Shooting, State, integrate_trajectories,
    integrate_trajectory, state_difference, is_mirrored,
};
use crate::watch::{Canceled, Watch};
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Solves the equations of motion and gathers what was asked for.
///
/// # Errors
/// [`DynamicsError`].
pub fn solve(p: &Parameters, analysis: &Analysis, watch: &Watch<'_>) -> Result<Response, DynamicsError> {
    let modes = modes(p, analysis)?;
    let point = Point { p, analysis, modes: &modes, watch };
    if point.rests() {
        return point.at_rest();
    }
    let start = point.start();
    let mirrored = point.is_mirrored(&start);
    match analysis.method {
        Method::Integrate { .. } => {
            let points = std::slice::from_ref(&point);
            let alone = LaneUse::Sequential(analysis.integrator);
            let mut responses = if mirrored { integrate::<6>(points, alone) } else { integrate::<12>(points, alone) }?;
            responses.pop().unwrap_or(Err(DynamicsError::Canceled(Canceled)))
        }
        Method::Auto | Method::Periodic => {
            if mirrored && let Some(response) = point.steady::<6>(&start, false)? {
                return Ok(response);
            }
            // Equal halves come here only when their motion leaves the mirror symmetry by itself: a start off the symmetry lets it.
            let found = point.steady::<12>(&start, mirrored)?;
            // Twelve coordinates are never given up for fewer.
            found.ok_or(DynamicsError::NotPeriodic { mesh_periods: 0, change: f64::NAN })
        }
    }
}

/// Solves many operating points as [`solve`] does each, on all threads of the pool and, where they are integrated by Taylor series, eight
/// side by side in vector instructions. The answers are those of [`solve`] to the last bit.
///
/// # Errors
/// Per point as [`solve`]; cancellation for all.
pub fn solve_many(
    points: &[Parameters],
    analysis: &Analysis,
    watch: &Watch<'_>,
) -> Result<Vec<Result<Response, DynamicsError>>, Canceled> {
    let done = AtomicUsize::new(0);
    let groups: Result<Vec<_>, Canceled> = points
        .par_chunks(POINTS_PER_GROUP)
        .map(|group| {
            let responses = solve_group(group, analysis, watch)?;
            let done = done.fetch_add(group.len(), Ordering::Relaxed) + group.len();
            watch.checkpoint(done as f64 / points.len() as f64)?;
            Ok(responses)
        })
        .collect();
    Ok(groups?.into_iter().flatten().collect())
}

/// Points that one thread takes at a time.
const POINTS_PER_GROUP: usize = 32;

fn solve_group(
    group: &[Parameters],
    analysis: &Analysis,
    watch: &Watch<'_>,
) -> Result<Vec<Result<Response, DynamicsError>>, Canceled> {
    // Their own progress would run back and forth.
    let canceled = || watch.checkpoint_quietly().is_err();
    let watch = &Watch::new(&|_| {}, &canceled);
    let lanes = matches!(analysis.method, Method::Integrate { .. }) && analysis.integrator == Integrator::Taylor;
    if !lanes {
        let solved = group.iter().map(|p| match solve(p, analysis, watch) {
            Err(DynamicsError::Canceled(canceled)) => Err(canceled),
            other => Ok(other),
        });
        return solved.collect();
    }
    let modes: Vec<_> = group.iter().map(|p| modes(p, analysis)).collect();
    let mut out = vec![Err(DynamicsError::Canceled(Canceled)); group.len()];
    // Points in six coordinates, and in twelve, with their places.
    let mut sides: [(Vec<usize>, Vec<Point<'_>>); 2] = Default::default();
    for (i, (p, modes)) in group.iter().zip(&modes).enumerate() {
        match modes {
            Ok(modes) => {
                let point = Point { p, analysis, modes, watch };
                if point.rests() {
                    out[i] = point.at_rest();
                    continue;
                }
                let side = &mut sides[usize::from(!point.is_mirrored(&point.start()))];
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

/// Checks the question and solves for the natural modes.
fn modes(p: &Parameters, analysis: &Analysis) -> Result<NaturalModes, DynamicsError> {
    p.validate()?;
    if !(1e-13..=0.1).contains(&analysis.accuracy) {
        return Err(DynamicsError::InvalidParameter {
            name: "accuracy",
            value: analysis.accuracy,
            reason: "must be between 1e-13 and 0.1",
        });
    }
    if let Some(bad) = analysis.initial_state.iter().flatten().find(|v| !v.is_finite()) {
        return Err(DynamicsError::InvalidParameter { name: "initial state", value: *bad, reason: "must be finite" });
    }
    NaturalModes::new(p)
}

/// One operating point and what is asked of it.
pub(super) struct Point<'a> {
    pub p: &'a Parameters,
    pub analysis: &'a Analysis,
    pub modes: &'a NaturalModes,
    pub watch: &'a Watch<'a>,
}

/// Relative size of the push that takes a motion off the mirror symmetry: as far as manufacture keeps halves alike.
const OFF_SYMMETRY: f64 = 1e-3;

impl Point<'_> {
    /// Where it starts: as asked, or at rest under the mean load.
    fn start(&self) -> [f64; 24] {
        self.analysis.initial_state.unwrap_or_else(|| {
            let mut at_rest = [0.0; 24];
            at_rest[..12].copy_from_slice(&self.modes.static_deflection(self.p));
            at_rest
        })
    }

    /// ObserverPair halves and the start mirror each other.
    fn is_mirrored(&self, start: &[f64; 24]) -> bool {
        self.p.is_symmetric() && (self.analysis.initial_state.is_none() || is_mirrored(start))
    }

    pub(super) fn asked(&self) -> Asked<'_> {
        Asked { p: self.p, analysis: self.analysis, modes: self.modes }
    }

    fn limits(&self, tolerance: f64) -> IntegrationLimits<'_> {
        IntegrationLimits { tolerance, max_steps: self.analysis.max_steps, watch: self.watch }
    }

    pub(super) fn mean_stiffness_n_per_m(&self) -> [f64; 2] {
        [0, 1].map(|j| self.p.halves[j].mesh_stiffness.mean_n_per_m())
    }

    /// The steady state; None when six coordinates do not tell the whole story.
    fn steady<const D: usize>(&self, start: &[f64; 24], off_symmetry: bool) -> Result<Option<Response>, DynamicsError> {
        let model = Model::<D>::new(self.p)?;
        let search = SteadyStateSearch {
            model: &model,
            mean_stiffness_n_per_m: self.mean_stiffness_n_per_m(),
            limits: self.limits((1e-3 * self.analysis.accuracy).clamp(1e-14, 1e-6)),
            must_repeat: self.analysis.method == Method::Periodic,
            from_start: self.analysis.initial_state.is_some(),
        };
        let mut state = model.state_from(start);
        if self.analysis.initial_state.is_none() {
            model.seat_teeth(&mut state);
        }
        if off_symmetry {
            let mut push: Perturbation<D> = ([0.0; D], [0.0; D]);
            for c in 0..PER_HALF - 1 {
                push.0[c] = OFF_SYMMETRY * state.x[c];
            }
            state = displaced(&model, state, &push);
        }
        let bounded = |error: DynamicsError| {
            let diverged = matches!(error, DynamicsError::Diverged { .. }) && self.analysis.method == Method::Auto;
            if diverged { self.unbounded(&model, state, error).map(Some) } else { Err(error) }
        };
        let found = match search.run(state) {
            Ok(found) => found,
            Err(error) => return bounded(error),
        };
        if found.leaves_symmetry {
            return Ok(None);
        }
        let mut numerics = found.numerics;
        let recorded = self.record(
            &model,
            (found.start, found.tolerance),
            found.record,
            self.recorder(&model, found.record),
            self.energy(&model),
        );
        let finished = match recorded {
            Ok(finished) => finished,
            Err(error) => return bounded(error),
        };
        let fate = match &found.orbit {
            Some(_) => None,
            None => {
                let by = (Integrator::Taylor, found.tolerance);
                Some(self.fate(&model, &finished, by, found.lyapunov)?)
            }
        };
        if let Some(fate) = &fate {
            numerics += fate.numerics;
            if fate.regime == Regime::Unstable {
                return bounded(DynamicsError::Diverged {
                    time_s: finished.from.period as f64 * self.p.mesh_period_s(),
                });
            }
        }
        let section = finished.record;
        numerics += section.numerics;
        let error_estimate = match &found.orbit {
            Some((n, monodromy)) => self.orbit_error(&model, &found, *n, monodromy, &finished.recorder)?,
            None => section.batch_error,
        };
        let verdict = Verdict {
            regime: match (&found.orbit, fate) {
                (Some((1, _)), _) => Regime::Period1,
                (Some(_), _) => Regime::PeriodN,
                (None, fate) => fate.map_or(Regime::QuasiPeriodic, |fate| fate.regime),
            },
            period: found.orbit.as_ref().map(|(n, _)| *n),
            floquet: found.floquet,
            multipliers: (!found.multipliers.is_empty()).then(|| {
                found.multipliers.iter().map(|m| Multiplier { modulus: m.norm(), angle_rad: m.arg() }).collect()
            }),
            lyapunov: found.lyapunov,
            method: if found.orbit.is_some() { "periodic" } else { "integrate" },
            error_estimate,
            energy_residual: finished.energy.and_then(|e| e.residual()),
            t0_s: if found.orbit.is_some() { 0.0 } else { found.start.period as f64 * self.p.mesh_period_s() },
            numerics,
        };
        Ok(Some(report(&self.asked(), &model, finished.recorder, section, verdict)))
    }

    /// What is known of an integrated record by itself; `compared` says whether its error is found by comparison.
    fn verdict<const D: usize>(
        &self,
        model: &Model<D>,
        finished: &Finished<'_, D>,
        tolerance: f64,
    ) -> Result<(Verdict, bool), DynamicsError> {
        let record = &finished.record;
        let period = record.recent.settled_period(REPEATS);
        let mut verdict = Verdict {
            regime: match period {
                Some(1) => Regime::Period1,
                Some(_) => Regime::PeriodN,
                None => Regime::QuasiPeriodic,
            },
            period: period.map(|n| n as u64),
            floquet: None,
            multipliers: None,
            lyapunov: None,
            method: "integrate",
            error_estimate: 0.0,
            energy_residual: finished.energy.as_ref().and_then(|e| e.residual()),
            t0_s: finished.from.period as f64 * self.p.mesh_period_s(),
            numerics: record.numerics,
        };
        if period.is_none() {
            let fate = self.fate(model, finished, (self.analysis.integrator, tolerance), None)?;
            verdict.numerics += fate.numerics;
            verdict.lyapunov = Some(fate.lyapunov);
            verdict.regime = fate.regime;
            if fate.regime == Regime::Chaotic {
                verdict.error_estimate = record.batch_error;
            }
        }
        let compared = verdict.regime != Regime::Chaotic;
        Ok((verdict, compared))
    }

    /// The energy balance, where it is asked for.
    pub(super) fn energy<'m, const D: usize>(&self, model: &'m Model<D>) -> Option<EnergyBalance<'m, D>> {
        self.analysis.energy_balance.then(|| EnergyBalance::new(model))
    }

    /// Records `periods` mesh periods of the motion from `start`.
    pub(super) fn record<'m, const D: usize>(
        &self,
        model: &'m Model<D>,
        (start, tolerance): (State<D>, f64),
        periods: u64,
        recorder: Recorder<D>,
        energy: Option<EnergyBalance<'m, D>>,
    ) -> Result<Finished<'m, D>, DynamicsError> {
        let span = (start.period, start.period + periods);
        let mut run = Run::new(model, start, tolerance, span, recorder)?.with_energy(energy);
        integrate_trajectory(&mut run, Integrator::Taylor, self.analysis.max_steps, self.watch)?;
        run.finish()
    }

    /// Relative error of the RMS values of a periodic motion: the map is repeated far more accurately, the start corrected by
    /// what it then fails to close, and the values compared.
    fn orbit_error<const D: usize>(
        &self,
        model: &Model<D>,
        found: &SteadyMotion<D>,
        n: u64,
        monodromy: &nalgebra::DMatrix<f64>,
        recorder: &Recorder<D>,
    ) -> Result<f64, DynamicsError> {
        let tight = (1e-3 * found.tolerance).max(1e-15);
        let start = State { period: 0, ..found.start };
        let once = self.record(model, (start, tight), n, self.recorder_of_rms(model), None)?.record;
        let shooting = Shooting::new(model, self.mean_stiffness_n_per_m(), self.limits(tight))?;
        let defect = state_difference(&once.last, &start);
        let Some(correction) = shooting.correction(&defect, monodromy, n) else { return Ok(f64::INFINITY) };
        let better = self
            .record(model, (displaced(model, start, &correction), tight), n, self.recorder_of_rms(model), None)?
            .recorder;
        Ok(SAFETY * rms_difference(recorder, &better, smallest(model)) + ROUNDING)
    }

    /// Channels every response needs, and those asked for.
    pub(super) fn recorder<const D: usize>(&self, model: &Model<D>, periods: u64) -> Recorder<D> {
        let mut statistics = Vec::new();
        for half in solved_halves::<D>() {
            statistics.push((ChannelId::mesh_acceleration(half), false));
            statistics.push((ChannelId::pinion_axial_acceleration(half), false));
            statistics.push((ChannelId::s(half), true));
            statistics.push((ChannelId::normal_force(half), false));
            statistics.push((ChannelId::tooth_force(half), true));
        }
        Recorder::new(model, &statistics, &self.analysis.channels, self.analysis.samples_per_mesh_period, periods)
    }

    /// The accelerations alone.
    fn recorder_of_rms<const D: usize>(&self, model: &Model<D>) -> Recorder<D> {
        let mut statistics = Vec::new();
        for half in solved_halves::<D>() {
            statistics.push((ChannelId::mesh_acceleration(half), false));
            statistics.push((ChannelId::pinion_axial_acceleration(half), false));
        }
        Recorder::new(model, &statistics, &[], 0, 0)
    }
}

/// How points are integrated: one after the other by any method, or side by side by Taylor series.
#[derive(Clone, Copy)]
enum LaneUse {
    Sequential(Integrator),
    Batched,
}

impl LaneUse {
    fn integrate<const D: usize>(
        self,
        runs: &mut [Run<'_, D>],
        tolerance: f64,
        max_steps: u64,
        watch: &Watch<'_>,
    ) -> Result<(), Canceled> {
        match self {
            LaneUse::Sequential(integrator) => {
                runs.iter_mut().try_for_each(|run| integrate_trajectory(run, integrator, max_steps, watch))
            }
            LaneUse::Batched => integrate_trajectories(runs, tolerance, max_steps, watch),
        }
    }

    /// For the comparison that measures the error: by Taylor series always.
    fn for_comparison(self) -> Self {
        match self {
            LaneUse::Sequential(_) => LaneUse::Sequential(Integrator::Taylor),
            LaneUse::Batched => LaneUse::Batched,
        }
    }
}

/// Integrates points that ask the same, and measures their errors by comparison with more accurate runs over the end of
/// each.
fn integrate<const D: usize>(
    points: &[Point<'_>],
    lane_use: LaneUse,
) -> Result<Vec<Result<Response, DynamicsError>>, Canceled> {
    let Some(Point { analysis, watch, .. }) = points.first() else { return Ok(Vec::new()) };
    let Method::Integrate { mesh_periods, record_mesh_periods } = analysis.method else { return Ok(Vec::new()) };
    let end = mesh_periods.max(1);
    let record_from = end - record_mesh_periods.clamp(1, end);
    // Measured on the reference cases: RMS error over tolerance is up to 10 for Taylor series, up to 300 for Runge–Kutta.
    let per_accuracy = match analysis.integrator {
        Integrator::Taylor => 0.05,
        Integrator::RungeKutta => 2e-3,
    };
    let tolerance = (per_accuracy * analysis.accuracy).max(1e-15);
    let tight = (1e-2 * tolerance).clamp(1e-15, 1e-9);
    // Where the comparison sets out: far enough before the record for its own start to fade.
    let compared_from = record_from.saturating_sub(COMPARED_LEAD_MESH_PERIODS);

    let models: Vec<_> = points.iter().map(|point| Model::<D>::new(point.p)).collect();
    let mut runs = Vec::with_capacity(points.len());
    let mut out: Vec<Result<Response, DynamicsError>> = Vec::with_capacity(points.len());
    let mut places = Vec::with_capacity(points.len());
    for (i, (point, model)) in points.iter().zip(&models).enumerate() {
        out.push(Err(DynamicsError::Canceled(Canceled)));
        let run = model.as_ref().map_err(Clone::clone).and_then(|model| {
            let recorder = point.recorder(model, end - record_from);
            let mut start = model.state_from(&point.start());
            if point.analysis.initial_state.is_none() {
                model.seat_teeth(&mut start);
            }
            let run = Run::new(model, start, tolerance, (record_from, end), recorder)?;
            Ok(run.keeping(compared_from).with_energy(point.energy(model)))
        });
        match run {
            Ok(run) => {
                runs.push(run);
                places.push(i);
            }
            Err(error) => out[i] = Err(error),
        }
    }
    lane_use.integrate(&mut runs, tolerance, analysis.max_steps, watch)?;

    let mut compared = Vec::new();
    let mut waiting = Vec::new();
    for (i, run) in places.into_iter().zip(runs) {
        let Ok(model) = &models[i] else { continue };
        let point = &points[i];
        let next = run.finish().and_then(|finished| {
            let (verdict, compare) = point.verdict(model, &finished, tolerance)?;
            let finely = compare
                .then(|| Run::new(model, finished.kept, tight, (record_from, end), point.recorder_of_rms(model)));
            Ok((finished, verdict, finely.transpose()?))
        });
        match next {
            Err(DynamicsError::Canceled(canceled)) => return Err(canceled),
            Err(error @ DynamicsError::Diverged { .. }) => {
                out[i] = point.unbounded(model, model.state_from(&point.start()), error);
            }
            Err(error) => out[i] = Err(error),
            Ok((finished, verdict, None)) => {
                out[i] = Ok(report(&point.asked(), model, finished.recorder, finished.record, verdict));
            }
            Ok((finished, verdict, Some(finely))) => {
                compared.push(finely);
                waiting.push((i, finished, verdict));
            }
        }
    }
    lane_use.for_comparison().integrate(&mut compared, tight, analysis.max_steps, watch)?;
    for ((i, finished, mut verdict), finely) in waiting.into_iter().zip(compared) {
        let Ok(model) = &models[i] else { continue };
        out[i] = finely.finish().map(|fine| {
            let difference = rms_difference(&finished.recorder, &fine.recorder, smallest(model));
            verdict.error_estimate = SAFETY * difference + ROUNDING;
            verdict.numerics += fine.record.numerics;
            report(&points[i].asked(), model, finished.recorder, finished.record, verdict)
        });
    }
    Ok(out)
}

/// Relative change over its period below which an integrated motion counts as repeating.
pub(super) const REPEATS: f64 = 1e-3;
/// What an error found by comparison is multiplied by, because it is a comparison with something that has an error too.
const SAFETY: f64 = 3.0;
/// Mesh periods before the record from which a run is compared with a more accurate one.
const COMPARED_LEAD_MESH_PERIODS: u64 = 50;
/// RMS values in double precision are not better than this.
const ROUNDING: f64 = 1e-13;

/// An acceleration that is nothing but rounding: 1e-12 of what the load would give the free mesh, m/s².
fn smallest<const D: usize>(model: &Model<D>) -> f64 {
    let square = model.omega_ref * model.omega_ref;
    (0..Model::<D>::HALVES).fold(0.0f64, |m, j| m.max(model.largest_push_n(j) * model.halves[j].inv_me * square))
        * 1e-12
}

/// Largest relative difference of the RMS accelerations of two records; below `floor` they count as equal.
fn rms_difference<const D: usize>(a: &Recorder<D>, b: &Recorder<D>, floor: f64) -> f64 {
    b.all().fold(0.0f64, |worst, (id, gb, _)| {
        let Some(ga) = a.gathered(id) else { return worst };
        let (ra, rb) = (ga.mean_and_square().1.sqrt(), gb.mean_and_square().1.sqrt());
        if rb > floor { worst.max((ra - rb).abs() / rb) } else { worst }
    })
}
