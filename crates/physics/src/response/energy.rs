//! Energy balance of a recorded motion by the work–energy theorem, a check that is independent of the integrator.

use super::statistics::GAUSS;
use crate::dynamics::{DynamicModel, Observer, Segment, is_rigid_rotation};

/// Longest record that is balanced; of longer ones the first mesh periods are.
const MAX_MESH_PERIODS: u64 = 200;

/// Ratio of velocities to displacements (scaled time) below which a motion counts as at rest.
const REST_VELOCITY_RATIO: f64 = 1e-9;

/// Change of the kinetic energy of a motion against the work of all forces, ∫ Σ_c F_c v_c dt with the forces of `model`
/// (springs, dampers, mesh, impacts, torques) along the solution, by Gauss–Legendre quadrature on every segment. The
/// rigid rotation of each half (w), or the rigid-body modes of a train, are excluded.
pub(super) struct EnergyBalance<'m, const D: usize> {
    model: &'m DynamicModel<D>,
    masses: [f64; D],
    /// Kinetic energy at the start over ω_ref², J s².
    initial_energy: Option<f64>,
    /// Mesh period at which the balance ends.
    until: u64,
    final_energy: f64,
    work: f64,
    /// ∫ Σ_c |F_c v_c| dt.
    absolute_work: f64,
    largest_x: f64,
    largest_v: f64,
}

impl<'m, const D: usize> EnergyBalance<'m, D> {
    pub(crate) fn new(model: &'m DynamicModel<D>) -> Self {
        let mut masses = model.masses_kg();
        (0..D).filter(|c| is_rigid_rotation(D, *c)).for_each(|c| masses[c] = 0.0);
        Self {
            model,
            masses,
            initial_energy: None,
            until: 0,
            final_energy: 0.0,
            work: 0.0,
            absolute_work: 0.0,
            largest_x: 0.0,
            largest_v: 0.0,
        }
    }

    /// `abs(ΔE − work)` over the integral of the absolute power of the forces on each coordinate. None where nothing
    /// moved.
    pub(crate) fn residual(&self) -> Option<f64> {
        let change = self.final_energy - self.initial_energy?;
        let moves = self.largest_v > REST_VELOCITY_RATIO * self.largest_x && self.absolute_work > 0.0;
        moves.then(|| (change - self.work).abs() / self.absolute_work)
    }

    fn kinetic(&self, v: &[f64; D]) -> f64 {
        (0..D).map(|c| 0.5 * self.masses[c] * v[c] * v[c]).sum()
    }
}

impl<const D: usize> Observer<D> for EnergyBalance<'_, D> {
    fn segment(&mut self, segment: &Segment<'_, D>) {
        if self.initial_energy.is_none() {
            self.initial_energy = Some(self.kinetic(&segment.rows[1]));
            self.until = segment.period + MAX_MESH_PERIODS;
        }
        if segment.period >= self.until {
            return;
        }
        let per_tau = 1.0 / self.model.period_tau;
        let interior = segment.phase + 0.5 * segment.h * per_tau;
        for &(node, weight) in GAUSS.iter() {
            let t = node * segment.h;
            let (x, v) = segment.at(t);
            let a = self.model.acceleration(segment.phase + t * per_tau, interior, &x, &v);
            for c in 0..D {
                let power = self.masses[c] * a[c] * v[c] * weight * segment.h;
                self.work += power;
                self.absolute_work += power.abs();
                if self.masses[c] > 0.0 {
                    self.largest_x = self.largest_x.max(x[c].abs());
                    self.largest_v = self.largest_v.max(v[c].abs());
                }
            }
        }
        self.final_energy = self.kinetic(&segment.at(segment.h).1);
    }
}

/// For an optional balance.
impl<const D: usize> Observer<D> for Option<EnergyBalance<'_, D>> {
    fn segment(&mut self, segment: &Segment<'_, D>) {
        if let Some(balance) = self {
            balance.segment(segment);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::tests::reference::{parameters, reference};
    use crate::dynamics::{Integrator, Motion, Parameters, Stiffness};
    use crate::watch::Watch;
    use herringbone_oracle::Tolerance::Absolute;
    use herringbone_oracle::{check, check_worst};

    const TOPIC: &str = "Response: energy balance";

    /// Residual over `periods` of the motion `motion` from the case's start, by the forces of `judge`.
    fn residual<'m, const D: usize>(judge: &'m DynamicModel<D>, mut motion: Motion<'m, D>, periods: u64) -> f64 {
        let mut balance = EnergyBalance::new(judge);
        for _ in 0..periods {
            motion.advance_period(&mut balance, &Watch::none(), 0.0).unwrap();
        }
        balance.residual().unwrap()
    }

    fn motion<'m, const D: usize>(model: &'m DynamicModel<D>, case: &str, tolerance: f64) -> Motion<'m, D> {
        let start: [f64; 24] = reference().cases[case].initial_state.as_slice().try_into().unwrap();
        Motion::new(model, model.state_from(&start), Integrator::Taylor, tolerance, u64::MAX)
    }

    #[test]
    fn quadrature_is_exact_for_powers_up_to_31() {
        let errors = (0..32).map(|n| GAUSS.iter().map(|(x, w)| w * x.powi(n)).sum::<f64>() * f64::from(n + 1) - 1.0);
        check_worst(TOPIC, "Gauss–Legendre quadrature of powers 0 to 31", errors, 1e-14);
    }

    #[test]
    fn the_taylor_method_balances_to_its_tolerance() {
        for case in ["A", "B", "C"] {
            let model = DynamicModel::<12>::new(&parameters(case)).unwrap();
            for (tolerance, limit) in [(1e-6, 1e-6), (1e-9, 1e-9), (1e-13, 2e-13)] {
                let found = residual(&model, motion(&model, case, tolerance), 40);
                check_worst(TOPIC, &format!("case {case}, 40 periods, Taylor at {tolerance:.0e}"), [found], limit);
            }
        }
    }

    /// Contact kept, constant step: the residual falls with the step at least with the order of the method, four.
    /// (Phase errors do not change the energy, so it can fall faster.)
    #[test]
    fn a_coarse_method_is_seen_with_its_order() {
        let mut p: Parameters = parameters("A");
        p.halves.iter_mut().for_each(|h| h.impact = None);
        let model = DynamicModel::<6>::new(&p).unwrap();
        let found = [32.0, 64.0, 128.0, 256.0].map(|parts| {
            let step = model.period_tau / parts;
            residual(&model, motion(&model, "A", 1e-9).with_fixed_runge_kutta(step), 20)
        });
        println!("Runge–Kutta with 32 to 256 steps per period: {}", found.map(|r| format!("{r:.1e}")).join(", "));
        assert!(found[0] > 1e-4);
        let order = (found[0] / found[3]).log2() / 3.0;
        check(TOPIC, "order of the residual, Runge–Kutta on case A (at least 4)", order, 5.0, Absolute(1.0));
    }

    /// The same motion with forces that differ by one part in a thousand in one place.
    #[test]
    fn a_wrong_force_is_caught() {
        for case in ["A", "B", "C"] {
            let right = DynamicModel::<6>::new(&parameters(case)).unwrap();
            let wrong = |change: fn(&mut Parameters)| {
                let mut p = parameters(case);
                change(&mut p);
                let judge = DynamicModel::<6>::new(&p).unwrap();
                assert_eq!(judge.omega_ref, right.omega_ref, "the same scale of time");
                residual(&judge, motion(&right, case, 1e-11), 40)
            };
            let damping = wrong(|p| p.halves.iter_mut().for_each(|h| h.mesh_damping_n_s_per_m *= 1.001));
            let torque = wrong(|p| p.halves.iter_mut().for_each(|h| h.pinion_torque_nm *= 1.001));
            let stiffness = wrong(|p| {
                p.halves.iter_mut().for_each(|h| {
                    if let Stiffness::Fourier { harmonics, .. } = &mut h.mesh_stiffness {
                        harmonics[0].phase_rad += 1e-3;
                    }
                });
            });
            let nothing = wrong(|_| {});
            println!(
                "{case}: nothing wrong {nothing:.1e}, damping {damping:.1e}, torque {torque:.1e}, phase of the stiffness {stiffness:.1e}"
            );
            assert!([damping, torque, stiffness].iter().all(|r| *r > 1e-7 && *r > 1e4 * nothing), "{case}");
        }
    }

    #[test]
    fn rest_has_no_balance() {
        let mut p = parameters("A");
        for h in &mut p.halves {
            h.impact = None;
            h.mesh_stiffness = Stiffness::Constant { mean_n_per_m: 9e8 };
        }
        let model = DynamicModel::<6>::new(&p).unwrap();
        let mut balance = EnergyBalance::new(&model);
        motion(&model, "A", 1e-9).advance_period(&mut balance, &Watch::none(), 0.0).unwrap();
        assert_eq!(balance.residual(), None);
    }
}
