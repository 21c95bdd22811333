//! One operating point: from parameters to a response.

use super::analysis::{Analysis, Method, Multiplier, PoincarePoint, Regime, Response};
use super::channel::ChannelId;
use super::confidence::MeanSquares;
use super::energy::EnergyBalance;
use super::recorder::Recorder;
use super::regime::{CHAOS_PER_MESH_PERIOD, Section, lyapunov};
use super::report::{Asked, Record, Verdict, report, solved_halves};
use super::statistics::Gathered;
use super::steady::{Found, Search, moved};
use crate::dynamics::{
    Both, Deviation, DynamicsError, Integrator, Limits, Model, Motion, NaturalModes, Numerics, Observer, PER_HALF,
    Parameters, Shooting, State, Unobserved, difference, is_mirrored,
};
use crate::watch::Watch;

/// Solves the equations of motion and gathers what was asked for.
pub fn solve(p: &Parameters, analysis: &Analysis, watch: &Watch<'_>) -> Result<Response, DynamicsError> {
    p.validate()?;
    if !(1e-13..=0.1).contains(&analysis.accuracy) {
        return Err(DynamicsError::InvalidParameter {
            name: "accuracy",
            value: analysis.accuracy,
            reason: "must be between 1e-13 and 0.1",
        });
    }
    let modes = NaturalModes::new(p)?;
    let rest = || {
        let mut at_rest = [0.0; 24];
        at_rest[..12].copy_from_slice(&modes.static_deflection(p));
        at_rest
    };
    let run = Run { p, analysis, modes: &modes, watch };
    let start = analysis.initial_state.unwrap_or_else(rest);
    if let Some(bad) = start.iter().find(|v| !v.is_finite()) {
        return Err(DynamicsError::InvalidParameter { name: "initial state", value: *bad, reason: "must be finite" });
    }
    let mirrored = p.is_symmetric() && (analysis.initial_state.is_none() || is_mirrored(&start));
    match analysis.method {
        Method::Integrate { mesh_periods, record_mesh_periods } => {
            let record = record_mesh_periods.clamp(1, mesh_periods.max(1));
            if mirrored {
                run.integrate::<6>(&start, mesh_periods.max(1), record)
            } else {
                run.integrate::<12>(&start, mesh_periods.max(1), record)
            }
        }
        Method::Auto | Method::Periodic => {
            if mirrored && let Some(response) = run.steady::<6>(&start, false)? {
                return Ok(response);
            }
            // Equal halves come here only when their motion leaves the mirror symmetry by itself: a start off the symmetry lets it.
            let found = run.steady::<12>(&start, mirrored)?;
            // Twelve coordinates are never given up for fewer.
            found.ok_or(DynamicsError::NotPeriodic { mesh_periods: 0, change: f64::NAN })
        }
    }
}

struct Run<'a> {
    p: &'a Parameters,
    analysis: &'a Analysis,
    modes: &'a NaturalModes,
    watch: &'a Watch<'a>,
}

/// Relative size of the push that takes a motion off the mirror symmetry: as far as manufacture keeps halves alike.
const OFF_SYMMETRY: f64 = 1e-3;

impl Run<'_> {
    fn asked(&self) -> Asked<'_> {
        Asked { p: self.p, analysis: self.analysis, modes: self.modes }
    }

    fn limits(&self, tolerance: f64) -> Limits<'_> {
        Limits { tolerance, max_steps: self.analysis.max_steps, watch: self.watch }
    }

    fn motion<'m, const D: usize>(
        &self,
        model: &'m Model<D>,
        start: State<D>,
        integrator: Integrator,
        tolerance: f64,
    ) -> Motion<'m, D> {
        Motion::new(model, start, integrator, tolerance, self.analysis.max_steps)
    }

    fn mean_stiffness_n_per_m(&self) -> [f64; 2] {
        [0, 1].map(|j| self.p.halves[j].mesh_stiffness.mean_n_per_m())
    }

    /// The steady state; None when six coordinates do not tell the whole story.
    fn steady<const D: usize>(&self, start: &[f64; 24], off_symmetry: bool) -> Result<Option<Response>, DynamicsError> {
        let model = Model::<D>::new(self.p)?;
        let search = Search {
            model: &model,
            mean_stiffness_n_per_m: self.mean_stiffness_n_per_m(),
            limits: self.limits((1e-3 * self.analysis.accuracy).clamp(1e-14, 1e-6)),
            must_repeat: self.analysis.method == Method::Periodic,
            from_start: self.analysis.initial_state.is_some(),
        };
        let mut state = model.state_from(start);
        if off_symmetry {
            let mut push: Deviation<D> = ([0.0; D], [0.0; D]);
            for c in 0..PER_HALF - 1 {
                push.0[c] = OFF_SYMMETRY * state.x[c];
            }
            state = moved(&model, state, &push);
        }
        let found = search.run(state)?;
        if found.leaves_symmetry {
            return Ok(None);
        }
        let mut numerics = found.numerics;
        let mut recorder = self.recorder(&model, found.record);
        let motion = self.motion(&model, found.start, Integrator::Taylor, found.tolerance);
        let mut energy = self.energy(&model);
        let section = self.record(motion, found.record, &mut recorder, &mut energy)?;
        numerics += section.numerics;
        let error_estimate = match &found.orbit {
            Some((n, map)) => self.orbit_error(&model, &found, *n, map, &recorder)?,
            None => section.batch_error,
        };
        let verdict = Verdict {
            regime: match (&found.orbit, found.lyapunov) {
                (Some((1, _)), _) => Regime::Period1,
                (Some(_), _) => Regime::PeriodN,
                (None, Some(l)) if l > CHAOS_PER_MESH_PERIOD => Regime::Chaotic,
                (None, _) => Regime::QuasiPeriodic,
            },
            period: found.orbit.as_ref().map(|(n, _)| *n),
            floquet: found.floquet,
            multipliers: (!found.multipliers.is_empty()).then(|| {
                found.multipliers.iter().map(|m| Multiplier { modulus: m.norm(), angle_rad: m.arg() }).collect()
            }),
            lyapunov: found.lyapunov,
            method: if found.orbit.is_some() { "periodic" } else { "integrate" },
            error_estimate,
            energy_residual: energy.and_then(|e| e.residual()),
            t0_s: if found.orbit.is_some() { 0.0 } else { found.start.period as f64 * self.p.mesh_period_s() },
            numerics,
        };
        Ok(Some(report(&self.asked(), &model, recorder, section, verdict)))
    }

    fn integrate<const D: usize>(
        &self,
        start: &[f64; 24],
        periods: u64,
        record: u64,
    ) -> Result<Response, DynamicsError> {
        let model = Model::<D>::new(self.p)?;
        let integrator = self.analysis.integrator;
        // Measured on the reference cases: RMS error over tolerance is up to 10 for Taylor series, up to 300 for Runge–Kutta.
        let per_accuracy = match integrator {
            Integrator::Taylor => 0.05,
            Integrator::RungeKutta => 2e-3,
        };
        let tolerance = (per_accuracy * self.analysis.accuracy).max(1e-15);
        let mut motion = self.motion(&model, model.state_from(start), integrator, tolerance);
        let before = periods - record;
        // Where the comparison that measures the error sets out: far enough before the record for its own start to fade.
        let lead = before.min(COMPARED_LEAD_MESH_PERIODS);
        let mut early = motion.state;
        for period in 0..before {
            if period == before - lead {
                early = motion.state;
            }
            let fraction = period as f64 / periods as f64;
            motion.advance_period(&mut Unobserved, self.watch, fraction)?;
            self.watch.checkpoint(fraction)?;
        }
        let mut numerics = motion.numerics;
        let from = motion.state;
        let mut recorder = self.recorder(&model, record);
        let recorded = self.motion(&model, from, integrator, tolerance);
        let mut energy = self.energy(&model);
        let section = self.record(recorded, record, &mut recorder, &mut energy)?;
        numerics += section.numerics;
        let period = section.recent.settled_period(REPEATS);
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
            energy_residual: energy.and_then(|e| e.residual()),
            t0_s: from.period as f64 * self.p.mesh_period_s(),
            numerics: Numerics::default(),
        };
        if period.is_none() {
            let mut motion = self.motion(&model, section.last, integrator, tolerance);
            let exponent = lyapunov(&mut motion, &model, LYAPUNOV_MESH_PERIODS, self.watch)?;
            numerics += motion.numerics;
            verdict.lyapunov = Some(exponent);
            if exponent > CHAOS_PER_MESH_PERIOD {
                verdict.regime = Regime::Chaotic;
            }
        }
        verdict.error_estimate = if verdict.regime == Regime::Chaotic {
            section.batch_error
        } else {
            let mut other = self.recorder_of_rms(&model);
            let tight = (1e-2 * tolerance).clamp(1e-15, 1e-9);
            let mut compared = self.motion(&model, early, Integrator::Taylor, tight);
            for _ in 0..lead {
                compared.advance_period(&mut Unobserved, self.watch, 0.9)?;
                self.watch.checkpoint(0.9)?;
            }
            numerics += compared.numerics;
            compared.numerics = Numerics::default();
            numerics += self.record(compared, record, &mut other, &mut Unobserved)?.numerics;
            SAFETY * rms_difference(&recorder, &other, smallest(&model)) + ROUNDING
        };
        verdict.numerics = numerics;
        Ok(report(&self.asked(), &model, recorder, section, verdict))
    }

    /// The energy balance, where it is asked for.
    fn energy<'m, const D: usize>(&self, model: &'m Model<D>) -> Option<EnergyBalance<'m, D>> {
        self.analysis.energy_balance.then(|| EnergyBalance::new(model))
    }

    /// Records `periods` mesh periods of a motion that has just begun, `beside` looking on.
    fn record<const D: usize>(
        &self,
        mut motion: Motion<'_, D>,
        periods: u64,
        recorder: &mut Recorder<D>,
        beside: &mut impl Observer<D>,
    ) -> Result<Record<D>, DynamicsError> {
        let model = motion.model;
        // A motion of which it is known that it repeats is not asked.
        let mut recent = if periods > 8 { Section::held(model)? } else { Section::new() };
        let mut points = Vec::with_capacity(periods as usize);
        let batch = (periods / BATCHES).max(1);
        let mut batches = Vec::new();
        let main = ChannelId::mesh_acceleration(0);
        let mut snapshot = Gathered::new(false);
        let mut squares = MeanSquares::new::<D>(periods);
        for period in 0..periods {
            recent.push(motion.state);
            points.push(poincare(model, &motion.state));
            motion.advance_period(&mut Both(&mut *recorder, &mut *beside), self.watch, 0.9)?;
            self.watch.checkpoint(0.9 + 0.1 * period as f64 / periods as f64)?;
            squares.push(recorder);
            if (period + 1) % batch == 0
                && let Some(now) = recorder.gathered(main)
            {
                batches.push(now.variance_since(&snapshot));
                snapshot = *now;
            }
        }
        recent.push(motion.state);
        Ok(Record {
            recent,
            points,
            last: motion.state,
            numerics: motion.numerics,
            batch_error: standard_error(&batches),
            mean_squares: squares.finish(),
        })
    }

    /// Relative error of the RMS values of a periodic motion: the map is repeated far more accurately, the start corrected by
    /// what it then fails to close, and the values compared.
    fn orbit_error<const D: usize>(
        &self,
        model: &Model<D>,
        found: &Found<D>,
        n: u64,
        map: &nalgebra::DMatrix<f64>,
        recorder: &Recorder<D>,
    ) -> Result<f64, DynamicsError> {
        let tight = (1e-3 * found.tolerance).max(1e-15);
        let mut unused = self.recorder_of_rms(model);
        let start = State { period: 0, ..found.start };
        let once =
            self.record(self.motion(model, start, Integrator::Taylor, tight), n, &mut unused, &mut Unobserved)?;
        let shooting = Shooting::new(model, self.mean_stiffness_n_per_m(), self.limits(tight))?;
        let defect = difference(&once.last, &start);
        let Some(correction) = shooting.correction(&defect, map, n) else { return Ok(f64::INFINITY) };
        let mut better = self.recorder_of_rms(model);
        let corrected = moved(model, start, &correction);
        self.record(self.motion(model, corrected, Integrator::Taylor, tight), n, &mut better, &mut Unobserved)?;
        Ok(SAFETY * rms_difference(recorder, &better, smallest(model)) + ROUNDING)
    }

    /// Channels every response needs, and those asked for.
    fn recorder<const D: usize>(&self, model: &Model<D>, periods: u64) -> Recorder<D> {
        let mut statistics = Vec::new();
        for half in solved_halves::<D>() {
            statistics.push((ChannelId::mesh_acceleration(half), false));
            statistics.push((ChannelId::pinion_axial_acceleration(half), false));
            statistics.push((ChannelId::s(half), true));
            statistics.push((ChannelId::normal_force(half), true));
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

/// Relative change over its period below which an integrated motion counts as repeating.
const REPEATS: f64 = 1e-3;
/// Mesh periods over which a Lyapunov exponent is averaged.
const LYAPUNOV_MESH_PERIODS: u64 = 300;
/// Parts of a record whose scatter gives its standard error.
const BATCHES: u64 = 10;
/// What an error found by comparison is multiplied by, because it is a comparison with something that has an error too.
const SAFETY: f64 = 3.0;
/// Mesh periods before the record from which a run is compared with a more accurate one.
const COMPARED_LEAD_MESH_PERIODS: u64 = 50;
/// RMS values in double precision are not better than this.
const ROUNDING: f64 = 1e-13;

fn poincare<const D: usize>(model: &Model<D>, state: &State<D>) -> PoincarePoint {
    let x = |row: &[f64; D]| row[crate::dynamics::YP] - row[crate::dynamics::YG] + row[crate::dynamics::U];
    PoincarePoint { x_left_m: x(&state.x), v_x_left_m_s: x(&state.v) * model.omega_ref }
}

/// Relative standard error of an RMS from the mean squares of the parts of its record.
fn standard_error(mean_squares: &[f64]) -> f64 {
    let n = mean_squares.len() as f64;
    if mean_squares.len() < 2 {
        return f64::INFINITY;
    }
    let mean = mean_squares.iter().sum::<f64>() / n;
    let variance = mean_squares.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
    if mean > 0.0 { 0.5 * (variance / n).sqrt() / mean } else { 0.0 }
}

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
