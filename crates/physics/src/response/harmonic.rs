//! Steady motion in contact by harmonic balance, confirmed by its integration over a mesh period.

use nalgebra::Complex;

use super::analysis::{AppliedMethod, Multiplier, Regime, Response};
use super::channel::ChannelId;
use super::poincare::largest_component;
use super::recorder::ChannelRecorder;
use super::recording::FinishedRun;
use super::report::{MotionAssessment, assemble_response, solved_halves};
use super::solve::{ROUNDING, ResponseProblem, SAFETY, acceleration_floor};
use super::steady::{check_load_balance, displaced};
use crate::dynamics::{
    DynamicModel, DynamicsError, HarmonicBalance, HarmonicOrbit, MotionState, PER_HALF, Perturbation, Shooting,
    StepCounts, ZG, ZP, state_difference,
};

/// Error of a start, relative to the velocities, at which a motion counts as periodic: this part of the accuracy.
const CLOSED: f64 = 0.1;
/// Part of this error that the series is permitted.
const PART_OF_SERIES: f64 = 0.25;
/// Corrections of a start from its series.
const MOST_CORRECTIONS: usize = 4;
/// Change beyond which the series is not that of a motion in contact.
const FAR: f64 = 0.01;
/// Largest difference of the RMS accelerations by the series from those by the record: the series ends at an order, the
/// accelerations of a motion with bends in its forces do not.
const SERIES: f64 = 1e-4;
/// RMS error over tolerance of a motion by Taylor series, at most on the reference cases.
const PER_TOLERANCE: f64 = 10.0;

/// A motion over a mesh period that closes.
struct ClosedRecord<'m, const D: usize> {
    from: MotionState<D>,
    /// Error of the start by the defect at the end, relative to the velocities.
    start_error: f64,
    finished: FinishedRun<'m, D>,
}

impl ResponseProblem<'_> {
    /// The steady motion in contact near `start`; None where harmonic balance does not find a stable one to the
    /// accuracy asked for.
    ///
    /// # Errors
    /// [`DynamicsError`] of an integration, and of a load that is not balanced.
    pub(super) fn solve_by_harmonic_balance<const D: usize>(
        &self,
        model: &DynamicModel<D>,
        start: &MotionState<D>,
        tolerance: f64,
    ) -> Result<Option<Response>, DynamicsError> {
        let closed = CLOSED * self.analysis.accuracy;
        let Some(balance) = HarmonicBalance::new(model, self.mean_stiffness_n_per_m()) else { return Ok(None) };
        let Some(orbit) = balance.solve(start, PART_OF_SERIES * closed) else { return Ok(None) };
        let shooting = || Shooting::new(model, self.mean_stiffness_n_per_m(), self.limits(tolerance));
        let rigid_body = balance.has_rigid_body_modes().then(shooting).transpose()?;
        let mut counts = StepCounts::default();
        let Some(record) =
            self.closed_record((model, rigid_body.as_ref()), &balance, &orbit, (tolerance, closed), &mut counts)?
        else {
            return Ok(None);
        };
        let ClosedRecord { from, start_error, finished } = record;
        if DynamicModel::<D>::IS_TRAIN && self.difference(model, &balance, &orbit, &finished.recorder) > SERIES {
            return Ok(None);
        }
        let (floquet, multipliers) = if !self.analysis.multipliers && balance.is_surely_stable(&orbit) {
            (None, None)
        } else {
            let Some(found) = self.stable_multipliers((model, &shooting()?), from, tolerance, &mut counts)? else {
                return Ok(None);
            };
            let modulus = found.first().map(|m| m.norm());
            let polar = found.iter().map(|m| Multiplier { modulus: m.norm(), angle_rad: m.arg() }).collect();
            (modulus, Some(polar))
        };
        let error_estimate = SAFETY * start_error + PER_TOLERANCE * tolerance + ROUNDING;
        let assessment = MotionAssessment {
            regime: Regime::Period1,
            period: Some(1),
            floquet,
            multipliers,
            lyapunov: None,
            method: AppliedMethod::Periodic,
            error_estimate,
            energy_residual: finished.energy.and_then(|energy| energy.residual()),
            t0_s: 0.0,
            counts,
        };
        Ok(Some(assemble_response(&self.report_input(), model, finished.recorder, finished.record, assessment)))
    }

    /// Floquet multipliers of the orbit from `from`, largest first, those of antisymmetric perturbations included; None
    /// where it is not stable.
    fn stable_multipliers<const D: usize>(
        &self,
        (model, shooting): (&DynamicModel<D>, &Shooting<'_, D>),
        from: MotionState<D>,
        tolerance: f64,
        counts: &mut StepCounts,
    ) -> Result<Option<Vec<Complex<f64>>>, DynamicsError> {
        let period_map = shooting.period_map(model, from, 1)?;
        *counts += period_map.counts;
        let mut found = shooting.multipliers(&period_map.monodromy);
        if D == PER_HALF {
            let antisymmetric = model.antisymmetric();
            let shooting = Shooting::new(&antisymmetric, self.mean_stiffness_n_per_m(), self.limits(tolerance))?;
            let period_map = shooting.period_map(model, from, 1)?;
            *counts += period_map.counts;
            found.extend(shooting.multipliers(&period_map.monodromy));
            found.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        }
        Ok(found.first().is_some_and(|largest| largest.norm() < 1.0).then_some(found))
    }

    /// Record of a mesh period from the start of the orbit, corrected until it closes; None where it does not, or where
    /// the motion loses contact.
    fn closed_record<'m, const D: usize>(
        &self,
        (model, rigid_body): (&'m DynamicModel<D>, Option<&Shooting<'_, D>>),
        balance: &HarmonicBalance<'m, D>,
        orbit: &HarmonicOrbit<D>,
        (tolerance, closed): (f64, f64),
        counts: &mut StepCounts,
    ) -> Result<Option<ClosedRecord<'m, D>>, DynamicsError> {
        let full = |from: MotionState<D>| {
            self.record(model, (from, tolerance), 1, self.recorder(model, 1), self.energy(model))
        };
        // Series and energy balance cost more than the motion: they are recorded once it closes.
        let is_dear = self.analysis.energy_balance || !self.analysis.channels.is_empty();
        let mut from = orbit.start;
        for _ in 0..=MOST_CORRECTIONS {
            let finished = if is_dear {
                self.record(model, (from, tolerance), 1, self.rms_recorder(model), None)?
            } else {
                full(from)?
            };
            *counts += finished.record.counts;
            let touches = |shares: [f64; 3]| shares.contains(&1.0);
            if !finished.recorder.contact_shares().into_iter().all(touches) {
                return Ok(None);
            }
            let defect = state_difference(&finished.record.last, &from);
            if let Some(shooting) = rigid_body {
                check_load_balance(model, shooting, &defect)?;
            }
            let size = largest_component(&([0.0; D], from.v)).max(1e-9 * largest_component(&(from.x, [0.0; D])));
            // Torsional impacts set the rigid-body modes of a pair off.
            let set_off = rigid_body.filter(|_| !DynamicModel::<D>::IS_TRAIN);
            let closing = set_off.map_or([0.0; D], |shooting| shooting.closing_velocity(&defect, 1));
            let mut elastic = defect;
            (0..D).for_each(|c| elastic.0[c] += closing[c] * model.period_tau);
            let change = largest_component(&elastic) / size;
            if change.is_nan() || change > FAR {
                return Ok(None);
            }
            let mut correction = balance.correction(&defect);
            (0..D).for_each(|c| correction.1[c] += closing[c]);
            let start_error = if DynamicModel::<D>::IS_TRAIN {
                largest_component(&correction) / size
            } else {
                largest_by_direction(&correction, &from.v, size)
            };
            if start_error <= closed {
                let finished = if is_dear { full(from)? } else { finished };
                return Ok(Some(ClosedRecord { from, start_error, finished }));
            }
            from = displaced(model, from, &correction);
        }
        Ok(None)
    }

    /// Largest relative difference of the RMS accelerations by the record from those by the series.
    fn difference<const D: usize>(
        &self,
        model: &DynamicModel<D>,
        balance: &HarmonicBalance<'_, D>,
        orbit: &HarmonicOrbit<D>,
        recorder: &ChannelRecorder<D>,
    ) -> f64 {
        let floor = acceleration_floor(model);
        let [mesh, axial] = balance.rms_accelerations_m_s2(orbit);
        let mut worst = 0.0f64;
        for half in solved_halves::<D>() {
            let j = usize::from(half);
            let pairs =
                [(ChannelId::mesh_acceleration(half), mesh[j]), (ChannelId::pinion_axial_acceleration(half), axial[j])];
            for (id, by_series) in pairs {
                let Some(recorded) = recorder.accumulator(id) else { continue };
                let rms = recorded.mean_and_square().1.sqrt();
                if rms > floor {
                    worst = worst.max((rms - by_series).abs() / rms);
                }
            }
        }
        worst
    }
}

/// Largest part of a correction over the velocity, of the axial motions and of the others apart: axial accelerations
/// are to be as exact as the circumferential ones, though they are smaller. Not of a train. `size`: of the velocity.
fn largest_by_direction<const D: usize>(correction: &Perturbation<D>, velocity: &[f64; D], size: f64) -> f64 {
    /// Smallest part of the velocity that counts as motion in a direction.
    const LEAST: f64 = 1e-4;
    let is_axial = |c: usize| matches!(c % PER_HALF, ZP | ZG);
    let largest = |values: &[f64; D], axial: bool| {
        (0..D).filter(|c| is_axial(*c) == axial).fold(0.0f64, |m, c| m.max(values[c].abs()))
    };
    let part = |axial: bool| {
        let by = largest(&correction.0, axial).max(largest(&correction.1, axial));
        by / largest(velocity, axial).max(LEAST * size)
    };
    part(true).max(part(false))
}
