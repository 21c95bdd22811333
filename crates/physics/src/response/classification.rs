//! Classification of a motion whose record did not repeat: transient, unstable, quasi-periodic or chaotic.
//!
//! Quasi-periodic and chaotic motions are stationary. On the torus of a quasi-periodic motion perturbations neither
//! grow nor decay; the perturbations of a transient decay as it does. As long as contact does not change the equations
//! are linear with periodic coefficients, and the Floquet multipliers decide exactly.

use super::analysis::{AppliedMethod, Regime, Response};
use super::channel::ChannelId;
use super::lyapunov::{CHAOS_PER_MESH_PERIOD, LYAPUNOV_MESH_PERIODS, lyapunov_exponent_with};
use super::poincare::PoincareSection;
use super::recorder::ChannelRecorder;
use super::recording::FinishedRun;
use super::report::{MotionAssessment, assemble_response, solved_halves};
use super::solve::{REPEATS, ResponseProblem};
use crate::dynamics::{
    DynamicModel, DynamicsError, IntegrationLimits, Integrator, Motion, MotionState, Shooting, StepCounts,
};

/// Distance from one within which the modulus of a multiplier counts as one (undamped motion).
const UNIT_MODULUS_TOLERANCE: f64 = 1e-7;
/// Slope of the logarithm of a perturbation per mesh period below which it decays. On a torus a perturbation
/// oscillates, and its slope over the mesh periods of the average stays well below this.
const DECAY_PER_MESH_PERIOD: f64 = 1e-3;
/// Displacement in multiples of the backlash beyond which the stiffness of both flanks alone determines the motion.
const BACKLASH_MULTIPLE: f64 = 100.0;
/// Parts of a growing record; their RMS values rise from each to the next, and at least twofold in all.
const RECORD_PARTS: usize = 6;
/// Recorded mesh periods of an unstable motion, at most, and the growth after which the record ends before that.
const UNSTABLE_MESH_PERIODS: f64 = 40.0;
const UNSTABLE_GROWTH: f64 = 1e3;

/// Result of the classification.
pub(super) struct Classification {
    pub regime: Regime,
    /// Largest Lyapunov exponent per mesh period; of an unstable motion its growth rate.
    pub lyapunov: f64,
    pub counts: StepCounts,
}

/// A motion continued after its record, with a perturbation.
struct ContinuedMotion {
    exponent: f64,
    /// Whether the motion has become periodic.
    repeats: bool,
    /// Whether the perturbation decays.
    decays: bool,
    counts: StepCounts,
}

impl ResponseProblem<'_> {
    /// Classifies a motion whose record did not repeat. `known`: its largest Lyapunov exponent, if computed already.
    ///
    /// # Errors
    /// [`DynamicsError`] where the motion cannot be integrated.
    pub(super) fn classify<const D: usize>(
        &self,
        model: &DynamicModel<D>,
        finished: &FinishedRun<'_, D>,
        (integrator, tolerance): (Integrator, f64),
        known: Option<f64>,
    ) -> Result<Classification, DynamicsError> {
        let last = finished.record.last;
        // A motion on a torus nearly repeats again and again; a transient begins to repeat only at its end.
        let nearly_repeated = finished.record.recent.settled_period(REPEATS).is_some();
        let continued = match known {
            Some(exponent) if exponent > CHAOS_PER_MESH_PERIOD => {
                Ok(ContinuedMotion { exponent, repeats: false, decays: false, counts: StepCounts::default() })
            }
            _ => self.continue_motion(model, last, integrator, tolerance),
        };
        // A tabulated contact force is not linear in contact either.
        let linear = !model.uses_contact_force() && contact_never_changes(&finished.recorder);
        let modulus = if linear || continued.is_err() || grows_beyond_backlash(model, finished) {
            self.fixed_contact_modulus(model, &last)?
        } else {
            0.0
        };
        let grows = modulus > 1.0 + UNIT_MODULUS_TOLERANCE;
        let (continued, diverged) = match continued {
            Ok(continued) => (continued, false),
            Err(DynamicsError::Diverged { .. }) if grows => (
                ContinuedMotion {
                    exponent: modulus.ln(),
                    repeats: false,
                    decays: false,
                    counts: StepCounts::default(),
                },
                true,
            ),
            Err(other) => return Err(other),
        };
        let regime = if linear && !diverged {
            match grows {
                true if !model.contact_can_change() => Regime::Unstable,
                true => Regime::NotSettled,
                false if modulus < 1.0 - UNIT_MODULUS_TOLERANCE => Regime::NotSettled,
                false => Regime::QuasiPeriodic,
            }
        } else if grows {
            Regime::Unstable
        } else if continued.exponent > CHAOS_PER_MESH_PERIOD {
            Regime::Chaotic
        } else if continued.decays || (continued.repeats && !nearly_repeated) {
            Regime::NotSettled
        } else {
            Regime::QuasiPeriodic
        };
        let exponent = known.unwrap_or(continued.exponent);
        let lyapunov = if regime == Regime::Unstable { modulus.ln() } else { exponent };
        Ok(Classification { regime, lyapunov, counts: continued.counts })
    }

    /// Continues the motion from the end of its record, with a perturbation.
    fn continue_motion<const D: usize>(
        &self,
        model: &DynamicModel<D>,
        from: MotionState<D>,
        integrator: Integrator,
        tolerance: f64,
    ) -> Result<ContinuedMotion, DynamicsError> {
        let mut motion = Motion::new(model, from, integrator, tolerance, self.analysis.max_steps);
        let mut section = PoincareSection::without_rigid_body(model)?;
        let mut growth = Vec::with_capacity(LYAPUNOV_MESH_PERIODS as usize);
        let exponent = lyapunov_exponent_with(&mut motion, model, LYAPUNOV_MESH_PERIODS, self.watch, |ln, state| {
            growth.push(ln);
            section.push(*state);
        })?;
        let decays = exponent == f64::NEG_INFINITY || decays(&growth[growth.len() / 10..]);
        Ok(ContinuedMotion {
            exponent,
            repeats: section.settled_period(REPEATS).is_some(),
            decays,
            counts: motion.counts,
        })
    }

    /// Largest modulus of the Floquet multipliers over one mesh period with fixed contact, rigid-body modes excluded.
    /// It is the growth of the vibration of a pair that keeps contact, or is far beyond its backlash.
    fn fixed_contact_modulus<const D: usize>(
        &self,
        model: &DynamicModel<D>,
        near: &MotionState<D>,
    ) -> Result<f64, DynamicsError> {
        const TOLERANCE: f64 = 1e-12;
        let limits = IntegrationLimits { tolerance: TOLERANCE, max_steps: self.analysis.max_steps, watch: self.watch };
        let shooting = Shooting::new(model, self.mean_stiffness_n_per_m(), limits)?;
        let mut start = MotionState { period: 0, phase: 0.0, ..*near };
        for j in 0..DynamicModel::<D>::HALVES {
            start.contact[j] = match model.uses_contact_force() {
                false if model.halves[j].load < 0.0 => -1,
                false => 1,
                true => model.contact_of(j, model.s(j, &start.x), 0.0),
            };
        }
        let period_map = shooting.period_map(&model.with_fixed_contact(), start, 1)?;
        Ok(shooting.multipliers(&period_map.monodromy).first().map_or(0.0, |m| m.norm()))
    }

    /// Response of an unstable motion: the record of its first mesh periods.
    ///
    /// # Errors
    /// `error` where the linear equations with fixed contact are not unstable; [`DynamicsError`] where not even one
    /// mesh period can be integrated.
    pub(super) fn unstable_response<const D: usize>(
        &self,
        model: &DynamicModel<D>,
        start: MotionState<D>,
        error: DynamicsError,
    ) -> Result<Response, DynamicsError> {
        const TOLERANCE: f64 = 1e-9;
        let modulus = self.fixed_contact_modulus(model, &start)?;
        if modulus.is_nan() || modulus <= 1.0 + UNIT_MODULUS_TOLERANCE {
            return Err(error);
        }
        let periods = (UNSTABLE_GROWTH.ln() / modulus.ln()).clamp(1.0, UNSTABLE_MESH_PERIODS) as u64;
        let start = MotionState { period: 0, ..start };
        let recorder = self.recorder(model, periods);
        let finished = self.record(model, (start, TOLERANCE), periods, recorder, self.energy(model))?;
        let assessment = MotionAssessment {
            regime: Regime::Unstable,
            period: None,
            floquet: Some(modulus),
            multipliers: None,
            lyapunov: Some(modulus.ln()),
            method: AppliedMethod::Integrate,
            // An RMS value of a growing motion has no accuracy.
            error_estimate: 1.0,
            energy_residual: finished.energy.and_then(|e| e.residual()),
            t0_s: 0.0,
            counts: finished.record.counts,
        };
        Ok(assemble_response(&self.report_input(), model, finished.recorder, finished.record, assessment))
    }
}

/// Whether every half stays on one flank over the whole record.
fn contact_never_changes<const D: usize>(recorder: &ChannelRecorder<D>) -> bool {
    recorder.contact_shares().iter().all(|share| share[0] == 1.0 || share[2] == 1.0)
}

/// Whether the record grows from each of its parts to the next and is far beyond the backlash.
fn grows_beyond_backlash<const D: usize>(model: &DynamicModel<D>, finished: &FinishedRun<'_, D>) -> bool {
    let far = solved_halves::<D>().any(|half| {
        finished.recorder.accumulator(ChannelId::s(half)).is_some_and(|s| {
            let s = s.finish();
            s.max > BACKLASH_MULTIPLE * model.b && s.min < -BACKLASH_MULTIPLE * model.b
        })
    });
    let squares = finished.record.mean_squares.iter().find(|(id, _)| *id == ChannelId::mesh_acceleration(0));
    let Some((_, squares)) = squares.filter(|(_, squares)| far && squares.len() >= RECORD_PARTS) else { return false };
    let part = squares.len() / RECORD_PARTS;
    let means: Vec<f64> = squares.chunks_exact(part).map(|part| part.iter().sum()).collect();
    means.windows(2).all(|two| two[1] > two[0]) && means[means.len() - 1] > 4.0 * means[0]
}

/// Whether the sum of the logarithmic growths falls steadily, over the whole and over each half of it.
fn decays(growth: &[f64]) -> bool {
    let half = growth.len() / 2;
    half > 2
        && trend(growth) < -DECAY_PER_MESH_PERIOD
        && trend(&growth[..half]) < -0.5 * DECAY_PER_MESH_PERIOD
        && trend(&growth[half..]) < -0.5 * DECAY_PER_MESH_PERIOD
}

/// Slope of the least-squares line through the running sums.
fn trend(growth: &[f64]) -> f64 {
    let n = growth.len() as f64;
    let centre = (n - 1.0) / 2.0;
    let (mut sum, mut above, mut below) = (0.0, 0.0, 0.0);
    for (i, g) in growth.iter().enumerate() {
        sum += g;
        let x = i as f64 - centre;
        above += x * sum;
        below += x * x;
    }
    above / below
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::reference::{parameters, reference};
    use crate::dynamics::{ImpactExcitation, NaturalModes, Parameters, Stiffness};
    use crate::response::{Analysis, SolutionMethod, Summary, solve};
    use crate::watch::Watch;

    fn summary(p: &Parameters, method: SolutionMethod, initial_state: Option<[f64; 24]>) -> Summary {
        let analysis = Analysis { method, initial_state, samples_per_mesh_period: 0, ..Analysis::default() };
        solve(p, &analysis, &Watch::none()).unwrap().summary
    }

    fn start(name: &str) -> [f64; 24] {
        reference().cases[name].initial_state.as_slice().try_into().unwrap()
    }

    /// Multiplies every damper by `factor`.
    fn damped(mut p: Parameters, factor: f64) -> Parameters {
        let mut dampers = Vec::new();
        for h in &mut p.halves {
            h.mesh_damping_n_s_per_m *= factor;
            dampers.extend([&mut h.pinion_lateral, &mut h.gear_lateral, &mut h.pinion_axial, &mut h.gear_axial]);
        }
        let c = &mut p.couplings;
        dampers.extend([&mut c.pinion_axial, &mut c.gear_axial, &mut c.pinion_lateral, &mut c.gear_lateral]);
        dampers.into_iter().for_each(|spring| spring.damping *= factor);
        p
    }

    /// A record that ends within the transient is not settled; the same motion integrated for long repeats.
    #[test]
    fn a_record_that_ends_too_soon_is_not_settled() {
        let begin = start("A").map(|c| 0.3 * c);
        for (case, factor, periods, record) in [
            ("A", 0.3, 45, 40),
            ("A", 0.1, 45, 40),
            ("A", 0.03, 100, 60),
            ("C", 1.0, 45, 40),
            ("C", 0.5, 60, 20),
            ("A", 0.3, 20, 5),
        ] {
            for initial_state in [None, Some(begin), Some([0.0; 24])] {
                let mut p = damped(parameters(case), factor);
                p.half_backlash_m = if case == "A" { 0.0 } else { p.half_backlash_m };
                let s = summary(
                    &p,
                    SolutionMethod::Integrate { mesh_periods: periods, record_mesh_periods: record },
                    initial_state,
                );
                println!(
                    "{case}, dampers x {factor}, {periods}: {:?}, {:?}, {:?}",
                    s.regime, s.contact, s.lyapunov_per_mesh_period
                );
                let settled = matches!(s.regime, Regime::Period1 | Regime::PeriodN);
                assert!(
                    s.regime == Regime::NotSettled || (settled && factor >= 0.3),
                    "{case}, {factor}: {:?}",
                    s.regime
                );
                assert!(!settled || s.period_mesh_periods.is_some());
                assert_eq!(s.rms_interval_95, None);
                if s.regime == Regime::NotSettled && factor >= 0.1 {
                    let long = summary(
                        &p,
                        SolutionMethod::Integrate { mesh_periods: 4000, record_mesh_periods: 40 },
                        initial_state,
                    );
                    assert!(
                        matches!(long.regime, Regime::Period1 | Regime::PeriodN),
                        "{case}, {factor}: {:?}",
                        long.regime
                    );
                }
            }
        }
    }

    /// Without dampers the transient does not decay: a motion that does not repeat is quasi-periodic, at any length of
    /// the record.
    #[test]
    fn an_undamped_vibration_is_quasi_periodic() {
        for (case, periods) in [("A", 45), ("A", 400), ("C", 100)] {
            let mut p = damped(parameters(case), 0.0);
            p.half_backlash_m = 0.0;
            for h in &mut p.halves {
                h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 9e8 };
            }
            let s = summary(
                &p,
                SolutionMethod::Integrate { mesh_periods: periods, record_mesh_periods: periods },
                Some(start("A")),
            );
            assert_eq!(s.regime, Regime::QuasiPeriodic, "{case}, {periods}: {:?}", s.lyapunov_per_mesh_period);
        }
    }

    /// A pair at twice the frequency of its mesh mode: parametric resonance, damped by `factor` of case A's dampers.
    fn resonant(factor: f64, half_backlash_m: f64) -> Parameters {
        let mut p = damped(parameters("A"), factor);
        p.half_backlash_m = half_backlash_m;
        p.halves.iter_mut().for_each(|h| h.impact = None);
        let modes = NaturalModes::new(&p).unwrap().describe(&p);
        let mesh = modes.iter().filter(|m| m.name.starts_with("mesh mode, meshes in phase")).map(|m| m.frequency_hz);
        p.mesh_frequency_hz = 2.0 * mesh.fold(0.0, f64::max);
        p
    }

    /// Every method reports growth without bound as unstable, with the growth rate of the motion.
    #[test]
    fn parametric_instability_is_unstable() {
        for (factor, half_backlash_m) in [(0.0, 0.0), (0.02, 0.0), (0.1, 0.0), (0.0, 1e-6), (0.1, 1e-6)] {
            let p = resonant(factor, half_backlash_m);
            let methods = [
                SolutionMethod::Auto,
                SolutionMethod::Integrate { mesh_periods: 60, record_mesh_periods: 40 },
                SolutionMethod::Integrate { mesh_periods: 300, record_mesh_periods: 100 },
                SolutionMethod::Integrate { mesh_periods: 3000, record_mesh_periods: 100 },
            ];
            for method in methods {
                let s = summary(&p, method, None);
                println!(
                    "dampers x {factor}, b {half_backlash_m}, {method:?}: {:?}, {:?}, {:?}, RMS {:.3e}",
                    s.regime, s.contact, s.lyapunov_per_mesh_period, s.rms.mesh_circumferential_acceleration_m_s2.left
                );
                if half_backlash_m == 0.0 {
                    assert_eq!(s.regime, Regime::Unstable, "{factor}, {method:?}");
                    let rate = s.lyapunov_per_mesh_period.unwrap();
                    assert!(rate > 0.0 && rate < 1.0, "{rate}");
                    assert!((s.floquet_modulus.map_or(rate, f64::ln) - rate).abs() < 1e-12);
                } else {
                    assert!(!matches!(s.regime, Regime::QuasiPeriodic), "{factor}, {method:?}");
                }
                let reported = s.period_mesh_periods.is_none() && s.rms_interval_95.is_none();
                assert!(reported || s.regime != Regime::Unstable, "{factor}, {method:?}");
            }
        }
        // The rate is that of the motion, from one part of a record to another.
        let p = resonant(0.02, 0.0);
        let at = |periods: u64| {
            let s = summary(&p, SolutionMethod::Integrate { mesh_periods: periods, record_mesh_periods: 1 }, None);
            (s.rms.mesh_circumferential_acceleration_m_s2.left.ln(), s.lyapunov_per_mesh_period)
        };
        let ((early, _), (late, rate)) = (at(60), at(100));
        assert!(((late - early) / 40.0 / rate.unwrap() - 1.0).abs() < 1e-2, "{early} {late} {rate:?}");
        // Enough damping makes it stable.
        assert_eq!(summary(&resonant(10.0, 0.0), SolutionMethod::Auto, None).regime, Regime::Period1);
    }

    /// Case B is chaotic with its impact, and not unstable without it.
    #[test]
    fn a_chaotic_motion_is_classified_as_chaotic() {
        let mut p = parameters("B");
        for pulse in [true, false] {
            if !pulse {
                p.halves.iter_mut().for_each(|h| h.impact = None::<ImpactExcitation>);
            }
            let s = summary(
                &p,
                SolutionMethod::Integrate { mesh_periods: 300, record_mesh_periods: 200 },
                Some(start("B")),
            );
            println!("pulse {pulse}: {:?}, {:?}", s.regime, s.lyapunov_per_mesh_period);
            assert!(!pulse || s.regime == Regime::Chaotic);
            assert_ne!(s.regime, Regime::Unstable);
        }
    }

    #[test]
    fn an_oscillation_is_no_decay_and_a_slow_fall_is() {
        let swing: Vec<f64> = (0..270).map(|i| (0.37 * f64::from(i)).sin()).collect();
        assert!(!decays(&swing));
        let falls: Vec<f64> = swing.iter().map(|g| 0.3 * g - 0.004).collect();
        assert!(decays(&falls));
        assert!((trend(&[-0.5; 40]) + 0.5).abs() < 1e-12);
    }
}
