//! Exact response of a pair at rest: no load, no impact, and a start at rest.

use super::analysis::{AppliedMethod, ContactState, Halves, Regime, Response, SolutionMethod};
use super::recording::RecordedRun;
use super::report::{MotionAssessment, assemble_response};
use super::solve::ResponseProblem;
use crate::dynamics::{
    DynamicModel, DynamicsError, ImpactExcitation, Integrator, MotionState, PER_HALF, Spring, StepCounts, U,
    integrate_trajectory, number_of_coordinates,
};

impl ResponseProblem<'_> {
    /// Whether the pair stays at its start: without load and impact, at rest in the middle of its backlash (initial
    /// state zero) or, without an initial state, with the driving flanks in contact without force, the limit of
    /// vanishing load.
    pub(super) fn stays_at_rest(&self) -> bool {
        let [left, right] = &self.p.halves;
        if [left, right].iter().any(|h| h.displacement_excitation.iter().any(|e| e.amplitude != 0.0)) {
            return false;
        }
        if let Some(train) = &self.p.train {
            let unloaded = train.load_n.iter().all(|load| *load == 0.0)
                && [left, right].iter().all(|h| h.impact.as_ref().is_none_or(ImpactExcitation::is_zero));
            let still = self.given_start().is_none_or(|start| start.iter().all(|c| *c == 0.0));
            return unloaded && still && train.opens_freely();
        }
        let unloaded = [left, right]
            .iter()
            .all(|h| h.pinion_torque_nm == 0.0 && h.impact.as_ref().is_none_or(ImpactExcitation::is_zero));
        // A torsional coupling of unequal halves would be strained where both are in contact.
        let c = &self.p.couplings;
        let uncoupled = c.pinion_torsion == Spring::default() && c.gear_torsion == Spring::default();
        let inertias = |h: &crate::dynamics::HalfParameters| (h.pinion_inertia_kg_m2, h.gear_inertia_kg_m2);
        let still = self.analysis.initial_state.is_none_or(|start| start.iter().all(|c| *c == 0.0));
        unloaded && still && (uncoupled || inertias(left) == inertias(right))
    }

    /// Response of a pair at rest.
    ///
    /// # Errors
    /// [`DynamicsError`] for invalid parameters.
    pub(super) fn rest_response(&self) -> Result<Response, DynamicsError> {
        match number_of_coordinates(self.p, true) {
            6 => self.rest_response_in::<6>(),
            12 => self.rest_response_in::<12>(),
            52 => self.rest_response_in::<52>(),
            76 => self.rest_response_in::<76>(),
            _ => self.rest_response_in::<100>(),
        }
    }

    fn rest_response_in<const D: usize>(&self) -> Result<Response, DynamicsError> {
        let model = DynamicModel::<D>::new(self.p)?;
        let touching = self.given_start().is_none() || model.b == 0.0;
        let (method, from, periods) = match self.analysis.method {
            SolutionMethod::Integrate { mesh_periods, record_mesh_periods } => {
                let end = mesh_periods.max(1);
                let periods = record_mesh_periods.clamp(1, end);
                (AppliedMethod::Integrate, end - periods, periods)
            }
            SolutionMethod::Auto | SolutionMethod::Periodic => (AppliedMethod::Periodic, 0, 1),
        };
        // In contact without force: the contact is fixed as open, so that rounding does not close it.
        let side = if model.b == 0.0 { 1 } else { 0 };
        let mut start = MotionState { period: from, phase: 0.0, x: [0.0; D], v: [0.0; D], contact: [side; 2] };
        if touching && DynamicModel::<D>::IS_TRAIN {
            start.x = model.static_state_of_train(self.mean_stiffness_n_per_m()).x;
        } else if touching {
            (0..DynamicModel::<D>::HALVES)
                .for_each(|j| start.x[j * PER_HALF + U] = model.first_contact_displacement_m(j) / model.cos);
        }
        let fixed = model.with_fixed_contact();
        let span = (from, from + periods);
        let mut run = RecordedRun::new(&fixed, start, 1e-6, span, self.recorder(&fixed, periods))?;
        integrate_trajectory(&mut run, Integrator::Taylor, self.analysis.max_steps, self.watch)?;
        let finished = run.finish()?;
        let assessment = MotionAssessment {
            regime: Regime::Period1,
            period: Some(1),
            floquet: None,
            multipliers: None,
            lyapunov: None,
            method,
            error_estimate: 0.0,
            energy_residual: None,
            t0_s: from as f64 * self.p.mesh_period_s(),
            counts: StepCounts::default(),
        };
        let mut response =
            assemble_response(&self.report_input(), &fixed, finished.recorder, finished.record, assessment);
        if touching {
            response.summary.contact = ContactState::Continuous;
            response.summary.contact_share = Halves { left: 1.0, right: 1.0 };
        }
        Ok(response)
    }
}

#[cfg(test)]
mod tests {
    use crate::dynamics::tests::reference::parameters;
    use crate::dynamics::{ImpactExcitation, Stiffness};
    use crate::response::{Analysis, ContactState, Regime, SolutionMethod, solve, solve_many};
    use crate::watch::Watch;

    /// Without load and impact: exactly at rest, with any stiffness, backlash and method.
    #[test]
    fn an_unloaded_pair_without_impact_rests() {
        let integrate = SolutionMethod::Integrate { mesh_periods: 30, record_mesh_periods: 10 };
        for (case, half_backlash_m) in [("A", 0.0), ("A", 2e-5), ("B", 1e-6), ("C", 3.7e-5)] {
            for method in [SolutionMethod::Auto, SolutionMethod::Periodic, integrate] {
                for (pulse, initial_state) in [(None, None), (Some(0.0), None), (None, Some([0.0; 24]))] {
                    let mut p = parameters(case);
                    p.half_backlash_m = half_backlash_m;
                    for h in &mut p.halves {
                        h.pinion_torque_nm = 0.0;
                        h.impact = pulse.map(|force_n| ImpactExcitation::HalfSine {
                            force_n,
                            duration_mesh_periods: 0.1,
                            start_mesh_periods: 0.0,
                        });
                    }
                    let analysis = Analysis { method, initial_state, ..Analysis::default() };
                    let alone = solve(&p, &analysis, &Watch::none()).unwrap();
                    let together = solve_many(std::slice::from_ref(&p), &analysis, &Watch::none()).unwrap();
                    assert_eq!(together, [Ok(alone.clone())]);
                    let s = alone.summary;
                    let what = format!("{case}, {half_backlash_m}, {method:?}, start {}", initial_state.is_some());
                    assert_eq!((s.regime, s.error_estimate, s.dynamic_factor), (Regime::Period1, 0.0, None), "{what}");
                    assert!(s.rms.channels.values().all(|rms| *rms == 0.0), "{what}: {:?}", s.rms.channels);
                    let apart = initial_state.is_some() && half_backlash_m > 0.0;
                    let contact = if apart { ContactState::Apart } else { ContactState::Continuous };
                    assert_eq!((s.contact, s.contact_share.left), (contact, if apart { 0.0 } else { 1.0 }), "{what}");
                    let s_m = if apart { 0.0 } else { half_backlash_m };
                    assert!((s.min_displacement_m - s_m).abs() <= 1e-12 * s_m, "{what}: {}", s.min_displacement_m);
                }
            }
        }
    }

    /// A pulse, or any load, moves the pair.
    #[test]
    fn a_load_or_a_pulse_moves() {
        let mut p = parameters("A");
        p.halves.iter_mut().for_each(|h| h.pinion_torque_nm = 1e-9);
        assert!(solve(&p, &Analysis::default(), &Watch::none()).unwrap().summary.dynamic_factor.is_some());
        p.halves.iter_mut().for_each(|h| {
            h.pinion_torque_nm = 0.0;
            h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 9e8 };
        });
        p.half_backlash_m = 0.0;
        let s = solve(&p, &Analysis::default(), &Watch::none()).unwrap().summary;
        assert!(s.rms.mesh_circumferential_acceleration_m_s2.left > 1.0);
    }
}
